#include "experiments/report/tables.h"

#include "experiments/analysis/comparison.h"
#include "experiments/analysis/row_fields.h"
#include "experiments/report/words.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace gib {

namespace {

using FieldOf = std::function<Field(const TableRow&)>;
using TextOf = std::function<std::string(const TableRow&)>;

Field field_of(const std::optional<Estimate>& e) { return e ? measured(*e) : Field{}; }
Field field_of(const std::optional<double>& v) { return v ? measured(*v) : Field{}; }
Field field_of(double value) { return measured(value); }

template <typename Member>
FieldOf of(Member TableRow::*member) {
    return [member](const TableRow& row) { return field_of(row.*member); };
}

/// A member of a part of the row, which may be missing.
template <typename Part, typename Member>
FieldOf of(std::optional<Part> TableRow::*part, Member Part::*member) {
    return [=](const TableRow& row) { return row.*part ? field_of((*(row.*part)).*member) : Field{}; };
}

/// Empty where the value is not finite, because it is undefined there.
FieldOf finite(const FieldOf& field) {
    return [field](const TableRow& row) {
        const Field f = field(row);
        return std::isfinite(f.value) ? f : Field{};
    };
}

FieldOf in_unit(const FieldOf& field, Unit unit) {
    return [=](const TableRow& row) {
        Field f = field(row);
        f.unit = unit;
        return f;
    };
}

/// The field if `keeps` holds for the row.
FieldOf where(bool (*keeps)(const TableRow&), const FieldOf& field) {
    return [=](const TableRow& row) { return keeps(row) ? field(row) : Field{}; };
}

struct Columns : std::vector<RowColumn> {
    void text(const Declared& column, const TextOf& text, unsigned sections = 0, const char* heading = "") {
        push_back({column, text, sections, heading, text, sections != 0});
    }
    /// These stand in sections only; `sentence` says what they mean.
    void shown(unsigned sections, const std::string& heading, const FieldOf& field, const std::string& sentence = "") {
        push_back({{"", "", sentence}, {}, sections, heading, field});
    }
    void words(unsigned sections, const std::string& heading, const TextOf& text, const std::string& sentence = "") {
        push_back({{"", "", sentence}, {}, sections, heading, text, true});
    }
    /// The meaning of the column that was added last, in sections.
    void means(const std::string& sentence) {
        auto column = std::find_if(rbegin(), rend(), [](const RowColumn& c) { return c.sections != 0; });
        column->meaning = sentence;
    }
    /// `shown`: its field in sections if that is another one.
    void number(const Declared& column, const FieldOf& field, unsigned sections = 0, const char* heading = "",
                const FieldOf& shown = {}) {
        push_back({column, [field](const TableRow& row) { return csv_text(field(row)); }, sections, heading,
                   shown ? shown : field});
    }
    void ends(const Declared& column, const FieldOf& field, int percent = 95) {
        for (const auto& [suffix, word, end] :
             {std::tuple{"_lo", "lower", &Interval::lo}, {"_hi", "upper", &Interval::hi}})
            push_back({{column.name + suffix, column.value,
                        fmt::format("{} end of the {} % interval of `{}`", word, percent, column.name)},
                       [field, end = end](const TableRow& row) {
                           const Field f = field(row);
                           return f.is_measured() && f.interval ? csv_number((*f.interval).*end) : "";
                       }});
    }
    void estimate(const Declared& column, const FieldOf& field, unsigned sections = 0, const char* heading = "",
                  const FieldOf& shown = {}) {
        number(column, field, sections, heading, shown);
        ends(column, field);
    }
};

/// Where bias^2 comes from: `unbiased` (0 by theory) or `measured`; empty if there is none.
std::string bias_state(const TableRow& row) {
    if (!row.statistics || !row.statistics->bias2) return "";
    return row.is_unbiased ? "unbiased" : row.contradicted_in.empty() ? "measured" : "contradicted";
}

/// Whether the error of the whole image is that of few pixels.
bool has_outliers(const TableRow& row) {
    return row.layer == Layer::total && row.robust && is_decided_by_outliers(*row.robust);
}

/// A field as the number of a column of table.csv, if it is in one of the states.
FieldOf in_states(const FieldOf& field, State one, State other) {
    return [=](const TableRow& row) {
        Field f = field(row);
        if (f.state != one && f.state != other) return Field{};
        f.state = State::measured;
        return f;
    };
}

/// A power whose estimate is unbiased, and may be negative where there is little.
Field low_frequencies_field(const TableRow& row) {
    if (!row.noise) return {};
    return row.noise->low_ratio > 0 ? measured(row.noise->low_ratio) : Field{State::not_resolved};
}

FieldOf time(std::size_t t) {
    return [t](const TableRow& row) { return time_field(row, t); };
}

Declared time_column(std::size_t t) {
    return {fmt::format("seconds_to_{}pct", target_names[t]), "s",
            fmt::format("time to a relative RMSE of {} %", target_names[t])};
}

Declared corrected_column() {
    return {"rel_mse_corrected", "", "`rel_mse` with the reference's own variance subtracted, as in `table.md`"};
}

void add_errors(Columns& c) {
    const auto error = [](auto member) { return of(&TableRow::statistics, member); };
    const FieldOf bias2 = error(&ReplicateStatistics::bias2), variance = error(&ReplicateStatistics::variance);
    const Declared variance_column{"variance", "radiance^2",
                                   "scatter from seed to seed, mean over pixels; it falls with more samples"};
    c.text({"scene", "", "the scene file's name without folder and ending"}, &TableRow::scene);
    c.text({"method", "", "label: the method with its settings"}, &TableRow::method);
    c.text({"component", "", "class of light paths, or `total`, the sum of those that the reference resolves"},
           [](const TableRow& row) { return std::string(name_of(row.layer)); });
    c.text({"seeds", "", "number of complete seeds"}, [](const TableRow& row) { return std::to_string(row.seeds); });
    c.number({"seconds", "s", "charged wall-clock time of the final images, mean over the seeds"},
             of(&TableRow::seconds), in_prices | in_errors, "seconds");
    c.estimate({"rmse", "radiance", "root mean squared error against the reference, by the plain formula"},
               error(&ReplicateStatistics::rmse));
    c.estimate({"rel_mse", "",
                "mean((x - r)^2 / (r^2 + epsilon)) over pixels and channels, by the plain formula: the square of a "
                "relative RMSE. Components are divided by the r^2 + epsilon of the total"},
               error(&ReplicateStatistics::rel_mse), in_prices | in_errors, "relative RMSE %", relative_error_field);
    c.means(
        "root of the mean of (x - r)^2 / (r^2 + epsilon) over pixels and channels, from which the reference's own "
        "variance is subtracted. Components are divided by the r^2 + epsilon of the total");
    c.shown(in_noise, "mean squared error [radiance^2]", corrected_mse_field,
            "the reference's own variance is subtracted");
    c.estimate({"bias2", "radiance^2",
                "part of the mean squared error that remains when many seeds are averaged, unclipped: below 0 where "
                "neither seeds nor reference resolve it"},
               bias2, in_errors | in_noise, "bias^2 [radiance^2]", bias2_field);
    c.means("part of the mean squared error that remains when many seeds are averaged");
    c.number(variance_column, variance, in_errors | in_noise, "variance [radiance^2]", variance_field);
    c.shown(in_noise, "share of bias^2 %", bias_share_field, "share of bias^2 in the square of the relative RMSE");
    c.words(
        in_errors, "bias or noise", error_kind,
        "whether averaging many images would remove the error: bias^2 and its 95 % interval as shares of the square "
        "of the relative RMSE; a method that is declared unbiased has noise alone, unless its mean energy contradicts "
        "that");
    c.number(
        {"noise_centroid", "cycles per pixel",
         "mean spatial frequency of the noise; white noise has 0.38. "
         "Left out: pixels without noise, and those at edges, across which the reference changes by more than 25 %"},
        of(&TableRow::noise, &NoiseSpectrum::centroid), in_errors | in_noise, "noise centroid [cycles per pixel]");
    c.number({"noise_low_ratio", "white noise = 1", "power of the noise below 0.1 cycles per pixel"},
             of(&TableRow::noise, &NoiseSpectrum::low_ratio), in_noise, "low frequencies [white noise = 1]",
             low_frequencies_field);
    for (std::size_t t = 0; t < 4; ++t) {
        c.number(time_column(t), time(t), t == 1 ? in_errors : 0u, "seconds to 5 %");
        if (t == 1) c.back().target = t;
    }
    for (std::size_t t = 0; t < target_names.size(); ++t) {
        c.shown(in_prices, fmt::format("seconds to {} %", target_names[t]), time(t));
        c.back().target = t;
    }
    c.number(
        {"nonfinite", "", "samples of all seeds that were not finite and were dropped"},
        [](const TableRow& row) { return measured(static_cast<double>(row.nonfinite), Unit::whole); }, in_errors,
        "samples not finite");
    c.number({"peak_rss_mib", "MiB", "largest resident set of the cells' processes"},
             in_unit(of(&TableRow::peak_rss_mib), Unit::whole), in_prices, "memory MiB");
    c.text(
        {"effects_missing", "", "effects that the scene calls for and the method does not simulate, separated by `;`"},
        [](const TableRow& row) { return row.effects_missing.names(); });
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
    c.words(in_prices | in_errors, "missing effects", left_out,
            "light transport that the scene calls for and the method leaves out");
    c.number({"rel_mse_resolved", "", "squared relative error below which the reference's noise hides the rest"},
             [](const TableRow& row) { return row.floor_known ? measured(row.noise_floor) : Field{}; });
    const FieldOf excess = of(&TableRow::footing, &Footing::excess);
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
               law(&PriceLaw::floor), in_laws, "floor %", floor_field);
    c.means(
        "relative RMSE that more time does not remove: floor of the law error^2 = floor^2 + c (t - "
        "preparation)^-slope");
    const FieldOf floor_bias = [](const TableRow& r) { return r.law ? measured(floor_bias2(r), Unit::root) : Field{}; };
    c.number({"law_floor_bias2", "", "part of `law_floor` that is bias"}, floor_bias, in_laws, "bias in the floor %",
             floor_bias_field);
    c.means("root of the part of floor^2 that is bias^2");
    c.estimate({"law_slope", "", "slope of the law"}, law(&PriceLaw::slope), in_laws, "slope", slope_field);
    c.number({"law_factor", "", "c of the law, for t in seconds"},
             [](const TableRow& r) { return r.law ? measured(r.law->law.factor) : Field{}; });
    c.number({"law_misfit", "", "largest relative deviation of a measured squared error from the law"},
             in_unit(law(&PriceLaw::misfit), Unit::share), in_laws, "worst point off the law %", [](const TableRow& r) {
                 return r.law ? measured(r.is_unbiased ? r.law->floorless_misfit : r.law->misfit, Unit::share)
                              : Field{};
             });
    c.estimate({"next_halving", "",
                "factor by which time would grow for half the error of the final image, extrapolated by the law; empty "
                "where its floor is not resolved, or where `table.md` extrapolates nothing"},
               in_states(next_halving_field, State::extrapolated, State::measured), in_laws,
               "next halving: times the seconds", next_halving_field);
    const FieldOf median = in_unit(robust(&RobustError::median), Unit::root);
    const FieldOf trimmed = in_unit(robust(&RobustError::trimmed), Unit::root);
    const FieldOf share = in_unit(robust(&RobustError::share), Unit::percent);
    c.number({"rel_mse_median", "", "median of the pixels' squared relative errors"}, median, in_outliers, "median %",
             where(has_outliers, median));
    c.means("root of the median of the pixels' squared relative errors");
    c.number(
        {"rel_mse_trimmed", "", "mean of the pixels' squared relative errors without the worst 0.1 % of the pixels"},
        trimmed, in_outliers, "relative RMSE without them %", where(has_outliers, trimmed));
    c.means("root of the mean of the pixels' squared relative errors without the worst 0.1 % of the pixels");
    c.number({"rel_mse_top_share", "", "share of `rel_mse` that the worst 0.1 % of the pixels hold"}, share,
             in_outliers, "share of the worst %", where(has_outliers, share));
    c.means("share of the squared relative error that the worst 0.1 % of the pixels hold");
    c.number({"epsilon", "radiance^2", "epsilon of the row's relative errors"}, of(&TableRow::epsilon));
    c.text({"components_missing", "",
            "components that hold light and of which the method leaves out paths, separated by `;`"},
           [](const TableRow& row) { return names_of(row.components_missing.list()); });
    c.text({"bias_state", "",
            "`unbiased`: the method declares itself unbiased and samples every path of the row, so that bias^2 is 0 by "
            "theory and all error is variance; `bias2` keeps what the seeds say, whose interval misses 0 in one of "
            "twenty rows. `measured`: `bias2` is all that is known. `contradicted`: the same of a method that declares "
            "itself unbiased, but has another mean energy than the reference, here or in a component. Empty: one seed"},
           bias_state);
    c.ends(corrected_column(), [](const TableRow& row) { return field_of(corrected_rel_mse(row)); });
    c.text({"external", "", "`yes`: an image of another renderer"},
           [](const TableRow& row) { return row.is_external ? "yes" : ""; });
    c.text(
        {"cpu", "",
         "processor that measured the row, by the name that the system gives; several are separated by `;`, and their "
         "times do not compare"},
        [](const TableRow& row) { return fmt::format("{}", fmt::join(row.cpus, ";")); });
    c.text(
        {"passes", "", "passes of the final images: one number, or the least and the most of the seeds"},
        [](const TableRow& r) { return r.most_passes > 0 ? passes_text(r.least_passes, r.most_passes) : ""; },
        in_prices | in_errors, "passes");
    c.back().of_words = false;
    for (std::size_t t = 0; t < target_names.size(); ++t) {
        const std::string name = time_column(t).name;
        c.text(
            {name + "_state", "",
             "`measured`: all seeds have reached it. `some seeds`: not all of them. By the fitted law: `extrapolated`, "
             "`at least`, `never` (its floor is above). `not reached`: nothing tells when. `not judged`: the reference "
             "is wrong there. `not resolved`: the "
             "reference's "
             "noise hides it"},
            [t](const TableRow& row) { return csv_state(time_field(row, t)); });
        c.estimate(
            {name + "_law", "s", fmt::format("`{}` by the fitted law; a lower bound if the state is `at least`", name)},
            in_states(time(t), State::extrapolated, State::at_least));
    }
    c.text({"label", "",
            "name of the method in `table.md`, the report and figures: the key `label` of the experiment "
            "file, else the method, with the settings that vary"},
           &TableRow::name);
    c.number({"rel_mse_unmet", "", "part of `rel_mse` that is light which no seed has met"}, of(&TableRow::unmet));
}

/// The columns of table.csv, with their headings in table.md.
std::vector<Declared> row_declarations() {
    std::vector<Declared> columns;
    for (const RowColumn& column : row_columns()) {
        if (column.name.empty()) continue;
        columns.push_back(column);
        if (column.sections != 0 && column.heading != column.name)
            columns.back().sentence += " (in `table.md`: " + column.heading + ")";
    }
    return columns;
}

CsvTable table_of(const char* file) { return {names_of(csv_files(), file), {}}; }

}  // namespace

std::string passes_text(std::uint32_t least, std::uint32_t most) {
    return least == most ? std::to_string(most) : fmt::format("{} to {}", least, most);
}

const std::vector<RowColumn>& row_columns() {
    static const Columns columns = [] {
        Columns c;
        add_errors(c);
        add_laws(c);
        return c;
    }();
    return columns;
}

const std::vector<DeclaredTable>& csv_files() {
    // The first columns of table.csv say what a row is about; so do those of the other files.
    static const Declared scene = row_columns()[0], method = row_columns()[1], component = row_columns()[2];
    static const Declared seed{"seed", "", "seed of the random numbers"};
    static const std::vector<DeclaredTable> files = {
        {"table.csv", "errors and times: a row for each scene, method and component", row_declarations()},
        {"curves.csv",
         "error of the total against time: a row for each scene, method, seed and checkpoint",
         {scene,
          method,
          seed,
          {"pass", "", "passes made"},
          {"seconds", "s", "charged wall-clock time until then"},
          {"prepare_seconds", "s", "part of `seconds` before the first pass"},
          {"spp", "", "samples a pixel"},
          {"photons", "", "photons emitted"},
          {"mse", "radiance^2", "mean squared error, by the plain formula"},
          {"rmse", "radiance", "its root"},
          {"rel_mse", "", "mean((x - r)^2 / (r^2 + epsilon)), by the plain formula"},
          {"nonfinite", "", "samples that were not finite and were dropped"},
          {"peak_rss_mib", "MiB", "largest resident set of the process until then"},
          {"rays", "", "rays traced"},
          {"rel_mse_corrected", "", "`rel_mse` with the reference's own variance subtracted"},
          {"mse_corrected", "radiance^2", "`mse` with the reference's own variance subtracted"}}},
        {"spectra.csv",
         "noise and bias by spatial frequency",
         {scene,
          method,
          {"kind", "", "`noise` or `bias`"},
          {"frequency", "cycles per pixel", "spatial frequency"},
          {"power", "", "of noise: white noise has 1; of bias: radiance^2"},
          component}},
        {"stages.csv",
         "where the time goes: a row for each scene, method, seed and stage",
         {scene,
          method,
          seed,
          {"stage", "", "part of the work, such as `gather`; `other` is what belongs to no stage"},
          {"seconds", "s", "charged wall-clock time of the stage"}}},
        {"bias_laws.csv",
         "how bias falls: a row for each scene, method, component and parameter with three values or more",
         {scene,
          {"method", "", "label without the parameter"},
          {"parameter", "", "name of the parameter x"},
          component,
          {"values", "", "number of values of the parameter"},
          {"resolved", "", "number of values at which bias^2 is above 0 with its whole interval; three are needed"},
          {"exponent", "", "p of the fitted law bias^2 = c x^-p"},
          {"exponent_lo", "", "lower end of the 95 % interval of `exponent`"},
          {"exponent_hi", "", "upper end of the 95 % interval of `exponent`"},
          {"theory", "", "p by theory, where light is smooth"},
          {"factor", "radiance^2", "c of the fitted law"}}}};
    return files;
}

CsvTable curves_table(const Analysis& analysis) {
    CsvTable table = table_of("curves.csv");
    for (const Cell& cell : analysis.cells)
        for (const auto& [checkpoint, errors] : cell.checkpoints) {
            const auto total = errors.find(Layer::total);
            const double nan = std::numeric_limits<double>::quiet_NaN();
            const ImageError error = total != errors.end() ? total->second : ImageError{nan, nan, nan, nan, nan};
            table.add({cell.scene, cell.method, std::to_string(cell.seed), std::to_string(checkpoint.passes),
                       csv_number(checkpoint.seconds), csv_number(cell.prepare_seconds),
                       std::to_string(checkpoint.passes), std::to_string(checkpoint.counts.photons),
                       csv_number(error.mse), csv_number(error.rmse), csv_number(error.rel_mse),
                       std::to_string(checkpoint.counts.non_finite.count), csv_number(checkpoint.peak_rss_mib),
                       std::to_string(checkpoint.counts.rays), csv_number(error.rel_mse_corrected),
                       csv_number(error.mse_corrected)});
        }
    return table;
}

CsvTable error_table(const Analysis& analysis) {
    CsvTable table = table_of("table.csv");
    for (const TableRow& row : analysis.rows) {
        std::vector<std::string> fields;
        for (const RowColumn& column : row_columns())
            if (!column.name.empty()) fields.push_back(column.csv(row));
        table.add(std::move(fields));
    }
    return table;
}

CsvTable spectra_table(const Analysis& analysis) {
    CsvTable table = table_of("spectra.csv");
    for (const auto& row : analysis.rows) {
        const auto add = [&](const char* kind, const std::vector<SpectrumPoint>& curve) {
            for (const auto& point : curve)
                table.add({row.scene, row.method, kind, csv_number(point.frequency), csv_number(point.power),
                           std::string(name_of(row.layer))});
        };
        if (row.noise) add("noise", row.noise->curve);
        add("bias", row.bias);
    }
    return table;
}

CsvTable stages_table(const Analysis& analysis) {
    CsvTable table = table_of("stages.csv");
    for (const Cell& cell : analysis.cells)
        for (const auto& stage : cell.stages)
            table.add({cell.scene, cell.method, std::to_string(cell.seed), stage.name, csv_number(stage.seconds)});
    return table;
}

CsvTable bias_law_table(const Analysis& analysis) {
    CsvTable table = table_of("bias_laws.csv");
    for (const BiasLaw& law : bias_laws(analysis)) {
        const auto end = [&](double Interval::*member) {
            return law.fit && law.fit->exponent.interval ? csv_number((*law.fit->exponent.interval).*member) : "";
        };
        table.add({law.scene, law.method, law.parameter, std::string(name_of(law.layer)),
                   std::to_string(law.rows.size()), std::to_string(law.resolved_count),
                   law.fit ? csv_number(law.fit->exponent.value) : "", end(&Interval::lo), end(&Interval::hi),
                   law.theory ? csv_number(*law.theory) : "", law.fit ? csv_number(law.fit->factor) : ""});
    }
    return table;
}

}  // namespace gib
