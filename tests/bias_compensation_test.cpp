#include "methods/bias_compensation.h"

#include "tests/density_fixtures.h"

#include <iostream>

namespace gib {
namespace {

using test::down_at;
using test::Moments;
using test::relative_estimates;
using test::scene_of_shapes;
using test::spread;
using test::white;

constexpr std::size_t n = 40000, k = 500;
const float radius = 2.f * std::sqrt(static_cast<float>(k) / (pi * static_cast<float>(n)));

/// Photons on [-1, 1]^2 of density 1 where x < 0 and `beyond` elsewhere, all of the same power or, with
/// `spread_powers`, of powers 0.2 and 1.8.
std::vector<Photon> step(float beyond, bool spread_powers, std::uint64_t seed) {
    std::vector<Photon> photons;
    const auto at = [](float x) { return Vec3(x, -1, 0); };
    const Vec3 up(0, 0, 1);
    spread(photons, n / 2, at(-1), Vec3(1, 0, 0), Vec3(0, 2, 0), up, 2.f, seed);
    const auto more = static_cast<std::size_t>(beyond * n / 2);
    spread(photons, more, at(0), Vec3(1, 0, 0), Vec3(0, 2, 0), up, 2.f * beyond, seed + 100000);
    if (spread_powers)
        for (std::size_t i = 0; i < photons.size(); ++i)
            photons[i].power *= i % 2 == 0 ? 0.2f : 1.8f;
    return photons;
}

/// By compensation (off, on) and by distance from the step, in radii of k photons.
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

TEST(BiasCompensation, OnEvenPhotonsTheMeanStaysAndTheNoiseHardlyGrows) {
    for (bool spread_powers : {false, true}) {
        const auto found = estimates(1.f, spread_powers, {1.3f, 3.8f, 6.3f}, 400);
        for (std::size_t g = 0; g < 3; ++g)
            std::cout << "even: mean " << found[1][g].mean() << " +- " << found[1][g].standard_error() << ", deviation "
                      << deviation(found[1][g]) << " against " << deviation(found[0][g]) << '\n';
    }
}

TEST(BiasCompensation, NearAnEdgeTheBiasFalls) {
    const std::vector<float> distances = {0.2f, 0.4f, 0.7f, 3.f};
    for (float beyond : {0.1f, 10.f}) {
        const auto found = estimates(beyond, false, distances, 60);
        for (std::size_t g = 0; g < distances.size(); ++g)
            std::cout << "edge: " << distances[g] << " r, beyond " << beyond << ": bias " << found[1][g].mean() - 1
                      << " against " << found[0][g].mean() - 1 << ", deviation " << deviation(found[1][g])
                      << " against " << deviation(found[0][g]) << '\n';
    }
}

}  // namespace
}  // namespace gib
