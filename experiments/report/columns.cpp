#include "experiments/report/columns.h"

#include "experiments/analysis/row_fields.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

namespace gib {

namespace {

using RowRef = const TableRow&;

Field field_of(const std::optional<Estimate>& e) { return e ? measured(*e) : Field{}; }
Field field_of(const std::optional<double>& v) { return v ? measured(*v) : Field{}; }
Field field_of(double value) { return measured(value); }

template <auto member>
Field of(RowRef row) {
    return field_of(row.*member);
}
/// A member of a part of the row, which may be missing.
template <auto part, auto member>
Field of(RowRef row) {
    return row.*part ? field_of((*(row.*part)).*member) : Field{};
}
/// A statistic; empty where it is undefined.
template <auto member>
Field finite(RowRef row) {
    const Field field = of<&TableRow::statistics, member>(row);
    return std::isfinite(field.value) ? field : Field{};
}

/// Where bias^2 comes from; empty if there is none.
std::string bias_state(RowRef row) {
    if (!row.statistics || !row.statistics->bias2) return "";
    return row.is_unbiased ? "unbiased" : row.contradicted_in.empty() ? "measured" : "contradicted";
}

template <std::size_t target>
std::string time_state(RowRef row) {
    return csv_state(time_field(row, target));
}

}  // namespace

std::string passes_text(std::uint32_t least, std::uint32_t most) {
    return least == most ? std::to_string(most) : fmt::format("{} to {}", least, most);
}

std::string passes_of(const TableRow& row) {
    return row.most_passes > 0 ? passes_text(row.least_passes, row.most_passes) : "";
}

Shown shown(const RowValue& value, const TableRow& row) {
    return std::visit([&](const auto& of) -> Shown { return of(row); }, value);
}

const std::vector<RowColumn>& row_columns() {
    using S = ReplicateStatistics;
    constexpr auto statistics = &TableRow::statistics;
    constexpr auto noise = &TableRow::noise;
    static const std::vector<RowColumn> columns = {
        {"scene", "", "the scene file's name without folder and ending", [](RowRef r) { return r.scene; }},
        {"method", "", "label: the method with its settings", [](RowRef r) { return r.method; }},
        {"component", "", "class of light paths, or `total`, the sum of all that the reference samples",
         [](RowRef r) { return std::string(name_of(r.layer)); }},
        {"label", "",
         "name of the method in `table.md`, the report and figures: the key `label` or the method, with the settings "
         "that vary",
         [](RowRef r) { return r.name; }},
        {"external", "", "`yes`: an image of another renderer",
         [](RowRef r) { return std::string(r.is_external ? "yes" : ""); }},
        {"seeds", "", "number of complete seeds", [](RowRef r) { return std::to_string(r.seeds); }},
        {"passes", "", "passes of the final images: one number, or the least and the most of the seeds", passes_of},
        {"seconds", "s", "charged wall-clock time of the final images, mean over the seeds", of<&TableRow::seconds>},

        {"rel_mse", "",
         "mean((x - r)^2 / (r^2 + epsilon)) over pixels and channels: the square of a relative RMSE that includes the "
         "reference's own variance. Components are divided by the r^2 + epsilon of the total",
         of<statistics, &S::rel_mse>, 95},
        {"rel_mse_corrected", "",
         "`rel_mse` with the reference's own variance subtracted, as in `table.md`. Subtract the same from the "
         "interval "
         "of `rel_mse`",
         finite<&S::rel_mse_corrected>},
        {"rel_mse_resolved", "", "squared relative error below which the reference's noise hides differences",
         [](RowRef r) { return r.floor_known ? measured(r.noise_floor) : Field{}; }},
        {"rel_mse_unmet", "", "part of `rel_mse` that is unsampled light: lit in the reference, black in every seed",
         of<&TableRow::unsampled>},
        {"rmse", "radiance", "root mean squared error against the reference, whose own variance is included",
         of<statistics, &S::rmse>, 95},
        {"rmse_corrected", "radiance", "`rmse` with the reference's own variance subtracted from its square",
         finite<&S::rmse_corrected>},
        {"epsilon", "radiance^2", "epsilon of the row's relative errors", of<&TableRow::epsilon>},

        {"bias2", "radiance^2",
         "part of the mean squared error that remains when many seeds are averaged. Unclipped: noise can make it "
         "negative",
         of<statistics, &S::bias2>, 95},
        {"bias_state", "",
         "`unbiased`: bias^2 is 0 by theory, because the method is unbiased and samples every path of the row; `bias2` "
         "keeps the seeds' estimate. `measured`: `bias2` is the only knowledge. `contradicted`: declared unbiased, but "
         "the mean energy differs from the reference's, here or in a component. Empty: one seed",
         bias_state},
        {"variance", "radiance^2", "scatter from seed to seed, mean over pixels; it falls with more samples",
         of<statistics, &S::variance>, 95},
        {"energy_excess", "",
         "(mean of the method - mean of the reference) / unit. The unit is the larger one of the reference's mean and "
         "a "
         "hundredth of the total's mean",
         [](RowRef r) { return r.balance ? measured(r.balance->excess) : Field{}; }, 99},
        {"footing", "", "energy balance: `agrees` within 1 %, `differs` or `inconclusive`",
         [](RowRef r) { return r.balance ? name_of(r.balance->verdict) : ""; }},
        {"seconds_to_10pct", "s", "time to a relative RMSE of 10 %", time_to<0>, 95},
        {"seconds_to_10pct_state", "",
         "`measured`: all seeds have reached the error. `some seeds`: not all of them. By the fitted law: "
         "`extrapolated` "
         "(with the extrapolation's interval), `at least` (the lower end is the bound), `never` (the error floor is "
         "above). `not reached`: no estimate. `no verdict`: the reference is contradicted. `below the reference's "
         "noise`: hidden by it",
         time_state<0>},
        {"seconds_to_5pct", "s", "time to a relative RMSE of 5 %", time_to<1>, 95},
        {"seconds_to_5pct_state", "", "state of `seconds_to_5pct`, as of `seconds_to_10pct`", time_state<1>},
        {"seconds_to_2pct", "s", "time to a relative RMSE of 2 %", time_to<2>, 95},
        {"seconds_to_2pct_state", "", "state of `seconds_to_2pct`, as of `seconds_to_10pct`", time_state<2>},
        {"seconds_to_1pct", "s", "time to a relative RMSE of 1 %", time_to<3>, 95},
        {"seconds_to_1pct_state", "", "state of `seconds_to_1pct`, as of `seconds_to_10pct`", time_state<3>},
        {"seconds_to_0.5pct", "s", "time to a relative RMSE of 0.5 %", time_to<4>, 95},
        {"seconds_to_0.5pct_state", "", "state of `seconds_to_0.5pct`, as of `seconds_to_10pct`", time_state<4>},
        {"noise_centroid", "cycles per pixel",
         "mean spatial frequency of the noise; white noise has 0.38. Left out: pixels without noise, and edges across "
         "which the reference changes by more than 25 %",
         of<noise, &NoiseSpectrum::centroid>},
        {"noise_low_ratio", "white noise = 1", "power of the noise below 0.1 cycles per pixel",
         of<noise, &NoiseSpectrum::low_ratio>},
        {"prepare_seconds", "s", "part of `seconds` before the first pass", of<&TableRow::prepare_seconds>},
        {"peak_rss_mib", "MiB", "largest resident set of the cells' processes", of<&TableRow::peak_rss_mib>},
        {"cpu", "",
         "processor that measured the row, by the system's name. Several are separated by `;`: their times do not "
         "compare",
         [](RowRef r) { return fmt::format("{}", fmt::join(r.cpus, ";")); }},
        {"flip", "0 to 1",
         "HDR-FLIP (Andersson et al. 2021) at 67 pixels per degree of the final images, mean over pixels and seeds; "
         "`total` "
         "only",
         of<&TableRow::flip>},
        {"nonfinite", "", "samples of all seeds that were not finite and were dropped",
         [](RowRef r) { return measured(static_cast<double>(r.nonfinite)); }},
        {"effects_missing", "", "effects that the scene calls for and the method does not simulate, separated by `;`",
         [](RowRef r) { return r.effects_missing.names(); }},
        {"components_missing", "", "components with light that the method samples incompletely, separated by `;`",
         [](RowRef r) { return names_of(r.components_missing.list()); }},
    };
    return columns;
}

std::vector<std::string> csv_fields(const TableRow& row) {
    std::vector<std::string> fields;
    for (const RowColumn& column : row_columns()) {
        const Shown value = shown(column.value, row);
        if (const auto* words = std::get_if<std::string>(&value)) {
            fields.push_back(*words);
            continue;
        }
        const Field& field = std::get<Field>(value);
        fields.push_back(field.is_measured() ? csv_number(field.value) : "");
        if (column.percent == 0) continue;
        const bool is_bound = field.state == State::at_least;
        fields.push_back(field.interval ? csv_number(field.interval->lo) : is_bound ? csv_number(field.value) : "");
        fields.push_back(field.interval ? csv_number(field.interval->hi) : "");
    }
    return fields;
}

}  // namespace gib
