// GoogleTest's main(). In builds with GIB_FLOAT_TRAPS, floating-point exceptions end the tests.
//
// Two environment variables, which scripts/test sets:
// - GIB_TEST_NAMES: a regular expression; of the tests that --gtest_filter selects, only those run whose names it matches.
// - GIB_TEST_LOG: a file to which each test adds the line `started NAME` and, at its end, `passed|failed|skipped NAME seconds`, where
//   seconds is this process's processor time. A test that started and did not end has crashed.

#include "common/core/float_traps.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <regex>
#include <string>

namespace {

std::string full_name(const testing::TestInfo& test) { return std::string(test.test_suite_name()) + "." + test.name(); }

class TestLog : public testing::EmptyTestEventListener {
public:
    explicit TestLog(const std::string& path) : file_(path, std::ios::app) {}

private:
    void OnTestStart(const testing::TestInfo& test) override {
        start_ = std::clock();
        file_ << "started " << full_name(test) << std::endl;
    }
    void OnTestEnd(const testing::TestInfo& test) override {
        const testing::TestResult& result = *test.result();
        file_ << (result.Failed()    ? "failed "
                  : result.Skipped() ? "skipped "
                                     : "passed ")
              << full_name(test) << " " << static_cast<double>(std::clock() - start_) / CLOCKS_PER_SEC << std::endl;
    }

    std::ofstream file_;
    std::clock_t start_ = 0;
};

/// Adds all tests whose names do not match to the tests that the filter leaves out.
void leave_out_all_but(const std::regex& names) {
    std::string filter = GTEST_FLAG_GET(filter);
    if (filter.find('-') == std::string::npos) filter += "-";
    const testing::UnitTest& all = *testing::UnitTest::GetInstance();
    for (int i = 0; i < all.total_test_suite_count(); ++i)
        for (int k = 0; k < all.GetTestSuite(i)->total_test_count(); ++k)
            if (const std::string name = full_name(*all.GetTestSuite(i)->GetTestInfo(k));
                !std::regex_search(name, names))
                filter += ":" + name;
    GTEST_FLAG_SET(filter, filter);
}

}  // namespace

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    if (const char* names = std::getenv("GIB_TEST_NAMES")) leave_out_all_but(std::regex(names, std::regex::extended));
    if (const char* log = std::getenv("GIB_TEST_LOG"))
        testing::UnitTest::GetInstance()->listeners().Append(new TestLog(log));
    gib::trap_floating_point_errors();
    return RUN_ALL_TESTS();
}
