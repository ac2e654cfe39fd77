// `gibench compare`: its numbers as JSON and as text, and its errors.
#include "experiments/program/compare.h"

#include "common/color/srgb.h"
#include "common/core/error.h"
#include "common/core/float_traps.h"
#include "common/images/image_file.h"
#include "experiments/metrics/epsilon.h"
#include "experiments/metrics/flip.h"
#include "experiments/program/compare_words.h"
#include "tests/experiments/metrics/paper_flip.h"
#include "tests/support/constant_image.h"
#include "tests/support/input_error.h"
#include "tests/support/matchers.h"
#include "tests/support/scene_text.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

namespace gib::test::compare_test {
namespace {

class Compare : public ::testing::Test {
protected:
    static Image constant(float value) { return constant_image(value, 8, 6); }
    std::string file(const std::string& name, const LayeredImage& image) const {
        write_exr(folder_ / name, image);
        return folder_ / name;
    }
    std::string file(const std::string& name, float value) const { return file(name, one_layer(constant(value))); }
    static nlohmann::json json(CompareOptions options) {
        options.json = true;
        std::ostringstream out;
        EXPECT_EQ(compare(options, out), 0);
        return nlohmann::json::parse(out.str());
    }
    TemporaryFolder folder_;
};

TEST_F(Compare, OneImageHasItsErrorsAndNoSplit) {
    const std::string r = file("r.exr", 2);
    const auto result = json({{file("x.exr", 2.5f)}, r});
    EXPECT_EQ(result["seeds"], 1);
    EXPECT_NEAR(result["epsilon"], 0.04, 1e-8) << "the square of a tenth of the reference's mean";
    EXPECT_NEAR(result["mse"], 0.25, 1e-12);
    EXPECT_NEAR(result["rmse"], 0.5, 1e-12);
    EXPECT_NEAR(result["rel_mse"], 0.25 / 4.04, 1e-8);
    EXPECT_NEAR(result["rel_rmse"], std::sqrt(0.25 / 4.04), 1e-8);
    EXPECT_EQ(result["nonfinite"], 0);
    // The exposure shows 2 as 0.85, and therefore 2.5 as filmic(2.118872 / 2 * 2.5).
    EXPECT_NEAR(
        result["flip"],
        paper::color_error(paper::hunt_lab(Colord::Constant(filmic(2.64859))), paper::hunt_lab(Colord::Constant(0.85))),
        1e-4);
    for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(result["mean"][k], 2.5, 1e-12);
        EXPECT_NEAR(result["reference_mean"][k], 2, 1e-12);
    }
    for (const char* key : {"mse_lo", "rmse_hi", "rel_mse_lo", "bias2", "bias2_lo", "variance", "variance_hi",
                            "noise_centroid", "noise_low_ratio"})
        EXPECT_TRUE(result.contains(key) && result[key].is_null()) << key;
    EXPECT_TRUE(result["components"].empty());
}

TEST_F(Compare, ReplicatesAreSplitIntoBiasAndVarianceInEveryComponent) {
    std::mt19937_64 random(4);
    std::normal_distribution<float> normal;
    const std::string r = file("r.exr", {{{"", constant(3)}, {"direct", constant(1)}, {"caustic", constant(2)}}, {}});
    CompareOptions options{{}, r};
    for (int i = 0; i < 4; ++i) {
        const Image direct = mapped(constant(1.5f), [&](float v) { return v + 0.1f * normal(random); });
        const Image total = mapped(direct, [](float v) { return v + 2; });
        options.tests.push_back(file("x" + std::to_string(i) + ".exr", {{{"", total}, {"direct", direct}}, {}}));
    }
    const auto result = json(options);
    EXPECT_EQ(result["seeds"], 4);
    EXPECT_NEAR(result["mse"], result["bias2"].get<double>() + result["variance"].get<double>(), 1e-9);
    EXPECT_NEAR(result["bias2"], 0.25, 0.05);
    EXPECT_NEAR(result["variance"], 0.01, 0.005);
    EXPECT_LT(result["bias2_lo"], result["bias2"]);
    EXPECT_LT(result["variance"], result["variance_hi"]);
    EXPECT_TRUE(result["noise_centroid"].is_number());
    ASSERT_EQ(result["components"].size(), 1u);
    // A component's relative error has the total's radiance in the denominator.
    const auto& direct = result["components"]["direct"];
    EXPECT_NEAR(direct["rel_mse"], direct["mse"].get<double>() / 9.09, 1e-8);
    // FLIP is measured for the whole image only; the result is its mean over the replicates.
    EXPECT_TRUE(direct["flip"].is_null());
    double flip = 0;
    for (const std::string& test : options.tests)
        flip += json({{test}, r})["flip"].get<double>() / 4;
    EXPECT_NEAR(result["flip"], flip, 1e-12);
}

TEST_F(Compare, NonFiniteValuesAreCountedAndNotHidden) {
    Image x = constant(2);
    x.rgb[3] = std::numeric_limits<float>::quiet_NaN();
    x.rgb[4] = std::numeric_limits<float>::infinity();
    const std::string r = file("r.exr", 2), path = file("x.exr", one_layer(x));
    const auto result = json({{path, path, path, path}, r});
    EXPECT_EQ(result["nonfinite"], 8);
    EXPECT_TRUE(result["mse"].is_null() && result["rel_mse"].is_null() && result["bias2"].is_null());
    EXPECT_TRUE(result["flip"].is_null());
    EXPECT_THAT(input_error_of([&] { json({{r}, path}); }), HasSubstr("not finite"));
}

TEST_F(Compare, WrongInputIsAnErrorThatNamesIt) {
    const FloatTrapsPaused paused;  // a NaN is passed below
    const std::string r = file("r.exr", 2);
    const std::string small = file("small.exr", one_layer(constant_image(2.f, 4, 3)));
    const std::string layers = file("layers.exr", {{{"a", constant(2)}, {"b", constant(2)}}, {}});
    const std::string none = folder_ / "none.exr";
    const auto error = [&](const std::string& test, const std::string& reference) {
        return input_error_of([&] { json({{test}, reference}); });
    };
    EXPECT_THAT(error(small, r), AllOf(HasSubstr("4 x 3"), HasSubstr("8 x 6"), HasSubstr("small.exr")));
    for (const std::string& file : {none, layers}) {
        EXPECT_THAT(error(file, r), HasSubstr(file));
        EXPECT_THAT(error(r, file), HasSubstr(file));
    }
    EXPECT_THROW(json({{r}, r, 0}), InputError);
    EXPECT_THROW(json({{r}, r, std::numeric_limits<double>::quiet_NaN()}), InputError);
}

/// A picture without symmetries, 64 x 48 pixels, with noise of 5 % and this seed.
Image picture(unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<float> noise(1, 0.05f);
    Image image(64, 48);
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x)
            for (int k = 0; k < 3; ++k)
                image.rgb[static_cast<std::size_t>(3 * (64 * y + x) + k)] =
                    (0.2f + 0.05f * static_cast<float>(x) + 0.15f * static_cast<float>(y)) *
                    (1 + 0.3f * static_cast<float>(k)) * noise(random);
    return image;
}

/// The sentence about the image beside picture(1), a reference without noise of its own.
std::string sentence_about(const Image& image) {
    const ReferenceLayer reference{picture(1), std::nullopt, {}};
    return comparison_sentence({image}, reference, Denominators(reference, 0.01));
}

Image changed(Image image, const std::function<float(float)>& change) {
    std::transform(image.rgb.begin(), image.rgb.end(), image.rgb.begin(), change);
    return image;
}

TEST(CompareWords, SayHowMuchTooBright) {
    const std::string bright = sentence_about(changed(picture(2), [](float v) { return 1.2f * v; }));
    const std::string head = "1.20 times too bright; scaled, relative RMSE ";
    EXPECT_THAT(bright, AllOf(StartsWith(head), Not(HasSubstr("fits better"))));
    EXPECT_NEAR(std::stod(bright.substr(head.size())), 5 * std::sqrt(2), 0.15) << "the noise of both pictures";
    EXPECT_THAT(sentence_about(changed(picture(3), [](float v) { return 0.5f * v; })),
                StartsWith("2.00 times too dark"));
}

// The noise of 100 pairs of pictures of equal brightness is never called a difference: its standard deviation is 0.05 %.
TEST(CompareWords, SayNothingOfNoise) {
    for (unsigned seed = 2; seed < 100; ++seed)
        EXPECT_THAT(sentence_about(picture(seed)), StartsWith("relative RMSE 7.")) << seed;
}

// Noise of 25 % in the reference, known or not, makes no image too bright or too dark.
TEST(CompareWords, SayNothingOfTheReferencesNoise) {
    std::vector<Image> groups;
    std::mt19937 random(3);
    std::normal_distribution<float> noise(1, 0.5f);
    for (unsigned seed = 10; seed < 14; ++seed)
        groups.push_back(changed(picture(seed), [&](float v) { return v * noise(random); }));
    const ReferenceLayer known = layer_of_groups(groups), unknown{known.mean, std::nullopt, {}};
    for (const ReferenceLayer& reference : {known, unknown})
        for (unsigned seed = 100; seed < 110; ++seed) {
            const Denominators denominators(reference, 0.01);
            EXPECT_THAT(comparison_sentence({picture(seed)}, reference, denominators), Not(HasSubstr("times too")));
        }
}

TEST(CompareWords, SayWhichWayUpItFits) {
    const Image right = picture(2);
    Image down = right, swapped = right;
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x)
            down.set(static_cast<std::size_t>(64 * y + x), right.at(static_cast<std::size_t>(64 * (47 - y) + x)));
    for (std::size_t p = 0; p < swapped.pixels(); ++p)
        std::swap(swapped.rgb[3 * p], swapped.rgb[3 * p + 2]);
    EXPECT_THAT(sentence_about(down), HasSubstr("fits better upside down"));
    EXPECT_THAT(sentence_about(swapped), HasSubstr("fits better with red and blue swapped"));
}

TEST(CompareWords, SayThatTheSrgbCurveWasApplied) {
    for (const float exposure : {0.05f, 0.2f, 1.f, 3.f}) {
        const auto curve = [&](float v) { return srgb_from_linear(exposure * v); };
        const std::string sentence = sentence_about(changed(picture(2), curve));
        const std::string head = "the sRGB curve of displays was applied, which radiance does not have; without it, ";
        EXPECT_THAT(sentence, AllOf(StartsWith(head), HasSubstr("relative RMSE 7."))) << exposure;
        if (exposure > 0.2f) continue;
        const Image clipped = changed(picture(2), [&](float v) { return std::min(curve(v), 1.f); });
        EXPECT_THAT(sentence_about(clipped), StartsWith(head)) << exposure;
        const Image bytes = changed(clipped, [](float v) { return std::round(255 * v) / 255; });
        EXPECT_THAT(sentence_about(bytes), StartsWith(head)) << exposure;
    }
    EXPECT_THAT(sentence_about(changed(picture(2), [](float v) { return srgb_from_linear(3 * v); })),
                HasSubstr("without it, 2.99 times too bright; scaled, relative RMSE 7."));
    EXPECT_THAT(sentence_about(changed(picture(2), [](float v) { return std::pow(v / 20, 1 / 2.2f); })),
                StartsWith("the sRGB curve"));
    Image lamp = picture(2), reference = picture(1);
    for (std::size_t p = 0; p < 20; ++p)
        for (Image* image : {&lamp, &reference})
            image->set(p, Color::Constant(40));
    EXPECT_EQ(doubts_about_image(changed(lamp, srgb_from_linear), reference), "")
        << "a lamp is not clipped by the curve";
}

TEST(CompareWords, SeeNoSrgbCurveInRadiance) {
    const Image reference = picture(1);
    for (const auto& change : std::vector<std::function<float(float)>>{
             [](float v) { return v; }, [](float v) { return 0.01f * v; }, [](float v) { return std::min(v, 1.f); },
             [](float v) { return std::min(v, 5.f); }, [](float v) { return v + 2; }, [](float v) { return v + 20; },
             [](float) { return 0.5f; }, [](float) { return 0.f; }})
        EXPECT_FALSE(has_srgb_curve(changed(picture(2), change), reference));
    EXPECT_FALSE(has_srgb_curve(constant_image(0.3f, 64, 48), constant_image(0.2f, 64, 48)));
    Image down = picture(2);
    std::ranges::reverse(down.rgb);
    EXPECT_FALSE(has_srgb_curve(down, reference));
}

TEST(CompareWords, WarnOfImagesThatCannotHoldRadiance) {
    const Image reference = picture(1), image = picture(2);
    EXPECT_EQ(doubts_about_image(image, reference), "");
    EXPECT_THAT(doubts_about_image(changed(image, [](float v) { return std::min(v, 5.f); }), reference),
                HasSubstr("clipped at 5.00"));
    EXPECT_THAT(doubts_about_image(changed(image, [](float v) { return std::round(v * 12) / 12; }), reference),
                HasSubstr("as an image of 8 bits has"));
    Image grey = image;
    for (std::size_t p = 0; p < grey.pixels(); ++p)
        grey.set(p, Color::Constant(grey.rgb[3 * p]));
    EXPECT_EQ(doubts_about_image(grey, reference), "it is grey, and the other has colours");
    EXPECT_EQ(doubts_about_image(grey, grey), "");
}

TEST_F(Compare, WritesAPictureOfTheDifferenceAndSaysASentence) {
    CompareOptions options{{file("x.exr", 2.4f)}, file("r.exr", 2)};
    options.png = folder_ / "d.png";
    std::ostringstream out;
    EXPECT_EQ(compare(options, out), 0);
    EXPECT_THAT(out.str(), StartsWith("1.20 times too bright; scaled, relative RMSE 0"));
    EXPECT_EQ(read_image(options.png).layers.front().second.width, 8);
    EXPECT_EQ(json(options)["sentence"], out.str().substr(0, out.str().find('\n')));
}

}  // namespace
}  // namespace gib::test::compare_test
