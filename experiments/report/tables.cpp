#include "experiments/report/tables.h"

#include "common/core/files.h"
#include "experiments/analysis/comparison.h"
#include "experiments/report/report.h"
#include "experiments/report/row_columns.h"
#include "experiments/text/numbers.h"

#include <limits>

namespace gib {

namespace {

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
          {"theory", "", "p by theory, where light is smooth"}}}};
    return files;
}

CsvTable curves_table(const Analysis& analysis) {
    CsvTable table = table_of("curves.csv");
    for (const Cell& cell : analysis.cells)
        for (const auto& [checkpoint, errors] : cell.checkpoints) {
            const auto total = errors.find(Layer::total);
            const double nan = std::numeric_limits<double>::quiet_NaN();
            const ImageError error =
                total != errors.end()
                    ? total->second
                    : ImageError{
                          .mse = nan, .rmse = nan, .rel_mse = nan, .mse_corrected = nan, .rel_mse_corrected = nan};
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
            return law.exponent && law.exponent->interval ? csv_number((*law.exponent->interval).*member) : "";
        };
        table.add({law.scene, law.method, law.parameter, std::string(name_of(law.layer)),
                   std::to_string(law.rows.size()), std::to_string(law.resolved_count),
                   law.exponent ? csv_number(law.exponent->value) : "", end(&Interval::lo), end(&Interval::hi),
                   law.theory ? csv_number(*law.theory) : ""});
    }
    return table;
}

void write_tables(const Analysis& analysis, const ResultFolder& folder) {
    write_file(folder.file("curves.csv"), curves_table(analysis).text());
    write_file(folder.file("table.csv"), error_table(analysis).text());
    write_file(folder.file("table.md"), markdown_table(analysis));
    write_file(folder.file("spectra.csv"), spectra_table(analysis).text());
    write_file(folder.file("stages.csv"), stages_table(analysis).text());
    write_file(folder.file("bias_laws.csv"), bias_law_table(analysis).text());
}

}  // namespace gib
