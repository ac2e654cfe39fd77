// Density estimates at the limits of their formulas: no photons, too few, all in
// one place, without power.

#include "methods/parts/density/volume_estimate.h"
#include "tests/methods/parts/density/density_fixtures.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace gib::test::degenerate_photons_test {
namespace {

constexpr double pi_d = std::numbers::pi;
const Vec3 up(0, 0, 1);
/// Distances, kernel weights and the result are rounded to 24 bits.
constexpr double float_rounding = 16 * 0x1p-24;

/// The kernels of the papers, over the disc and over the ball (methods/parts/density/kernel.h,
/// methods/parts/density/volume_estimate.cpp): the profile of s = d / r over its own integral.
double kernel_on_disc(Kernel kernel, double d, double r) {
    const double s = d / r, area = pi_d * r * r;
    switch (kernel) {
        case Kernel::uniform:
            return 1 / area;
        case Kernel::cone:
            return 3 * std::max(1 - s, 0.0) / area;
        case Kernel::gaussian:
            return 2 * std::exp(-2 * s * s) / (1 - std::exp(-2.0)) / area;
        case Kernel::epanechnikov:
            return 2 * std::max(1 - s * s, 0.0) / area;
    }
    return 0;
}
double kernel_in_ball(Kernel kernel, double d, double r) {
    const double s = d / r, r3 = r * r * r;
    // The integral of s^2 exp(-2 s^2) from 0 to 1, by parts.
    const double moment = std::sqrt(pi_d / 2) * std::erf(std::numbers::sqrt2) / 8 - std::exp(-2.0) / 4;
    switch (kernel) {
        case Kernel::uniform:
            return 3 / (4 * pi_d * r3);
        case Kernel::cone:
            return 3 / (pi_d * r3) * std::max(1 - s, 0.0);
        case Kernel::gaussian:
            return std::exp(-2 * s * s) / (4 * pi_d * moment * r3);
        case Kernel::epanechnikov:
            return 15 / (8 * pi_d * r3) * std::max(1 - s * s, 0.0);
    }
    return 0;
}
using KernelFormula = double (*)(Kernel, double, double);

struct PhotonCase {
    std::string name;
    std::vector<Photon> photons;
    Vec3 query = Vec3::Zero();
    float radius = 0.5f;
};

/// The estimate by theory. If all photons are asked for, or fewer than k lie within `c.radius`, all within that
/// radius count. Otherwise the k - 1 nearest count and the k-th sets the radius
/// (methods/parts/density/density_estimate.h). If that radius is below `known`, the rounding of the place, all
/// photons within `known` count over the radius `known`.
double theory(const PhotonCase& c, Kernel kernel, std::size_t k, double known, KernelFormula weight) {
    std::vector<std::pair<double, double>> near;  // distance, power
    for (const Photon& photon : c.photons)
        if (const float d = (photon.p - c.query).norm(); d <= c.radius)
            near.emplace_back(static_cast<double>(d), static_cast<double>(photon.power()[0]));
    std::sort(near.begin(), near.end());
    std::size_t inside = near.size();
    double r = static_cast<double>(c.radius);
    if (k != all_photons && near.size() >= k) {
        inside = k - 1;
        r = near[inside].first;
        if (const double least = std::min(known, static_cast<double>(c.radius)); r <= least) {
            r = least;
            while (inside < near.size() && near[inside].first <= r)
                ++inside;
        }
    }
    double sum = 0;
    for (std::size_t i = 0; i < inside && r > 0; ++i)
        sum += near[i].second * weight(kernel, near[i].first, r);
    return sum;
}

Photon photon(float x, float y, float power = 1.f) { return photon_at(Vec3(x, y, 0), up, power); }

std::vector<Photon> copies(std::size_t n, const Photon& one) { return std::vector<Photon>(n, one); }

std::vector<Photon> on_a_line(std::size_t n, float power = 1.f) {
    std::vector<Photon> photons;
    for (std::size_t i = 0; i < n; ++i)
        photons.push_back(photon(0.0625f * static_cast<float>(i + 1), 0, power));
    return photons;
}

std::vector<PhotonCase> photon_cases() {
    constexpr std::size_t k = 4;
    auto half_dark = on_a_line(6);
    for (std::size_t i = 0; i < half_dark.size(); i += 2)
        half_dark[i].set_power(Color::Zero());
    auto focus_and_more = copies(40, photon(0, 0));
    for (std::size_t i = 0; i < 200; ++i)
        focus_and_more.push_back(photon(0.002f * static_cast<float>(i), 0.01f));
    return {
        {"None", {}},
        {"One", on_a_line(1)},
        {"OneFewerThanK", on_a_line(k - 1)},
        {"K", on_a_line(k)},
        {"OneMoreThanK", on_a_line(k + 1)},
        {"OnALine", on_a_line(100)},
        {"OnTheRim", {photon(0.5f, 0), photon(0, -0.5f)}},
        {"BeyondTheRadius", on_a_line(7), Vec3(-0.5f, 0, 0)},
        {"FarFromAny", on_a_line(100), Vec3(-1.5f, -1.5f, 0)},
        {"OfNoPower", on_a_line(7, 0.f)},
        {"HalfOfNoPower", half_dark},
        {"Of1e30", on_a_line(7, 1e30f)},
        {"Of1eMinus30", on_a_line(7, 1e-30f)},
        {"Of3e38", on_a_line(2, 3e38f), Vec3::Zero(), 1.5f},
        {"Duplicates", copies(10, photon(0.25f, 0))},
        {"AtThePoint", copies(10, photon(0, 0))},
        {"FewAtThePoint", copies(k - 1, photon(0, 0))},
        {"CloserThanRounding", copies(10, photon(1e-12f, 0))},
        {"AtThePointOfNoPower", copies(10, photon(0, 0, 0.f))},
        {"AtThePointAndBesideIt", focus_and_more},
        {"RadiusZeroAtThePoint", copies(10, photon(0, 0)), Vec3::Zero(), 0.f},
        {"RadiusZeroBesideThem", on_a_line(10), Vec3::Zero(), 0.f},
        {"RadiusBelowTheRootOfFloats", copies(2, photon(0, 0, 1e-20f)), Vec3::Zero(), 1e-23f},
    };
}

const LoadedScene& floor_scene() {
    static const LoadedScene scene = scene_of_shapes(white("rectangle", "<scale value='2'/>"));
    return scene;
}

/// The rounding of places on the floor [scene units].
double known_at(const Vec3& p) { return static_cast<double>(place_rounding(*floor_scene().scene, p)); }

/// A hit on the floor at exactly p, which a ray would meet only up to rounding.
SurfaceHit floor_at(const Vec3& p) {
    SurfaceHit hit = *floor_scene().scene->intersect(down_at(p.x(), p.y()));
    hit.p = p;
    return hit;
}

Reflected looked_up(const DensityEstimator& e, const PhotonMap& map, const SurfaceHit& hit) {
    RayQueries rays(*floor_scene().scene);
    return e.reflected_radiance(map, rays, hit, up, EyePath{100}, Sampler(PointSet::independent, 1, 0, 0), 0);
}

class DegeneratePhotons : public testing::TestWithParam<PhotonCase> {
protected:
    static void expect_theory(const PhotonCase& c, double found, double expected, double steepest) {
        double power = 0;
        for (const Photon& p : c.photons)
            power += static_cast<double>(p.power()[0]);
        // Rounded distances change a photon's weight by as much of the kernel's largest weight.
        EXPECT_NEAR(found, expected, float_rounding * (expected + steepest * power));
    }
};
INSTANTIATE_TEST_SUITE_P(Table, DegeneratePhotons, testing::ValuesIn(photon_cases()),
                         [](const auto& test) { return test.param.name; });

TEST_P(DegeneratePhotons, EstimateOnASurfaceIsWhatTheoryHas) {
    const PhotonCase& c = GetParam();
    const PhotonMap map(c.photons, 1);
    const SurfaceHit hit = floor_at(c.query);
    for (std::size_t kernel = 0; kernel < kernel_names.size(); ++kernel)
        for (const std::size_t k : {std::size_t{1}, std::size_t{4}, std::size_t{100}, all_photons})
            for (const DiscArea area : {DiscArea::surface, DiscArea::rejected, DiscArea::plain}) {
                SCOPED_TRACE(testing::Message()
                             << kernel_names[kernel] << " k " << k << " area " << static_cast<int>(area));
                const DensityEstimator e{static_cast<Kernel>(kernel), k, c.radius, area};
                const Reflected L = looked_up(e, map, hit);
                ASSERT_TRUE(L.between_surfaces.isFinite().all());
                EXPECT_TRUE(is_black(L.through_media));
                const double expected = theory(c, e.kernel, k, known_at(c.query), kernel_on_disc) / pi_d;
                const double r = static_cast<double>(L.radius);
                expect_theory(c, static_cast<double>(L.between_surfaces[0]), expected,
                              expected > 0 ? kernel_on_disc(e.kernel, 0, r) / pi_d : 0);
            }
}

const LoadedScene& empty_space() {
    static const LoadedScene scene = scene_of_shapes("");
    return scene;
}

Color scattered(const VolumeEstimator& e, const PhotonMap& map, const Vec3& p) {
    RayQueries rays(*empty_space().scene);
    const Sampler sampler(PointSet::independent, 1, 0, 0);
    NumberStream u(sampler);
    return e.scattered_radiance(map, rays, p, PhaseFunction{}, Vec3::UnitX(), EyePath{100}, u).radiance;
}

// The cases in a medium whose isotropic phase function is 1 / (4 pi).
TEST_P(DegeneratePhotons, EstimateInAMediumIsWhatTheoryHas) {
    PhotonCase c = GetParam();
    // 1 / r^3 of the smallest radius is beyond floats, whatever the light.
    if (c.name == "RadiusBelowTheRootOfFloats") c.radius = 1e-14f;
    const PhotonMap map(c.photons, 1);
    const double known = static_cast<double>(place_rounding(*empty_space().scene, c.query));
    for (std::size_t kernel = 0; kernel < kernel_names.size(); ++kernel)
        for (const std::size_t k : {std::size_t{1}, std::size_t{4}, std::size_t{100}, all_photons})
            for (const DiscArea area : {DiscArea::surface, DiscArea::plain}) {
                SCOPED_TRACE(testing::Message() << kernel_names[kernel] << " k " << k);
                const VolumeEstimator e{static_cast<Kernel>(kernel), k, c.radius, area};
                const Color L = scattered(e, map, c.query);
                ASSERT_TRUE(L.isFinite().all());
                const double expected = theory(c, e.kernel, k, known, kernel_in_ball) / (4 * pi_d);
                expect_theory(c, static_cast<double>(L[0]), expected, expected);
            }
}

}  // namespace
}  // namespace gib::test::degenerate_photons_test
