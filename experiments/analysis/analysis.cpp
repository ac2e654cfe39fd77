#include "experiments/analysis/analysis.h"

#include "common/core/error.h"
#include "common/core/number_text.h"
#include "common/images/image_file.h"
#include "experiments/analysis/equal_time_look.h"
#include "experiments/analysis/known_bias.h"
#include "experiments/analysis/price.h"
#include "experiments/analysis/processors.h"
#include "experiments/analysis/same_method.h"
#include "experiments/analysis/scene_light.h"
#include "experiments/metrics/time_to_error.h"
#include "experiments/results/flip_record.h"
#include "experiments/results/judgement.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace gib {

namespace {

/// The replicates of one method on one scene.
struct Replicates {
    std::vector<const Cell*> cells;
    std::vector<std::string> folders;  ///< names of the cells' folders
    std::vector<ComponentImages> images;
    std::vector<Image> totals;  ///< images as they are judged
};

/// The curve of error against time of each replicate, with the reference's own variance subtracted; an error is 0 if
/// that variance exceeds it. NaN stays NaN.
std::vector<std::vector<CurvePoint>> curves_of(const Replicates& replicates, const std::string& component) {
    std::vector<std::vector<CurvePoint>> curves;
    for (const Cell* cell : replicates.cells) {
        curves.emplace_back();
        for (const auto& c : cell->checkpoints)
            if (const auto error = c.errors.find(component); error != c.errors.end())
                curves.back().push_back(
                    {c.checkpoint.seconds, std::sqrt(std::max(error->second.rel_mse_corrected, 0.0))});
    }
    return curves;
}

/// The part of a row that needs no reference.
TableRow plain_row(const Replicates& replicates, const ResultIndex& index, const std::string& component) {
    const Cell& first = *replicates.cells.front();
    TableRow row;
    row.scene = first.scene;
    row.method = first.method;
    row.component = component;
    row.is_external = index.is_external(row.method);
    row.cpu = processors_of(replicates.cells);
    row.seeds = static_cast<int>(replicates.cells.size());
    for (const Cell* cell : replicates.cells) {
        row.seconds += cell->last().seconds / row.seeds;
        row.prepare_seconds += cell->prepare_seconds / row.seeds;
        row.nonfinite += cell->last().counts.non_finite.count;
        row.peak_rss_mib = std::max(row.peak_rss_mib, cell->last().peak_rss_mib);
    }
    if (const auto missing = index.effects_missing.find({row.scene, row.method});
        missing != index.effects_missing.end())
        row.effects_missing = missing->second;
    return row;
}

TableRow judged_row(const Replicates& replicates, const ResultIndex& index, const std::string& component,
                    const std::vector<Image>& images, const ReferenceLayer& reference, const Denominators& denominators,
                    const ReferenceQuality& quality) {
    TableRow row = plain_row(replicates, index, component);
    const double noise_floor = row.noise_floor = quality.noise_floors.at(component);
    row.floor_known = quality.error_known;
    row.epsilon = quality.epsilon;
    const Image& r_total = denominators.plain();
    row.statistics = replicate_statistics(images, reference, denominators);
    row.robust = robust_error(images, reference.mean, r_total, row.epsilon);
    row.noise = noise_spectrum(images, r_total);
    row.bias = bias_spectrum(images, reference);
    const auto curves = curves_of(replicates, component);
    for (std::size_t t = 0; t < target_errors.size(); ++t)
        if (is_target_resolved(t, noise_floor)) row.times[t] = time_to_error(curves, target_errors[t]);
    row.footing = equal_footing(images, reference, r_total);
    row.law = price_law_of(replicates.cells, component, noise_floor);
    row.last_halving = last_halving(replicates.cells, component, noise_floor);
    return row;
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
    if (judgement.is_empty()) {
        rows.push_back(plain_row(replicates, index, total_name));
    } else {
        rows.push_back(judged_row(replicates, index, total_name, totals, judgement.total(), denominators, quality));
        rows.back().flip = mean_flip(replicates, totals, denominators.plain(), folder);
    }
    for (Component c : all_components) {
        std::vector<Image> images;
        for (const auto& image : replicates.images)
            if (image[c]) images.push_back(*image[c]);
        if (images.size() != replicates.images.size()) continue;
        const std::string name(name_of(c));
        if (const auto* layer = judgement.component(c))
            rows.push_back(judged_row(replicates, index, name, images, *layer, denominators, quality));
        else if (!judgement.is_resolved(c)) rows.push_back(plain_row(replicates, index, name));
    }
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
    if (const auto passes = reference.metadata.find("passes"); passes != reference.metadata.end())
        quality.samples = number_from<std::uint64_t>(passes->second).value_or(0) * std::uint64_t{reference_groups};
    for (const auto& [name, layer] : judgement.layers())
        quality.noise_floors[name] = noise_floor_of(*layer, judgement.denominators(epsilon));
    return quality;
}

/// The reference of a scene. Empty if the scene has none yet, or if its file is missing or damaged; then `damage`
/// gets a message.
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

/// Appends the complete cells of a scene to the analysis and returns the names of their folders.
std::vector<std::string> add_cells(const IndexScene& scene, const ResultFolder& folder, Analysis& analysis) {
    const ResultIndex& index = analysis.index;
    std::vector<std::string> names;
    for (const auto& method : index.methods)
        for (int seed = 1; seed <= index.seeds; ++seed) {
            const std::string name = cell_folder_name(scene.name, method, static_cast<std::uint64_t>(seed));
            const auto key = index.cell_keys.find(name);
            std::string damage;
            auto cell = key == index.cell_keys.end() ? std::nullopt : folder.read_cell(name, key->second, &damage);
            if (!damage.empty()) analysis.damage.push_back(damage + "; the cell is left out");
            if (cell) {
                names.push_back(name);
                analysis.cells.push_back(*std::move(cell));
            } else {
                ++analysis.missing_cells;
            }
        }
    return names;
}

/// ResultIndex::components_missing of a method; empty if it leaves out nothing.
std::string components_missing(const ResultIndex& index, const std::string& scene, const std::string& method) {
    const auto found = index.components_missing.find({scene, method});
    return found == index.components_missing.end() ? "" : found->second;
}

void add_scene(const IndexScene& scene, const Reference& reference, const ResultFolder& folder, Analysis& analysis) {
    const std::size_t first = analysis.cells.size();
    const auto names = add_cells(scene, folder, analysis);
    const Judgement judgement(reference);
    analysis.references.push_back(quality_of(scene, reference, judgement, analysis.index.epsilon));
    if (const std::string warning = unlike_processors(analysis.cells, scene.name); !warning.empty())
        analysis.references.back().notes.push_back(warning);
    SceneLight light(reference);
    const std::size_t first_row = analysis.rows.size();
    for (const auto& method : analysis.index.methods) {
        Replicates replicates;
        for (std::size_t i = 0; i < names.size(); ++i) {
            const Cell& cell = analysis.cells[first + i];
            if (cell.method != method) continue;
            replicates.cells.push_back(&cell);
            replicates.folders.push_back(names[i]);
            const LayeredImage file = read_image(folder.cell_image(names[i]));
            replicates.images.push_back(components_in(file));
            replicates.totals.push_back(judgement.total_of(file));
        }
        if (replicates.cells.empty()) continue;
        light.add(replicates.images, components_missing(analysis.index, scene.name, method));
        for (auto& row : rows_of(replicates, analysis.index, judgement, analysis.references.back(), folder))
            analysis.rows.push_back(std::move(row));
    }
    for (std::size_t i = first_row; i < analysis.rows.size(); ++i) {
        TableRow& row = analysis.rows[i];
        const std::string left_out = components_missing(analysis.index, scene.name, row.method);
        row.components_missing = light.holding_light(left_out);
        row.is_unbiased = is_unbiased(row, left_out);
    }
    analysis.references.back().unjudged = light.holding_light(names_of(reference.unresolved));
    for (auto& look : equal_time_looks(one_label_a_method(analysis), scene.name, judgement, folder))
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
    return analysis;
}

}  // namespace gib
