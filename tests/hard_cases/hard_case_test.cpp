// The cases of experiments/hard-cases.toml as tests, one for each case and method, and the rules of their verdicts.

#include "experiments/hard_cases/hard_case.h"

#include "common/core/error.h"
#include "tests/support/hard_cases.h"
#include "tests/support/input_error.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <numbers>
#include <ostream>

namespace gib::test {
namespace {

using ::testing::HasSubstr;

const HardCases& shipped_cases() {
    static const HardCases file = load_hard_cases(source_path("experiments/hard-cases.toml"));
    return file;
}

struct CaseAndMethod {
    const HardCase* hard;
    MethodLabel method;
};

void PrintTo(const CaseAndMethod& pair, std::ostream* out) { *out << pair.hard->name << " by " << pair.method.text(); }

std::vector<CaseAndMethod> pairs_to_judge() {
    std::vector<CaseAndMethod> pairs;
    for (const HardCase& hard : shipped_cases().cases)
        for (const MethodLabel& method : shipped_cases().methods)
            if (!exclusion(hard, method)) pairs.push_back({&hard, method});
    return pairs;
}

std::string name_of(const testing::TestParamInfo<CaseAndMethod>& info) {
    const auto& methods = shipped_cases().methods;
    const auto at = std::find_if(methods.begin(), methods.end(),
                                 [&](const MethodLabel& m) { return m.text() == info.param.method.text(); });
    std::string name = info.param.hard->name + " by " + hard_methods()[std::size_t(at - methods.begin())].name;
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
    return name;
}

class HardCaseTable : public testing::TestWithParam<CaseAndMethod> {};
INSTANTIATE_TEST_SUITE_P(Shipped, HardCaseTable, testing::ValuesIn(pairs_to_judge()), name_of);

TEST_P(HardCaseTable, Holds) {
    const auto& [hard, method] = GetParam();
    const HardCases& file = shipped_cases();
    const HardCaseImages images = render_hard_case(*hard, method, hard->seeds, 1);
    const HardCaseVerdict verdict = judge(*hard, images, file.tail(), file.resolve, file.may_leave_out(method));
    if (verdict.verdict == Verdict::left_out) GTEST_SKIP() << verdict.why;
    EXPECT_EQ(gib::name_of(verdict.verdict), "holds") << hard->reason << ": " << verdict.why;
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
    const auto& cases = shipped_cases().cases;
    const auto leaning =
        std::find_if(cases.begin(), cases.end(), [](const HardCase& hard) { return hard.name == "leaning-normals"; });
    ASSERT_NE(leaning, cases.end());
    EXPECT_NEAR(sum / (steps * steps), leaning->expected, 1e-6);
}

// All but one of 1e4 lamps face away from the floor below. A choice without regard to power finds the lamp that
// matters once in 1e4 times. The others are dimmer by 1e8, so their share of the power is 1e-4.
TEST(HardLight, OneOfTenThousandLampsMatters) {
    const auto lamp = [](double half, double x, double y, double z, bool down, double radiance) {
        return shape("rectangle",
                     "<transform name='to_world'><scale value='" + exact(half) + "'/>" +
                         (down ? "<rotate x='1' angle='180'/>" : "") + "<translate x='" + exact(x) + "' y='" +
                         exact(y) + "' z='" + exact(z) + "'/></transform>",
                     diffuse_bsdf(0) + area_emitter(radiance));
    };
    std::string body =
        "<integrator type='direct'/><sensor type='orthographic'><transform name='to_world'><scale value='1e-3'/>" +
        lookat({0, 0, 0.005}, {0, 0, 0}) + "</transform>" + box_film(8) + "</sensor>" +
        shape("rectangle", "<transform name='to_world'><scale value='10'/></transform>", diffuse_bsdf(0.5));
    for (int i = 0; i < 9999; ++i)
        body += lamp(0.01, i % 100 * 0.05 - 2.5, i / 100 * 0.05 - 2.5, 2, false, 1e-4);
    const LoadedScene scene = scene_of(scene_xml(body + lamp(5e-3, 0, 0, 1, true, 1e4)));
    const double expected = 0.5 / std::numbers::pi;  // E = L A / h^2, up to a relative error of A / h^2 = 1e-4
    for (const HardMethod& method : hard_methods()) {
        std::vector<double> means;
        for (std::uint64_t seed = 1; seed <= 4; ++seed)
            means.push_back(mean_of(render(scene, method.label, 16, seed, 1).total()).mean());
        HardCase hard{};
        hard.expected = expected;
        hard.accuracy = 1e-4;
        HardCaseImages images;
        images.means = means;
        const HardCaseVerdict verdict = judge(hard, images, 1e-3, 0.1);
        EXPECT_EQ(verdict.verdict, Verdict::holds) << method.name << ' ' << verdict.why;
    }
}

/// The verdict on a case that expects 1, for images with these means.
HardCaseVerdict judged(const std::vector<double>& means, Relation relation = Relation::equal) {
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

// Four seeds have the standard deviation 0.01, so the half width is t_3(0.01) 0.01 / 2 = 5.8409 x 0.005 = 0.0292.
TEST(HardCaseVerdicts, RestOnTheScatterOfSeeds) {
    const double d = 0.01 * std::sqrt(3.0) / 2;
    const auto around = [&](double mean) { return std::vector<double>{mean - d, mean + d, mean - d, mean + d}; };
    EXPECT_NEAR(judged(around(1)).half_width, 0.029205, 1e-5);
    EXPECT_EQ(judged(around(1.029)).verdict, Verdict::holds);
    EXPECT_EQ(judged(around(1.030)).verdict, Verdict::fails);
    EXPECT_EQ(judged(around(0.971)).verdict, Verdict::holds);
    EXPECT_EQ(judged(around(0.970)).verdict, Verdict::fails);
    EXPECT_EQ(judged(around(0.970), Relation::at_most).verdict, Verdict::holds);
    EXPECT_EQ(judged(around(1.030), Relation::at_most).verdict, Verdict::fails);
    EXPECT_EQ(judged({0.9, 1.1, 0.9, 1.1}).verdict, Verdict::unresolved);
    EXPECT_EQ(judged({0.9, 1.1, 0.9, 1.1}, Relation::at_most).verdict, Verdict::unresolved);
    EXPECT_EQ(judged({0.2, 0.4, 0.2, 0.4}, Relation::at_most).verdict, Verdict::holds) << "certainly below";
    EXPECT_EQ(judged({1.000009, 1.000009}).verdict, Verdict::holds);
    EXPECT_EQ(judged({1.00002, 1.00002}).verdict, Verdict::fails);
    EXPECT_EQ(judged({0, 0}, Relation::black).verdict, Verdict::holds);
    EXPECT_EQ(judged({0, 1e-30}, Relation::black).verdict, Verdict::fails);
}

TEST(HardCaseVerdicts, BoundsHaveTwoSides) {
    HardCase hard{};
    hard.relation = Relation::at_most;
    hard.expected = 1;
    hard.at_least = 0.8;
    HardCaseImages images;
    const auto verdict_of = [&](const std::vector<double>& means) {
        images.means = means;
        return judge(hard, images, 0.01, 0.05).verdict;
    };
    EXPECT_EQ(verdict_of({0.9, 0.9}), Verdict::holds);
    EXPECT_EQ(verdict_of({0.79, 0.79}), Verdict::fails);
    EXPECT_EQ(verdict_of({1.01, 1.01}), Verdict::fails);
    EXPECT_EQ(verdict_of({0.75, 0.85, 0.75, 0.85}), Verdict::unresolved);
}

TEST(HardCaseVerdicts, NeitherNanNorNegativeNorRefusedScenesPass) {
    HardCase hard{};
    hard.expected = 1;
    hard.accuracy = 1e-5;
    HardCaseImages images;
    images.means = {1, 1};
    images.smallest = images.largest = 1;
    EXPECT_EQ(judge(hard, images, 0.01, 0.05).verdict, Verdict::holds);
    HardCaseImages bad = images;
    bad.not_finite = 1;
    EXPECT_EQ(judge(hard, bad, 0.01, 0.05).verdict, Verdict::fails);
    bad = images;
    bad.negative = 1;
    EXPECT_EQ(judge(hard, bad, 0.01, 0.05).verdict, Verdict::fails);
    bad = images;
    bad.means = {std::numeric_limits<double>::quiet_NaN(), 1};
    bad.not_finite = 1;
    EXPECT_EQ(judge(hard, bad, 0.01, 0.05).verdict, Verdict::fails);
    bad = images;
    bad.refusal = "no";
    EXPECT_EQ(judge(hard, bad, 0.01, 0.05).verdict, Verdict::fails);
    hard.every_pixel = true;
    bad = images;
    bad.smallest = 0.5;
    EXPECT_EQ(judge(hard, bad, 0.01, 0.05).verdict, Verdict::fails);
    hard.relation = Relation::refused;
    hard.refusal = "too small";
    EXPECT_EQ(judge(hard, images, 0.01, 0.05).verdict, Verdict::fails);
    bad.refusal = "a.xml:1:2: radius is too large";
    EXPECT_EQ(judge(hard, bad, 0.01, 0.05).verdict, Verdict::fails);
    bad.refusal = "a.xml:1:2: radius is too small";
    EXPECT_EQ(judge(hard, bad, 0.01, 0.05).verdict, Verdict::holds);
}

TEST(HardCaseVerdicts, MethodsMayOnlyLeaveOutWhatIsAllowed) {
    HardCase hard{};
    hard.expected = 1;
    HardCaseImages images;
    images.missing = {Effect::caustics, Effect::dispersion};
    EXPECT_EQ(judge(hard, images, 0.01, 0.05, {Effect::dispersion, Effect::textures, Effect::caustics}).verdict,
              Verdict::left_out);
    const HardCaseVerdict verdict = judge(hard, images, 0.01, 0.05, {Effect::caustics});
    EXPECT_EQ(verdict.verdict, Verdict::fails);
    EXPECT_THAT(verdict.why, HasSubstr("leaves out dispersion"));
}

class HardCaseFile : public testing::Test {
protected:
    HardCaseFile() { folder_.write("a.xml", "<scene/>"); }
    HardCases parse(const std::string& text) {
        return parse_hard_cases("[[method]]\nname = 'path'\n" + text, folder_ / "h.toml");
    }
    std::string error_of(const std::string& text) {
        const std::string what = test::input_error_of([&] { parse(text); });
        const std::size_t place = what.find("h.toml");
        return place == std::string::npos ? what : what.substr(place);
    }
    TemporaryFolder folder_;
};

TEST_F(HardCaseFile, ListsOfParametersMakeCases) {
    const HardCases file =
        parse("[[case]]\nscene = 'a.xml'\nset = { b = [1, 2], a = 5, c = ['x', 'y'] }\nexpected = 2.0\nreason = 'r'\n");
    ASSERT_EQ(file.cases.size(), 4u);
    EXPECT_EQ(file.cases[0].name, "a b=1 c=x");
    EXPECT_EQ(file.cases[3].name, "a b=2 c=y");
    EXPECT_EQ(file.cases[3].parameters, (std::map<std::string, std::string>{{"a", "5"}, {"b", "2"}, {"c", "y"}}));
    EXPECT_EQ(file.tail(), 0.01 / 4);
}

TEST_F(HardCaseFile, CasesMayHaveMoreSeeds) {
    const HardCases file = parse(
        "[[case]]\nscene = 'a.xml'\nname = 'more'\nseeds = 32\nblack = true\nreason = 'r'\n"
        "[[case]]\nscene = 'a.xml'\nblack = true\nreason = 'r'\n");
    EXPECT_EQ(file.cases[0].seeds, 32);
    EXPECT_EQ(file.cases[1].seeds, file.seeds);
}

TEST_F(HardCaseFile, SaysWhatMethodsMayLeaveOut) {
    const HardCases file = parse(
        "[leaves_out]\n'path spp' = ['caustics']\npath = ['refraction']\n"
        "[[case]]\nscene = 'a.xml'\nblack = true\nreason = 'r'\n");
    EXPECT_EQ(file.may_leave_out(MethodLabel::parse("path")), Effects{Effect::refraction});
    EXPECT_EQ(file.may_leave_out(MethodLabel::parse("path spp=4")), (Effects{Effect::caustics, Effect::refraction}));
    EXPECT_TRUE(file.may_leave_out(MethodLabel::parse("radiosity")).empty());
    EXPECT_THAT(error_of("[leaves_out]\npath = ['glass']\n"), HasSubstr("h.toml:4:9: there is no effect 'glass'"));
}

TEST_F(HardCaseFile, ErrorsHaveTheirPlace) {
    const std::string begin = "[[case]]\nscene = 'a.xml'\n";
    EXPECT_EQ(error_of(begin + "expected = 1.0\n"), "h.toml:3:1: a [[case]] needs 'reason'");
    EXPECT_THAT(error_of(begin + "reason = 'r'\n"), HasSubstr("h.toml:3:1: a [[case]] needs 'expected'"));
    EXPECT_THAT(error_of(begin + "expected = 1.0\nblack = true\nreason = 'r'\n"), HasSubstr("has one answer"));
    EXPECT_THAT(error_of("[[case]]\nscene = 'b.xml'\n"), HasSubstr("h.toml:4:9: there is no scene file"));
    EXPECT_THAT(error_of(begin + "expected = -1.0\nreason = 'r'\n"), HasSubstr("needs a number above 0"));
    EXPECT_EQ(error_of(begin + "expected = 1.0\nat_least = 0.5\nreason = 'r'\n"),
              "h.toml:6:12: 'at_least' stands beside 'at_most' only");
    EXPECT_EQ(error_of(begin + "at_most = 1.0\nat_least = 2.0\nreason = 'r'\n"),
              "h.toml:6:12: 'at_least' is above 'at_most'");
    EXPECT_THAT(error_of(begin + "exepcted = 1.0\n"), HasSubstr("exepcted"));
    const std::string whole = begin + "black = true\nreason = 'r'\n";
    EXPECT_THAT(error_of(whole + whole), HasSubstr("two cases are named 'a'"));
}

}  // namespace
}  // namespace gib::test
