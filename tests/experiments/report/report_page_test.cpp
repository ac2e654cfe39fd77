// report.html as text: HDR images come back as they were, the data are JSON, and
// the page asks for nothing outside the file.

#include "experiments/analysis/analysis.h"
#include "experiments/report/report.h"
#include "experiments/report/report_pictures.h"
#include "experiments/results/judgement.h"
#include "experiments/results/pictures.h"
#include "experiments/text/html.h"
#include "tests/support/page_reader.h"
#include "tests/support/run_fixtures.h"

#include "common/images/image_file.h"

#include <fmt/format.h>
#include <zlib.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <regex>

namespace gib::test::report_page_test {
namespace {

using nlohmann::json;

float float_of_half(unsigned bits) {
    const float sign = bits & 0x8000u ? -1.f : 1.f;
    const int exponent = static_cast<int>((bits >> 10) & 31u);
    const auto mantissa = static_cast<float>(bits & 1023u);
    if (exponent == 31) return mantissa > 0 ? std::nanf("") : sign * std::numeric_limits<float>::infinity();
    return exponent == 0 ? sign * std::ldexp(mantissa, -24) : sign * std::ldexp(1024 + mantissa, exponent - 25);
}

/// Unpacks an image as the page's script does, from the text and the size alone.
std::vector<float> unpacked(const std::string& text, std::size_t width, std::size_t height, std::size_t channels,
                            int exponent) {
    const auto packed = bytes_of_base64(text);
    const std::size_t pixels = width * height;
    std::vector<std::uint8_t> bytes(2 * pixels * channels);
    uLongf size = bytes.size();
    EXPECT_EQ(uncompress(bytes.data(), &size, packed.data(), packed.size()), Z_OK);
    EXPECT_EQ(size, bytes.size());
    std::vector<float> values(pixels * channels);
    for (std::size_t c = 0; c < channels; ++c)
        for (std::size_t y = 0; y < height; ++y) {
            unsigned high = 0;
            for (std::size_t x = 0; x < width; ++x) {
                const std::size_t i = y * width + x;
                high = (high + bytes[c * pixels + i]) & 255u;
                const unsigned low = bytes[(channels + c) * pixels + i];
                values[channels * i + c] = std::ldexp(float_of_half((high << 8) | low), -exponent);
            }
        }
    return values;
}

TEST(ImagePack, HalvesComeBackWithinTheirPrecision) {
    std::vector<float> values = {0.f, 1.f, -1.f, 3.14159f, 1e-3f, 1234.5f, 70000.f, 65519.f, 0.333f, -2e-2f, 5e4f, 7.f};
    for (const float scale : {1.f, 1e-30f, 1e30f}) {
        std::vector<float> scaled;
        for (const float v : values)
            scaled.push_back(v * scale);
        const PackedImage packed = pack_half(scaled, 2, 2, 3);
        const auto back = unpacked(packed.text, 2, 2, 3, packed.exponent);
        for (std::size_t i = 0; i < scaled.size(); ++i)
            EXPECT_LE(std::abs(back[i] - scaled[i]), std::abs(scaled[i]) * std::ldexp(1.f, -11)) << scaled[i];
    }
    values[3] = std::nanf("");
    values[5] = std::numeric_limits<float>::infinity();
    const PackedImage packed = pack_half(values, 4, 1, 3);
    const auto back = unpacked(packed.text, 4, 1, 3, packed.exponent);
    EXPECT_TRUE(std::isnan(back[3]));
    EXPECT_EQ(back[5], std::numeric_limits<float>::infinity());
    EXPECT_LE(std::abs(back[6] - 70000.f), 70000.f / 2048);
    EXPECT_THROW(pack_half(values, 3, 1, 3), std::invalid_argument);
}

TEST(ImagePack, Base64IsThatOfTheStandard) {
    for (const auto& [text, code] :
         std::map<std::string, std::string>{{"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foobar", "Zm9vYmFy"}})
        EXPECT_EQ(base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}), code);
}

TEST(Html, TextCannotBecomeMarkup) {
    EXPECT_EQ(html_escape("<b title=\"a\">'&amp;'"), "&lt;b title=&quot;a&quot;&gt;&apos;&amp;amp;&apos;");
    EXPECT_EQ(sentence_html("`a<b` is > `c`"), "<code>a&lt;b</code> is &gt; <code>c</code>");
    EXPECT_EQ(script_safe_json(json({{"a", "</script><!--"}}).dump()).find('<'), std::string::npos);
    EXPECT_EQ(json::parse(script_safe_json(json("</script>").dump())), "</script>");
    EXPECT_EQ(script_safe_code("x = '</script>';"), "x = '<\\/script>';");
}

TEST(Frames, AreReducedToMeansOfBlocks) {
    EXPECT_EQ(reduction_for(512, 300, 512), 1);
    EXPECT_EQ(reduction_for(300, 1025, 512), 3);
    Image image(3, 2);
    for (std::size_t i = 0; i < 6; ++i)
        image.set(i, Color::Constant(static_cast<float>(i)));
    const Image small = reduced(image, 2);
    ASSERT_EQ(small.width, 2);
    ASSERT_EQ(small.height, 1);
    EXPECT_EQ(small.at(0)[0], 2) << "of 0, 1, 3, 4";
    EXPECT_EQ(small.at(1)[1], 3.5) << "of 2 and 5: the block at the edge is smaller";
}

class ReportPageTest : public ::testing::Test {
protected:
    static void SetUpTestSuite() {
        files_ = std::make_unique<ExperimentFolder>();
        files_->write("e.toml",
                      "title = 'A </script><b> title'\nscenes = ['tiny.xml']\nseeds = 2\n[reference]\ntarget = '40%'\n"
                      "[[method]]\nname = 'path'\nspp = [8, 64]\n");
        ASSERT_THAT(files_->run(), exits(0));
        folder_ = std::make_unique<ResultFolder>(files_->path("results/e"));
        analysis_ = analyse(*folder_);
    }
    static void TearDownTestSuite() {
        folder_.reset();
        files_.reset();
        analysis_ = {};
    }
    static std::vector<float> pixels(const std::string& page, const json& picture) {
        return unpacked(element_of_page(page, picture.at("id")), picture.at("width"), picture.at("height"),
                        picture.at("channels"), picture.at("exponent"));
    }

    static inline std::unique_ptr<ExperimentFolder> files_;
    static inline std::unique_ptr<ResultFolder> folder_;
    static inline Analysis analysis_;
};

TEST_F(ReportPageTest, AsksForNothingOutsideTheFile) {
    std::string page = report_html(analysis_, *folder_);
    EXPECT_THAT(page, AllOf(HasSubstr("default-src 'none'"), HasSubstr("Released under the MIT License")));
    const std::string library = script_safe_code(embedded_file("chart.js"));
    const std::size_t at = page.find(library);
    ASSERT_NE(at, std::string::npos);
    page.erase(at, library.size());  // its comments contain web addresses
    EXPECT_THAT(page, AllOf(Not(HasSubstr("://")), Not(HasSubstr("{{"))));
    EXPECT_FALSE(std::regex_search(page, std::regex("(src|href)=\"[^#]"))) << "links lead to the page itself";
}

TEST_F(ReportPageTest, TitlesAndDataDoNotBreakThePage) {
    const std::string page = report_html(analysis_, *folder_);
    EXPECT_THAT(page, HasSubstr("<h1>A &lt;/script&gt;&lt;b&gt; title</h1>"));
    const json data = json::parse(element_of_page(page, "report-data"));
    EXPECT_EQ(data.at("methods"), json::array({"path"})) << "both labels are one method";
    ASSERT_EQ(data["scenes"]["tiny"]["curves"]["total"].size(), 1u) << "labels that differ in spp alone are one method";
    const json& curve = data["scenes"]["tiny"]["curves"]["total"][0];
    EXPECT_EQ(curve.at("method"), 0);
    EXPECT_EQ(curve.at("stops"), json({8}));
    ASSERT_FALSE(curve.at("points").empty());
    EXPECT_EQ(curve["points"][0].size(), 9u);
}

TEST_F(ReportPageTest, HoldsThePixelsOfTheImages) {
    const std::string page = report_html(analysis_, *folder_);
    const json data = json::parse(element_of_page(page, "report-data"));
    const json& scene = data["pictures"]["tiny"];
    EXPECT_EQ(scene.at("reduction"), 1);
    ASSERT_EQ(scene.at("images").size(), 2u) << "the reference and one method, which two labels run";
    const ComponentImages file = components_in(read_image(folder_->method_image("tiny", "path spp=64")));
    std::vector<float> sum(file.total().rgb.size(), 0.f);
    for (const auto& name : scene["layers"][0].at("parts")) {
        const auto part = pixels(page, scene["images"][1]["parts"].at(name.get<std::string>()));
        for (std::size_t i = 0; i < sum.size(); ++i)
            sum[i] += part[i];
    }
    const Image total = file.total();
    float largest = 0;
    for (std::size_t i = 0; i < sum.size(); ++i) {
        EXPECT_LE(std::abs(sum[i] - total.rgb[i]), std::ldexp(std::abs(total.rgb[i]), -10));
        largest = std::max(largest, sum[i]);
    }
    EXPECT_GT(largest, 0.f);
}

// The two labels are one method, whose longest run was the only one that could go on.
TEST_F(ReportPageTest, ShowsEachMethodAtEqualTime) {
    ASSERT_EQ(analysis_.looks.size(), 1u);
    const EqualTimeLook& look = analysis_.looks[0];
    EXPECT_EQ(look.method, "path spp=64");
    EXPECT_TRUE(look.is_final) << "it is the fastest, and has come to its end";
    EXPECT_EQ(look.passes, 64u);
    ASSERT_TRUE(look.flip.has_value());
    EXPECT_GT(*look.flip, 0);
    EXPECT_LT(*look.flip, 1);
    const std::string page = report_html(analysis_, *folder_);
    EXPECT_THAT(page, HasSubstr(fmt::format("data-method=\"path\" data-passes=\"{}\"", look.passes)));
    const std::size_t strip = page.find("class=\"strip"), chart = page.find("class=\"curve-chart"),
                      words = page.find("class=\"verdict"), table = page.find("<details class=\"folded");
    EXPECT_LT(strip, chart) << "look first, then error against time";
    EXPECT_LT(chart, words);
    EXPECT_LT(words, table);
}

TEST_F(ReportPageTest, HoldsTheFramesOnTheWay) {
    const ReportPictures pictures = report_pictures(analysis_, *folder_);
    const json& frames = pictures.scenes["tiny"]["images"][2]["frames"];
    std::vector<int> passes;
    for (const json& frame : frames)
        passes.push_back(frame.at("passes"));
    EXPECT_THAT(passes, ElementsAre(1, 2, 4, 8, 16, 32));
    const auto stored = read_frame(*folder_, cell_folder_name("tiny", "path spp=64", 1), 8);
    ASSERT_TRUE(stored);
    const auto shown = pixels(pictures.elements, frames[3].at("image"));
    for (std::size_t i = 0; i < shown.size(); ++i)
        EXPECT_EQ(shown[i], stored->rgb[i]) << "frames are rounded when they are stored";
    // The first eight passes of a run with more passes are those of a shorter one.
    const Image shorter = components_in(read_image(folder_->method_image("tiny", "path spp=8"))).total();
    for (std::size_t i = 0; i < shown.size(); ++i)
        EXPECT_NEAR(shown[i], shorter.rgb[i], std::ldexp(std::abs(shorter.rgb[i]), -10));
}

TEST_F(ReportPageTest, KeepsToItsBudget) {
    const std::size_t all = report_pictures(analysis_, *folder_).elements.size();
    const ReportPictures fewer = report_pictures(analysis_, *folder_, {1'000'000, all - 1000});
    EXPECT_LT(fewer.elements.size(), all);
    EXPECT_LT(fewer.scenes["tiny"]["images"][2]["frames"].size(), 6u);
    EXPECT_THAT(fewer.note, HasSubstr("To keep the page small"));
    EXPECT_EQ(fewer.scenes["tiny"]["reduction"], 1);
    const std::size_t final_images = report_pictures(analysis_, *folder_, {1'000'000, 0}).elements.size();
    const ReportPictures smaller = report_pictures(analysis_, *folder_, {final_images / 2, 1'000'000});
    EXPECT_GT(smaller.scenes["tiny"]["reduction"], 1);
    EXPECT_THAT(smaller.note, HasSubstr("of the film's size"));
    const json& part = smaller.scenes["tiny"]["images"][2]["parts"]["direct"];
    EXPECT_EQ(pixels(smaller.elements, part).size(),
              3 * part["width"].get<std::size_t>() * part["height"].get<std::size_t>());
}

TEST(FlipMapValues, ComeBackFromAPicture) {
    FlipMap map{256, 1, {}};
    for (int i = 0; i < 256; ++i)
        map.values.push_back(static_cast<float>(i) / 255.f);
    TemporaryFolder folder;
    const auto png = encode_png(flip_image(map), 1.f);
    folder.write("map.png", std::string(png.begin(), png.end()));
    const Image back = flip_values(read_image(folder / "map.png").layers.front().second);
    for (std::size_t i = 0; i < 256; ++i)
        EXPECT_NEAR(back.rgb[3 * i], map.values[i], 1.01 / 255);
}

}  // namespace
}  // namespace gib::test::report_page_test
