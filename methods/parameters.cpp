#include "methods/parameters.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace gib {

namespace {

std::optional<double> parse_number(std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

std::string range_text(const Parameter& p) {
    const std::string range =
        std::isinf(p.upper) ? fmt::format("at least {}", p.lower) : fmt::format("from {} to {}", p.lower, p.upper);
    return p.choices.empty() ? range : fmt::format("{}, or {}", range, fmt::join(p.choices, ", "));
}

void check(const Parameter& p, const std::string& value, const SourceLocation& where) {
    const bool is_word = std::find(p.choices.begin(), p.choices.end(), value) != p.choices.end();
    if (is_word || p.kind == Parameter::Kind::text) return;
    if (p.kind == Parameter::Kind::choice)
        throw InputError(where, fmt::format("parameter '{}' cannot be '{}'; it is one of: {}", p.name, value,
                                            fmt::join(p.choices, ", ")));
    const auto number = parse_number(value);
    if (!number) throw InputError(where, fmt::format("parameter '{}' needs a number, not '{}'", p.name, value));
    if (*number < p.lower || *number > p.upper)
        throw InputError(where, fmt::format("parameter '{}' = {} is out of range: {}", p.name, value, range_text(p)));
    if (p.kind == Parameter::Kind::integer && (*number != std::floor(*number) || std::abs(*number) > 0x1p53))
        throw InputError(where, fmt::format("parameter '{}' needs a whole number, not '{}'", p.name, value));
}

}  // namespace

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
            throw InputError(where, fmt::format("a method's label has no commas, quotes or line breaks: '{}'", word));
        const std::size_t equals = word.find('=');
        if (label.name.empty()) {
            if (equals != std::string::npos)
                throw InputError(where, fmt::format("a method's label starts with its name, not '{}'", word));
            label.name = word;
        } else if (equals == std::string::npos || equals == 0 || equals + 1 == word.size()) {
            throw InputError(where, fmt::format("expected key=value after the method's name, not '{}'", word));
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
            std::vector<std::string> names;
            for (const auto& d : declared_)
                names.push_back(d.name);
            throw InputError(where, fmt::format("method '{}' has no parameter '{}'; it has: {}", label.name, key,
                                                fmt::join(names, ", ")));
        }
        for (std::size_t j = 0; j < i; ++j)
            if (values_[j].first == key) throw InputError(where, fmt::format("parameter '{}' is given twice", key));
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

Parameter count_parameter(std::string name, std::string initial, std::string unit, std::string meaning) {
    return {.name = std::move(name),
            .kind = Parameter::Kind::integer,
            .default_value = std::move(initial),
            .unit = std::move(unit),
            .lower = 0,
            .upper = 4e9,
            .choices = {},
            .sentence = std::move(meaning)};
}
Parameter fraction_parameter(std::string name, std::string initial, std::string unit, double most,
                             std::string meaning) {
    return {.name = std::move(name),
            .kind = Parameter::Kind::number,
            .default_value = std::move(initial),
            .unit = std::move(unit),
            .lower = 0,
            .upper = most,
            .choices = {},
            .sentence = std::move(meaning)};
}
Parameter choice_parameter(std::string name, std::vector<std::string> choices, std::string meaning) {
    std::string initial = choices.front();
    return {.name = std::move(name),
            .kind = Parameter::Kind::choice,
            .default_value = std::move(initial),
            .unit = "",
            .lower = 0,
            .upper = 0,
            .choices = std::move(choices),
            .sentence = std::move(meaning)};
}

}  // namespace gib
