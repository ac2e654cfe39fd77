// Names of methods: the key `label`, else the settings that differ; all settings where names would be equal.

#include "experiments/analysis/method_names.h"

#include "experiments/report/report.h"
#include "experiments/report/tables.h"
#include "experiments/report/terminal.h"
#include "tests/support/analysis_fixtures.h"
#include "tests/support/csv_reader.h"
#include "tests/support/matchers.h"

#include <sstream>

namespace gib::test::short_names_test {
namespace {

/// An analysis with these labels, whose runs have made four passes.
Analysis of(const std::vector<std::string>& labels) {
    std::vector<Cell> cells;
    for (const std::string& label : labels)
        for (std::uint64_t seed = 1; seed <= 2; ++seed)
            cells.push_back(run_of(label, 1e-2 * (1 + 0.1 * static_cast<double>(seed)), 1, 4, 0, seed));
    return analysis_of(cells);
}

using Names = std::map<std::string, std::string>;

TEST(ShortNames, HaveTheSettingsThatDiffer) {
    EXPECT_EQ(short_names(of({"path spp=64", "photon_mapper photons=1e4 k=50", "photon_mapper photons=1e5 k=50"})),
              Names({{"path spp=64", "path"},
                     {"photon_mapper photons=1e4 k=50", "photon_mapper photons=1e4"},
                     {"photon_mapper photons=1e5 k=50", "photon_mapper photons=1e5"}}));
    EXPECT_EQ(short_names(of({"vcm", "vcm radius=0.1"})),
              Names({{"vcm", "vcm"}, {"vcm radius=0.1", "vcm radius=0.1"}}));
}

}  // namespace
}  // namespace gib::test::short_names_test
