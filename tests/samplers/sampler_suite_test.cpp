// Tests every sampler of the program against the density that it claims, as one family of tests.

#include "common/core/parallel.h"
#include "tests/samplers/chi_square.h"
#include "tests/samplers/sampler_cases.h"

#include <gtest/gtest.h>
#include <cstdlib>
#include <set>

namespace gib::test::sampler_suite_test {
namespace {

/// The probability, over the choice of the seeds, that any p-value of the whole family fails a correct program.
constexpr double alpha = 0.01;

/// All cases, or those whose names contain the environment variable GIB_SAMPLER_CASES, which is for use while a
/// sampler is being written.
std::vector<SamplerCase> all_cases() {
    const char* only = std::getenv("GIB_SAMPLER_CASES");
    std::vector<SamplerCase> cases;
    for (auto make : {warp_cases, bsdf_cases, light_cases})
        for (SamplerCase& test : make())
            if (!only || test.name.find(only) != std::string::npos) cases.push_back(std::move(test));
    return cases;
}

void expect_family_of(std::uint64_t samples) {
    const std::vector<SamplerCase> cases = all_cases();
    ASSERT_FALSE(cases.empty());
    std::set<std::string> names;
    for (const SamplerCase& test : cases)
        EXPECT_TRUE(names.insert(test.name).second) << test.name << " appears twice";

    std::vector<CaseResult> results(cases.size());
    parallel_blocks(cases.size(), 1, [&](std::size_t begin, std::size_t, std::size_t) {
        results[begin] = run_case(cases[begin], samples);
    });
    std::vector<double> p_values;
    std::vector<std::string> tests;
    for (const CaseResult& result : results) {
        for (const std::string& failure : result.failures)
            ADD_FAILURE() << result.name << ": " << failure;
        for (const PValue& value : result.p_values) {
            p_values.push_back(value.p);
            tests.push_back(result.name + ", " + value.test);
        }
    }
    for (std::size_t i : holm_rejections(p_values, alpha))
        ADD_FAILURE() << tests[i] << ": p = " << p_values[i];
}

TEST(SamplerSuite, ChiSquareFamily) { expect_family_of(100'000); }
// Notices densities that are off by a third of what the other test notices.
TEST(SamplerSuite, ChiSquareFamilyOfAMillionSamples) { expect_family_of(1'000'000); }

}  // namespace
}  // namespace gib::test::sampler_suite_test
