// `gibench compare --z-test` as a user meets it.

#include "common/images/image_file.h"
#include "tests/support/constant_image.h"
#include "tests/support/run_fixtures.h"

#include <limits>
#include <nlohmann/json.hpp>
#include <random>

namespace gib::test::compare_z_test_test {
namespace {

Image constant(float value, int size = 20) { return constant_image(value, size, size); }

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
