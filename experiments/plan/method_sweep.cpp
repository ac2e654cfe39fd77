#include "experiments/plan/method_sweep.h"

#include "common/core/reject.h"

#include <algorithm>

namespace gib {

MethodSweep::MethodSweep(const TomlReader& reader, std::vector<Parameter> parameters, MethodLabel start)
    : reader_(reader), parameters_(std::move(parameters)), labels_{std::move(start)} {}

void MethodSweep::add(const TomlReader::Entry& entry) {
    std::vector<std::string> values;
    if (const auto* array = entry.value->as_array()) {
        for (const auto& value : reader_.filled_array(*array, entry.key, "values"))
            values.push_back(checked(entry, value));
    } else {
        values.push_back(checked(entry, *entry.value));
    }
    add(entry, values);
}

void MethodSweep::add(const TomlReader::Entry& entry, const std::vector<std::string>& values) {
    if (labels_.size() * values.size() > most_combinations)
        reject(entry.key_at, "the lists up to '{}' make more than {} combinations of values", entry.key,
               most_combinations);
    std::vector<MethodLabel> grid;
    for (const auto& label : labels_)
        for (const auto& value : values) {
            grid.push_back(label);
            grid.back().values.emplace_back(entry.key, value);
        }
    labels_ = std::move(grid);
}

std::vector<std::string> MethodSweep::keys_beside(std::vector<std::string> own) const {
    for (const std::string& name : names_of(parameters_))
        if (std::ranges::find(own, name) == own.end()) own.push_back(name);
    return own;
}

std::vector<MethodLabel> MethodSweep::labels(const SourceLocation& where) const {
    for (const auto& label : labels_) {
        const ConfiguredMethod method(label, where);
        try {
            method.create(MethodDefaults{});
        } catch (const InputError& error) {
            throw InputError(where, error.what());
        }
    }
    return labels_;
}

std::string MethodSweep::checked(const TomlReader::Entry& entry, const toml::node& value) const {
    if (!value.is_string() && !value.is_number() && !value.is_boolean())
        reject(reader_.at(value), "parameter '{}' needs a number or a word", entry.key);
    const std::string text = reader_.text_of(value);
    const auto declared = std::ranges::find_if(parameters_, [&](const Parameter& p) { return p.name == entry.key; });
    const bool known = declared != parameters_.end();
    // An unknown parameter is reported at its key, every other error at the value.
    ParameterValues(parameters_, MethodLabel{labels_.front().name, {{entry.key, text}}},
                    known ? reader_.at(value) : entry.key_at);
    const bool is_word = known && (declared->kind == Parameter::Kind::text ||
                                   std::ranges::find(declared->choices, text) != declared->choices.end());
    if (value.is_string() && !is_word)
        reject(reader_.at(value), "parameter '{}' needs a number without quotes", entry.key);
    return text;
}

}  // namespace gib
