#include "experiments/report/tables.h"

#include "common/core/files.h"
#include "experiments/report/report.h"
#include "experiments/report/row_columns.h"
#include "experiments/text/numbers.h"

#include <limits>

namespace gib {

CsvTable curves_table(const Analysis& analysis) {
    CsvTable table;
    table.columns = {"scene",           "method",    "seed",         "pass", "seconds",
                     "prepare_seconds", "spp",       "photons",      "mse",  "rmse",
                     "rel_mse",         "nonfinite", "peak_rss_mib", "rays", "rel_mse_corrected",
                     "mse_corrected"};
    for (const Cell& cell : analysis.cells)
        for (const auto& [checkpoint, errors] : cell.checkpoints) {
            const auto total = errors.find(total_name);
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
    CsvTable table;
    for (const RowColumn& column : row_columns())
        if (!column.name.empty()) table.columns.push_back(column.name);
    for (const TableRow& row : analysis.rows) {
        std::vector<std::string> fields;
        for (const RowColumn& column : row_columns())
            if (!column.name.empty()) fields.push_back(column.csv_text(row));
        table.add(std::move(fields));
    }
    return table;
}

CsvTable spectra_table(const Analysis& analysis) {
    CsvTable table;
    table.columns = {"scene", "method", "kind", "frequency", "power", "component"};
    for (const auto& row : analysis.rows) {
        const auto add = [&](const char* kind, const std::vector<SpectrumPoint>& curve) {
            for (const auto& point : curve)
                table.add(
                    {row.scene, row.method, kind, csv_number(point.frequency), csv_number(point.power), row.component});
        };
        if (row.noise) add("noise", row.noise->curve);
        add("bias", row.bias);
    }
    return table;
}

CsvTable stages_table(const Analysis& analysis) {
    CsvTable table;
    table.columns = {"scene", "method", "seed", "stage", "seconds"};
    for (const Cell& cell : analysis.cells)
        for (const auto& stage : cell.stages)
            table.add({cell.scene, cell.method, std::to_string(cell.seed), stage.name, csv_number(stage.seconds)});
    return table;
}

void write_tables(const Analysis& analysis, const ResultFolder& folder) {
    write_file(folder.file("curves.csv"), curves_table(analysis).text());
    write_file(folder.file("table.csv"), error_table(analysis).text());
    write_file(folder.file("table.md"), markdown_table(analysis));
    write_file(folder.file("spectra.csv"), spectra_table(analysis).text());
    write_file(folder.file("stages.csv"), stages_table(analysis).text());
}

}  // namespace gib
