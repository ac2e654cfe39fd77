// The key `filter` of an experiment: filtered images are measured like any others, and errors name their place.

#include "common/images/image_file.h"
#include "experiments/results/result_folder.h"
#include "tests/support/constant_image.h"
#include "tests/support/run_fixtures.h"

#include <cmath>

namespace gib::test::filtered_run_test {
namespace {

using ::testing::HasSubstr;

class FilteredRun : public ::testing::Test, protected ExperimentFolder {
protected:
    /// An experiment of `path` whose reference is an exact image of ones; `more` is the end of its [[method]].
    void write_path(const std::string& more, int seeds = 1) {
        LayeredImage reference = one_layer(constant_image(1, 8, 8));
        reference.layers.emplace_back("stderr", constant_image(0, 8, 8));
        write_exr(path("r.exr"), reference);
        write("e.toml", "scenes = ['tiny.xml']\nseeds = " + std::to_string(seeds) +
                            "\n[reference]\nimage = 'r.exr'\n[[method]]\nname = 'path'\n" + more);
    }
    std::string field(const std::string& label, const std::string& column,
                      const std::string& component = "total") const {
        const CsvTable rows = table();
        for (std::size_t i = 0; i < rows.rows.size(); ++i)
            if (field_of(rows, "method", i) == label && field_of(rows, "component", i) == component)
                return field_of(rows, column, i);
        return "no row";
    }
    Image image_of(const std::string& label, std::uint64_t seed) const {
        return *read_image(results("cells/" + cell_folder_name("tiny", label, seed) + "/final.exr")).find("");
    }
    double seconds_of_stage(const std::string& stage) const {
        const CsvTable stages = table("stages.csv");
        for (std::size_t i = 0; i < stages.rows.size(); ++i)
            if (field_of(stages, "stage", i) == stage) return std::stod(field_of(stages, "seconds", i));
        return 0;
    }
};

/// Squared bias and variance of images of one truth, all of whose values are 1, by their definitions.
struct Parts {
    double bias2 = 0, variance = 0;
};
Parts parts_of(const std::vector<Image>& images) {
    Parts parts;
    const auto n = static_cast<double>(images.size()), values = static_cast<double>(images.front().rgb.size());
    for (std::size_t i = 0; i < images.front().rgb.size(); ++i) {
        double mean = 0, squares = 0;
        for (const Image& image : images)
            mean += double{image.rgb[i]} / n;
        for (const Image& image : images)
            squares += std::pow(double{image.rgb[i]} - mean, 2) / (n - 1);
        parts.variance += squares / values;
        parts.bias2 += (std::pow(mean - 1, 2) - squares / n) / values;
    }
    return parts;
}

TEST_F(FilteredRun, ARowHasTheBiasAndTheVarianceOfTheFilteredImages) {
    write_path("spp = 8\nfilter = ['none', 'nlm']\n", 4);
    ASSERT_THAT(run(), exits(0));
    for (const std::string label : {"path spp=8 filter=none", "path spp=8 filter=nlm"}) {
        std::vector<Image> images;
        for (std::uint64_t seed = 1; seed <= 4; ++seed)
            images.push_back(image_of(label, seed));
        const Parts parts = parts_of(images);
        EXPECT_NEAR(std::stod(field(label, "bias2")), parts.bias2, 1e-6 * parts.bias2) << label;
        EXPECT_NEAR(std::stod(field(label, "variance")), parts.variance, 1e-6 * parts.variance) << label;
    }
    EXPECT_EQ(field("path spp=8 filter=none", "bias_state"), "unbiased");
    EXPECT_EQ(field("path spp=8 filter=nlm", "bias_state"), "measured");
    EXPECT_NE(image_of("path spp=8 filter=nlm", 1).rgb, image_of("path spp=8 filter=none", 1).rgb);
    EXPECT_EQ(field("path spp=8 filter=nlm", "label"), "path filter=nlm");
    EXPECT_GT(seconds_of_stage("filter"), 0);
    EXPECT_GT(seconds_of_stage("features"), 0);
    EXPECT_THAT(gibench("run --repeat results/e").out, HasSubstr("8 of 8 identical"));
}

TEST_F(FilteredRun, AFilterStandsInTheNameOfTheOnlyRow) {
    write_path("spp = 4\nfilter = 'nlm'\n");
    ASSERT_THAT(run(), exits(0));
    EXPECT_EQ(field("path spp=4 filter=nlm", "label"), "path filter=nlm");
}

// The wall faces the camera, is 5 units away and reflects one half; the corners of the image show nothing.
TEST_F(FilteredRun, FeaturesAreThoseOfTheFirstSurface) {
    ASSERT_THAT(gibench("render tiny.xml --method 'path spp=1' --features -o x.exr"), exits(0));
    const LayeredImage image = read_image(path("x.exr"));
    ASSERT_TRUE(image.find("albedo") && image.find("normal") && image.find("depth"));
    const std::size_t middle = 4 * 8 + 4;
    EXPECT_NEAR(image.find("albedo")->at(middle).x(), 0.5f, 1e-5f);
    EXPECT_NEAR(std::abs(image.find("normal")->at(middle).z()), 1.f, 1e-5f);
    const float depth = image.find("depth")->at(middle).x(), beside = image.find("depth")->at(middle + 1).x();
    EXPECT_TRUE(5 < depth && depth < beside && beside < 5.1f) << depth << " " << beside;
    for (const char* layer : {"albedo", "normal", "depth"})
        EXPECT_TRUE(is_black(image.find(layer)->at(0))) << layer;
}

TEST_F(FilteredRun, ACommandFiltersAndIsCharged) {
    write("copy.sh", "sleep 0.3\nfor file in $2 $3 $4 $5; do [ -s $file ] || exit 4; done\ncp $1 $7\n");
    write_path(
        "spp = 4\nfilter = ['none', 'sh copy.sh {image} {albedo} {normal} {depth} {variance} {threads} {out}']\n", 2);
    ASSERT_THAT(run(), exits(0));
    EXPECT_EQ(image_of("path spp=4 filter=sh", 2).rgb, image_of("path spp=4 filter=none", 2).rgb);
    EXPECT_EQ(field("path spp=4 filter=sh", "bias2"), field("path spp=4 filter=none", "bias2"));
    EXPECT_EQ(field("path spp=4 filter=sh", "bias_state"), "measured");
    EXPECT_EQ(field("path spp=4 filter=sh", "bias2", "direct"), "no row");
    const double seconds = std::stod(field("path spp=4 filter=sh", "seconds"));
    EXPECT_TRUE(0.3 <= seconds && seconds < 30) << seconds;
}

TEST_F(FilteredRun, ACommandThatFailsIsToldWithItsLastMessage) {
    write("fail.sh", "echo no weights >&2\nexit 3\n");
    write_path("spp = 4\nfilter = ['sh fail.sh {image} {out}', 'true {image} {out}']\n");
    EXPECT_THAT(run(),
                exits(1,
                      HasSubstr("path spp=4 filter=sh, seed 1: its filter ended with exit code 3; its last message: "
                                "no weights (all are in "),
                      HasSubstr("path spp=4 filter=true, seed 1: its filter wrote no image")));
}

using FilterErrors = FilteredRun;

TEST_F(FilterErrors, AreToldWhereTheyStand) {
    const auto says = [&](const std::string& more, const std::string& message) {
        write_path(more);
        EXPECT_THAT(run(), exits(2, HasSubstr(message))) << more;
    };
    says("filter = 'nlmm'\n",
         "e.toml:7:10: 'filter' is none, nlm or a command with the placeholders {image} and {out}, not 'nlmm'; "
         "did you mean 'nlm'?");
    says("filter = 'oidn {image} {out} {color}'\n",
         "e.toml:7:10: the placeholder {color} has no value: there are image, albedo");
    says("spp = 2\nfilter = 'nlm'\n",
         "e.toml:5:1: the filter estimates noise from halves of the passes: 'spp' has to be 4");
    says("spp = 1\nfilter = 'x {image} {variance} {out}'\n", "'spp' has to be 2");
    says("[[method]]\nname = 'radiosity'\nfilter = 'nlm'\n", "e.toml:7:1: a filter takes two halves of the passes");
    EXPECT_THAT(gibench("render tiny.xml --method 'path filter=oidn' -o x.exr"),
                exits(2, HasSubstr("there is no filter 'oidn'")));
    EXPECT_THAT(gibench("reference tiny.xml --method 'path filter=nlm' -o x.exr"),
                exits(2, HasSubstr("makes no reference")));
    EXPECT_THAT(gibench("plan tiny.xml --method 'path filter=nlm'").out, HasSubstr("runs: filter nlm (biased"));
}

}  // namespace
}  // namespace gib::test::filtered_run_test
