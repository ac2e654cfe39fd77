// The cases of hard-cases.toml as tests, one for each case and method, and the rules of their verdicts.

#include "tests/hard_cases/hard_case.h"

#include "tests/support/source_path.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <ostream>

namespace gib::test::hard_case_test {
namespace {

using ::testing::HasSubstr;

const HardCases& hard_cases() {
    static const HardCases file = load_hard_cases(source_path("tests/hard_cases/hard-cases.toml"));
    return file;
}

struct CaseAndMethod {
    HardCase hard;
    MethodUnderTest method;
};

void PrintTo(const CaseAndMethod& pair, std::ostream* out) { *out << pair.hard.name << " by " << pair.method.label; }

const std::vector<CaseAndMethod>& pairs() {
    static const std::vector<CaseAndMethod> all = [] {
        std::vector<CaseAndMethod> pairs;
        const auto methods = methods_under_test(Work::small), variants = look_up_variants(Work::small);
        for (const HardCase& hard : hard_cases().cases) {
            for (const MethodUnderTest& method : methods)
                if (hard.is_for(method)) pairs.push_back({hard, method});
            for (const MethodUnderTest& variant : variants)
                if (hard.is_for_variant(variant)) pairs.push_back({hard, variant});
        }
        return pairs;
    }();
    return all;
}

/// The probability with which each verdict may be wrong, so that at least one of all verdicts is wrong with
/// probability at most `alpha` (Bonferroni).
double tail() { return hard_cases().alpha / static_cast<double>(pairs().size()); }

std::string name_of(const testing::TestParamInfo<CaseAndMethod>& info) {
    std::string name = info.param.hard.name + " by " + info.param.method.name;
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
    return name;
}

class HardCaseTable : public testing::TestWithParam<CaseAndMethod> {};
INSTANTIATE_TEST_SUITE_P(Shipped, HardCaseTable, testing::ValuesIn(pairs()), name_of);

TEST_P(HardCaseTable, Holds) {
    const auto& [hard, method] = GetParam();
    HardCaseImages refused;
    try {
        const Plan plan = method.plan(*scene_of(hard).scene);
        if (hard.relation != Relation::refused) {
            const auto held = case_for(hard, method, plan);
            if (!held) GTEST_SKIP() << "leaves out " << plan.missing.names();
            const Verdict verdict = render_and_judge(*held, method, tail(), hard_cases().resolve);
            fmt::print("{} by {}: {:.5g} +- {:.2g}\n", hard.name, method.name, verdict.got, verdict.half_width);
            EXPECT_EQ(verdict.problem, "") << "expected " << hard.expected << ": " << hard.reason;
            return;
        }
    } catch (const InputError& error) {
        refused.refusal = error.what();
    }
    EXPECT_EQ(judge(hard, refused, tail(), hard_cases().resolve).problem, "");
}

// A method declares what it leaves out; it is held to the rest, and that is much.
TEST(HardCases, HoldEveryMethodToManyAnswers) {
    std::map<std::string, int> answers;
    for (const auto& [hard, method] : pairs()) {
        if (hard.relation == Relation::refused) continue;
        const Plan plan = method.plan(*scene_of(hard).scene);
        const Effects undeclared = plan.missing & method.description->simulates;
        EXPECT_TRUE(undeclared.empty() || !plan.unresolved.empty())
            << hard.name << " by " << method.label << " without " << undeclared.names();
        const auto held = case_for(hard, method, plan);
        if (held && held->relation == hard.relation) ++answers[method.name];
    }
    for (const MethodUnderTest& method : methods_under_test())
        EXPECT_GE(answers[method.name], 20) << method.name;
}

// The expected value of leaning-normals.xml: the mean over the image of (1 + cos a) / 2, where a is the angle between
// the interpolated normal and the triangles' normal.
TEST(HardCaseAnswers, LeaningNormals) {
    const double sine = std::sqrt(0.75);
    const Vec3d normals[] = {{sine, 0, -0.5}, {0, sine, -0.5}, {-sine, 0, -0.5}, {0, 0, 1}};
    constexpr int steps = 600;
    double sum = 0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double u = 0.05 + 0.9 * (i + 0.5) / steps, v = 0.05 + 0.9 * (j + 0.5) / steps;
            const Vec3d normal = u > v ? Vec3d((1 - u) * normals[0] + (u - v) * normals[1] + v * normals[2])
                                       : Vec3d((1 - v) * normals[0] + u * normals[2] + (v - u) * normals[3]);
            sum += (1 + std::abs(normal.z()) / normal.norm()) / 2;
        }
    const auto& cases = hard_cases().cases;
    const auto leaning =
        std::find_if(cases.begin(), cases.end(), [](const HardCase& hard) { return hard.name == "leaning-normals"; });
    ASSERT_NE(leaning, cases.end());
    // The sum is within 3e-7 of its limit, and the expected number is rounded by at most 5e-7.
    EXPECT_NEAR(sum / (steps * steps), leaning->expected, 1e-6);
}

/// The verdict on a case that expects 1, for images with these means.
Verdict judged(const std::vector<double>& means, Relation relation = Relation::equal) {
    HardCase hard{};
    hard.relation = relation;
    hard.expected = relation == Relation::black ? 0 : 1;
    hard.accuracy = 1e-5;
    HardCaseImages images;
    images.means = means;
    images.smallest = *std::min_element(means.begin(), means.end());
    images.largest = *std::max_element(means.begin(), means.end());
    return judge(hard, images, 0.01, 0.05);
}
std::string problem_of(const std::vector<double>& means, Relation relation = Relation::equal) {
    return judged(means, relation).problem;
}

// Four seeds have the standard deviation 0.01, so the half width is t_3(0.01) 0.01 / 2 = 5.8409 x 0.005 = 0.0292.
TEST(HardCaseVerdicts, RestOnTheScatterOfSeeds) {
    const double d = 0.01 * std::sqrt(3.0) / 2;
    const auto around = [&](double mean) { return std::vector<double>{mean - d, mean + d, mean - d, mean + d}; };
    EXPECT_NEAR(judged(around(1)).half_width, 0.029205, 1e-5);
    EXPECT_EQ(problem_of(around(1.029)), "");
    EXPECT_THAT(problem_of(around(1.030)), HasSubstr("bright"));
    EXPECT_EQ(problem_of(around(0.971)), "");
    EXPECT_THAT(problem_of(around(0.970)), HasSubstr("dark"));
    EXPECT_EQ(problem_of(around(0.970), Relation::at_most), "");
    EXPECT_THAT(problem_of(around(1.030), Relation::at_most), HasSubstr("bright"));
    EXPECT_THAT(problem_of({0.9, 1.1, 0.9, 1.1}), HasSubstr("not resolved"));
    EXPECT_THAT(problem_of({0.9, 1.1, 0.9, 1.1}, Relation::at_most), HasSubstr("not resolved"));
    EXPECT_EQ(problem_of({0.9, 1.1, 0.9, 1.1}, Relation::not_above), "");
    EXPECT_EQ(problem_of({0, 0, 0, 0}, Relation::not_above), "");
    EXPECT_THAT(problem_of(around(1.030), Relation::not_above), HasSubstr("bright"));
    EXPECT_EQ(problem_of({0.2, 0.4, 0.2, 0.4}, Relation::at_most), "") << "certainly below";
    EXPECT_EQ(problem_of({1.000009, 1.000009}), "");
    EXPECT_THAT(problem_of({1.00002, 1.00002}), HasSubstr("bright"));
    EXPECT_EQ(problem_of({0, 0}, Relation::black), "");
    EXPECT_THAT(problem_of({0, 1e-30}, Relation::black), HasSubstr("a pixel"));
}

}  // namespace
}  // namespace gib::test::hard_case_test
