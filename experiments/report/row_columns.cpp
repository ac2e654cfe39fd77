#include "experiments/report/row_columns.h"

#include "experiments/analysis/price.h"
#include "experiments/report/error_words.h"
#include "experiments/report/price_text.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>

#include <cmath>
#include <tuple>

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
    void text(const Declared& column, const RowText& csv_text, unsigned sections = 0, const char* heading = "") {
        push_back({column, csv_text, sections, heading, csv_text});
    }
    /// These texts stand in sections only.
    void words(unsigned sections, const std::string& heading, const RowText& section_text) {
        push_back({{}, {}, sections, heading, section_text});
    }
    void number(const Declared& column, const Value& value, unsigned sections = 0, const char* heading = "",
                const RowText& section_text = {}) {
        const auto csv_text = [value](const TableRow& row) {
            const auto e = value(row);
            return e ? csv_number(e->value) : "";
        };
        push_back({column, csv_text, sections, heading, section_text ? section_text : shown(value, short_number)});
    }
    void ends(const Declared& column, const Value& value, int percent = 95) {
        for (const auto& [suffix, word, end] :
             {std::tuple{"_lo", "lower", &Interval::lo}, {"_hi", "upper", &Interval::hi}})
            text({column.name + suffix, column.value,
                  fmt::format("{} end of the {} % interval of `{}`", word, percent, column.name)},
                 [value, end = end](const TableRow& row) {
                     const auto e = value(row);
                     return e && e->interval ? csv_number((*e->interval).*end) : "";
                 });
    }
    void estimate(const Declared& column, const Value& value, unsigned sections = 0, const char* heading = "",
                  const RowText& section_text = {}) {
        number(column, value, sections, heading, section_text);
        ends(column, value);
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

Declared corrected_column() {
    return {"rel_mse_corrected", "", "`rel_mse` with the reference's own variance subtracted, as in `table.md`"};
}

void add_errors(Columns& c) {
    const auto error = [](auto member) { return of(&TableRow::statistics, member); };
    const Value bias2 = error(&ReplicateStatistics::bias2), variance = error(&ReplicateStatistics::variance);
    const auto time = [](std::size_t t) { return Value([t](const TableRow& row) { return row.times[t]; }); };
    const auto time_column = [](std::size_t t) {
        return Declared{fmt::format("seconds_to_{}pct", target_names[t]), "s",
                        fmt::format("time to a relative RMSE of {} %", target_names[t])};
    };
    const Declared variance_column{"variance", "radiance^2",
                                   "scatter from seed to seed, mean over pixels; it falls with more samples"};
    c.text({"scene", "", "the scene file's name without folder and ending"}, &TableRow::scene);
    c.text({"method", "", "label: the method with its settings"}, &TableRow::method);
    c.text({"component", "", "class of light paths, or `total`, the sum of those that the reference resolves"},
           &TableRow::component);
    c.text({"seeds", "", "number of complete seeds"}, [](const TableRow& row) { return std::to_string(row.seeds); });
    c.number({"seconds", "s", "charged wall-clock time of the final images, mean over the seeds"},
             of(&TableRow::seconds), in_prices | in_errors, "seconds");
    c.estimate({"rmse", "radiance", "root mean squared error against the reference, by the plain formula"},
               error(&ReplicateStatistics::rmse));
    c.estimate({"rel_mse", "",
                "mean((x - r)^2 / (r^2 + epsilon)) over pixels and channels, by the plain formula: the square of a "
                "relative RMSE. Components are divided by the r^2 + epsilon of the total"},
               error(&ReplicateStatistics::rel_mse), in_prices | in_errors, "relative RMSE %", relative_error_text);
    c.words(in_noise, "mean squared error [radiance^2]", shown(error(&ReplicateStatistics::mse), short_number));
    c.estimate({"bias2", "radiance^2",
                "part of the mean squared error that remains when many seeds are averaged, unclipped: below 0 where "
                "neither seeds nor reference resolve it"},
               bias2, in_errors | in_noise, "bias^2 [radiance^2]",
               [measured = shown(bias2, clipped)](const TableRow& row) {
                   return bias_state(row) == "unbiased" ? "0, unbiased" : measured(row);
               });
    c.number(variance_column, variance, in_errors | in_noise, "variance [radiance^2]");
    c.words(in_noise, "share of bias^2", bias_share);
    c.words(in_errors, "bias or noise", error_kind);
    c.number({"noise_centroid", "cycles per pixel", "mean spatial frequency of the noise; white noise has 0.38"},
             of(&TableRow::noise, &NoiseSpectrum::centroid), in_errors | in_noise, "noise centroid [cycles per pixel]");
    c.number({"noise_low_ratio", "white noise = 1", "power of the noise below 0.1 cycles per pixel"},
             of(&TableRow::noise, &NoiseSpectrum::low_ratio), in_noise, "low frequencies [white noise = 1]");
    for (std::size_t t = 0; t < 4; ++t)
        c.number(time_column(t), time(t), t == 1 ? in_errors : 0u, "seconds to 5 %",
                 [t](const TableRow& row) { return time_text(row, t); });
    for (std::size_t t = 0; t < target_names.size(); ++t)
        c.words(in_prices, fmt::format("seconds to {} %", target_names[t]),
                [t](const TableRow& row) { return time_text(row, t); });
    c.text(
        {"nonfinite", "", "samples of all seeds that were not finite and were dropped"},
        [](const TableRow& row) { return std::to_string(row.nonfinite); }, in_errors, "samples not finite");
    const Value memory = of(&TableRow::peak_rss_mib);
    c.number({"peak_rss_mib", "MiB", "largest resident set of the cells' processes"}, memory, in_prices, "memory MiB",
             shown(memory, whole));
    c.text(
        {"effects_missing", "", "effects that the scene calls for and the method does not simulate, separated by `;`"},
        &TableRow::effects_missing);
    c.ends(variance_column, variance);
    c.number({"rmse_corrected", "radiance", "`rmse` with the reference's own variance subtracted from its square"},
             finite(error(&ReplicateStatistics::rmse_corrected)));
    c.number(corrected_column(), finite(error(&ReplicateStatistics::rel_mse_corrected)));
    c.number(time_column(4), time(4));
    for (std::size_t t = 0; t < target_names.size(); ++t)
        c.ends(time_column(t), time(t));
    c.number({"prepare_seconds", "s", "part of `seconds` before the first pass"}, of(&TableRow::prepare_seconds),
             in_prices, "seconds of preparation");
    c.number({"flip", "0 to 1",
              "HDR-FLIP (Andersson et al. 2021) at 67 pixels per degree of the final images, mean over pixels and "
              "seeds; of `total` only"},
             of(&TableRow::flip), in_errors, "FLIP [0 to 1]");
    c.words(in_prices | in_errors, "missing effects", left_out);
    c.number({"rel_mse_resolved", "", "squared relative error below which the reference's noise hides the rest"},
             [](const TableRow& row) { return row.floor_known ? estimate_of(row.noise_floor) : std::nullopt; });
    const Value excess = of(&TableRow::footing, &Footing::excess);
    const Declared excess_column{
        "energy_excess", "",
        "(mean of the method - mean of the reference) as a share of the reference's mean, or of "
        "a hundredth of the total's mean if that is more"};
    c.number(excess_column, excess);
    c.ends(excess_column, excess, 99);
    c.text({"footing", "", "verdict of equal footing: `agrees` within 1 %, `differs` or `unresolved`"},
           [](const TableRow& row) { return row.footing ? name_of(row.footing->verdict) : ""; });
}

void add_laws(Columns& c) {
    const auto law = [](auto member) { return of(&TableRow::law, member); };
    const auto robust = [](auto member) { return finite(of(&TableRow::robust, member)); };
    c.estimate({"last_halving", "", "factor by which time grew for the last halving of the error, as measured"},
               of(&TableRow::last_halving), in_laws, "last halving: times the seconds");
    c.estimate({"law_floor", "", "floor^2 of the fitted law error^2 = floor^2 + c (t - preparation)^-slope"},
               law(&PriceLaw::floor), in_laws, "floor %", floor_text);
    c.number({"law_floor_bias2", "", "part of `law_floor` that is bias"},
             [](const TableRow& r) { return r.law ? estimate_of(floor_bias2(r)) : std::nullopt; });
    c.estimate({"law_slope", "", "slope of the law"}, law(&PriceLaw::slope), in_laws, "slope");
    c.number({"law_factor", "", "c of the law, for t in seconds"},
             [](const TableRow& r) { return r.law ? estimate_of(r.law->law.factor) : std::nullopt; });
    c.number({"law_misfit", "", "largest relative deviation of a measured squared error from the law"},
             law(&PriceLaw::misfit), in_laws, "worst point off the law", shown(law(&PriceLaw::misfit), whole_percent));
    c.estimate({"next_halving", "",
                "factor by which time would grow for half the error of the final image, extrapolated by the law; empty "
                "where its floor is not resolved, or where `table.md` extrapolates nothing"},
               next_halving, in_laws, "next halving: times the seconds (extrapolated)", next_halving_text);
    const Value median = robust(&RobustError::median), trimmed = robust(&RobustError::trimmed);
    const Value share = robust(&RobustError::share);
    c.number({"rel_mse_median", "", "median of the pixels' squared relative errors"}, median, in_outliers, "median %",
             if_outliers(median, root_percent));
    c.number(
        {"rel_mse_trimmed", "", "mean of the pixels' squared relative errors without the worst 0.1 % of the pixels"},
        trimmed, in_outliers, "relative RMSE without them %", if_outliers(trimmed, root_percent));
    c.number({"rel_mse_top_share", "", "share of `rel_mse` that the worst 0.1 % of the pixels hold"}, share,
             in_outliers, "share of the worst %", if_outliers(share, percent_text));
    c.number({"epsilon", "radiance^2", "epsilon of the row's relative errors"}, of(&TableRow::epsilon));
    c.text({"components_missing", "",
            "components that hold light and of which the method leaves out paths, separated by `;`"},
           &TableRow::components_missing);
    c.text({"bias_state", "",
            "`unbiased`: the method declares itself unbiased and samples every path of the row, so that bias^2 is 0 by "
            "theory and all error is variance; `bias2` keeps what the seeds say, whose interval misses 0 in one of "
            "twenty rows. `measured`: `bias2` is all that is known. Empty: one seed"},
           bias_state);
    c.ends(corrected_column(), corrected_rel_mse);
    c.text({"external", "", "`yes`: an image of another renderer"},
           [](const TableRow& row) { return row.is_external ? "yes" : ""; });
    c.text(
        {"cpu", "",
         "processor that measured the row, by the name that the system gives; several are separated by `;`, and their "
         "times do not compare"},
        &TableRow::cpu);
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
