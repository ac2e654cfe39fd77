#include "experiments/plan/experiment_file.h"

#include "common/core/files.h"
#include "common/core/nearest_word.h"
#include "common/core/number_text.h"
#include "common/core/reject.h"
#include "common/reader/scene_sensor.h"
#include "experiments/metrics/epsilon.h"
#include "experiments/plan/experiment_keys.h"
#include "experiments/plan/experiment_methods.h"
#include "experiments/plan/method_sweep.h"
#include "experiments/plan/toml_reader.h"
#include "experiments/system/shipped_files.h"
#include "methods/method.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace gib {

namespace {

/// The relative standard error of references for which the experiment file gives neither a target nor a time.
constexpr double default_target = 0.01;

/// A path that is relative to the experiment file, as the program opens it.
std::string path_beside(const Experiment& experiment, const std::filesystem::path& written) {
    const auto folder = std::filesystem::path(experiment.path).parent_path();
    return (written.is_absolute() ? written : folder / written).lexically_normal().string();
}

/// "; did you mean 'cornell-box.xml'?", if a file of the folder or a scene that comes with the program has such a name.
std::string near_scene(const std::filesystem::path& path) {
    std::vector<std::string> names;
    std::error_code no_folder;
    for (const auto& entry : std::filesystem::directory_iterator(path.parent_path(), no_folder))
        if (entry.path().extension() == ".xml") names.push_back(entry.path().filename().string());
    std::ranges::sort(names);
    const std::string file = did_you_mean(path.filename().string(), names);
    return file.empty() ? did_you_mean(path.stem().string(), shipped_scene_names()) : file;
}

void read_scenes(const TomlReader& reader, const toml::node& node, Experiment& experiment) {
    for (const auto& value : reader.filled_array(node, "scenes", "scene files")) {
        ExperimentScene scene;
        scene.where = reader.at(value);
        scene.written = reader.string(value, "scenes");
        scene.path = path_beside(experiment, scene.written);
        if (std::error_code error; !std::filesystem::is_regular_file(scene.path, error)) {
            const std::string shipped = shipped_scene(scene.written);
            if (shipped.empty())
                reject(scene.where, "there is no scene file '{}', and no scene of that name (`gibench list scenes`){}",
                       scene.path, near_scene(scene.path));
            scene.path = shipped;
        }
        scene.name = std::filesystem::path(scene.path).stem().string();
        for (const auto& other : experiment.scenes)
            if (other.name == scene.name)
                reject(scene.where, "two scenes are named '{}': tables need different names", scene.name);
        experiment.scenes.push_back(std::move(scene));
    }
}

/// Reads folders, which are relative to the experiment file.
void read_paths(const TomlReader& reader, const toml::node& node, Experiment& experiment) {
    namespace fs = std::filesystem;
    for (const auto& folder : reader.filled_array(node, "paths", "folders")) {
        const fs::path path = fs::path(experiment.path).parent_path() / reader.string(folder, "paths");
        if (std::error_code error; !fs::is_directory(path, error))
            reject(reader.at(folder), "there is no folder '{}'", path.string());
        experiment.paths.push_back(path.string());
    }
}

void read_resolution(const TomlReader& reader, const toml::node& node, Experiment& experiment) {
    const auto& sizes = reader.filled_array(node, "resolution", "two numbers: width and height");
    if (sizes.size() != 2)
        throw InputError(reader.at(node), "'resolution' needs a list of two numbers: width and height");
    experiment.resolution = {reader.whole_number(sizes[0], "resolution", 1, most_pixels_across),
                             reader.whole_number(sizes[1], "resolution", 1, most_pixels_across)};
    const auto [width, height] = *experiment.resolution;
    if (1.0 * width * height > most_image_pixels)
        reject(reader.at(node), "an image of {} x {} pixels is above {:g} pixels", width, height, most_image_pixels);
}

Budget read_budget(const TomlReader& reader, const toml::node& node) {
    const auto& table = reader.table(node, "budget");
    reader.check_keys(table, "budget", names_of(experiment_keys(), "[budget]"));
    Budget budget;
    if (const auto* seconds = table.get("seconds")) budget.seconds = reader.positive_number(*seconds, "seconds");
    if (const auto* passes = table.get("passes"))
        budget.passes = static_cast<std::uint32_t>(reader.whole_number(*passes, "passes", 1, most_budget_passes));
    return budget;
}

double read_target(const TomlReader& reader, const toml::node& node) {
    if (!node.is_string() && !node.is_number())
        throw InputError(reader.at(node), "'target' needs a relative error such as \"1%\"");
    return parse_target(reader.text_of(node), reader.at(node));
}

void read_targets(const TomlReader& reader, const toml::node& node, Experiment& experiment) {
    const auto* list = node.as_array();
    if (!list) {
        const double target = read_target(reader, node);
        for (auto& scene : experiment.scenes)
            scene.goal.target = target;
        return;
    }
    if (list->size() != experiment.scenes.size())
        reject(reader.at(node), "'target' lists {} values for {} scenes", list->size(), experiment.scenes.size());
    for (std::size_t i = 0; i < list->size(); ++i)
        experiment.scenes[i].goal.target = read_target(reader, (*list)[i]);
}

/// Reads the images that are the references: for the only scene one, or a list of replicates; for several scenes a list
/// with one, or with a list of replicates, for each.
void read_reference_images(const TomlReader& reader, const toml::table& table, Experiment& experiment) {
    reader.check_keys(table, "[reference] with an image", {"image"});
    const toml::node& node = *table.get("image");
    const auto* list = node.as_array();
    const bool is_of_one_scene = experiment.scenes.size() == 1 && !(list && list->size() == 1 && (*list)[0].is_array());
    if (const std::size_t count = list && !is_of_one_scene ? list->size() : 1; count != experiment.scenes.size())
        reject(reader.at(node), "'image' gives {} references for {} scenes", count, experiment.scenes.size());
    for (std::size_t i = 0; i < experiment.scenes.size(); ++i) {
        const toml::node& value = list && !is_of_one_scene ? (*list)[i] : node;
        std::vector<std::string> paths;
        const auto add = [&](const toml::node& one) {
            paths.push_back(path_beside(experiment, reader.string(one, "image")));
            if (std::error_code error; !std::filesystem::is_regular_file(paths.back(), error))
                reject(reader.at(one), "there is no image '{}'", paths.back());
        };
        if (const auto* replicates = value.as_array()) {
            if (replicates->empty()) reject(reader.at(value), "'image' is an empty list");
            for (const toml::node& one : *replicates)
                add(one);
        } else add(value);
        experiment.scenes[i].reference_image = paths.front();
        experiment.scenes[i].reference_replicates.assign(paths.begin() + 1, paths.end());
    }
}

void read_reference(const TomlReader& reader, const toml::node* node, Experiment& experiment) {
    MethodLabel label{std::string(auto_reference), {}};
    const toml::table empty;
    const auto& table = node ? reader.table(*node, "reference") : empty;
    if (table.get("image")) {
        read_reference_images(reader, table, experiment);
        experiment.reference_method = label;
        return;
    }
    SourceLocation where = node ? reader.at(*node) : SourceLocation{experiment.path};
    if (const auto* method = table.get("method")) {
        where = reader.at(*method);
        label = MethodLabel::parse(reader.string(*method, "method"), where);
    }
    const std::string name = label.name;
    // Parameters of several methods are those of the first one, if all have them.
    label.name = reference_methods(label, where).front()->name;
    MethodSweep further(reader, find_comparable_method(label.name, where), label);
    const auto own = names_of(experiment_keys(), "[reference]");
    reader.check_keys(table, "[reference]", further.keys_beside(own));
    for (const auto& entry : reader.entries(table))
        if (std::ranges::find(own, entry.key) == own.end()) further.add(entry);
    const auto labels = further.labels(where);
    if (labels.size() != 1) throw InputError(where, "a reference has one value for each parameter, not a list");
    experiment.reference_method = {name, labels.front().values};
    static_cast<void>(reference_methods(experiment.reference_method, where));

    if (const auto* target = table.get("target")) read_targets(reader, *target, experiment);
    const auto* seconds = table.get("seconds");
    for (auto& scene : experiment.scenes) {
        if (seconds) scene.goal.seconds = reader.positive_number(*seconds, "seconds");
        if (!scene.goal.target && !scene.goal.seconds) scene.goal.target = default_target;
    }
}

/// The texts of a list, or a single text.
std::vector<TuneFile::Text> read_texts(const TomlReader& reader, const toml::node& node, const char* key,
                                       const char* of_what) {
    if (node.is_string()) return {{reader.string(node, key), reader.at(node)}};
    std::vector<TuneFile::Text> texts;
    for (const auto& value : reader.filled_array(node, key, of_what))
        texts.push_back({reader.string(value, key), reader.at(value)});
    return texts;
}

std::string checked_method(const TuneFile::Text& label) {
    const MethodLabel parsed = MethodLabel::parse(label.text, label.where);
    find_comparable_method(parsed.name, label.where);
    const ConfiguredMethod method(parsed, label.where);
    try {
        method.create(MethodDefaults{});
    } catch (const InputError& error) {
        throw InputError(label.where, error.what());
    }
    return label.text;
}

void read_tune(const TomlReader& reader, const toml::table& table, TuneFile& file) {
    reader.check_keys(table, "tune", names_of(experiment_keys(), "[tune]"));
    if (const auto* target = table.get("target")) {
        read_target(reader, *target);
        file.target = reader.text_of(*target);
    }
    if (const auto* method = table.get("method"))
        for (const auto& label : read_texts(reader, *method, "method", "labels"))
            file.methods.push_back(checked_method(label));
    if (const auto* vary = table.get("vary")) file.variations = read_texts(reader, *vary, "vary", "variations");
    if (const auto* minutes = table.get("minutes")) file.minutes = reader.positive_number(*minutes, "minutes");
}

}  // namespace

double parse_target(const std::string& text, const SourceLocation& where) {
    const std::size_t last = text.find_last_not_of(" \t");
    const bool percent = last != std::string::npos && text[last] == '%';
    std::string number = text.substr(0, percent ? last : last + 1);
    number.erase(number.find_last_not_of(" \t") + 1);
    const double value = number_from<double>(number).value_or(0) / (percent ? 100 : 1);
    if (!(std::isfinite(value) && value > 0 && value < 1))
        reject(where, "a target is a relative error such as \"1%\" or 0.01, not '{}'{}", text,
               !percent && value >= 1 && value < 100 ? fmt::format("; did you mean \"{}%\"?", number) : "");
    return value;
}

Experiment parse_experiment(const std::string& text, const std::string& path) {
    const TomlReader reader(text, path);
    const auto& root = reader.root();
    reader.check_keys(root, "an experiment", names_of(experiment_keys(), "experiment"));
    Experiment experiment;
    experiment.path = path;
    experiment.text = text;
    experiment.name = std::filesystem::path(path).stem().string();
    experiment.title = experiment.name;
    if (const auto* title = root.get("title")) experiment.title = reader.string(*title, "title");
    const auto* scenes = root.get("scenes");
    if (!scenes) throw InputError({path}, "an experiment needs 'scenes', a list of scene files");
    read_scenes(reader, *scenes, experiment);
    if (const auto* paths = root.get("paths")) read_paths(reader, *paths, experiment);
    if (const auto* resolution = root.get("resolution")) read_resolution(reader, *resolution, experiment);
    if (const auto* seeds = root.get("seeds")) experiment.seeds = reader.whole_number(*seeds, "seeds", 1, most_seeds);
    if (const auto* epsilon = root.get("epsilon")) {
        experiment.epsilon = reader.positive_number(*epsilon, "epsilon");
        require_epsilon(*experiment.epsilon, reader.at(*epsilon));
    }
    if (root.get("tune")) return experiment;  // parse_tune_file() reads the rest
    if (const auto* budget = root.get("budget")) experiment.budget = read_budget(reader, *budget);
    read_reference(reader, root.get("reference"), experiment);
    const auto* methods = root.get("method");
    if (!methods) throw InputError({path}, "an experiment needs at least one [[method]]");
    static_cast<ExperimentMethods&>(experiment) = read_methods(reader, *methods);
    for (const auto& [text_of_label, external] : experiment.externals)
        if (external.takes("seconds") && !experiment.budget.seconds)
            reject(external.where, "a command with {{seconds}} needs a budget in seconds");
    return experiment;
}

bool has_time_budget(const std::string& text) {
    try {
        const TomlReader reader(text, "");
        const auto* budget = reader.root().get("budget");
        return !reader.root().get("method") || (budget && read_budget(reader, *budget).seconds);
    } catch (const InputError&) {
        return true;
    }
}

Experiment load_experiment(const std::string& path) { return parse_experiment(read_file(path), path); }

std::optional<TuneFile> parse_tune_file(const std::string& text, const std::string& path) {
    const TomlReader reader(text, path);
    const auto* tune = reader.root().get("tune");
    if (!tune) return std::nullopt;
    reader.check_keys(reader.root(), "an experiment with [tune]",
                      {"title", "scenes", "paths", "resolution", "epsilon", "tune"});
    TuneFile file;
    file.head = parse_experiment(text, path);
    read_tune(reader, reader.table(*tune, "tune"), file);
    return file;
}

std::optional<TuneFile> load_tune_file(const std::string& path) { return parse_tune_file(read_file(path), path); }

}  // namespace gib
