// A wall clock that jumps by decades changes nothing but the manifest's date.

#include "tests/machine/run_content.h"
#include "tests/support/run_fixtures.h"

#include <nlohmann/json.hpp>

namespace gib::test::clock_test {
namespace {

class ClockTest : public ::testing::Test, protected ExperimentFolder {
protected:
    ProgramResult run_with_jumps() const {
        // The address sanitizer demands to be the first library of the process; that check
        // is off here, because the clock is first.
        setenv("LD_PRELOAD", GIB_JUMPING_CLOCK, 1);
        const char* options = std::getenv("ASAN_OPTIONS");
        const std::string before = options ? options : "";
        setenv("ASAN_OPTIONS", (before + ":verify_asan_link_order=0").c_str(), 1);
        ProgramResult result = run();
        unsetenv("LD_PRELOAD");
        setenv("ASAN_OPTIONS", before.c_str(), 1);
        return result;
    }
    std::string date() const { return nlohmann::json::parse(read_file(results("manifest.json"))).at("date"); }
};

TEST_F(ClockTest, JumpsChangeNoResult) {
    complete();
    const auto steady = content_of(results(""));
    std::filesystem::remove_all(path("results"));
    ASSERT_THAT(run_with_jumps(), exits(0));
    EXPECT_TRUE(date().rfind("200", 0) == 0 || date().rfind("206", 0) == 0) << date() << ": the clock did not jump";
    EXPECT_TRUE(content_of(results("")) == steady) << "an image, a table or the set of files differs";
    // The time of a file does not decide whether a cell is kept or done again, either.
    for (const auto& [name, time] : cells())
        std::filesystem::last_write_time(results("cells/" + name + "/cell.json"),
                                         time + std::chrono::hours(24 * 365 * (name.back() == '1' ? 20 : -20)));
    const auto before = cells();
    ASSERT_EQ(run().code, 0);
    EXPECT_EQ(cells(), before);
}

TEST_F(ClockTest, DurationsAreThoseOfASteadyClock) {
    write_experiment("[100000000]", "target = 0.0001\nseconds = 0.1\n", "budget = { seconds = 0.05 }\n");
    ASSERT_THAT(run_with_jumps(), exits(0));
    const CsvTable curves = table("curves.csv");
    double before = 0;
    for (std::size_t i = 0; i < curves.rows.size(); ++i) {
        if (field_of(curves, "pass", i) == "1") before = 0;
        const double seconds = std::stod(field_of(curves, "seconds", i));
        EXPECT_GE(seconds, before) << "time went back";
        EXPECT_LT(seconds, 3600) << "a jump was charged";
        before = seconds;
    }
    EXPECT_GT(curves.rows.size(), 4u) << "a jump ended a cell after its first pass";
}

}  // namespace
}  // namespace gib::test::clock_test
