// Tests of bitmaps and checkerboards against Mitsuba's definition, evaluated here in double from the stored values.

#include "common/images/texture.h"

#include "common/core/float_traps.h"
#include "common/core/parallel.h"
#include "common/images/linear_file.h"
#include "common/materials/material.h"
#include "tests/support/texture_fixtures.h"

#include <gmock/gmock.h>
#include <cmath>

namespace gib::test::texture_test {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
const FileFormat bytes{OIIO::TypeDesc::UINT8, 0, {}, {}};

/// The linear value of an sRGB value v (IEC 61966-2-1), in double.
double decoded(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }

/// An image whose values the test knows.
struct Picture {
    int width, height, channels;
    std::vector<float> values;

    double at(int x, int y, int channel) const {
        return values[static_cast<std::size_t>((y * width + x) * channels + (channels == 1 ? 0 : channel))];
    }
    Color color(int x, int y) const {
        return {static_cast<float>(at(x, y, 0)), static_cast<float>(at(x, y, 1)), static_cast<float>(at(x, y, 2))};
    }
};

Picture picture(int width, int height, int channels, unsigned seed = 1) {
    return {width, height, channels, random_values(width, height, channels, seed)};
}

class Bitmaps : public ::testing::Test {
protected:
    std::shared_ptr<const Bitmap> load(const std::string& path, bool raw = false,
                                       const std::string& channel = "") const {
        return std::make_shared<const Bitmap>(cache_, path, raw, channel);
    }
    /// The texture of `p`, written to a float EXR file and read from it.
    BitmapTexture texture_of(const Picture& p, const FileFormat& format = {}) const {
        return {load(write_image(folder_ / "p.exr", p.width, p.height, p.channels, p.values, format))};
    }

    TemporaryFolder folder_;
    std::shared_ptr<TextureCache> cache_ = std::make_shared<TextureCache>();
};

Texture with(BitmapTexture bitmap, TextureFilter filter, Wrap wrap) {
    bitmap.filter = filter;
    bitmap.wrap = wrap;
    return Texture(std::move(bitmap));
}

constexpr TextureFilter every_filter[] = {TextureFilter::bilinear, TextureFilter::nearest};
constexpr Wrap every_wrap[] = {Wrap::repeat, Wrap::mirror, Wrap::clamp, Wrap::zero, Wrap::one};

/// The texel in [0, size) that stands for any index i, by the common definition of the modes, which is Mitsuba's.
int texel_of(int i, int size, Wrap wrap) {
    if (wrap == Wrap::clamp) return std::clamp(i, 0, size - 1);
    if (wrap == Wrap::repeat) return ((i % size) + size) % size;
    const int j = ((i % (2 * size)) + 2 * size) % (2 * size);
    return j < size ? j : 2 * size - 1 - j;
}

/// The filtered colour at uv; uv * size - 0.5 counts texels from the centre of the first one.
Colord filtered(const Picture& p, const Vec2d& uv, TextureFilter filter, Wrap wrap) {
    const auto texel = [&](int x, int y) {
        const bool inside = x >= 0 && x < p.width && y >= 0 && y < p.height;
        if (!inside && (wrap == Wrap::zero || wrap == Wrap::one))
            return Colord(Colord::Constant(wrap == Wrap::one ? 1 : 0));
        return Colord(p.color(texel_of(x, p.width, wrap), texel_of(y, p.height, wrap)).cast<double>());
    };
    if (filter == TextureFilter::nearest)
        return texel(static_cast<int>(std::floor(uv.x() * p.width)), static_cast<int>(std::floor(uv.y() * p.height)));
    const double x = uv.x() * p.width - 0.5, y = uv.y() * p.height - 0.5;
    const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
    return (1 - (y - j)) * ((1 - (x - i)) * texel(i, j) + (x - i) * texel(i + 1, j)) +
           (y - j) * ((1 - (x - i)) * texel(i, j + 1) + (x - i) * texel(i + 1, j + 1));
}

TEST_F(Bitmaps, ShowATexelAtItsCentreAndRowZeroAtVZero) {
    const Picture p = picture(3, 2, 3);
    const BitmapTexture bitmap = texture_of(p);
    for (const auto filter : every_filter) {
        const Texture texture = with(bitmap, filter, Wrap::repeat);
        EXPECT_FALSE(texture.constant());
        for (int y = 0; y < 2; ++y)
            for (int x = 0; x < 3; ++x) {
                const Vec2 centre((static_cast<float>(x) + 0.5f) / 3, (static_cast<float>(y) + 0.5f) / 2);
                EXPECT_TRUE(texture.color(centre).isApprox(p.color(x, y), 1e-6f)) << x << " " << y;
            }
    }
    // The first row in the file is closest to v = 0.
    const Texture clamped = with(bitmap, TextureFilter::nearest, Wrap::clamp);
    EXPECT_TRUE(clamped.color(Vec2{0, 0}).isApprox(p.color(0, 0)));
    EXPECT_TRUE(clamped.color(Vec2{1, 1}).isApprox(p.color(2, 1)));
}

TEST_F(Bitmaps, FilterAndWrapAsDefinedFarOutsideOfTheImage) {
    const Picture p = picture(5, 3, 3);
    const BitmapTexture bitmap = texture_of(p);
    std::mt19937 generator(7);
    std::uniform_real_distribution<float> uniform(-4, 5);
    for (const auto filter : every_filter)
        for (const Wrap wrap : every_wrap) {
            const Texture texture = with(bitmap, filter, wrap);
            for (int i = 0; i < 2000; ++i) {
                const Vec2 uv(uniform(generator), uniform(generator));
                const Vec2d texels(uv.x() * 5.0, uv.y() * 3.0);
                // Within rounding of a border the nearest texel may be either one.
                if (filter == TextureFilter::nearest &&
                    (texels.array() - texels.array().round()).abs().minCoeff() < 1e-4)
                    continue;
                const Colord expected = filtered(p, uv.cast<double>(), filter, wrap);
                const Colord found = texture.color(uv).cast<double>();
                ASSERT_LT((found - expected).abs().maxCoeff(), 2e-5)
                    << uv.transpose() << " filter " << static_cast<int>(filter) << " wrap " << static_cast<int>(wrap);
            }
        }
}

TEST_F(Bitmaps, HaveAValueForEveryUv) {
    const FloatTrapsPaused paused;  // intermediate values are not finite where uv is not
    const BitmapTexture bitmap = texture_of(picture(5, 3, 3));
    for (const auto filter : every_filter)
        for (const Wrap wrap : every_wrap) {
            const Texture texture = with(bitmap, filter, wrap);
            const float ulp = std::nextafter(1.f, 0.f);
            for (const float u : {0.f, -0.f, 1.f, 2.f, ulp, -1e-30f, -1.f, 1e9f, -1e30f, infinity, -infinity, nan})
                for (const float v : {0.f, 1.f, -1e-30f, -infinity, nan, 1e38f}) {
                    const Color c = texture.color(Vec2{u, v});
                    EXPECT_TRUE((c >= texture.minimum()).all() && (c <= texture.maximum()).all()) << u << " " << v;
                    EXPECT_TRUE(texture.gradient({u, v}).allFinite());
                }
        }
}

TEST_F(Bitmaps, StayWithinTheirBoundsWhereRoundingWouldLeaveThem) {
    // All texels are equal, and an interpolation that rounds each product may exceed them.
    const Picture p{2, 2, 3, std::vector<float>(12, 1.f)};
    const Texture texture(texture_of(p));
    std::mt19937 generator(3);
    std::uniform_real_distribution<float> uniform;
    for (int i = 0; i < 20000; ++i) {
        const Vec2 uv(uniform(generator), uniform(generator));
        ASSERT_LE(texture.color(uv).maxCoeff(), 1.f);
        ASSERT_LE(texture.value(uv), 1.f);
    }
}

TEST_F(Bitmaps, AreDecodedFromSrgbBeforeTheyAreFiltered) {
    std::vector<float> values;
    for (int i = 0; i < 256; ++i)
        for (const int c : {i, 255 - i, i / 2})
            values.push_back(byte(c));
    const std::string path = write_image(folder_ / "s.png", 256, 1, 3, values, bytes);
    const Texture texture(BitmapTexture{load(path)});
    const Texture raw(BitmapTexture{load(path, true)});
    for (int i = 0; i < 256; ++i) {
        const Vec2 uv((static_cast<float>(i) + 0.5f) / 256, 0.5f);
        EXPECT_NEAR(texture.color(uv)[0], decoded(i / 255.0), 2e-6) << i;
        EXPECT_NEAR(texture.color(uv)[1], decoded((255 - i) / 255.0), 2e-6) << i;
        EXPECT_NEAR(texture.color(uv)[2], decoded(i / 2 / 255.0), 2e-6) << i;
        EXPECT_NEAR(raw.color(uv)[0], i / 255.0, 2e-6) << i;
        if (i == 255) continue;
        const Vec2 between(static_cast<float>(i + 1) / 256, 0.5f);
        EXPECT_NEAR(texture.color(between)[0], (decoded(i / 255.0) + decoded((i + 1) / 255.0)) / 2, 2e-6);
    }
    // Between black and white, the mean is 0.5, not the 0.21 that decoding after the filter would give.
    const std::string edge = write_image(folder_ / "e.png", 2, 1, 1, {0, 1}, bytes);
    EXPECT_NEAR(Texture(BitmapTexture{load(edge)}).value(Vec2{0.5f, 0.5f}), 0.5, 1e-6);
}

TEST_F(Bitmaps, OfSixteenBitsAreSrgbAndFloatsAreLinear) {
    const std::vector<float> values{0.01f, 0.2f, 0.7f, 0.9f};
    const std::string integers = write_image(folder_ / "s.png", 2, 2, 1, values, {OIIO::TypeDesc::UINT16, 0, {}, {}});
    const std::string floats = write_image(folder_ / "f.exr", 2, 2, 1, values);
    const auto srgb = load(integers), stored = load(integers, true), linear = load(floats), raw = load(floats, true);
    EXPECT_TRUE(srgb->grey() && linear->grey());
    for (int i = 0; i < 4; ++i) {
        const auto v = static_cast<double>(values[static_cast<std::size_t>(i)]);
        EXPECT_NEAR(srgb->texel(i % 2, i / 2)[0], decoded(v), 2e-5);
        EXPECT_NEAR(stored->texel(i % 2, i / 2)[0], v, 1e-5);
        EXPECT_EQ(linear->texel(i % 2, i / 2)[0], values[static_cast<std::size_t>(i)]);
        EXPECT_EQ(raw->texel(i % 2, i / 2)[0], values[static_cast<std::size_t>(i)]);
    }
}

TEST_F(Bitmaps, IgnoreAlphaAndDoNotMultiplyByIt) {
    const std::vector<float> rgba{byte(255), byte(102), byte(51), 0,         byte(204), byte(10), byte(0), byte(30),
                                  byte(1),   byte(2),   byte(3),  byte(255), byte(9),   byte(8),  byte(7), byte(128)};
    for (const char* name : {"a.png", "a.tga"}) {
        const auto image = load(write_image(folder_ / name, 2, 2, 4, rgba, bytes), true);
        for (int i = 0; i < 4; ++i)
            for (int k = 0; k < 3; ++k)
                EXPECT_NEAR(image->texel(i % 2, i / 2)[k], rgba[static_cast<std::size_t>(4 * i + k)], 1e-6)
                    << name << i;
    }
    const auto grey = load(write_image(folder_ / "g.png", 1, 2, 2, {byte(50), 0, byte(80), byte(128)}, bytes));
    EXPECT_TRUE(grey->grey());
    EXPECT_NEAR(grey->texel(0, 0)[0], decoded(50 / 255.0), 1e-6);
    EXPECT_NEAR(grey->texel(0, 1)[2], decoded(80 / 255.0), 1e-6);
}

TEST_F(Bitmaps, OfOneChannelAreGreyAndAlphaIsNotDecoded) {
    const std::string file = write_image(folder_ / "a.png", 1, 1, 4, {byte(200), byte(100), byte(50), byte(25)}, bytes);
    const auto value = [&](const std::string& channel, bool raw) {
        const auto bitmap = load(file, raw, channel);
        EXPECT_TRUE(bitmap->grey());
        return double{bitmap->texel(0, 0)[1]};
    };
    EXPECT_NEAR(value("r", false), decoded(200 / 255.0), 1e-6);
    EXPECT_NEAR(value("B", false), decoded(50 / 255.0), 1e-6);
    EXPECT_NEAR(value("g", true), 100 / 255.0, 1e-6);
    EXPECT_NEAR(value("a", false), 25 / 255.0, 1e-6);
    EXPECT_NEAR(load(file)->texel(0, 0)[0], decoded(200 / 255.0), 1e-6);  // the cache keeps them apart
}

TEST_F(Bitmaps, OfOneGreyHaveTheirValueAsNumberAndOthersTheirLuminance) {
    const Picture grey = picture(4, 4, 1), colour = picture(4, 4, 3);
    const Texture first(texture_of(grey));
    EXPECT_EQ(first.value(Vec2{0.3f, 0.8f}), first.color(Vec2{0.3f, 0.8f})[2]);
    const Texture second(BitmapTexture{load(write_image(folder_ / "c.exr", 4, 4, 3, colour.values))});
    EXPECT_EQ(second.value(Vec2{0.3f, 0.8f}), luminance(second.color(Vec2{0.3f, 0.8f})));
}

TEST_F(Bitmaps, MeasureTheirTexels) {
    const Picture p = picture(300, 270, 3);  // several tiles of the cache
    const auto bitmap = texture_of(p).bitmap;
    Colord sum = Colord::Zero();
    Color lowest = p.color(0, 0), highest = lowest;
    for (int y = 0; y < 270; ++y)
        for (int x = 0; x < 300; ++x) {
            ASSERT_TRUE((bitmap->texel(x, y) == p.color(x, y)).all()) << x << " " << y;
            sum += p.color(x, y).cast<double>();
            lowest = lowest.min(p.color(x, y));
            highest = highest.max(p.color(x, y));
        }
    EXPECT_TRUE((bitmap->mean().cast<double>() - sum / (300 * 270)).abs().maxCoeff() < 1e-7);
    EXPECT_TRUE((bitmap->minimum() == lowest).all());
    EXPECT_TRUE((bitmap->maximum() == highest).all());
}

TEST_F(Bitmaps, ThatArePagedAreTheSameFromManyThreads) {
    const Picture p = picture(320, 300, 3);
    const auto resident = texture_of(p);
    // Nine tiles of 0.2 MB each: two of them fit.
    BitmapTexture paged = resident;
    paged.bitmap = std::make_shared<const Bitmap>(std::make_shared<TextureCache>(0.5), folder_ / "p.exr", false);
    ASSERT_TRUE(paged.bitmap->paged() && !resident.bitmap->paged());
    const Texture expected(resident), texture(paged);
    constexpr std::size_t count = 1000;
    std::vector<Vec2> uvs(count);
    std::mt19937 generator(5);
    std::uniform_real_distribution<float> uniform;
    for (auto& uv : uvs)
        uv = Vec2(uniform(generator), uniform(generator));
    std::vector<Color> found(count), kept(count);
    with_threads(5, [&] {
        parallel_blocks(count, 20, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t i = begin; i < end; ++i) {
                found[i] = texture.color(uvs[i]);
                kept[i] = expected.color(uvs[i]);
            }
        });
    });
    for (std::size_t i = 0; i < count; ++i) {
        ASSERT_TRUE((found[i] == kept[i]).all()) << i;
        ASSERT_TRUE((kept[i] == expected.color(uvs[i])).all()) << i;
    }
}

Texture with_transform(BitmapTexture bitmap, const Eigen::Matrix2f& linear, const Vec2& offset) {
    bitmap.to_uv = {linear, offset};
    return Texture(std::move(bitmap));
}

TEST_F(Bitmaps, AreLookedUpAtTheTransformedUv) {
    const BitmapTexture bitmap = texture_of(picture(6, 4, 3));
    Eigen::Matrix2f linear;
    linear << 2, -0.5f, 0.25f, 3;
    const Vec2 offset(0.1f, -0.3f);
    const Texture plain(bitmap), moved = with_transform(bitmap, linear, offset);
    for (const Vec2& uv : {Vec2(0, 0), Vec2(0.3f, 0.9f), Vec2(0.7f, 0.2f)})
        EXPECT_TRUE(moved.color(uv).isApprox(plain.color(Vec2(linear * uv + offset)), 1e-5f));
    EXPECT_TRUE((moved.mean() == plain.mean()).all());
}

TEST_F(Bitmaps, HaveTheGradientOfTheirValue) {
    const BitmapTexture bitmap = texture_of(picture(8, 5, 3));
    Eigen::Matrix2f turned;
    turned << 0.2f, -1.5f, 0.9f, 0.4f;
    std::mt19937 generator(11);
    std::uniform_real_distribution<float> uniform;
    for (const Wrap wrap : every_wrap)
        for (const Eigen::Matrix2f& linear : {Eigen::Matrix2f(Eigen::Matrix2f::Identity()), turned}) {
            BitmapTexture wrapped_bitmap = bitmap;
            wrapped_bitmap.wrap = wrap;
            const Texture texture = with_transform(wrapped_bitmap, linear, {0.3f, -0.2f});
            int compared = 0;
            for (int i = 0; i < 300; ++i) {
                const Vec2 uv(2 * uniform(generator) - 0.5f, 2 * uniform(generator) - 0.5f);
                const float h = 1e-3f;
                // Bilinear interpolation has kinks at texel centres: both one-sided differences must agree first.
                Vec2 forward, backward;
                for (int k = 0; k < 2; ++k) {
                    const Vec2 step = h * Vec2::Unit(k);
                    forward[k] = (texture.value(Vec2(uv + step)) - texture.value(uv)) / h;
                    backward[k] = (texture.value(uv) - texture.value(Vec2(uv - step))) / h;
                }
                if ((forward - backward).norm() > 0.02f * (forward.norm() + 0.1f)) continue;
                ++compared;
                const Vec2 expected = 0.5f * (forward + backward);
                ASSERT_LT((texture.gradient(uv) - expected).norm(), 0.02f * (expected.norm() + 0.1f)) << uv.transpose();
            }
            EXPECT_GT(compared, 200);
        }
}

// Surfaces of any size have the same normals if their bumps scale with them. The product |dp_du| |dp_dv| would leave
// the range of float.
TEST_F(Bitmaps, BumpsTiltSurfacesOfAnySize) {
    const Texture height(texture_of({2, 1, 1, {0.f, 1.f}}));
    const auto inside = std::make_shared<const Material>(Scattering(Diffuse{Color::Constant(0.5f)}));
    const auto tilt = [&](float size) {
        const Material bumped(BumpMap{height, 0.3f * size, inside, {false, false}});
        const MaterialPoint point{Vec2(0.5f, 0.5f), Vec3::UnitZ(), size * Vec3::UnitX(), size * Vec3::UnitY(),
                                  frame_along(Vec3::UnitZ(), Vec3::UnitX())};
        return bumped.at(point).layers().at(0).to_layer.value();
    };
    EXPECT_GT((tilt(1.f) - Eigen::Matrix3f::Identity()).norm(), 0.1f);
    for (const float size : {1e-25f, 1e-12f, 1e12f, 1e25f})
        EXPECT_LT((tilt(size) - tilt(1.f)).norm(), 1e-6f) << size;
}

TEST(Checkerboards, HaveTheirFirstColourOnTheDiagonal) {
    const Color a(0.9f, 0.1f, 0.2f), b(0.3f, 0.4f, 0.8f);
    const Texture board(CheckerboardTexture{Texture(a), Texture(b), {}});
    EXPECT_FALSE(board.constant());
    for (const float shift : {0.f, 1.f, -3.f}) {
        const auto color = [&](float u, float v) { return board.color(Vec2{u + shift, v + shift}); };
        EXPECT_TRUE((color(0.25f, 0.25f) == a).all() && (color(0.75f, 0.75f) == a).all());
        EXPECT_TRUE((color(0.75f, 0.25f) == b).all() && (color(0.25f, 0.75f) == b).all());
        EXPECT_TRUE((color(0.5f, 0.5f) == a).all()) << "0.5 belongs to the first half";
    }
    EXPECT_TRUE(board.mean().isApprox(0.5f * (a + b)));
    EXPECT_TRUE((board.minimum() == a.min(b)).all() && (board.maximum() == a.max(b)).all());
    EXPECT_FALSE(board.has_gradient());
    const FloatTrapsPaused paused;
    EXPECT_TRUE(board.color(Vec2{nan, infinity}).allFinite());
}

}  // namespace
}  // namespace gib::test::texture_test
