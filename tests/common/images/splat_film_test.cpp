#include "common/images/splat_film.h"

#include "common/core/parallel.h"

#include <gtest/gtest.h>

namespace gib::test::splat_film_test {
namespace {

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
}  // namespace gib::test::splat_film_test
