#include "experiments/report/row_columns.h"

#include "experiments/analysis/price.h"
#include "experiments/report/error_words.h"
#include "experiments/report/price_text.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>

#include <cmath>

namespace gib {

namespace {

using Value = std::function<std::optional<Estimate>(const TableRow&)>;

std::optional<Estimate> estimate_of(const std::optional<Estimate>& e) { return e; }
std::optional<Estimate> estimate_of(double value) { return Estimate{value, std::nullopt}; }
std::optional<Estimate> estimate_of(const std::optional<double>& v) { return v ? estimate_of(*v) : std::nullopt; }

template <typename Member>
Value of(Member TableRow::*member) {
    return [member](const TableRow& row) { return estimate_of(row.*member); };
}

/// A member of a part of the row, which may be missing.
template <typename Part, typename Member>
Value of(std::optional<Part> TableRow::*part, Member Part::*member) {
    return [=](const TableRow& row) { return row.*part ? estimate_of((*(row.*part)).*member) : std::nullopt; };
}

/// Empty where the value is not finite, because it is undefined there.
Value finite(const Value& value) {
    return [value](const TableRow& row) {
        const auto e = value(row);
        return e && std::isfinite(e->value) ? e : std::nullopt;
    };
}

/// A value with its interval; empty if it is undefined.
RowText shown(const Value& value, std::string (*text)(double)) {
    return [=](const TableRow& row) {
        const auto e = value(row);
        return e ? with_interval(*e, text) : "";
    };
}

struct Columns : std::vector<RowColumn> {
    void text(const std::string& name, const RowText& csv_text, unsigned sections = 0, const char* heading = "") {
        push_back({name, csv_text, sections, heading, csv_text});
    }
    /// These texts stand in sections only.
    void words(unsigned sections, const std::string& heading, const RowText& section_text) {
        push_back({"", {}, sections, heading, section_text});
    }
    void number(const std::string& name, const Value& value, unsigned sections = 0, const char* heading = "",
                const RowText& section_text = {}) {
        const auto csv_text = [value](const TableRow& row) {
            const auto e = value(row);
            return e ? csv_number(e->value) : "";
        };
        push_back({name, csv_text, sections, heading, section_text ? section_text : shown(value, short_number)});
    }
    void ends(const std::string& name, const Value& value) {
        for (const auto& [suffix, end] : {std::pair{"_lo", &Interval::lo}, {"_hi", &Interval::hi}})
            text(name + suffix, [value, end = end](const TableRow& row) {
                const auto e = value(row);
                return e && e->interval ? csv_number((*e->interval).*end) : "";
            });
    }
    void estimate(const std::string& name, const Value& value, unsigned sections = 0, const char* heading = "",
                  const RowText& section_text = {}) {
        number(name, value, sections, heading, section_text);
        ends(name, value);
    }
};

std::string root_percent(double square) { return percent_text(std::sqrt(at_least_zero(square))); }
std::string clipped(double value) { return short_number(at_least_zero(value)); }
std::string whole(double value) { return fmt::format("{:.0f}", value); }
std::string whole_percent(double share) { return fmt::format("{:.0f} %", 100 * share); }

/// rel_mse with its interval, less the reference's own variance; unclipped.
std::optional<Estimate> corrected_rel_mse(const TableRow& row) {
    if (!row.statistics) return std::nullopt;
    const auto& s = *row.statistics;
    const double own = s.rel_mse.value - s.rel_mse_corrected;
    Estimate corrected{s.rel_mse_corrected, std::nullopt};
    if (s.rel_mse.interval) corrected.interval = Interval{s.rel_mse.interval->lo - own, s.rel_mse.interval->hi - own};
    return corrected;
}

/// The relative RMSE [%] with its 95 % interval, the reference's own variance subtracted.
std::string relative_error_text(const TableRow& row) {
    if (!row.statistics) return "not judged";
    if (row.statistics->rel_mse_corrected <= row.noise_floor)
        return fmt::format("below {}, not resolved", root_percent(row.noise_floor));
    return with_interval(*corrected_rel_mse(row), root_percent);
}

/// Where bias^2 comes from: `unbiased` (0 by theory) or `measured`; empty if there is none.
std::string bias_state(const TableRow& row) {
    if (!row.statistics || !row.statistics->bias2) return "";
    return row.is_unbiased ? "unbiased" : "measured";
}

/// The share of bias^2 in the mean squared error; empty if it is not known.
std::string bias_share(const TableRow& row) {
    if (bias_state(row) == "unbiased") return "none: unbiased";
    if (!row.statistics || !row.statistics->bias2 || !row.statistics->variance) return "";
    const double bias2 = at_least_zero(row.statistics->bias2->value);
    const double sum = bias2 + at_least_zero(row.statistics->variance->value);
    return sum > 0 && std::isfinite(sum) ? whole_percent(bias2 / sum) + " bias" : "";
}

/// The floor as a relative error [%] and its parts, "2.30 (1.90 to 2.70: bias 1.10, fixed noise 2.02)". A floor whose
/// interval reaches 0 is not resolved.
std::string floor_text(const TableRow& row) {
    if (!row.law) return "";
    const auto& [floor, interval] = row.law->floor;
    if (!interval) return root_percent(floor);
    if (!(interval->lo > 0)) return "below " + root_percent(interval->hi);
    const double bias2 = floor_bias2(row);
    return fmt::format("{} ({} to {}: bias {}, fixed noise {})", root_percent(floor), root_percent(interval->lo),
                       root_percent(interval->hi), root_percent(bias2), root_percent(floor - bias2));
}

/// The text if the error of the whole image is that of few pixels, else empty.
RowText if_outliers(const Value& value, std::string (*text)(double)) {
    return [show = shown(value, text)](const TableRow& row) {
        return row.component == total_name && row.robust && is_decided_by_outliers(*row.robust) ? show(row) : "";
    };
}

void add_errors(Columns& c) {
    const auto error = [](auto member) { return of(&TableRow::statistics, member); };
    const Value bias2 = error(&ReplicateStatistics::bias2), variance = error(&ReplicateStatistics::variance);
    const auto time = [](std::size_t t) { return Value([t](const TableRow& row) { return row.times[t]; }); };
    const auto name_of_time = [](std::size_t t) { return fmt::format("seconds_to_{}pct", target_names[t]); };
    c.text("scene", &TableRow::scene);
    c.text("method", &TableRow::method);
    c.text("component", &TableRow::component);
    c.text("seeds", [](const TableRow& row) { return std::to_string(row.seeds); });
    c.number("seconds", of(&TableRow::seconds), in_prices | in_errors, "seconds");
    c.estimate("rmse", error(&ReplicateStatistics::rmse));
    c.estimate("rel_mse", error(&ReplicateStatistics::rel_mse), in_prices | in_errors, "relative RMSE %",
               relative_error_text);
    c.words(in_noise, "mean squared error [radiance^2]", shown(error(&ReplicateStatistics::mse), short_number));
    c.estimate("bias2", bias2, in_errors | in_noise, "bias^2 [radiance^2]",
               [measured = shown(bias2, clipped)](const TableRow& row) {
                   return bias_state(row) == "unbiased" ? "0, unbiased" : measured(row);
               });
    c.number("variance", variance, in_errors | in_noise, "variance [radiance^2]");
    c.words(in_noise, "share of bias^2", bias_share);
    c.words(in_errors, "bias or noise", error_kind);
    c.number("noise_centroid", of(&TableRow::noise, &NoiseSpectrum::centroid), in_errors | in_noise,
             "noise centroid [cycles per pixel]");
    c.number("noise_low_ratio", of(&TableRow::noise, &NoiseSpectrum::low_ratio), in_noise,
             "low frequencies [white noise = 1]");
    for (std::size_t t = 0; t < 4; ++t)
        c.number(name_of_time(t), time(t), t == 1 ? in_errors : 0u, "seconds to 5 %",
                 [t](const TableRow& row) { return time_text(row, t); });
    for (std::size_t t = 0; t < target_names.size(); ++t)
        c.words(in_prices, fmt::format("seconds to {} %", target_names[t]),
                [t](const TableRow& row) { return time_text(row, t); });
    c.text(
        "nonfinite", [](const TableRow& row) { return std::to_string(row.nonfinite); }, in_errors,
        "samples not finite");
    const Value memory = of(&TableRow::peak_rss_mib);
    c.number("peak_rss_mib", memory, in_prices, "memory MiB", shown(memory, whole));
    c.text("effects_missing", &TableRow::effects_missing);
    c.ends("variance", variance);
    c.number("rmse_corrected", finite(error(&ReplicateStatistics::rmse_corrected)));
    c.number("rel_mse_corrected", finite(error(&ReplicateStatistics::rel_mse_corrected)));
    c.number(name_of_time(4), time(4));
    for (std::size_t t = 0; t < target_names.size(); ++t)
        c.ends(name_of_time(t), time(t));
    c.number("prepare_seconds", of(&TableRow::prepare_seconds), in_prices, "seconds of preparation");
    c.number("flip", of(&TableRow::flip), in_errors, "FLIP [0 to 1]");
    c.words(in_prices | in_errors, "missing effects", left_out);
    c.number("rel_mse_resolved",
             [](const TableRow& row) { return row.floor_known ? estimate_of(row.noise_floor) : std::nullopt; });
    c.estimate("energy_excess", of(&TableRow::footing, &Footing::excess));
    c.text("footing", [](const TableRow& row) { return row.footing ? name_of(row.footing->verdict) : ""; });
}

void add_laws(Columns& c) {
    const auto law = [](auto member) { return of(&TableRow::law, member); };
    const auto robust = [](auto member) { return finite(of(&TableRow::robust, member)); };
    c.estimate("last_halving", of(&TableRow::last_halving), in_laws, "last halving: times the seconds");
    c.estimate("law_floor", law(&PriceLaw::floor), in_laws, "floor %", floor_text);
    c.number("law_floor_bias2", [](const TableRow& r) { return r.law ? estimate_of(floor_bias2(r)) : std::nullopt; });
    c.estimate("law_slope", law(&PriceLaw::slope), in_laws, "slope");
    c.number("law_factor", [](const TableRow& r) { return r.law ? estimate_of(r.law->law.factor) : std::nullopt; });
    c.number("law_misfit", law(&PriceLaw::misfit), in_laws, "worst point off the law",
             shown(law(&PriceLaw::misfit), whole_percent));
    c.estimate("next_halving", next_halving, in_laws, "next halving: times the seconds (extrapolated)",
               next_halving_text);
    const Value median = robust(&RobustError::median), trimmed = robust(&RobustError::trimmed);
    const Value share = robust(&RobustError::share);
    c.number("rel_mse_median", median, in_outliers, "median %", if_outliers(median, root_percent));
    c.number("rel_mse_trimmed", trimmed, in_outliers, "relative RMSE without them %",
             if_outliers(trimmed, root_percent));
    c.number("rel_mse_top_share", share, in_outliers, "share of the worst %", if_outliers(share, percent_text));
    c.number("epsilon", of(&TableRow::epsilon));
    c.text("components_missing", &TableRow::components_missing);
    c.text("bias_state", bias_state);
    c.ends("rel_mse_corrected", corrected_rel_mse);
    c.text("external", [](const TableRow& row) { return row.is_external ? "yes" : ""; });
    c.text("cpu", &TableRow::cpu);
}

}  // namespace

const std::vector<RowColumn>& row_columns() {
    static const Columns columns = [] {
        Columns c;
        add_errors(c);
        add_laws(c);
        return c;
    }();
    return columns;
}

}  // namespace gib
