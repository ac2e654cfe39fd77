// References that were made elsewhere: `image` in [reference].

#include "common/images/image_file.h"
#include "experiments/metrics/reference_image.h"
#include "tests/support/run_fixtures.h"

#include <gmock/gmock.h>

#include <limits>

namespace gib::test::given_reference_run_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class GivenReferenceRun : public ::testing::Test {
protected:
    GivenReferenceRun() { folder_.write_experiment("4", "image = 'r.exr'\n"); }
    /// Writes an image of one value as r.exr, with a layer of the standard error if that is not empty.
    void write_image(int size, float value, std::optional<float> standard_error = {}) {
        const auto filled = [size](float v) {
            Image image(size, size);
            std::fill(image.rgb.begin(), image.rgb.end(), v);
            return image;
        };
        LayeredImage file;
        file.layers.emplace_back("", filled(value));
        if (standard_error) file.layers.emplace_back("stderr", filled(*standard_error));
        write_exr(folder_.path("r.exr"), file);
    }
    std::string field(const std::string& column) {
        const CsvTable table = folder_.table("table.csv");
        const auto at = static_cast<std::size_t>(std::find(table.columns.begin(), table.columns.end(), column) -
                                                 table.columns.begin());
        return table.rows.at(0).at(at);
    }
    ExperimentFolder folder_;
};

TEST_F(GivenReferenceRun, WithoutAStandardErrorTheNoiseFloorIsUnknown) {
    write_image(8, 0.5f);
    const ProgramResult result = folder_.run();
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(field("rel_mse_resolved"), "");
    EXPECT_NE(field("rel_mse"), "");
    const std::string text = read_file(folder_.results("table.md"));
    EXPECT_THAT(text,
                AllOf(HasSubstr("Reference of tiny: the image r.exr, standard error unknown with epsilon"),
                      HasSubstr("how much of each error is its own is unknown"), Not(HasSubstr("samples a pixel"))));
    EXPECT_THAT(read_file(folder_.results("report.html")), HasSubstr("how much of each error is its own is unknown"));
    EXPECT_THAT(folder_.run().err, HasSubstr("cells complete already, not done again: 2"));
}

TEST_F(GivenReferenceRun, WithAStandardErrorItIsSubtracted) {
    write_image(8, 0.5f, 0.05f);
    const ProgramResult result = folder_.run();
    ASSERT_EQ(result.code, 0) << result.err;
    const double epsilon = std::stod(field("epsilon")), expected = 0.05 * 0.05 / (0.25 + epsilon);
    EXPECT_NEAR(std::stod(field("rel_mse")) - std::stod(field("rel_mse_corrected")), expected, 1e-4 * expected);
    EXPECT_GT(std::stod(field("rel_mse_resolved")), 0);
    EXPECT_THAT(read_file(folder_.results("table.md")), HasSubstr("relative standard error 9.95"));
}

TEST_F(GivenReferenceRun, AnotherImageMeasuresTheCellsAgain) {
    write_image(8, 0.5f);
    ASSERT_EQ(folder_.run().code, 0);
    const std::string before = field("rel_mse");
    write_image(8, 0.25f);
    EXPECT_THAT(folder_.run().err, HasSubstr("done again: 2"));
    EXPECT_NE(field("rel_mse"), before);
}

TEST_F(GivenReferenceRun, AReferenceThatDoesNotFitFailsWithItsReason) {
    write_image(4, 0.5f);
    EXPECT_THAT(folder_.run().err, HasSubstr("r.exr:1:1: the reference has 4 x 4 pixels, the scene has 8 x 8"));
    write_image(8, std::numeric_limits<float>::quiet_NaN());
    EXPECT_THAT(folder_.run().err, HasSubstr("the reference has values that are not finite"));
    write_image(8, 0.5f, -1.f);
    EXPECT_EQ(folder_.run().code, 1);
    folder_.write("other.xml", tiny_scene_xml(8) + "<!-- another -->");
    ASSERT_EQ(run_gibench("reference other.xml --target 40% -o r.exr --replace", folder_.path()).code, 0);
    EXPECT_THAT(folder_.run().err, HasSubstr("the reference is that of another scene"));
}

// A reference of gibench keeps its groups, so that all intervals contain its uncertainty.
TEST_F(GivenReferenceRun, AReferenceOfGibenchCountsWithItsGroups) {
    ASSERT_EQ(run_gibench("reference tiny.xml --target 10% -o r.exr", folder_.path()).code, 0);
    ASSERT_EQ(folder_.run().code, 0);
    EXPECT_EQ(read_reference(folder_.results("images/tiny-reference.exr")).total.groups.size(),
              static_cast<std::size_t>(reference_groups));
    EXPECT_THAT(read_file(folder_.results("table.md")), HasSubstr("samples a pixel, relative standard error"));
}

}  // namespace
}  // namespace gib::test::given_reference_run_test
