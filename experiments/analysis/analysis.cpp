#include "experiments/analysis/analysis.h"

#include "common/core/error.h"
#include "common/core/number_text.h"
#include "common/images/image_file.h"
#include "experiments/analysis/comparison.h"
#include "experiments/analysis/method_names.h"
#include "experiments/analysis/row_fields.h"
#include "experiments/analysis/unsampled_light.h"
#include "experiments/analysis/warnings.h"
#include "experiments/metrics/energy_test.h"
#include "experiments/metrics/few_hits.h"
#include "experiments/plan/experiment_file.h"
#include "experiments/plan/label_checks.h"
#include "experiments/references/agreement.h"
#include "experiments/references/reference_methods.h"
#include "experiments/results/judgement.h"
#include "experiments/results/manifest.h"
#include "experiments/results/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace gib {

namespace {

/// The replicates of one method on one scene.
struct Replicates {
    Runs cells;
    std::vector<std::string> folders = {};  ///< names of the cells' folders
    std::vector<ComponentImages> images = {};
    std::vector<Image> totals = {};  ///< the compared part of each image
    bool is_lit = false;             ///< whether an image has light in it

    Replicates(const Runs& runs, const ResultFolder& folder, const Judgement& judgement) : cells(runs) {
        for (const Cell* cell : runs) {
            folders.push_back(cell_folder_name(cell->scene, cell->method, cell->seed));
            const LayeredImage file = read_image(folder.cell_image(folders.back()));
            images.push_back(components_in(file));
            totals.push_back(judgement.total_of(file));
            is_lit = is_lit || !is_black(file.find("") ? *file.find("") : totals.back());
        }
    }
    bool are_equal() const {
        return std::ranges::all_of(totals, [&](const Image& x) { return x.rgb == totals.front().rgb; });
    }
};

/// The part of a row that needs no reference.
TableRow plain_row(const Replicates& replicates, const ResultIndex& index, Layer layer) {
    const Cell& first = *replicates.cells.front();
    TableRow row;
    row.scene = first.scene;
    row.method = first.method;
    row.layer = layer;
    row.is_external = index.is_external(row.method);
    row.cpus = processors_of(replicates.cells);
    row.least_passes = first.last().passes;
    row.seeds = static_cast<int>(replicates.cells.size());
    for (const Cell* cell : replicates.cells) {
        row.least_passes = std::min(row.least_passes, cell->last().passes);
        row.most_passes = std::max(row.most_passes, cell->last().passes);
        row.seconds += cell->last().seconds / row.seeds;
        row.prepare_seconds += cell->prepare_seconds / row.seeds;
        row.nonfinite += cell->last().counts.non_finite.count;
        row.peak_rss_mib = std::max(row.peak_rss_mib, cell->last().peak_rss_mib);
    }
    row.effects_missing = index.left_out_by(row.scene, row.method).effects;
    return row;
}

TableRow judged_row(const Replicates& replicates, const ResultIndex& index, Layer layer,
                    const std::vector<Image>& images, const Image& missed, const ReferenceLayer& reference,
                    const Denominators& denominators, const ReferenceQuality& quality) {
    TableRow row = plain_row(replicates, index, layer);
    row.noise_floor = quality.noise_floors.at(layer);
    row.floor_known = quality.error_known;
    row.epsilon = quality.epsilon;
    const Image& r_total = denominators.plain();
    row.statistics = replicate_statistics(images, reference, denominators);
    row.robust = robust_error(images, reference.mean, r_total, row.epsilon);
    row.noise = noise_spectrum(images, r_total);
    row.bias = bias_spectrum(images, reference);
    row.balance = energy_balance(images, reference, r_total);
    allow_for_missed_light(row, images, missed, reference, denominators);
    if (!row.floor_known) {
        // The reference's noise counts as bias in all of these.
        row.statistics->bias2.reset();
        row.statistics->rel_bias2.reset();
        row.bias.clear();
        if (row.balance) row.balance->verdict = BalanceVerdict::inconclusive;
    }
    add_curve_numbers(row, replicates.cells);
    return row;
}

/// Whether the images of a method that is unbiased by theory contradict this. `unsampled`: energy of unsampled light
/// [W/(sr m^2)]. All rows that the table can have share the level (Bonferroni).
void test_energy(TableRow& row, const ResultIndex& index, const Judgement& judgement, const std::vector<Image>& images,
                 const ReferenceLayer& reference, const Components& left_out, double unsampled) {
    if (!row.balance || !is_unbiased_by_theory(row, left_out)) return;
    if (!find_method(MethodLabel::parse(row.method).name).samples_pixels_alone) return;
    const std::size_t rows = index.scenes.size() * index.methods.size() * (component_count + 1);
    const SampledLight sampled{.passes = row.least_passes, .brightest = judgement.brightest_light()};
    const auto test =
        energy_test(images, sampled, reference, *row.balance, unsampled, energy_alpha / static_cast<double>(rows));
    if (!test || !test->is_rejected) return;
    row.contradicted_in = {row.layer};
    row.balance->excess = test->excess;
    row.balance->verdict = BalanceVerdict::differs;
}

/// The mean FLIP of the replicates; empty if one of them has no FLIP value.
std::optional<double> mean_flip(const Replicates& replicates, const std::vector<Image>& totals, const Image& r_total,
                                const ResultFolder& folder) {
    double sum = 0;
    for (std::size_t i = 0; i < totals.size(); ++i) {
        const auto flip = cell_flip(folder, replicates.folders[i], totals[i], r_total);
        if (!flip) return std::nullopt;
        sum += *flip;
    }
    return sum / static_cast<double>(totals.size());
}

std::vector<TableRow> rows_of(const Replicates& replicates, const ResultIndex& index, const Judgement& judgement,
                              const ReferenceQuality& quality, const ResultFolder& folder) {
    std::vector<TableRow> rows;
    const Denominators& denominators = judgement.denominators(quality.epsilon);
    const std::vector<Image>& totals = replicates.totals;
    const Cell& first = *replicates.cells.front();
    const Components left_out = index.left_out_by(first.scene, first.method).components;
    Image all_unsampled(totals.front().width, totals.front().height), all_missed = all_unsampled;
    for (Component c : all_components) {
        std::vector<Image> images;
        for (const auto& image : replicates.images)
            if (image[c]) images.push_back(*image[c]);
        if (images.size() != replicates.images.size()) continue;
        if (const auto* reference = judgement.component(c)) {
            const Image missed = light_missed_by(*reference, images);
            all_missed += missed;
            rows.push_back(
                judged_row(replicates, index, layer_of(c), images, missed, *reference, denominators, quality));
            if (left_out.has(c)) continue;
            const Image unsampled = unsampled_light(images, reference->mean);
            const double unsampled_energy =
                allow_for_unsampled_light(rows.back(), images, unsampled, *reference, denominators);
            test_energy(rows.back(), index, judgement, images, *reference, left_out, unsampled_energy);
            all_unsampled += unsampled;
        } else if (!judgement.is_resolved(c)) rows.push_back(plain_row(replicates, index, layer_of(c)));
    }
    if (judgement.is_empty()) {
        rows.insert(rows.begin(), plain_row(replicates, index, Layer::total));
        return rows;
    }
    if (std::ranges::none_of(rows, [](const TableRow& row) { return row.statistics.has_value(); }))
        all_missed = light_missed_by(judgement.total(), totals);  // images without components
    rows.insert(rows.begin(), judged_row(replicates, index, Layer::total, totals, all_missed, judgement.total(),
                                         denominators, quality));
    TableRow& total = rows.front();
    total.flip = mean_flip(replicates, totals, denominators.plain(), folder);
    const double unsampled_energy =
        allow_for_unsampled_light(total, totals, all_unsampled, judgement.total(), denominators);
    test_energy(total, index, judgement, totals, judgement.total(), left_out, unsampled_energy);
    for (std::size_t i = 1; i < rows.size(); ++i)
        total.contradicted_in.insert(total.contradicted_in.end(), rows[i].contradicted_in.begin(),
                                     rows[i].contradicted_in.end());
    return rows;
}

ReferenceQuality quality_of(const IndexScene& scene, const Reference& reference, const Judgement& judgement,
                            const std::optional<double>& given_epsilon) {
    const double epsilon = judgement.epsilon(given_epsilon);
    const ReferenceLayer& judged = judgement.is_empty() ? reference.total : judgement.total();
    ReferenceQuality quality{.scene = scene.name,
                             .method = scene.reference_method,
                             .relative_error = relative_standard_error(judged, judgement.denominators(epsilon)),
                             .error_known = judged.standard_error || !judged.groups.empty(),
                             .target = scene.target,
                             .notes = scene.notes,
                             .epsilon = epsilon};
    const auto units = number_from<std::uint64_t>(attribute_in(reference.metadata, "passes")).value_or(0);
    quality.samples = std::max<std::size_t>(reference.total.groups.size(), 1) *
                      passes_in(shares_in(attribute_in(reference.metadata, "makers")), units);
    for (const auto& [name, layer] : judgement.layers())
        quality.noise_floors[*layer_named(name)] = least_resolved(*layer, judgement.denominators(epsilon));
    return quality;
}

/// The reference of a scene. Empty if the scene has none yet, or, with a message in `damage`, if its file is missing or
/// damaged.
std::optional<Reference> reference_of(const IndexScene& scene, const ResultFolder& folder,
                                      std::vector<std::string>& damage) {
    if (scene.reference.empty()) return std::nullopt;
    const std::string path = folder.reference_image(scene.name);
    const auto damaged = [&](const std::string& what) {
        damage.push_back(what + "; the scene is left out");
        return std::nullopt;
    };
    if (!std::filesystem::exists(path)) return damaged(path + ": the file is missing");
    try {
        return read_reference(path);
    } catch (const InputError& error) {
        return damaged(error.what());
    }
}

/// Appends the complete cells of a scene to the analysis.
void add_cells(const IndexScene& scene, const ResultFolder& folder, Analysis& analysis) {
    const ResultIndex& index = analysis.index;
    for (const auto& method : index.methods)
        for (int seed = 1; seed <= index.seeds; ++seed) {
            const std::string name = cell_folder_name(scene.name, method, static_cast<std::uint64_t>(seed));
            const auto key = index.cell_keys.find(name);
            std::string damage;
            auto cell = key == index.cell_keys.end() ? std::nullopt : folder.read_cell(name, key->second, &damage);
            if (!damage.empty()) analysis.damage.push_back(damage + "; the cell is left out");
            if (cell) analysis.cells.push_back(*std::move(cell));
            else ++analysis.missing_cells;
        }
}

/// Equal images of another renderer count as one, because its command may ignore the seed.
void drop_equal_cells(const std::string& scene, Analysis& analysis) {
    for (const auto& method : analysis.index.externals) {
        const auto is_of_method = [&](const Cell& c) { return c.scene == scene && c.method == method; };
        const auto first = std::ranges::find_if(analysis.cells, is_of_method);
        if (first == analysis.cells.end() || std::ranges::count_if(analysis.cells, is_of_method) < 2) continue;
        const std::string image = first->image;
        if (!std::ranges::all_of(analysis.cells, [&](const Cell& c) { return !is_of_method(c) || c.image == image; }))
            continue;
        analysis.cells.erase(std::remove_if(first + 1, analysis.cells.end(), is_of_method), analysis.cells.end());
        analysis.warnings.push_back(
            {.kind = Warning::Kind::equal_images,
             .scene = scene,
             .sentence =
                 fmt::format("all seeds of {} have the same image and count as one; a command needs {{seed}} to "
                             "make others",
                             method)});
    }
}

/// The path of the experiment file as it was typed.
std::string experiment_file_of(const ResultFolder& folder) {
    try {
        return read_manifest(folder.file("manifest.json")).experiment_file;
    } catch (const InputError&) {
        return "EXPERIMENT.toml";  // of a run that was killed early
    }
}

/// The command that runs the experiment of a folder again; empty if there is none because the folder is that of a
/// tuning.
std::string run_command_of(const ResultFolder& folder, const ResultIndex& index) {
    if (std::filesystem::exists(folder.file("tune.json"))) return "";
    return fmt::format("gibench run '{}' --out '{}' --seeds {} --threads {}", experiment_file_of(folder), folder.path(),
                       index.seeds, index.threads);
}

/// Equal images give no interval of their method's mean energy, because all of them may have missed a rare path.
/// Exceptions: a method without random numbers, which is recognized by equal totals and is not unbiased by theory; a
/// component that the method does not sample, so that its black images are no chance.
void drop_intervals_of_equal_images(TableRow& row, bool totals_are_equal) {
    if (!row.balance || row.balance->energy.variance.variance != 0) return;
    if (row.balance->verdict != BalanceVerdict::differs || !std::isfinite(row.balance->excess.value)) return;
    if (totals_are_equal && !row.is_unbiased) return;
    if (row.balance->energy.value == 0 && row.components_missing.touches(row.layer)) return;
    row.balance->verdict = BalanceVerdict::inconclusive;
    row.balance->excess.interval.reset();
}

/// Removes the numbers of a scene in which nothing emits light: its images are right, and no time compares.
void drop_dark_scene(const std::string& scene, Analysis& analysis) {
    std::erase_if(analysis.rows, [&](const TableRow& row) { return row.scene == scene; });
    std::erase_if(analysis.cells, [&](const Cell& cell) { return cell.scene == scene; });
    analysis.warnings.push_back({.kind = Warning::Kind::no_light,
                                 .scene = scene,
                                 .sentence = "the scene has no light: its reference and all images are black"});
}

/// Whether the reference consists of images of this method, so that a difference between them says nothing of the
/// reference.
bool has_made(const std::string& method, const Reference& reference) {
    const std::string methods = attribute_in(reference.metadata, "makers");
    const std::string only = attribute_in(reference.metadata, "method");
    if (methods.empty()) return !only.empty() && MethodLabel::parse(only).name == method;
    const auto shares = shares_in(methods);
    return std::ranges::any_of(shares,
                               [&](const MethodShare& share) { return share.passes > 0 && share.method == method; });
}

/// The components of the reference that images of a method contradict (agreement.h).
std::vector<Contradiction> contradicted_by(const Replicates& replicates, const ResultIndex& index,
                                           const Components& left_out, const Reference& reference) {
    const std::string& method = replicates.cells.front()->method;
    if (index.is_external(method) || !filter_of(MethodLabel::parse(method)).empty()) return {};
    std::vector<Component> unbiased_for;
    const bool is_other = !has_made(MethodLabel::parse(method).name, reference);
    for (const Component c : all_components)
        if (is_other && is_unbiased_by_theory(plain_row(replicates, index, layer_of(c)), left_out))
            unbiased_for.push_back(c);
    return contradictions(reference, replicates.images, unbiased_for);
}

/// The findings that the images of a scene support.
struct SceneRows {
    std::vector<TableRow> rows = {};
    Components unjudged = {};  ///< ReferenceQuality::unjudged
    bool is_lit = false;       ///< whether an image has light in it
    std::map<Component, std::pair<std::string, Contradiction>> contradictions = {};  ///< with the method that shows it
};

SceneRows rows_of_scene(const ReferenceQuality& quality, const Reference& reference, const Judgement& judgement,
                        const ResultFolder& folder, const Analysis& analysis) {
    SceneRows all{.is_lit = !is_black(reference.total.mean)};
    SceneLight light(reference);
    const CellsByMethod cells = cells_by_method(analysis, quality.scene);
    std::set<std::string> equal;  // methods all of whose totals are equal
    for (const auto& method : analysis.index.methods) {
        const auto found = cells.find(method);
        if (found == cells.end()) continue;
        const Replicates replicates(found->second, folder, judgement);
        const Components left_out = analysis.index.left_out_by(quality.scene, method).components;
        for (const Contradiction& c : contradicted_by(replicates, analysis.index, left_out, reference))
            all.contradictions.try_emplace(c.component, method, c);
        all.is_lit = all.is_lit || replicates.is_lit;
        if (replicates.are_equal()) equal.insert(method);
        light.add(replicates.images, left_out);
        for (auto& row : rows_of(replicates, analysis.index, judgement, quality, folder))
            all.rows.push_back(std::move(row));
    }
    for (TableRow& row : all.rows) {
        const Components left_out = analysis.index.left_out_by(quality.scene, row.method).components;
        row.components_missing = light.holding_light(left_out);
        row.is_unbiased = row.floor_known && row.contradicted_in.empty() && is_unbiased_by_theory(row, left_out);
        drop_intervals_of_equal_images(row, equal.count(row.method) > 0);
    }
    all.unjudged = light.holding_light(Components(reference.unresolved));
    return all;
}

/// The options of an experiment that a command for one of its references repeats.
std::string other_options(const ResultIndex& index, const ResultFolder& folder) {
    std::string options = index.epsilon ? fmt::format(" --epsilon {}", *index.epsilon) : "";
    try {
        for (const auto& path : parse_experiment(index.experiment_text, experiment_file_of(folder)).paths)
            options += fmt::format(" -a '{}'", path);
    } catch (const InputError&) {  // folders that are not there any more
    }
    return options;
}

/// Removes the contradicted components from a reference, and warns of them.
void drop_contradicted(const IndexScene& scene, const ResultFolder& folder, const SceneRows& rows, Reference& reference,
                       Analysis& analysis) {
    const double error = analysis.references.back().relative_error;
    for (const auto& [component, found] : rows.contradictions) {
        reference.unresolved.push_back(component);
        analysis.warnings.push_back(
            {.kind = Warning::Kind::reference_contradicted,
             .scene = scene.name,
             .sentence = fmt::format(
                 "no verdict on `{}` and on times to an error: the reference is contradicted by {}, which finds {}",
                 name_of(component), found.first, found.second.text()),
             .command = fmt::format("gibench reference '{}' --resolution {}x{} --seed 2 --target {:.2g}%{} -o '{}.exr'",
                                    scene.path, reference.total.mean.width, reference.total.mean.height, 50 * error,
                                    other_options(analysis.index, folder), scene.name)});
    }
}

/// Removes the curves of the total, which include the contradicted components.
void drop_curves_of_total(const std::string& scene, Analysis& analysis) {
    for (Cell& cell : analysis.cells)
        if (cell.scene == scene)
            for (CellCheckpoint& checkpoint : cell.checkpoints)
                checkpoint.errors.erase(Layer::total);
}

void add_scene(const IndexScene& scene, Reference reference, const ResultFolder& folder, Analysis& analysis) {
    add_cells(scene, folder, analysis);
    drop_equal_cells(scene.name, analysis);
    const auto judge = [&](const Judgement& judgement) {
        analysis.references.push_back(quality_of(scene, reference, judgement, analysis.index.epsilon));
        return rows_of_scene(analysis.references.back(), reference, judgement, folder, analysis);
    };
    SceneRows rows = judge(Judgement(reference));
    const bool is_contradicted = !rows.contradictions.empty();
    if (is_contradicted) {
        drop_contradicted(scene, folder, rows, reference, analysis);
        drop_curves_of_total(scene.name, analysis);
        analysis.references.pop_back();
        rows = judge(Judgement(reference));
    }
    analysis.references.back().unjudged = rows.unjudged;
    for (TableRow& row : rows.rows) {
        row.has_times = !is_contradicted || row.layer != Layer::total;
        analysis.rows.push_back(std::move(row));
    }
    if (!rows.is_lit && !cells_by_method(analysis, scene.name).empty()) return drop_dark_scene(scene.name, analysis);
    if (const auto warning = unlike_processors(analysis.cells, scene.name)) analysis.warnings.push_back(*warning);
    for (auto& warning : contradicted_declarations(analysis, scene.name))
        analysis.warnings.push_back(std::move(warning));
    if (is_contradicted) return;
    for (auto& look : equal_time_looks(one_label_a_method(analysis), scene.name, Judgement(reference), folder))
        analysis.looks.push_back(std::move(look));
}

}  // namespace

Analysis analyse(const ResultFolder& folder) {
    Analysis analysis;
    analysis.index = folder.read_index();
    for (const auto& scene : analysis.index.scenes) {
        const auto reference = reference_of(scene, folder, analysis.damage);
        if (reference) add_scene(scene, *reference, folder, analysis);
        else analysis.missing_cells += analysis.index.methods.size() * static_cast<std::size_t>(analysis.index.seeds);
    }
    if (const auto warning = busy_machine(analysis, run_command_of(folder, analysis.index)))
        analysis.warnings.push_back(*warning);
    const auto names = short_names(analysis);
    for (TableRow& row : analysis.rows)
        row.name = names.at(row.method);
    return analysis;
}

}  // namespace gib
