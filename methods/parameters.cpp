#include "methods/parameters.h"

#include "common/core/nearest_word.h"
#include "common/core/number_text.h"
#include "common/core/reject.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

std::optional<double> parse_number(std::string_view text) {
    const auto value = number_from<double>(text);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

void check(const Parameter& p, const std::string& value, const SourceLocation& where) {
    const bool is_word = std::find(p.choices.begin(), p.choices.end(), value) != p.choices.end();
    if (is_word || p.kind == Parameter::Kind::text) return;
    if (p.kind == Parameter::Kind::choice)
        reject(where, "parameter '{}' cannot be '{}'; it is one of: {}", p.name, value, fmt::join(p.choices, ", "));
    const auto number = parse_number(value);
    if (!number) reject(where, "parameter '{}' needs a number such as 16 or 1e6, not '{}'", p.name, value);
    if (*number < p.lower || *number > p.upper)
        reject(where, "parameter '{}' = {} is out of range: {}", p.name, value, range_of(p));
    if (p.kind == Parameter::Kind::integer && (*number != std::floor(*number) || std::abs(*number) > 0x1p53))
        reject(where, "parameter '{}' needs a whole number, not '{}'", p.name, value);
}

}  // namespace

std::string range_of(const Parameter& p) {
    if (p.kind == Parameter::Kind::text) return "text";
    if (p.kind == Parameter::Kind::choice) return fmt::format("{}", fmt::join(p.choices, "|"));
    std::string range =
        std::isinf(p.upper) ? fmt::format("at least {:g}", p.lower) : fmt::format("{:g} to {:g}", p.lower, p.upper);
    if (p.kind == Parameter::Kind::integer) range = "whole, " + range;
    if (!p.choices.empty()) range += fmt::format(", or {}", fmt::join(p.choices, ", "));
    return range;
}

MethodLabel MethodLabel::parse(std::string_view text, const SourceLocation& where) {
    MethodLabel label;
    std::size_t at = 0;
    while (true) {
        at = text.find_first_not_of(" \t", at);
        if (at == std::string_view::npos) break;
        const std::size_t end = std::min(text.find_first_of(" \t", at), text.size());
        const std::string word(text.substr(at, end - at));
        at = end;
        if (word.find_first_of(",\"\n") != std::string::npos)
            reject(where,
                   "a method's label has no commas, quotes or line breaks: '{}' (lists of values belong in experiment "
                   "files)",
                   word);
        const std::size_t equals = word.find('=');
        if (label.name.empty()) {
            if (equals != std::string::npos) reject(where, "a method's label starts with its name, not '{}'", word);
            label.name = word;
        } else if (equals == std::string::npos || equals == 0 || equals + 1 == word.size()) {
            reject(where, "expected key=value after the method's name, not '{}'", word);
        } else {
            label.values.emplace_back(word.substr(0, equals), word.substr(equals + 1));
        }
    }
    if (label.name.empty()) throw InputError(where, "the method's label is empty");
    return label;
}

std::string MethodLabel::text() const {
    std::string text = name;
    for (const auto& [key, value] : values)
        text += " " + key + "=" + value;
    return text;
}

ParameterValues::ParameterValues(const std::vector<Parameter>& declared, const MethodLabel& label,
                                 const SourceLocation& where)
    : declared_(declared), values_(label.values) {
    for (std::size_t i = 0; i < values_.size(); ++i) {
        const auto& [key, value] = values_[i];
        const auto p = std::find_if(declared_.begin(), declared_.end(),
                                    [&wanted = key](const auto& d) { return d.name == wanted; });
        if (p == declared_.end()) {
            reject(where, "method '{}' has no parameter '{}'{} It has: {}", label.name, key,
                   did_you_mean_or_stop(key, names_of(declared_)), fmt::join(names_of(declared_), ", "));
        }
        for (std::size_t j = 0; j < i; ++j)
            if (values_[j].first == key) reject(where, "parameter '{}' is given twice", key);
        check(*p, value, where);
    }
}

bool ParameterValues::given(std::string_view name) const {
    return std::any_of(values_.begin(), values_.end(), [&](const auto& v) { return v.first == name; });
}

std::string ParameterValues::text(std::string_view name) const {
    for (const auto& [key, value] : values_)
        if (key == name) return value;
    for (const auto& d : declared_)
        if (d.name == name) return d.default_value;
    throw std::logic_error(fmt::format("parameter '{}' was never declared", name));
}

double ParameterValues::number(std::string_view name) const { return parse_number(text(name)).value(); }
std::int64_t ParameterValues::integer(std::string_view name) const { return static_cast<std::int64_t>(number(name)); }
std::string ParameterValues::choice(std::string_view name) const { return text(name); }
std::optional<double> ParameterValues::number_unless_word(std::string_view name) const {
    return parse_number(text(name));
}

void ParameterValues::refuse(const std::vector<std::string>& names, std::string_view setting) const {
    for (const auto& name : names)
        if (given(name)) reject({}, "parameter '{}' has no effect with {}", name, setting);
}

Parameter number_parameter(std::string name, std::string initial, std::string unit, double lower, double upper,
                           std::string meaning) {
    return {.name = std::move(name),
            .kind = Parameter::Kind::number,
            .default_value = std::move(initial),
            .unit = std::move(unit),
            .lower = lower,
            .upper = upper,
            .sentence = std::move(meaning)};
}
Parameter integer_parameter(std::string name, std::string initial, std::string unit, double lower, double upper,
                            std::string meaning, std::vector<std::string> words) {
    Parameter parameter =
        number_parameter(std::move(name), std::move(initial), std::move(unit), lower, upper, std::move(meaning));
    parameter.kind = Parameter::Kind::integer;
    parameter.choices = std::move(words);
    return parameter;
}
Parameter count_parameter(std::string name, std::string initial, std::string unit, std::string meaning) {
    return integer_parameter(std::move(name), std::move(initial), std::move(unit), 0, 4e9, std::move(meaning));
}
Parameter choice_parameter(std::string name, std::vector<std::string> choices, std::string meaning) {
    const std::string initial = choices.front();
    Parameter parameter = number_parameter(std::move(name), initial, "", 0, 0, std::move(meaning));
    parameter.kind = Parameter::Kind::choice;
    parameter.choices = std::move(choices);
    return parameter;
}

Parameter tuned(Parameter parameter, const TuningSpan& span) {
    parameter.tuning = span;
    return parameter;
}

std::vector<std::string> names_of(const std::vector<Parameter>& parameters) {
    std::vector<std::string> names;
    for (const auto& parameter : parameters)
        names.push_back(parameter.name);
    return names;
}

}  // namespace gib
