// Tests of image files (EXR, PFM and PNG), and of films that light paths add to.

#include "common/images/image_file.h"
#include "common/core/parallel.h"
#include "common/images/splat_film.h"
#include "tests/support/scene_errors.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

namespace gib::test::image_file_test {
namespace {

/// An image whose values all differ, so that any exchange of rows, columns or channels shows.
Image gradient(int width, int height, float scale = 1) {
    Image image(width, height);
    for (std::size_t i = 0; i < image.rgb.size(); ++i)
        image.rgb[i] = scale * (static_cast<float>(i) + 0.1f);
    return image;
}

std::string bytes_of(const Image& image, const std::vector<int>& rows, const std::vector<std::size_t>& channels) {
    std::string bytes;
    for (int y : rows)
        for (int x = 0; x < image.width; ++x)
            for (std::size_t k : channels) {
                const float v = image.rgb[3 * static_cast<std::size_t>(y * image.width + x) + k];
                bytes.append(reinterpret_cast<const char*>(&v), sizeof v);
            }
    return bytes;
}

TEST(ImageFile, ExrKeepsEveryBitEveryLayerAndTheMetadata) {
    LayeredImage written;
    written.layers.emplace_back("", gradient(7, 5));
    written.layers.emplace_back("stderr", gradient(7, 5, 1e-6f));
    written.layers.emplace_back("direct", gradient(7, 5, 3e5f));
    written.layers.emplace_back("direct_group00", gradient(7, 5, -2));
    written.layers[0].second.rgb[4] = std::numeric_limits<float>::quiet_NaN();
    written.layers[0].second.rgb[5] = std::numeric_limits<float>::infinity();
    written.metadata = {{"gibench:method", "path spp=64"}, {"scene_hash", "00ff"}, {"unresolved", "caustic;volume"}};
    const TemporaryFolder folder;
    const std::string path = folder / "roundtrip.exr";
    for (const Flush flush : {Flush::now, Flush::later}) {
        write_exr(path, written, flush);
        const LayeredImage read = read_image(path);
        ASSERT_EQ(read.layers.size(), written.layers.size());
        EXPECT_EQ(read.layers[0].first, "");
        for (const auto& [name, image] : written.layers) {
            const Image* found = read.find(name);
            ASSERT_NE(found, nullptr) << name;
            ASSERT_TRUE(found->same_size(image));
            EXPECT_EQ(std::memcmp(found->rgb.data(), image.rgb.data(), image.rgb.size() * sizeof(float)), 0) << name;
        }
        for (const auto& [key, value] : written.metadata) {
            ASSERT_TRUE(read.metadata.count(key)) << key;
            EXPECT_EQ(read.metadata.at(key), value);
        }
    }
}

TEST(ImageFile, PfmHasItsLastRowFirstInTheFileAndRowZeroOnTopInMemory) {
    const Image image = gradient(4, 3);
    const TemporaryFolder folder;
    const std::string path = folder / "colour.pfm";
    write_file(path, "PF\n4 3\n-1.0\n" + bytes_of(image, {2, 1, 0}, {0, 1, 2}));
    EXPECT_EQ(read_image(path).find("")->rgb, image.rgb);
    // A single grey channel is read as all three channels.
    write_file(path, "Pf\n4 3\n-1.0\n" + bytes_of(image, {2, 1, 0}, {1}));
    const LayeredImage grey = read_image(path);
    for (std::size_t p = 0; p < image.pixels(); ++p)
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_EQ(grey.find("")->rgb[3 * p + k], image.rgb[3 * p + 1]);
}

/// Writes the channels of an EXR file, each with one value in its 2 x 1 pixels.
std::string write_channels(const std::string& path, const std::vector<std::pair<std::string, float>>& channels) {
    Imf::Header header(2, 1);
    Imf::FrameBuffer pixels;
    std::vector<std::array<float, 2>> values;
    for (const auto& channel : channels)
        values.push_back({channel.second, channel.second});
    for (std::size_t i = 0; i < channels.size(); ++i) {
        header.channels().insert(channels[i].first, Imf::Channel(Imf::FLOAT));
        pixels.insert(channels[i].first, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values[i].data()),
                                                    sizeof(float), 2 * sizeof(float)));
    }
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(pixels);
    file.writePixels(1);
    return path;
}

// The white of sRGB is D65, whose X, Y and Z are 0.95047, 1 and 1.08883.
TEST(ImageFile, XyzBecomesRgbInEveryLayer) {
    const TemporaryFolder folder;
    const LayeredImage file = read_image(write_channels(folder / "xyz.exr", {{"X", 0.95047f},
                                                                             {"Y", 1.f},
                                                                             {"Z", 1.08883f},
                                                                             {"direct.X", 0.4124f},
                                                                             {"direct.Y", 0.2126f},
                                                                             {"direct.Z", 0.0193f},
                                                                             {"A", 1.f}}));
    ASSERT_NE(file.find(""), nullptr);
    ASSERT_NE(file.find("direct"), nullptr);
    for (std::size_t k = 0; k < 6; ++k) {
        EXPECT_NEAR(file.find("")->rgb[k], 1, 1e-3);
        EXPECT_NEAR(file.find("direct")->rgb[k], k % 3 == 0 ? 1 : 0, 1e-3);
    }
}

TEST(ImageFile, ALayerWithSomeOfItsChannelsIsRefused) {
    using Channels = std::vector<std::pair<std::string, float>>;
    const TemporaryFolder folder;
    const Channels image = {{"R", 1.f}, {"G", 1.f}, {"B", 1.f}};
    const auto error_of = [&](Channels channels, bool beside_an_image) {
        if (beside_an_image) channels.insert(channels.end(), image.begin(), image.end());
        return input_error_of([&] { read_image(write_channels(folder / "x.exr", channels)); });
    };
    EXPECT_THAT(error_of({{"X", 1.f}, {"Y", 1.f}}, false), HasSubstr("the layer '' has a channel X, but not all of"));
    EXPECT_THAT(error_of({{"x", 1.f}, {"y", 1.f}, {"z", 1.f}}, false), HasSubstr("no channels R,G,B or Y"));
    EXPECT_THAT(error_of({{"stderr.R", 1.f}, {"stderr.G", 1.f}}, true),
                HasSubstr("the layer 'stderr' has a channel R"));
    EXPECT_THAT(error_of({{"direct.X", 1.f}, {"direct.Y", 1.f}}, true),
                HasSubstr("the layer 'direct' has a channel X"));
    // Y alone is grey, also beside a depth Z; what others keep in layers of their own names does not matter.
    EXPECT_EQ(error_of({{"Y", 1.f}, {"Z", 9.f}}, false), "no error");
    EXPECT_EQ(error_of({{"flow.R", 1.f}, {"flow.G", 1.f}}, true), "no error");
}

TEST(ImageFile, WrongFilesAreErrorsWithTheirName) {
    const TemporaryFolder folder;
    folder.write("text.exr", "this is not an image");
    folder.write("unknown.xyz", "this is not an image");
    write_exr(folder / "cut.exr", {{{"", gradient(200, 200)}}, {}});
    std::filesystem::resize_file(folder / "cut.exr", std::filesystem::file_size(folder / "cut.exr") / 2);
    folder.write("cut.pfm", "PF\n40 30\n-1.0\n" + std::string(40 * 30 * 6, 'x'));
    for (const auto& [name, message] :
         {std::pair("missing.exr", "no such file"), std::pair("", "folder"), std::pair("text.exr", ""),
          std::pair("unknown.xyz", ""), std::pair("cut.exr", ""), std::pair("cut.pfm", "")})
        EXPECT_THAT(input_error_of([&] { read_image(folder / name); }),
                    AllOf(HasSubstr(folder / name), HasSubstr(message)));
}

TEST(ImageFile, PngIsEncodedInMemoryWithTheSrgbCurveAndRowZeroOnTop) {
    Image image(2, 2);
    image.set(0, {0.25f, 0.1f, 0.f});  // exposure 2: 0.5, 0.2, 0
    image.set(1, {10.f, std::numeric_limits<float>::quiet_NaN(), -1.f});
    image.set(3, {0.5f, 0.5f, 0.5f});
    const auto png = encode_png(image, 2);
    const TemporaryFolder folder;
    const std::string path = folder.write("picture.png", {reinterpret_cast<const char*>(png.data()), png.size()});
    // Reading an 8-bit file undoes the curve; the error is at most half a step of 1/255.
    const Image back = *read_image(path).find("");
    ASSERT_EQ(back.width, 2);
    const std::vector<float> expected = {0.5f, 0.2f, 0, 1, 0, 0, 0, 0, 0, 1, 1, 1};
    for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_NEAR(back.rgb[i], expected[i], 0.0045f) << i;
}

// Sums of values over 40 orders of magnitude, of both signs, are exact, however the additions are ordered.
TEST(FixedPointImage, SumsDoNotDependOnTheOrder) {
    FixedPointImage up(2, 1, 0.5), down(2, 1, 0.5);
    constexpr int n = 40;
    std::vector<Color> values;
    for (int i = 0; i < n; ++i)
        values.push_back(Color(1.f, -3.f, 0.7f) * std::ldexp(1.f, i - 20));
    for (int i = 0; i < n; ++i) {
        up.add(1, values[static_cast<std::size_t>(i)]);
        down.add(1, values[static_cast<std::size_t>(n - 1 - i)]);
    }
    EXPECT_EQ(up.mean(1).rgb, down.mean(1).rgb);
    const double sum = std::ldexp(1.0, n - 20) - std::ldexp(1.0, -20);  // sum of the powers of 2
    const Color mean = up.mean(4).at(1);
    EXPECT_EQ(mean.x(), static_cast<float>(sum / 4));
    EXPECT_EQ(mean.y(), static_cast<float>(-3 * sum / 4));
    EXPECT_NEAR(mean.z(), 0.7 * sum / 4, 1e-7 * sum);
    EXPECT_TRUE(is_black(up.mean(4).at(0)));
}

TEST(FixedPointImage, SumsOverThreadsLoseNothing) {
    FixedPointImage image(1, 1, 1);
    constexpr std::size_t count = 1 << 16;
    // The sum of the fractions passes 1 many times: every carry must arrive.
    with_threads(4, [&] {
        parallel_blocks(count, 64, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t i = begin; i < end; ++i)
                image.add(0, Color::Constant(i % 2 == 0 ? 0.75f : -0.25f));
        });
    });
    EXPECT_EQ(image.mean(1).at(0).x(), 0.25f * count);
}

TEST(SplatFilm, CountsAndDropsLightThatIsNotFiniteOrTooLarge) {
    SplatFilm film(2, 2, {Component::direct}, 1);
    PixelSample sample;
    for (const float value : {std::numeric_limits<float>::quiet_NaN(), infinity, 1e30f}) {
        sample[Component::direct] = Color::Constant(value);
        film.add(3, 7, sample);
    }
    sample[Component::direct] = Color::Ones();
    film.add(3, 8, sample);
    ComponentImages images;
    images[Component::direct] = Image(2, 2);
    film.add_mean(1, images);
    EXPECT_EQ(images[Component::direct]->at(3).x(), 1.f);
    EXPECT_EQ(film.non_finite().count, 3u);
    EXPECT_EQ(film.non_finite().first_pass, 7u);
    EXPECT_EQ(film.non_finite().first_pixel, 3u);
    sample[Component::caustic] = Color::Ones();
    EXPECT_THROW(film.add(0, 0, sample), std::logic_error);
}

}  // namespace
}  // namespace gib::test::image_file_test
