// `gibench compare --z-test` as a user meets it, and the decision rule of Mitsuba's test.

#include "common/images/image_file.h"
#include "experiments/metrics/z_statistic.h"
#include "tests/support/constant_image.h"
#include "tests/support/run_fixtures.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

namespace gib::test::compare_z_test_test {
namespace {

Image constant(float value, int size = 20) { return constant_image(value, size, size); }

/// The linear RGB for which Mitsuba's matrix gives X = Y = Z = v (solved to seven digits).
Color rgb_of_equal_xyz(float v) { return v * Color(1.2047935f, 0.9482910f, 0.9089164f); }

TEST(MitsubaZTest, FourHundredPixelsMayHaveThreeBadValues) {
    // 0.9975 x 400 pixels are 399: the test passes with one pixel off in X, Y and Z, but not with two.
    const Image r = constant(1), variance = constant(0.04f);
    Image x = r;
    x.set(42, Color::Constant(2));
    MitsubaZTest result = mitsuba_z_test(x, r, variance, 64);
    EXPECT_EQ(result.values, 1200u);
    EXPECT_EQ(result.passing, 1197u);
    EXPECT_TRUE(result.accepted());
    EXPECT_EQ(result.smallest_p, 0);
    EXPECT_EQ(result.x, 2);
    EXPECT_EQ(result.y, 2);
    x.set(43, Color::Constant(0));
    result = mitsuba_z_test(x, r, variance, 64);
    EXPECT_EQ(result.passing, 1194u);
    EXPECT_FALSE(result.accepted());
}

TEST(MitsubaZTest, ThresholdIsOnePercentSharedByThePixels) {
    const Image r = constant(0);
    const MitsubaZTest none = mitsuba_z_test(r, r, r, 1);
    EXPECT_NEAR(none.threshold / (1 - std::pow(0.99, 1 / 400.0)), 1, 1e-9);
    EXPECT_EQ(none.smallest_p, 1);
    // P(|Z| > z) = 2.51e-5 at z = 4.2140. With a variance of 4 in X, Y and Z and
    // 100 samples, a deviation of 0.2 is z = 1.
    const auto image_of = [](float xyz) { return constant_image(rgb_of_equal_xyz(xyz), 20, 20); };
    const auto passing_at = [&](float z) { return mitsuba_z_test(image_of(0.2f * z), r, image_of(4), 100).passing; };
    EXPECT_EQ(passing_at(4.20f), 1200u);
    EXPECT_EQ(passing_at(4.23f), 0u);
    EXPECT_EQ(passing_at(-4.23f), 0u);
}

TEST(MitsubaZTest, VarianceIsThatOfXyzAndNotBelowItsFloor) {
    // The variance is in Y alone; as RGB it is negative in R and B. It judges a deviation in Y alone.
    const Color y_alone(-1.537150f, 1.875991f, -0.204043f);
    const Image x = constant_image(0.1f * y_alone, 20, 20), variance = constant_image(4 * y_alone, 20, 20);
    EXPECT_EQ(mitsuba_z_test(x, constant(0), variance, 100).passing, 1200u);  // z = 0.1 / 0.2
    // Without variance the floor of 1e-4 holds. White has Y = 1, and X and Z within 9 % of it: z = 0.0035 sqrt(100 /
    // 1e-4) = 3.5, and 5 for 0.005.
    EXPECT_EQ(mitsuba_z_test(constant(0.0035f), constant(0), constant(0), 100).passing, 1200u);
    EXPECT_EQ(mitsuba_z_test(constant(0.005f), constant(0), constant(0), 100).passing, 0u);
    EXPECT_EQ(mitsuba_z_test(constant(0.005f), constant(0), constant(0), 50).passing, 1200u);
}

TEST(MitsubaZTest, FloatsLimitTheSmallestProbability) {
    // For 480 x 480 pixels the exact threshold is z = 5.476. In floats p is a
    // multiple of 2^-23, and 0 above z = 5.348.
    const Image r = constant(0, 480);
    const auto passes = [&](float z) {
        const Image x = constant_image(rgb_of_equal_xyz(z * 1e-2f), 480, 480);
        return mitsuba_z_test(x, r, r, 1).passing == 3 * x.pixels();
    };
    EXPECT_TRUE(passes(5.33f));
    EXPECT_FALSE(passes(5.37f));
}

TEST(MitsubaZTest, ValuesThatAreNotFiniteDoNotPass) {
    Image x = constant(1);
    for (const std::size_t p : {std::size_t{0}, std::size_t{7}})
        x.set(p, {1, std::numeric_limits<float>::quiet_NaN(), 1});
    x.set(9, Color::Constant(infinity));
    const MitsubaZTest result = mitsuba_z_test(x, constant(1), constant(1), 16);
    EXPECT_EQ(result.nonfinite, 9u);
    EXPECT_EQ(result.passing, 1200u - 9);
    EXPECT_FALSE(result.accepted());
}

/// Noisy images as files, and the program to compare them.
class CompareZTest : public ::testing::Test {
protected:
    Image noisy(float mean, float noise, int size = 64) {
        return mapped(Image(size, size), [&](float) { return mean * (1 + noise * normal_(random_)); });
    }
    void write(const std::string& name, const LayeredImage& image) const { write_exr(folder_ / name, image); }
    void write_reference() {
        write("r.exr", {{{"", noisy(2, 0.003f)},
                         {"direct", noisy(1, 0.003f)},
                         {"stderr", constant(0.006f, 64)},
                         {"direct_stderr", constant(0.003f, 64)}},
                        {}});
    }
    void write_test(const std::string& name, float factor, float noise, std::map<std::string, std::string> keys = {}) {
        write(name, {{{"", noisy(2 * factor, noise)}, {"direct", noisy(factor, noise)}}, std::move(keys)});
    }
    ProgramResult run(const std::string& arguments) const { return run_gibench("compare " + arguments, folder_ / ""); }

    TemporaryFolder folder_;
    std::mt19937_64 random_{17};
    std::normal_distribution<float> normal_;
};

TEST_F(CompareZTest, ExitCodeIsTheVerdict) {
    write_reference();
    write_test("good.exr", 1, 0.01f);
    write_test("dark.exr", 0.99f, 0.01f);
    write_test("noisy.exr", 1, 1);
    EXPECT_THAT(run("good.exr r.exr --z-test"),
                prints(HasSubstr("gibench's own"), HasSubstr("accepted"), HasSubstr("8 x 8 blocks"),
                       HasSubstr("mean of G"), HasSubstr("rel_mse"), Not(HasSubstr("z_"))));
    EXPECT_THAT(run("dark.exr r.exr --z-test"),
                prints_with(1, HasSubstr("the images differ"), HasSubstr("tests of whole image"), HasSubstr("R -")));
    EXPECT_THAT(run("noisy.exr r.exr --z-test"),
                prints_with(1, HasSubstr("not enough samples"), HasSubstr("within 0.2 %: the interval is R "),
                            Not(HasSubstr("images differ"))));
    EXPECT_EQ(run("dark.exr r.exr").code, 0);
}

TEST_F(CompareZTest, JsonHoldsTheFiguresUnderFlatKeys) {
    write_reference();
    write_test("dark.exr", 0.99f, 0.01f);
    const ProgramResult result = run("dark.exr r.exr --z-test --json");
    ASSERT_EQ(result.code, 1) << result.err;
    const auto json = nlohmann::json::parse(result.out);
    const nlohmann::json flat = {
        {"z_test", "blocks"},       {"z_accepted", false},       {"z_verdict", "differs"},
        {"z_noise", "scatter"},     {"z_alpha", 0.01},           {"z_blocks_tests", 2 * 3 * 64},
        {"z_regions_tests", 2 * 3}, {"z_image_rejected", 2 * 3}, {"z_blocks_width", 8}};
    for (const auto& [key, value] : flat.items())
        EXPECT_EQ(json[key], value) << key;
    EXPECT_LT(json["z_image_p_corrected"], 1e-6);
    for (const auto& layer : {json, json["components"]["direct"]})
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_LT(layer["z_deviation_lo"][k], layer["z_deviation"][k]);
            EXPECT_LT(layer["z_deviation"][k], layer["z_deviation_hi"][k]);
        }
    EXPECT_NEAR(json["z_deviation"][0], -0.01, 1e-3);
    // A component's deviation is relative to the total.
    EXPECT_NEAR(json["components"]["direct"]["z_deviation"][0], -0.005, 1e-3);
    EXPECT_TRUE(json.contains("mse"));
    for (const auto& [name, value] : json.items())
        EXPECT_EQ(value.is_object(), name == "components") << name;
}

TEST_F(CompareZTest, ValuesThatAreNotFiniteAreCountedAndRejected) {
    write_reference();
    Image x = noisy(2, 0.01f);
    x.rgb[100] = infinity;
    x.rgb[200] = std::numeric_limits<float>::quiet_NaN();
    write("x.exr", one_layer(x));
    EXPECT_THAT(run("x.exr r.exr --z-test"),
                prints_with(1, HasSubstr("rejected: 2 values of the test are not finite")));
    EXPECT_EQ(nlohmann::json::parse(run("x.exr r.exr --z-test --json").out)["z_verdict"], "not_finite");
}

TEST_F(CompareZTest, ReplicatesAndStandardErrorsAreUsed) {
    write_reference();
    for (const char* seed : {"1", "2", "3"})
        write_test(std::string("x") + seed + ".exr", 1, 0.01f,
                   {{"seed", seed}, {"method", "path spp=4"}, {"scene_hash", "1"}});
    EXPECT_THAT(run("x1.exr x2.exr x3.exr r.exr --z-test").out,
                AllOf(HasSubstr("known from 3 replicates"), HasSubstr("accepted")));
    EXPECT_THAT(run("r.exr r.exr --z-test").out, AllOf(HasSubstr("its standard error"), HasSubstr("accepted")));
    EXPECT_THAT(run("x1.exr x2.exr x1.exr r.exr --z-test"), exits(2, HasSubstr("x1.exr"), HasSubstr("same seed")));
    EXPECT_EQ(run("x1.exr x1.exr r.exr").code, 0);
}

TEST_F(CompareZTest, MitsubasTestIsNamedAndDecides) {
    write("r.exr", one_layer(constant(1)));
    write("v.exr", one_layer(constant(0.64f)));
    write("x.exr", one_layer(constant(1.1f)));  // at 64 samples z = 1, at 6400 z = 10
    EXPECT_THAT(run("x.exr r.exr --z-test --variance v.exr --spp 64"),
                prints(HasSubstr("Mitsuba 3's"), HasSubstr("100.0000 % of 1200 values"), HasSubstr("99.75 %")));
    const ProgramResult bad = run("x.exr r.exr --z-test --variance v.exr --spp 6400 --json");
    EXPECT_EQ(bad.code, 1) << bad.out << bad.err;
    const auto json = nlohmann::json::parse(bad.out);
    EXPECT_EQ(json["z_test"], "mitsuba");
    EXPECT_EQ(json["z_accepted"], false);
    EXPECT_EQ(json["z_share"], 0);
    EXPECT_EQ(json["z_values"], 1200);
    EXPECT_EQ(json["z_spp"], 6400);
}

TEST_F(CompareZTest, VariancesAreFiniteAndNotNegative) {
    write("r.exr", one_layer(constant(1)));
    write("x.exr", one_layer(constant(9)));
    for (const float wrong : {infinity, -infinity, std::numeric_limits<float>::quiet_NaN(), -1e-6f}) {
        Image variance = constant(0.64f);
        variance.rgb[1] = variance.rgb[77] = wrong;
        write("v.exr", one_layer(variance));
        EXPECT_THAT(run("x.exr r.exr --z-test --variance v.exr --spp 64"),
                    exits(2, StartsWith("v.exr:1:1: cannot be a variance: 2 values are not finite or below 0")))
            << wrong;
    }
}

TEST_F(CompareZTest, WrongInputGivesTwo) {
    write_reference();
    write_test("x.exr", 1, 0.01f);
    write("small.exr", one_layer(constant(1)));
    folder_.write("text.exr", "no image");
    for (const char* arguments :
         {"x.exr r.exr --z-test --variance r.exr", "x.exr r.exr --z-test --spp 64", "x.exr r.exr --spp 64",
          "x.exr r.exr --variance r.exr", "x.exr r.exr --variance r.exr --spp 64",
          "x.exr r.exr --z-test --variance r.exr --spp 0", "x.exr r.exr --z-test --variance r.exr --spp -4",
          "x.exr r.exr --z-test --variance r.exr --spp 1.5", "x.exr r.exr --z-test --variance r.exr --spp many",
          "x.exr x.exr r.exr --z-test --variance r.exr --spp 64", "x.exr r.exr --z-test --variance none.exr --spp 64",
          "x.exr r.exr --z-test --variance small.exr --spp 64", "x.exr r.exr --z-test --variance text.exr --spp 64",
          "small.exr r.exr --z-test", "x.exr small.exr --z-test", "none.exr r.exr --z-test", "x.exr none.exr --z-test",
          "x.exr --z-test"}) {
        EXPECT_THAT(run(arguments), exits(2, Not(""))) << arguments;
    }
    EXPECT_THAT(run("x.exr r.exr --z-test --variance small.exr --spp 64").err,
                AllOf(HasSubstr("small.exr"), HasSubstr("20 x 20"), HasSubstr("64 x 64")));
}

// Renders of the right scene pass; with a lamp that is one percent dimmer they do not.
TEST_F(CompareZTest, RendersPassAndAChangedLampDoesNot) {
    std::string xml = tiny_scene_xml(32);
    folder_.write("right.xml", xml);
    const std::string radiance = "name='radiance' value='5'";
    ASSERT_NE(xml.find(radiance), std::string::npos);
    folder_.write("dim.xml", xml.replace(xml.find(radiance), radiance.size(), "name='radiance' value='4.95'"));
    const auto program = [&](const std::string& arguments) {
        EXPECT_THAT(run_gibench(arguments, folder_ / ""), exits(0)) << arguments;
    };
    program("reference right.xml --target 0.2% --max-seconds 5 -o r.exr");
    program("render right.xml --method 'path spp=256' --seed 1 -o a.exr");
    program("render right.xml --method 'path spp=256' --seed 2 -o b.exr");
    program("render dim.xml --method 'path spp=256' --seed 1 -o dim.exr");
    for (const char* good : {"a.exr", "b.exr", "a.exr b.exr"})
        EXPECT_THAT(run(std::string(good) + " r.exr --z-test"), exits(0)) << good;
    EXPECT_THAT(run("dim.exr r.exr --z-test --other-scene"), prints_with(1, HasSubstr("the images differ")));
}

}  // namespace
}  // namespace gib::test::compare_z_test_test
