// Statistics at the limits of their formulas: a black reference, images of one
// pixel, fireflies, sums of very many samples.

#include "common/core/error.h"
#include "common/images/film.h"
#include "common/images/image_file.h"
#include "experiments/metrics/energy_balance.h"
#include "experiments/metrics/flip.h"
#include "experiments/metrics/spectrum.h"
#include "experiments/program/compare.h"
#include "experiments/references/store.h"
#include "experiments/report/report.h"
#include "experiments/report/tables.h"
#include "tests/support/csv_reader.h"
#include "tests/support/driver_fixtures.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

namespace gib::test::degenerate_statistics_test {
namespace {

using testing::HasSubstr;

constexpr double epsilon = 0.01;
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

Image constant(float value, int width = 8, int height = 8) {
    Image image(width, height);
    std::fill(image.rgb.begin(), image.rgb.end(), value);
    return image;
}
Image with_pixel(Image image, std::size_t pixel, float value) {
    image.set(pixel, Color::Constant(value));
    return image;
}

struct OutlierCase {
    std::string name;
    std::vector<Image> replicates;
    double median, trimmed, share;  ///< NaN: undefined
};

/// The relative error of a pixel of value x against a reference of 1, with epsilon 0.01: (x - 1)^2 / 1.01.
double error_of(double x) { return sqr(x - 1) / 1.01; }

std::vector<OutlierCase> outlier_cases() {
    const auto firefly = static_cast<double>(1e8f);
    const double big = error_of(firefly), small = error_of(1.5);
    Image halves = constant(1.5f, 2, 1);
    halves.set(1, Color::Constant(3));
    Image other_channel = constant(1, 1, 1);
    other_channel.rgb[1] = 1.5f;
    return {
        {"Equal", {constant(1)}, 0, 0, nan},
        {"ConstantError", {constant(1.5f)}, small, small, 1.0 / 64},
        {"Firefly", {with_pixel(constant(1.5f), 37, 1e8f)}, small, small, big / (big + 63 * small)},
        {"FireflyInAnEqualImage", {with_pixel(constant(1), 0, 1e8f)}, 0, 0, 1},
        {"FireflyOfALargeImage",
         {with_pixel(constant(1.5f, 100, 100), 5000, 1e8f)},
         small,
         small,
         (big + 9 * small) / (big + 9999 * small)},
        {"ElevenFirefliesOfTenThatAreLeftOut",
         {[] {
             Image image = constant(1, 100, 100);
             for (std::size_t i = 0; i < 11; ++i)
                 image.set(900 * i, Color::Constant(3));
             return image;
         }()},
         0,
         error_of(3) / 9990,
         10.0 / 11},
        {"OneThousandPixels",
         {with_pixel(constant(1.5f, 50, 20), 3, 9)},
         small,
         small,
         error_of(9) / (error_of(9) + 999 * small)},
        {"OneMorePixel",
         {with_pixel(constant(1.5f, 1001, 1), 3, 9)},
         small,
         small,
         (error_of(9) + small) / (error_of(9) + 1000 * small)},
        {"OnePixel", {constant(1.5f, 1, 1)}, small, nan, 1},
        {"TwoPixels", {halves}, (small + error_of(3)) / 2, small, error_of(3) / (error_of(3) + small)},
        {"OneChannel", {other_channel}, small / 3, nan, 1},
        {"FireflyOfOneSeedInFour",
         {constant(1.5f), constant(1.5f), constant(1.5f), with_pixel(constant(1.5f), 9, 1e8f)},
         small,
         small,
         (big + 3 * small) / (big + 255 * small)},
        {"NotANumber", {with_pixel(constant(1), 5, nan)}, nan, nan, nan},
        {"NotANumberInOneSeed", {constant(1), with_pixel(constant(1), 5, nan)}, nan, nan, nan},
        {"Infinite", {with_pixel(constant(1), 5, infinity)}, nan, nan, nan},
    };
}

class Outliers : public testing::TestWithParam<OutlierCase> {};
INSTANTIATE_TEST_SUITE_P(Table, Outliers, testing::ValuesIn(outlier_cases()),
                         [](const auto& test) { return test.param.name; });

TEST_P(Outliers, AreLeftOutAsTheFormulasSay) {
    const OutlierCase& c = GetParam();
    const Image one = constant(1, c.replicates.front().width, c.replicates.front().height);
    const RobustError found = robust_error(c.replicates, one, one, epsilon);
    const auto expect = [](double value, double expected, const char* what) {
        if (std::isnan(expected)) EXPECT_TRUE(std::isnan(value)) << what << ' ' << value;
        else EXPECT_NEAR(value, expected, 1e-12 * std::abs(expected)) << what;
    };
    expect(found.median, c.median, "median");
    expect(found.trimmed, c.trimmed, "trimmed");
    expect(found.share, c.share, "share");
    const bool few = !std::isnan(c.share) && !std::isnan(c.trimmed) && c.share >= 0.5;
    EXPECT_EQ(is_decided_by_outliers(found), few);
}

/// Compares image files by `compare` and reads its JSON.
class DegenerateImages : public testing::Test {
protected:
    std::string file(const std::string& name, const Image& image) const {
        write_exr(folder_ / name, {{{"", image}}, {}});
        return folder_ / name;
    }
    nlohmann::json json(const std::vector<Image>& tests, const Image& reference, bool z_test = false) const {
        CompareOptions options;
        options.reference = file("r.exr", reference);
        options.json = true;
        options.epsilon = 0.01;
        options.z_test = z_test;
        for (std::size_t i = 0; i < tests.size(); ++i)
            options.tests.push_back(file("x" + std::to_string(i) + ".exr", tests[i]));
        std::ostringstream out;
        compare(options, out);
        EXPECT_THAT(out.str(), testing::Not(testing::ContainsRegex("nan|inf[^o]"))) << "no JSON";
        return nlohmann::json::parse(out.str());
    }
    TemporaryFolder folder_;
};

// The denominator of the relative error is epsilon alone. Equal replicates have neither variance nor noise.
TEST_F(DegenerateImages, AReferenceOfZeroGivesNumbers) {
    for (const std::size_t seeds : {1u, 3u}) {
        const auto result = json(std::vector<Image>(seeds, constant(0.5f)), constant(0));
        EXPECT_NEAR(result["mse"], 0.25, 1e-12);
        EXPECT_NEAR(result["rel_mse"], 25, 1e-9);
        EXPECT_NEAR(result["rel_mse_corrected"], 25, 1e-9);
        EXPECT_NEAR(result["rmse_corrected"], 0.5, 1e-12);
        EXPECT_NEAR(result["rel_mse_median"], 25, 1e-9);
        EXPECT_NEAR(result["rel_mse_trimmed"], 25, 1e-9);
        EXPECT_NEAR(result["rel_mse_top_share"], 1.0 / 64, 1e-12);
        EXPECT_TRUE(result["noise_centroid"].is_null());
        EXPECT_TRUE(result["flip"].is_number());
        EXPECT_GT(result["flip"], 0);
        EXPECT_LE(result["flip"], 1);
        if (seeds == 1) continue;
        EXPECT_NEAR(result["bias2"], 0.25, 1e-12);
        for (const char* zero : {"variance", "variance_lo", "variance_hi"})
            EXPECT_EQ(result[zero], 0) << zero;
    }
    const auto equal = json({constant(0)}, constant(0));
    for (const char* zero : {"mse", "rmse", "rel_mse", "rel_mse_corrected", "rel_mse_median", "flip"})
        EXPECT_EQ(equal[zero], 0) << zero;
    EXPECT_TRUE(equal["rel_mse_top_share"].is_null());
    EXPECT_FALSE(energy_balance({constant(0.5f)}, {constant(0), {}, {}}, constant(0)));
}

TEST_F(DegenerateImages, OfOnePixelHaveTheirErrorsAndNoSpectrum) {
    const std::vector<Image> seeds = {constant(0.9f, 1, 1), constant(1.f, 1, 1), constant(1.2f, 1, 1),
                                      constant(1.3f, 1, 1)};
    const auto result = json(seeds, constant(1, 1, 1));
    EXPECT_NEAR(result["mse"], (0.01 + 0 + 0.04 + 0.09) / 4, 1e-7);
    // The mean is 1.1; the squared deviations are 0.04 + 0.01 + 0.01 + 0.04.
    EXPECT_NEAR(result["variance"], 0.1 / 3, 1e-7);
    EXPECT_NEAR(result["bias2"], 0.01 - 0.1 / 3 / 4, 1e-7);
    EXPECT_TRUE(result["noise_centroid"].is_null());
    EXPECT_TRUE(result["rel_mse_trimmed"].is_null());
    EXPECT_TRUE(result["flip"].is_number());
    EXPECT_FALSE(noise_spectrum(seeds, constant(1, 1, 1)));
    EXPECT_TRUE(json({seeds[0]}, constant(1, 1, 1))["variance"].is_null());
    EXPECT_NO_THROW(json(seeds, constant(1, 1, 1), true));
    EXPECT_NO_THROW(json({seeds[1]}, constant(1, 1, 1), true));
    for (const SpectrumPoint& point :
         bias_spectrum(seeds, {constant(1, 1, 1), {}, {constant(0.9f, 1, 1), constant(1.1f, 1, 1)}}))
        EXPECT_TRUE(std::isfinite(point.frequency) && std::isfinite(point.power));
}

TEST(DegenerateRuns, AnImageOfOnePixelHasAllItsTablesAndItsReport) {
    const TemporaryFolder folder;
    folder.write("box.xml", tiny_scene_xml());
    folder.write("e.toml",
                 "title = \"T\"\nscenes = [\"box.xml\"]\nresolution = [1, 1]\nseeds = 3\nbudget = { passes = 4 }\n"
                 "[reference]\nmethod = \"path\"\nseconds = 0.05\n[[method]]\nname = \"path\"\n");
    const ProgramResult result = run_gibench("run e.toml --out out --threads 1", folder / "");
    EXPECT_EQ(result.code, 0) << result.err;
    const CsvTable table = parse_csv(read_file(folder / "out/table.csv"), "table.csv");
    EXPECT_FALSE(table.rows.empty());
    for (const char* name : {"table.csv", "spectra.csv", "curves.csv", "table.md"})
        EXPECT_THAT(read_file(folder / (std::string("out/") + name)),
                    testing::Not(testing::ContainsRegex("[,|( ]-?(nan|inf)[,|) \n]")))
            << name;
    EXPECT_THAT(read_file(folder / "out/report.html"), HasSubstr("</html>"));
}

/// Equal batches, one for each of the reference's groups.
std::vector<ComponentImages> batches_of(float value) {
    ComponentImages batch;
    batch.width = batch.height = 1;
    batch[Component::direct] = constant(value, 1, 1);
    return std::vector<ComponentImages>(reference_groups, batch);
}

// A reference's means are kept in single precision. Each round updates them by mean += share (batch - mean), which
// rounds by half a unit. After n rounds of equal length the i-th rounding counts i / n of that, in all (n + 1) / 4
// units of the largest mean at most. A mean that every batch has is exact.
TEST(Accumulation, OfAReferencesRoundsKeepsItsMean) {
    ReferenceGroups even, mixed;
    constexpr int rounds = 2000;
    for (int i = 0; i < rounds; ++i) {
        even.add_round(batches_of(0.5f), 50000);
        mixed.add_round(batches_of(i % 2 == 0 ? 0.f : 1.f), 50000);
    }
    EXPECT_EQ(even.units, 100000000u);
    const Reference reference = even.reference();
    EXPECT_EQ(reference.total.mean.rgb[0], 0.5f);
    EXPECT_EQ(reference.total.standard_error->rgb[0], 0.f);
    EXPECT_NEAR(mixed.reference().total.mean.rgb[0], 0.5, (rounds + 1) / 4.0 * 0x1p-24);
}

}  // namespace
}  // namespace gib::test::degenerate_statistics_test
