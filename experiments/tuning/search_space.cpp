#include "experiments/tuning/search_space.h"

#include "common/core/number_text.h"
#include "common/core/reject.h"
#include "common/sampling/sampler.h"
#include "methods/method.h"

#include <fmt/format.h>
#include <boost/algorithm/string/split.hpp>

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

/// The search is of no use among more parameters than a few.
constexpr std::size_t most_axes = 12;
static_assert(most_axes <= sobol_dimensions);
/// The share of the cover that has a default which lies apart from its span.
constexpr double share_of_default = 0.25;

/// The axis of a parameter, with the values that were asked for, if any were.
TuningAxis axis_of(const Parameter& parameter, const Variation* asked) {
    const bool is_number = parameter.kind == Parameter::Kind::number || parameter.kind == Parameter::Kind::integer;
    TuningAxis axis{.name = parameter.name,
                    .span = parameter.tuning.value_or(TuningSpan{0, 0}),
                    .is_whole = parameter.kind == Parameter::Kind::integer};
    if (asked) {
        axis.words = asked->words;
    } else if (!is_number) {
        const auto begin = parameter.choices.begin();
        axis.words.assign(begin + static_cast<int>(axis.span.lower), begin + static_cast<int>(axis.span.upper) + 1);
    }
    if (!axis.words.empty()) {
        const auto place = std::ranges::find(axis.words, parameter.default_value);
        if (place != axis.words.end()) axis.initial = static_cast<double>(place - axis.words.begin());
        return axis;
    }
    axis.initial = number_from<double>(parameter.default_value);
    if (!asked) {
        axis.has_default_apart = axis.initial && (*axis.initial < axis.span.lower || *axis.initial > axis.span.upper);
        return axis;
    }
    if (!is_number)
        reject(asked->where, "{}: '{}' has no range; list its values, as in {}=A,B", asked->source(), parameter.name,
               parameter.name);
    if (asked->lower < parameter.lower || asked->upper > parameter.upper)
        reject(asked->where, "{}: '{}' has to lie in {}", asked->source(), parameter.name, range_of(parameter));
    axis.span.lower = asked->lower;
    axis.span.upper = asked->upper;
    axis.span.is_logarithmic = axis.span.is_logarithmic && asked->lower > 0;  // a factor cannot lead to 0
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

}  // namespace

double TuningAxis::rounded(double value) const {
    const double decade = value == 0 ? 1 : std::pow(10, std::floor(std::log10(std::abs(value))) - 1);
    const double two_digits = std::round(value / decade) * decade;
    return is_whole ? std::round(two_digits) : number_from<double>(fmt::format("{:.2g}", two_digits)).value();
}

std::string TuningAxis::text(double value) const {
    if (!words.empty()) return words[static_cast<std::size_t>(value)];
    return is_whole ? fmt::format("{:.0f}", value) : fmt::format("{:.2g}", value);
}

double TuningAxis::at(double share) const {
    if (has_default_apart) {
        if (share < share_of_default) return *initial;
        share = (share - share_of_default) / (1 - share_of_default);
    }
    if (const auto count = static_cast<double>(words.size()); count > 0)
        return std::min(std::floor(share * count), count - 1);
    if (!span.is_logarithmic) return rounded(span.lower + share * (span.upper - span.lower));
    return rounded(span.lower * std::pow(span.upper / span.lower, share));
}

Variation parse_variation(const std::string& text, const SourceLocation& where) {
    const std::size_t equals = std::min(text.find('='), text.size());
    Variation variation{.parameter = text.substr(0, equals), .where = where};
    const auto wrong = [&] {
        reject(where, "{} needs a range such as photons=1e4..1e7 or a list such as cache=on,off, not '{}'",
               where.file.empty() ? "--vary" : "'vary'", text);
    };
    if (equals == 0 || equals + 1 >= text.size()) wrong();
    const std::string values = text.substr(equals + 1);
    if (const std::size_t dots = values.find(".."); dots != std::string::npos) {
        const auto lower = number_from<double>(values.substr(0, dots));
        const auto upper = number_from<double>(values.substr(dots + 2));
        if (!lower || !upper || !(*lower < *upper)) wrong();
        variation.lower = *lower;
        variation.upper = *upper;
        return variation;
    }
    boost::split(variation.words, values, [](char c) { return c == ','; });
    if (std::ranges::count(variation.words, "") > 0) wrong();
    return variation;
}

std::vector<TuningAxis> tuning_axes(const MethodLabel& base, const std::vector<Variation>& variations) {
    std::vector<TuningAxis> axes;
    for (const Parameter& parameter : find_method(base.name).parameters) {
        const auto asked =
            std::ranges::find_if(variations, [&](const Variation& v) { return v.parameter == parameter.name; });
        const Variation* variation = asked == variations.end() ? nullptr : &*asked;
        const bool is_set =
            std::ranges::count(base.values, parameter.name, &std::pair<std::string, std::string>::first) > 0;
        if (variation && is_set)
            reject(variation->where, "{}: '{}' is set by the method '{}'", variation->source(), parameter.name,
                   base.text());
        if ((variation || parameter.tuning) && !is_set) axes.push_back(axis_of(parameter, variation));
    }
    if (axes.size() > most_axes)
        reject({}, "at most {} parameters can vary, and '{}' has {}", most_axes, base.text(), axes.size());
    return axes;
}

MethodLabel SearchSpace::label(const Setting& setting) const {
    MethodLabel label = base_;
    for (std::size_t d = 0; d < axes_.size(); ++d)
        if (setting[d]) label.values.emplace_back(axes_[d].name, axes_[d].text(*setting[d]));
    return label;
}

Setting SearchSpace::normal(Setting setting) const {
    Setting result = defaults();
    for (std::size_t d = 0; d < axes_.size(); ++d) {
        if (setting[d] == axes_[d].initial) continue;
        result[d] = setting[d];
        if (result[d] && !is_accepted(label(result))) result[d].reset();
    }
    return result;
}

std::optional<double> SearchSpace::effective(const Setting& setting, std::size_t axis) const {
    if (setting[axis] || !axes_[axis].initial) return setting[axis];
    // A parameter whose default is set where it has no effect is refused.
    Setting with_default = setting;
    with_default[axis] = axes_[axis].initial;
    return is_accepted(label(with_default)) ? axes_[axis].initial : std::nullopt;
}

std::vector<Setting> SearchSpace::cover(int count) const {
    constexpr std::uint64_t seed = 1;
    std::vector<Setting> settings = {defaults()};
    for (int i = 0; !axes_.empty() && i < count; ++i) {
        const Sampler point(PointSet::sobol, seed, 0, static_cast<std::uint32_t>(i));
        Setting setting;
        for (std::size_t d = 0; d < axes_.size(); ++d)
            setting.push_back(axes_[d].at(point.get_1d(static_cast<std::uint32_t>(d))));
        setting = normal(setting);
        if (std::ranges::find(settings, setting) == settings.end()) settings.push_back(setting);
    }
    return settings;
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

}  // namespace gib
