#include "experiments/tuning/search_space.h"

#include "common/core/number_text.h"
#include "common/core/reject.h"
#include "methods/method.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace gib {

namespace {

constexpr std::array primes = {2, 3, 5, 7, 11, 13};

/// The digits of i in this base, mirrored at the point.
double radical_inverse(int i, int base) {
    double value = 0, digit = 1;
    for (; i > 0; i /= base)
        value += (digit /= base) * (i % base);
    return value;
}

const std::string* value_in(const MethodLabel& label, const std::string& parameter) {
    for (const auto& [name, value] : label.values)
        if (name == parameter) return &value;
    return nullptr;
}

TuningAxis axis_of(const Parameter& parameter, const Variation* variation) {
    TuningAxis axis{.name = parameter.name,
                    .least = parameter.lower,
                    .most = parameter.upper,
                    .is_whole = parameter.kind == Parameter::Kind::integer,
                    .initial = parameter.default_value};
    if (parameter.tuning) axis.span = *parameter.tuning;
    if (!variation) return axis;
    axis.words = variation->words;
    if (!axis.words.empty()) return axis;
    if (parameter.kind != Parameter::Kind::number && parameter.kind != Parameter::Kind::integer)
        reject({}, "--vary: '{}' has no range; list its values, as in {}=A,B", parameter.name, parameter.name);
    if (variation->lower < parameter.lower || variation->upper > parameter.upper)
        reject({}, "--vary: '{}' has to lie in {}", parameter.name, range_of(parameter));
    axis.span.lower = variation->lower;
    axis.span.upper = variation->upper;
    // A factor cannot lead to 0.
    axis.span.is_logarithmic = axis.span.is_logarithmic && variation->lower > 0;
    return axis;
}

}  // namespace

std::string TuningAxis::text_of(double value) const {
    const double inside = std::clamp(value, least, most);
    const double decade = inside == 0 ? 1 : std::pow(10, std::floor(std::log10(std::abs(inside))) - 1);
    const double rounded = std::round(inside / decade) * decade;
    return is_whole ? fmt::format("{:.0f}", std::round(rounded)) : fmt::format("{:.2g}", rounded);
}

std::string TuningAxis::at(double share) const {
    if (!words.empty())
        return words[std::min(words.size() - 1, static_cast<std::size_t>(share * static_cast<double>(words.size())))];
    if (!span.is_logarithmic) return text_of(span.lower + share * (span.upper - span.lower));
    return text_of(span.lower * std::pow(span.upper / span.lower, share));
}

Variation parse_variation(const std::string& text) {
    const auto wrong = [&] {
        reject({}, "--vary needs a range such as photons=1e4..1e7 or a list such as cache=on,off, not '{}'", text);
    };
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) wrong();
    Variation variation{.parameter = text.substr(0, equals)};
    const std::string values = text.substr(equals + 1);
    if (const std::size_t dots = values.find(".."); dots != std::string::npos) {
        const auto lower = number_from<double>(values.substr(0, dots));
        const auto upper = number_from<double>(values.substr(dots + 2));
        if (!lower || !upper || !(*lower < *upper)) wrong();
        variation.lower = *lower;
        variation.upper = *upper;
        return variation;
    }
    for (std::size_t begin = 0; begin <= values.size();) {
        const std::size_t end = std::min(values.find(',', begin), values.size());
        if (end == begin) wrong();
        variation.words.push_back(values.substr(begin, end - begin));
        begin = end + 1;
    }
    return variation;
}

std::vector<TuningAxis> tuning_axes(const MethodLabel& base, const std::vector<Variation>& variations) {
    std::vector<TuningAxis> axes;
    for (const Parameter& parameter : find_method(base.name).parameters) {
        const auto asked = std::find_if(variations.begin(), variations.end(),
                                        [&](const Variation& v) { return v.parameter == parameter.name; });
        const Variation* variation = asked == variations.end() ? nullptr : &*asked;
        if (!variation && !parameter.tuning) continue;
        if (value_in(base, parameter.name)) {
            if (variation) reject({}, "--vary: '{}' is set by the method '{}'", parameter.name, base.text());
            continue;
        }
        axes.push_back(axis_of(parameter, variation));
    }
    if (axes.size() > primes.size())
        reject({}, "at most {} parameters can vary, and '{}' has {}", primes.size(), base.text(), axes.size());
    return axes;
}

MethodLabel with_value(MethodLabel label, const std::string& parameter, const std::string& value) {
    for (auto& [name, old] : label.values)
        if (name == parameter) {
            old = value;
            return label;
        }
    label.values.emplace_back(parameter, value);
    return label;
}

std::vector<MethodLabel> candidates(const MethodLabel& base, const std::vector<TuningAxis>& axes, int count) {
    std::vector<MethodLabel> labels = {base};
    for (int i = 1; !axes.empty() && i <= count; ++i) {
        MethodLabel label = base;
        for (std::size_t d = 0; d < axes.size(); ++d)
            label = with_value(label, axes[d].name, axes[d].at(radical_inverse(i, primes[d])));
        const auto same = [&](const MethodLabel& other) { return other.text() == label.text(); };
        if (std::none_of(labels.begin(), labels.end(), same)) labels.push_back(label);
    }
    return labels;
}

std::vector<MethodLabel> neighbours(const MethodLabel& label, const std::vector<TuningAxis>& axes) {
    std::vector<MethodLabel> labels;
    for (const TuningAxis& axis : axes) {
        const std::string* own = value_in(label, axis.name);
        const std::string& value = own ? *own : axis.initial;
        for (const auto& word : axis.words)
            if (word != value) labels.push_back(with_value(label, axis.name, word));
        const auto number = number_from<double>(value);
        if (!axis.words.empty() || !number) continue;
        for (const double factor : {0.5, 2.0})
            if (const std::string stepped = axis.text_of(*number * factor); stepped != axis.text_of(*number))
                labels.push_back(with_value(label, axis.name, stepped));
    }
    return labels;
}

}  // namespace gib
