#include "experiments/plan/tune_file.h"

#include "common/core/files.h"
#include "common/core/reject.h"
#include "experiments/plan/experiment_keys.h"
#include "experiments/plan/toml_reader.h"
#include "methods/method.h"

namespace gib {

namespace {

/// The texts of a list, or the one that stands there alone.
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
        if (!target->is_string() && !target->is_number())
            throw InputError(reader.at(*target), "'target' needs a relative error such as \"1%\"");
        file.target = reader.text_of(*target);
        parse_target(file.target, reader.at(*target));
    }
    if (const auto* method = table.get("method"))
        for (const auto& label : read_texts(reader, *method, "method", "labels"))
            file.methods.push_back(checked_method(label));
    if (const auto* vary = table.get("vary")) file.variations = read_texts(reader, *vary, "vary", "variations");
    if (const auto* minutes = table.get("minutes")) file.minutes = reader.positive_number(*minutes, "minutes");
}

}  // namespace

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
