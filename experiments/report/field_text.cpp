#include "experiments/report/field_text.h"

#include "experiments/text/numbers.h"

#include <fmt/format.h>

#include <cmath>

namespace gib {

namespace {

std::string whole_percent(double share) {
    const double value = 100 * share;
    return value > 0 && value < 1 ? fmt::format("{:.1g}", value) : fmt::format("{:.0f}", value);
}

std::string number_text(double value, Unit unit) {
    if (std::isnan(value)) return "nan";
    switch (unit) {
        case Unit::percent:
            return percent_text(value);
        case Unit::root:
            return percent_text(std::sqrt(at_least_zero(value)));
        case Unit::whole:
            return fmt::format("{:.0f}", value);
        case Unit::share:
            return whole_percent(value);
        case Unit::number:
            break;
    }
    return short_number(value);
}

}  // namespace

FieldText text_of(const Field& field, const std::string& unit) {
    const auto number = [&](double value) { return number_text(value, field.unit) + unit; };
    const std::string range = field.interval ? fmt::format("{} to {}", number_text(field.interval->lo, field.unit),
                                                           number_text(field.interval->hi, field.unit))
                                             : "";
    switch (field.state) {
        case State::measured:
            return {number(field.value), range};
        case State::extrapolated:
            return {number(field.value), "extrapolated, " + range};
        case State::at_least:
            return {"at least " + number(field.value), "extrapolated"};
        case State::below:
            return {"below " + number(field.value), ""};
        case State::some_seeds:
            return {"not by all seeds", fmt::format("by {:.0f} of {}", field.value, field.seeds)};
        case State::never:
            return {"never", fmt::format("floor {} %", number_text(field.value, field.unit))};
        case State::unbiased:
            return {"0", "unbiased"};
        case State::no_image:
            return {fmt::format("no image yet; first after {} s", short_number(field.value)), ""};
        case State::not_resolved:
            if (!std::isnan(field.value)) return {fmt::format("below {}, not resolved", number(field.value)), ""};
            break;
        default:
            break;
    }
    return {csv_state(field), ""};
}

std::string line_of(const Field& field, const std::string& unit) {
    const auto [value, detail] = text_of(field, unit);
    return detail.empty() ? value : fmt::format("{} ({})", value, detail);
}

std::string csv_text(const Field& field) { return field.is_measured() ? csv_number(field.value) : ""; }

std::string csv_state(const Field& field) {
    // In the order of State.
    constexpr const char* names[] = {
        "",      "measured", "extrapolated", "at least",       "below",    "some seeds", "not reached",
        "never", "unbiased", "not resolved", "cannot be told", "no image", "not judged"};
    static_assert(std::size(names) == static_cast<std::size_t>(State::not_judged) + 1);
    return names[static_cast<std::size_t>(field.state)];
}

}  // namespace gib
