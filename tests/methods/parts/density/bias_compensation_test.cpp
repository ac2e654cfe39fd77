// Bias compensation of the density estimate: its effect on even light and near an edge.
#include "methods/parts/density/bias_compensation.h"

#include "tests/methods/parts/density/density_fixtures.h"

#include <iostream>

namespace gib::bias_compensation_test {
namespace {

using test::down_at;
using test::Moments;
using test::relative_estimates;
using test::scene_of_shapes;
using test::spread;
using test::white;

constexpr std::size_t n = 40000, k = 500;
const float radius = 2.f * std::sqrt(static_cast<float>(k) / (pi * static_cast<float>(n)));

/// Photons on [-1, 1]^2 whose power density is 1 where x < 0 and `beyond` elsewhere. All have the same power; with
/// `spread_powers`, the powers are 0.2 and 1.8 times as large.
std::vector<Photon> step(float beyond, bool spread_powers, std::uint64_t seed) {
    std::vector<Photon> photons;
    const auto at = [](float x) { return Vec3(x, -1, 0); };
    const Vec3 up(0, 0, 1);
    spread(photons, n / 2, at(-1), Vec3(1, 0, 0), Vec3(0, 2, 0), up, 2.f, seed);
    const auto more = static_cast<std::size_t>(beyond * n / 2);
    spread(photons, more, at(0), Vec3(1, 0, 0), Vec3(0, 2, 0), up, 2.f * beyond, seed + 100000);
    if (spread_powers)
        for (std::size_t i = 0; i < photons.size(); ++i)
            photons[i].set_power(photons[i].power() * (i % 2 == 0 ? 0.2f : 1.8f));
    return photons;
}

/// Estimates relative to the truth, first without and then with compensation. Distances from the step are in units of
/// the radius of k photons.
std::vector<std::vector<Moments>> estimates(float beyond, bool spread_powers, const std::vector<float>& distances,
                                            std::size_t maps) {
    static const LoadedScene scene = scene_of_shapes(white("rectangle", ""));
    test::Groups groups;
    for (float s : distances) {
        auto& eyes = groups.emplace_back();
        for (int i = -2; i <= 2; ++i)
            eyes.push_back(down_at(-s * radius, 0.35f * static_cast<float>(i)));
    }
    return relative_estimates(
        *scene.scene,
        {{Kernel::uniform, k, 1.f, DiscArea::surface, false}, {Kernel::uniform, k, 1.f, DiscArea::surface, true}}, maps,
        1.0, [=](std::uint64_t seed) { return step(beyond, spread_powers, seed); }, groups);
}

double deviation(const Moments& m) { return m.standard_error() * std::sqrt(static_cast<double>(m.count())); }

// False alarms choose discs that look too bright more often than discs that look too dark: the
// mean rises by 0.3 to 0.5 % (0 % with powers as unequal as these). The bounds are 1 % of the mean
// and 1.8 times the full disc's deviation.
TEST(BiasCompensation, OnEvenPhotonsTheMeanStaysAndTheNoiseHardlyGrows) {
    for (bool spread_powers : {false, true}) {
        const auto found = estimates(1.f, spread_powers, {1.3f, 3.8f, 6.3f}, 400);
        for (std::size_t g = 0; g < 3; ++g) {
            SCOPED_TRACE(g);
            EXPECT_NEAR(found[0][g].mean(), 1.0, 4 * found[0][g].standard_error());
            EXPECT_NEAR(found[1][g].mean(), 1.0, 0.01);
            EXPECT_LT(deviation(found[1][g]), 1.8 * deviation(found[0][g]));
            std::cout << "even: mean " << found[1][g].mean() << " +- " << found[1][g].standard_error() << ", deviation "
                      << deviation(found[1][g]) << " against " << deviation(found[0][g]) << '\n';
        }
    }
}

// Near a step by a factor of 10, compensation divides the full disc's bias by 3 to 5 or more on the dark side. On the
// bright side, where at most half of the photons are missing, it divides the bias by 1.15 or more. Farther from the
// step than the radius of k photons nothing changes.
TEST(BiasCompensation, NearAnEdgeTheBiasFalls) {
    const std::vector<float> distances = {0.2f, 0.4f, 0.7f, 3.f};
    const auto dark = estimates(10.f, false, distances, 60), bright = estimates(0.1f, false, distances, 60);
    const auto bias = [](const Moments& m) { return std::abs(m.mean() - 1); };
    const std::array fall = {3.0, 5.0, 5.0};
    for (std::size_t g = 0; g < distances.size(); ++g) {
        SCOPED_TRACE(distances[g]);
        for (const auto* side : {&dark, &bright})
            std::cout << "edge at " << distances[g] << " r, " << (side == &dark ? "dark" : "bright") << ": bias "
                      << (*side)[1][g].mean() - 1 << " against " << (*side)[0][g].mean() - 1 << ", deviation "
                      << deviation((*side)[1][g]) << " against " << deviation((*side)[0][g]) << '\n';
        if (g == 3) {
            EXPECT_LT(bias(dark[1][g]), 0.01 + 4 * dark[1][g].standard_error());
            continue;
        }
        EXPECT_LT(bias(dark[1][g]) * fall[g], bias(dark[0][g]));
        EXPECT_LT(bias(bright[1][g]) * 1.15, bias(bright[0][g]));
    }
}

}  // namespace
}  // namespace gib::bias_compensation_test
