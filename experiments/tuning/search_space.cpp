#include "experiments/tuning/search_space.h"

#include "common/core/number_text.h"
#include "common/core/reject.h"
#include "common/sampling/sampler.h"
#include "methods/method.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

/// The search is of no use among more parameters than a few.
constexpr std::size_t most_axes = 12;
static_assert(most_axes <= sobol_dimensions);
/// The share of the cover that has a default which lies apart from its span.
constexpr double share_of_default = 0.25;

const std::string* value_in(const MethodLabel& label, const std::string& parameter) {
    for (const auto& [name, value] : label.values)
        if (name == parameter) return &value;
    return nullptr;
}

bool is_number(const Parameter& parameter) {
    return parameter.kind == Parameter::Kind::number || parameter.kind == Parameter::Kind::integer;
}

/// The name by which a message calls the source of a variation.
const char* source_of(const Variation& variation) { return variation.where.file.empty() ? "--vary" : "vary"; }

TuningAxis declared_axis(const Parameter& parameter) {
    TuningAxis axis{.name = parameter.name,
                    .least = parameter.lower,
                    .most = parameter.upper,
                    .is_whole = parameter.kind == Parameter::Kind::integer,
                    .initial = parameter.default_value};
    if (!parameter.tuning) return axis;
    axis.span = *parameter.tuning;
    if (!is_number(parameter)) {
        const auto begin = parameter.choices.begin();
        axis.words.assign(begin + static_cast<int>(axis.span.lower), begin + static_cast<int>(axis.span.upper) + 1);
        return axis;
    }
    const auto initial = number_from<double>(axis.initial);
    axis.has_default_apart = initial && (*initial < axis.span.lower || *initial > axis.span.upper);
    return axis;
}

TuningAxis axis_of(const Parameter& parameter, const Variation* variation) {
    TuningAxis axis = declared_axis(parameter);
    if (!variation) return axis;
    axis.has_default_apart = false;
    axis.words = variation->words;
    if (!axis.words.empty()) return axis;
    if (!is_number(parameter))
        reject(variation->where, "{}: '{}' has no range; list its values, as in {}=A,B", source_of(*variation),
               parameter.name, parameter.name);
    if (variation->lower < parameter.lower || variation->upper > parameter.upper)
        reject(variation->where, "{}: '{}' has to lie in {}", source_of(*variation), parameter.name,
               range_of(parameter));
    axis.span.lower = variation->lower;
    axis.span.upper = variation->upper;
    // A factor cannot lead to 0.
    axis.span.is_logarithmic = axis.span.is_logarithmic && variation->lower > 0;
    return axis;
}

/// Whether the method takes these values together.
bool is_accepted(const MethodLabel& label) {
    try {
        ConfiguredMethod(label).create(MethodDefaults{});
        return true;
    } catch (const InputError&) {
        return false;
    }
}

/// The label with this value of an axis, unless that is the default or the method refuses it.
MethodLabel with_accepted(const MethodLabel& label, const TuningAxis& axis, const std::string& value) {
    if (value.empty() || value == axis.initial) return label;
    MethodLabel changed = with_value(label, axis.name, value);
    return is_accepted(changed) ? changed : label;
}

/// The label without the values of the axes.
MethodLabel without_axes(MethodLabel label, const std::vector<TuningAxis>& axes) {
    std::erase_if(label.values, [&](const auto& value) {
        return std::any_of(axes.begin(), axes.end(), [&](const TuningAxis& a) { return a.name == value.first; });
    });
    return label;
}

/// The values of all axes of a label, empty where it has none.
std::vector<std::string> values_of(const MethodLabel& label, const std::vector<TuningAxis>& axes) {
    std::vector<std::string> values;
    for (const TuningAxis& axis : axes) {
        const std::string* value = value_in(label, axis.name);
        values.push_back(value ? *value : "");
    }
    return values;
}

MethodLabel with_values(MethodLabel label, const std::vector<TuningAxis>& axes,
                        const std::vector<std::string>& values) {
    for (std::size_t d = 0; d < axes.size(); ++d)
        label = with_accepted(label, axes[d], values[d]);
    return label;
}

/// The values one step away from `value`.
std::vector<std::string> steps_from(const TuningAxis& axis, const std::string& value) {
    std::vector<std::string> steps;
    for (const auto& word : axis.words)
        if (word != value) steps.push_back(word);
    const auto number = number_from<double>(value);
    if (!axis.words.empty() || !number) return steps;
    if (axis.has_default_apart && value == axis.initial) return {axis.text_of(axis.span.lower)};
    for (const double factor : {0.5, 2.0})
        if (const std::string stepped = axis.text_of(*number * factor); stepped != axis.text_of(*number))
            steps.push_back(stepped);
    // From the lower end of the span, a step down leads to the default that lies below it.
    if (axis.has_default_apart && *number / 2 < axis.span.lower) steps.front() = axis.initial;
    return steps;
}

/// The values of all axes of a label, the defaults where it has none.
std::vector<std::string> values_or_defaults(const MethodLabel& label, const std::vector<TuningAxis>& axes) {
    auto values = values_of(label, axes);
    for (std::size_t d = 0; d < axes.size(); ++d)
        if (values[d].empty()) values[d] = axes[d].initial;
    return values;
}

/// Changes the numbers that follow that of axis `leader` by its factor from `before` to `values`.
void follow(std::size_t leader, const std::vector<std::string>& before, const std::vector<TuningAxis>& axes,
            std::vector<std::string>& values) {
    const auto from = number_from<double>(before[leader]), to = number_from<double>(values[leader]);
    if (!from || !to || !(*from > 0) || !(*to > 0)) return;
    for (std::size_t d = 0; d < axes.size(); ++d)
        if (const auto number = number_from<double>(before[d]); number && axes[d].span.follows == axes[leader].name)
            values[d] = axes[d].text_of(*number * (*to / *from));
}

}  // namespace

std::string TuningAxis::text_of(double value) const {
    const double inside = std::clamp(value, least, most);
    const double decade = inside == 0 ? 1 : std::pow(10, std::floor(std::log10(std::abs(inside))) - 1);
    const double rounded = std::round(inside / decade) * decade;
    return is_whole ? fmt::format("{:.0f}", std::round(rounded)) : fmt::format("{:.2g}", rounded);
}

std::string TuningAxis::at(double share) const {
    if (has_default_apart) {
        if (share < share_of_default) return initial;
        share = (share - share_of_default) / (1 - share_of_default);
    }
    if (!words.empty())
        return words[std::min(words.size() - 1, static_cast<std::size_t>(share * static_cast<double>(words.size())))];
    if (!span.is_logarithmic) return text_of(span.lower + share * (span.upper - span.lower));
    return text_of(span.lower * std::pow(span.upper / span.lower, share));
}

Variation parse_variation(const std::string& text, const SourceLocation& where) {
    const auto wrong = [&] {
        reject(where, "{} needs a range such as photons=1e4..1e7 or a list such as cache=on,off, not '{}'",
               where.file.empty() ? "--vary" : "'vary'", text);
    };
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) wrong();
    Variation variation{.parameter = text.substr(0, equals), .where = where};
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
            if (variation)
                reject(variation->where, "{}: '{}' is set by the method '{}'", source_of(*variation), parameter.name,
                       base.text());
            continue;
        }
        axes.push_back(axis_of(parameter, variation));
    }
    if (axes.size() > most_axes)
        reject({}, "at most {} parameters can vary, and '{}' has {}", most_axes, base.text(), axes.size());
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
    constexpr std::uint64_t seed = 1;
    std::vector<MethodLabel> labels = {base};
    for (int i = 0; !axes.empty() && i < count; ++i) {
        const Sampler point(PointSet::sobol, seed, 0, static_cast<std::uint32_t>(i));
        std::vector<std::string> values;
        for (std::size_t d = 0; d < axes.size(); ++d)
            values.push_back(axes[d].at(point.get_1d(static_cast<std::uint32_t>(d))));
        const MethodLabel label = with_values(base, axes, values);
        const auto same = [&](const MethodLabel& other) { return other.text() == label.text(); };
        if (std::none_of(labels.begin(), labels.end(), same)) labels.push_back(label);
    }
    return labels;
}

std::vector<MethodLabel> neighbours(const MethodLabel& label, const std::vector<TuningAxis>& axes) {
    const MethodLabel base = without_axes(label, axes);
    const auto own = values_of(label, axes), effective = values_or_defaults(label, axes);
    std::vector<MethodLabel> labels;
    for (std::size_t d = 0; d < axes.size(); ++d)
        for (const auto& step : steps_from(axes[d], effective[d])) {
            auto values = own;
            values[d] = step;
            follow(d, effective, axes, values);
            MethodLabel changed = with_values(base, axes, values);
            if (changed.text() != label.text()) labels.push_back(std::move(changed));
        }
    return labels;
}

MethodLabel with_all_changes(const MethodLabel& label, const std::vector<MethodLabel>& better,
                             const std::vector<TuningAxis>& axes) {
    const auto own = values_of(label, axes);
    auto values = own;
    for (const MethodLabel& other : better) {
        const auto theirs = values_of(other, axes);
        for (std::size_t d = 0; d < axes.size(); ++d)
            if (values[d] == own[d]) values[d] = theirs[d];
    }
    return with_values(without_axes(label, axes), axes, values);
}

MethodLabel with_change_repeated(const MethodLabel& from, const MethodLabel& to, const std::vector<TuningAxis>& axes) {
    auto values = values_of(to, axes);
    for (std::size_t d = 0; d < axes.size(); ++d) {
        if (!axes[d].words.empty()) continue;
        const auto before = number_from<double>(effective_value(from, axes[d]));
        const auto after = number_from<double>(effective_value(to, axes[d]));
        if (before && after && *before > 0 && *before != *after)
            values[d] = axes[d].text_of(*after * (*after / *before));
    }
    return with_values(without_axes(to, axes), axes, values);
}

std::string effective_value(const MethodLabel& label, const TuningAxis& axis) {
    if (const std::string* own = value_in(label, axis.name)) return *own;
    // A parameter whose default is set where it has no effect is refused.
    if (axis.initial.empty() || !is_accepted(with_value(label, axis.name, axis.initial))) return "";
    return axis.initial;
}

}  // namespace gib
