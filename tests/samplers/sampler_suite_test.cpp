// Tests every sampler of the program against the density that it claims, as one family of tests.

#include "common/core/parallel.h"
#include "tests/samplers/chi_square.h"
#include "tests/samplers/sampler_cases.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cstdlib>
#include <set>

namespace gib::test::sampler_suite_test {
namespace {

/// The probability, over the choice of the seeds, that any p-value of the whole family fails a correct program.
constexpr double alpha = 0.01;

std::vector<CaseResult> run_all(const std::vector<SamplerCase>& cases, std::uint64_t samples) {
    std::vector<CaseResult> results(cases.size());
    parallel_blocks(cases.size(), 1, [&](std::size_t begin, std::size_t, std::size_t) {
        results[begin] = run_case(cases[begin], samples);
    });
    return results;
}

struct Family {
    std::vector<std::string> names;
    std::vector<double> p_values;

    explicit Family(const std::vector<CaseResult>& results) {
        for (const CaseResult& result : results) {
            for (const PValue& value : result.p_values) {
                names.push_back(result.name + ", " + value.test);
                p_values.push_back(value.p);
            }
        }
    }
    std::vector<std::size_t> rejected() const { return holm_rejections(p_values, alpha); }

    void print_smallest(std::size_t count) const {
        std::vector<std::size_t> order(p_values.size());
        for (std::size_t i = 0; i < order.size(); ++i)
            order[i] = i;
        std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p_values[a] < p_values[b]; });
        fmt::print("{} p-values, the first threshold is {:.2g}; the smallest:\n", p_values.size(),
                   alpha / static_cast<double>(p_values.size()));
        for (std::size_t i = 0; i < std::min(count, order.size()); ++i)
            fmt::print("  {:<9.2g} {}\n", p_values[order[i]], names[order[i]]);
    }
};

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

    const std::vector<CaseResult> results = run_all(cases, samples);
    std::size_t evaluations = 0;
    for (const CaseResult& result : results) {
        evaluations += result.evaluations;
        for (const std::string& failure : result.failures)
            ADD_FAILURE() << result.name << ": " << failure;
    }
    const Family family(results);
    fmt::print("{} cases, {} samples each, {:.1f} million evaluations of densities\n", cases.size(), samples,
               static_cast<double>(evaluations) / 1e6);
    family.print_smallest(10);
    for (std::size_t i : family.rejected())
        ADD_FAILURE() << family.names[i] << ": p = " << family.p_values[i];
}

TEST(SamplerSuite, ChiSquareFamily) { expect_family_of(100'000); }
// Notices densities that are off by a third of what the other test notices.
TEST(SamplerSuite, ChiSquareFamilyOfAMillionSamples) { expect_family_of(1'000'000); }

}  // namespace
}  // namespace gib::test::sampler_suite_test
