#include "experiments/report/tables.h"

#include "experiments/analysis/comparison.h"
#include "experiments/report/section_columns.h"
#include "experiments/text/numbers.h"

#include <fmt/format.h>

#include <limits>

namespace gib {

namespace {

/// The columns of table.csv, with their headings in table.md.
std::vector<Declared> row_declarations() {
    std::vector<Declared> columns;
    for (const RowColumn& column : row_columns()) {
        columns.push_back({column.name, column.unit, column.sentence});
        for (const SectionColumn& shown : section_columns())
            if (shown.column == column.name && shown.heading != column.name)
                columns.back().sentence += fmt::format(" (in `table.md`: {})", shown.heading);
        if (column.percent == 0) continue;
        for (const auto& [suffix, end] : {std::pair{"_lo", "lower"}, {"_hi", "upper"}})
            columns.push_back({column.name + suffix, column.unit,
                               fmt::format("{} end of the {} % interval of `{}`", end, column.percent, column.name)});
    }
    return columns;
}

CsvTable table_of(const char* file) { return {names_of(csv_files(), file), {}}; }

}  // namespace

const std::vector<DeclaredTable>& csv_files() {
    // The first columns of table.csv say what a row is about; so do those of the other files.
    static const std::vector<Declared> rows = row_declarations();
    static const Declared &scene = rows[0], &method = rows[1], &component = rows[2];
    static const Declared seed{"seed", "", "seed of the random numbers"};
    static const std::vector<DeclaredTable> files = {
        {"table.csv", "errors and times: a row for each scene, method and component", rows},
        {"curves.csv",
         "error of the total against time: a row for each scene, method, seed and checkpoint",
         {scene,
          method,
          seed,
          {"pass", "", "passes made"},
          {"seconds", "s", "charged wall-clock time of these passes"},
          {"prepare_seconds", "s", "part of `seconds` before the first pass"},
          {"photons", "", "photons emitted"},
          {"mse", "radiance^2", "mean squared error, with the reference's own variance"},
          {"rel_mse", "", "mean((x - r)^2 / (r^2 + epsilon)), with the reference's own variance"},
          {"nonfinite", "", "samples that were not finite and were dropped"},
          {"peak_rss_mib", "MiB", "largest resident set of the process so far"},
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
          {"stage", "", "part of the work, such as `gather`; `other`: the rest"},
          {"seconds", "s", "charged wall-clock time of the stage"}}},
        {"bias_laws.csv",
         "how bias falls: a row for each scene, method, component and parameter with three values or more",
         {scene,
          {"method", "", "label without the parameter"},
          {"parameter", "", "name of the parameter x"},
          component,
          {"values", "", "number of values of the parameter"},
          {"resolved", "", "number of values whose interval of bias^2 lies above 0; three are needed"},
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
            const ImageError error = total != errors.end() ? total->second : ImageError{nan, nan, nan, nan};
            table.add({cell.scene, cell.method, std::to_string(cell.seed), std::to_string(checkpoint.passes),
                       csv_number(checkpoint.seconds), csv_number(cell.prepare_seconds),
                       std::to_string(checkpoint.counts.photons), csv_number(error.mse), csv_number(error.rel_mse),
                       std::to_string(checkpoint.counts.non_finite.count), csv_number(checkpoint.peak_rss_mib),
                       std::to_string(checkpoint.counts.rays), csv_number(error.rel_mse_corrected),
                       csv_number(error.mse_corrected)});
        }
    return table;
}

CsvTable error_table(const Analysis& analysis) {
    CsvTable table = table_of("table.csv");
    for (const TableRow& row : analysis.rows)
        table.add(csv_fields(row));
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
