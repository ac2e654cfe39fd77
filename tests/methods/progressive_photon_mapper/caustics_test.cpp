// Methods that merge or look up photons with a shrinking radius: its law and its start, and caustics with closed forms.

#include "methods/parts/density/radius.h"
#include "methods/parts/photons/photon_map.h"
#include "methods/parts/photons/photon_walk.h"
#include "tests/support/moments.h"
#include "tests/support/scene_fixtures.h"

#include <array>
#include <functional>
#include <iostream>
#include <numeric>
#include <random>

namespace gib::test::caustics_test {
namespace {

TEST(ShrinkingRadius, IsTheProductOfTheLaw) {
    for (const double alpha : {0.3, 0.67, 0.9}) {
        const ShrinkingRadius radius(alpha);
        double product = 1;
        for (std::uint64_t passes = 0; passes < 1000; ++passes) {
            ASSERT_NEAR(std::pow(radius.on_surfaces(passes), 2) / product, 1, 1e-10);
            ASSERT_NEAR(std::pow(radius.in_media(passes), 3) / product, 1, 1e-10);
            const auto i = static_cast<double>(passes + 1);
            product *= (i + alpha) / (i + 1);
        }
    }
}

// Photons spread evenly have no bias: the radius is the last, of those whose discs double, whose discs hold 10 at most.
TEST(ShrinkingRadius, StartsAtTheDensityOfPhotons) {
    const auto scene =
        Scene(element("sensor", "orthographic", to_world(scale(0.3), look_at("0,0,0.5", "0,0,0")), box_film(32)),
              shape("rectangle", diffuse(0.5)), emitter("constant"))
            .load();
    constexpr std::uint64_t count = 100000;
    PhotonWalkResult walk = trace_photons(*scene.scene, PhotonMapKind::full, count, 3, 1);
    std::erase_if(walk.photons, [](const Photon& photon) { return photon.surface_normal().z() < 0; });
    const double lambda = static_cast<double>(walk.photons.size()) / 4;
    std::uint64_t rays = 0;
    const SeenPlaces places = seen_places(*scene.scene, {3, false, false}, 1, rays);
    EXPECT_EQ(places.on_surfaces.size(), 8192u);
    EXPECT_EQ(rays, 8192u);
    const double r = first_radius(walk.photons, 1, places.on_surfaces, 10, 2, scene.scene->diagonal());
    EXPECT_LT(std::numbers::pi * r * r * lambda, 10.3);
    EXPECT_GT(std::numbers::pi * r * r * lambda, 4.9);
}

// The density of photons is lambda (1 + a cos k x) with a = 1/2. A disc of radius r has the bias r^2 / 8 times its second
// derivative, whose mean square is (a lambda k^2)^2 / 2, and the variance lambda / (pi r^2). Over the passes with
// alpha = 2/3 three times the squared bias stands against the variance, and half of it is best:
// r^6 = 64 / (3 pi a^2 lambda k^4). The search finds it within the factor of one step either way.
TEST(ShrinkingRadius, StartsWhereBiasAndVarianceBalance) {
    for (const double waves : {2.0, 8.0})
        for (const auto& [count, passes] :
             {std::pair(20000u, 1.0), std::pair(200000u, 1.0), std::pair(200000u, 10.0)}) {
            const double k = 2 * std::numbers::pi * waves;
            std::mt19937_64 random(count);
            std::uniform_real_distribution<double> number(0, 1);
            std::vector<Photon> photons;
            std::vector<Vec3> places;
            while (photons.size() < count) {
                const Vec3 p(static_cast<float>(number(random)), static_cast<float>(number(random)), 0);
                if (number(random) * 1.5 < 1 + 0.5 * std::cos(k * double{p.x()}))
                    photons.emplace_back(p, Color::Ones(), Vec3::UnitZ(), Vec3::UnitZ(), 1);
            }
            for (int i = 0; i < 8192; ++i)
                places.emplace_back(static_cast<float>(0.1 + 0.8 * number(random)),
                                    static_cast<float>(0.1 + 0.8 * number(random)), 0.f);
            const double expected =
                std::pow(64 / (3 * std::numbers::pi * 0.25 * count / passes * std::pow(k, 4)), 1.0 / 6);
            const double r = first_radius(photons, passes, places, 1e9, 2, 1.4f);
            EXPECT_LT(r / expected, std::numbers::sqrt2)
                << waves << " waves, " << count << " photons, " << passes << " passes";
            EXPECT_GT(r / expected, 1 / std::numbers::sqrt2)
                << waves << " waves, " << count << " photons, " << passes << " passes";
        }
}

constexpr double reflectance = 0.5, intensity = 10, index = 1.5, light_height = 2;
constexpr int pixels = 24;

/// A floor in z = 0 under a point light, seen from `eye` above by a camera of parallel rays that covers a square of the
/// given side.
LoadedScene lit_floor(const std::string& more, int size = pixels, double side = 1, double light = light_height,
                      double eye = 1.8) {
    return Scene(element("sensor", "orthographic",
                         to_world(scale(side / 2), look_at(fmt::format("0,0,{}", eye), "0,0,0")), box_film(size)),
                 shape("rectangle", to_world(scale(3)), diffuse(reflectance)), point_light(0, 0, light, intensity),
                 more)
        .load();
}

/// A slab of glass around z, wider than the light that reaches what is seen.
std::string slab(double z, double thickness) {
    return shape("cube", to_world(scale(0.8, 0.8, thickness / 2), translate(0, 0, z)), bsdf("dielectric"));
}

/// Fresnel transmittance into or out of glass, for the cosine in air.
double transmittance(double cosine) {
    const double inside = std::sqrt(1 - (1 - cosine * cosine) / (index * index));
    const double s = (cosine - index * inside) / (cosine + index * inside);
    const double p = (index * cosine - inside) / (index * cosine + inside);
    return 1 - (s * s + p * p) / 2;
}

/// Radiance that the floor sends straight up through slabs of this total thickness, at the distance x from the axis, of
/// light that is refracted and never reflected. A ray that leaves the light at the angle t meets the floor at
/// x = (h - d) tan t + d tan t', with Snell's sin t' = sin t / index, so the irradiance is I sin t / (x dx/dt) times the
/// transmittance of all faces.
double radiance_under_glass(double x, double thickness, int slabs, double height = light_height) {
    const auto distance = [&](double t) {
        const double s = std::sin(t) / index;
        return (height - thickness) * std::tan(t) + thickness * s / std::sqrt(1 - s * s);
    };
    double lower = 0, upper = 1.2;
    for (int i = 0; i < 60; ++i)
        (distance((lower + upper) / 2) < x ? lower : upper) = (lower + upper) / 2;
    const double t = std::max(lower, 1e-6), h = 1e-5;
    const double slope = (distance(t + h) - distance(t - h)) / (2 * h);
    const double irradiance = intensity * std::sin(t) / (distance(t) * slope);
    return reflectance / std::numbers::pi * irradiance *
           std::pow(transmittance(std::cos(t)) * transmittance(1), 2 * slabs);
}

/// The mean of `value` over the pixels whose distance from the axis lies in this ring of two.
double ring_mean(int ring, const std::function<double(int pixel, double x)>& value) {
    double sum = 0, count = 0;
    for (int i = 0; i < pixels * pixels; ++i) {
        const double x = std::hypot((i % pixels + 0.5) / pixels - 0.5, (i / pixels + 0.5) / pixels - 0.5);
        if ((x < 0.3) != (ring == 0)) continue;
        sum += value(i, x);
        ++count;
    }
    return sum / count;
}

class HiddenSlabs : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Merging, HiddenSlabs, testing::Values("progressive_photon_mapper", "vcm"),
                         [](const auto& name) { return name.param; });

// The light passes the glass on its way to the floor and, seen from above, on its way back: no connection can make it.
TEST_P(HiddenSlabs, ShowTheLightOfTheClosedForm) {
    struct Case {
        std::string glass;
        double thickness;
        int slabs;
    };
    for (const Case& c : {Case{slab(0.6, 0.2), 0.2, 1}, Case{slab(0.4, 0.1) + slab(0.9, 0.15), 0.25, 2}}) {
        const auto scene = lit_floor(c.glass);
        const bool is_vcm = GetParam() == "vcm";
        const std::string label = GetParam() + (is_vcm ? " radius=0.01" : " caustic_photons=4e4") +
                                  " max_depth=" + std::to_string(2 + 4 * c.slabs);
        std::array<Moments, 2> rings;
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
            const Image image = *render(scene, label, is_vcm ? 1536 : 64, seed)[Component::caustic];
            for (int ring = 0; ring < 2; ++ring)
                rings[static_cast<std::size_t>(ring)].add(ring_mean(ring, [&](int pixel, double x) {
                    return double{image.at(static_cast<std::size_t>(pixel))[1]} /
                           radiance_under_glass(x, c.thickness, c.slabs);
                }));
        }
        for (const Moments& ring : rings) {
            EXPECT_NEAR(ring.mean(), 1, 0.01) << label << ", standard error " << ring.standard_error();
            EXPECT_LT(ring.standard_error(), 0.0055) << label;
        }
    }
}

constexpr std::array<int, 4> measured = {2, 6, 18, 54};  ///< numbers of passes N

/// The means over N passes of the radiance at the centre, by seed.
std::vector<std::array<double, 4>> runs_of(const LoadedScene& scene, const std::string& label, std::uint64_t seeds) {
    std::vector<std::array<double, 4>> runs;
    const ConfiguredMethod configured(MethodLabel::parse(label));
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        StageTimes stages;
        const auto run = configured.create({})->start(*scene.scene, seed, stages);
        std::array<double, 4>& means = runs.emplace_back();
        std::uint32_t pass = 0;
        for (std::size_t i = 0; i < measured.size(); ++i) {
            while (pass < static_cast<std::uint32_t>(measured[i]))
                run->advance(pass++);
            means[i] = mean_of(*run->image()[Component::caustic])[1];
        }
    }
    return runs;
}

/// Slope of y over x by least squares.
double slope_of(const std::array<double, 4>& x, const std::array<double, 4>& y) {
    const double mx = std::accumulate(x.begin(), x.end(), 0.0) / 4, my = std::accumulate(y.begin(), y.end(), 0.0) / 4;
    double xy = 0, xx = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        xy += (x[i] - mx) * (y[i] - my);
        xx += (x[i] - mx) * (x[i] - mx);
    }
    return xy / xx;
}

/// Slopes, over the logarithm of N, of the logarithms of bias and variance.
struct Slopes {
    double bias, variance;
};
Slopes slopes_of(const std::vector<std::array<double, 4>>& runs, double truth) {
    std::array<double, 4> log_n, log_bias, log_variance;
    for (std::size_t i = 0; i < 4; ++i) {
        Moments moments;
        for (const auto& run : runs)
            moments.add(run[i]);
        log_n[i] = std::log(measured[i]);
        log_bias[i] = std::log(std::abs(moments.mean() - truth));
        log_variance[i] = 2 * std::log(moments.standard_error());
    }
    return {slope_of(log_n, log_bias), slope_of(log_n, log_variance)};
}

/// The same by the theory: the bias of the mean is the mean of r_i^2, its variance the sum of 1 / r_i^2 over N^2.
Slopes slopes_by_theory(double alpha) {
    std::array<double, 4> log_n, log_bias, log_variance;
    double r2 = 1, bias = 0, variance = 0;
    int pass = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        for (; pass < measured[i]; r2 *= (pass + alpha) / (pass + 1)) {
            ++pass;
            bias += r2;
            variance += 1 / r2;
        }
        log_n[i] = std::log(pass);
        log_bias[i] = std::log(bias / pass);
        log_variance[i] = std::log(variance / (double(pass) * pass));
    }
    return {slope_of(log_n, log_bias), slope_of(log_n, log_variance)};
}

/// Expects the slopes of the theory within 99.9 % intervals by the delete-one jackknife over seeds.
void expect_theory(const LoadedScene& scene, const std::string& label, double truth, double alpha) {
    const auto runs = runs_of(scene, label, 48);
    const Slopes all = slopes_of(runs, truth), theory = slopes_by_theory(alpha);
    double bias = 0, variance = 0;
    for (std::size_t left_out = 0; left_out < runs.size(); ++left_out) {
        auto others = runs;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(left_out));
        const Slopes without = slopes_of(others, truth);
        bias += std::pow(without.bias - all.bias, 2);
        variance += std::pow(without.variance - all.variance, 2);
    }
    const double factor = static_cast<double>(runs.size() - 1) / static_cast<double>(runs.size());
    const double of_bias = 3.5 * std::sqrt(factor * bias), of_variance = 3.5 * std::sqrt(factor * variance);
    EXPECT_NEAR(all.bias, theory.bias, of_bias) << label;
    EXPECT_NEAR(all.variance, theory.variance, of_variance) << label;
    EXPECT_LT(of_bias, 0.2) << label;
    EXPECT_LT(of_variance, 0.5) << label;
    std::cout << label << ": bias " << all.bias << " +- " << of_bias << " (" << theory.bias << "), variance "
              << all.variance << " +- " << of_variance << " (" << theory.variance << ")\n";
}

std::string progressive(double alpha) {
    return "progressive_photon_mapper max_depth=6 caustic_photons=2000 caustic_radius=0.05 alpha=" +
           std::to_string(alpha);
}

TEST(ErrorOfProgressivePhotonMapping, FallsWithoutAFloorUnderGlass) {
    const auto scene = lit_floor(slab(0.6, 0.2), 1, 0.01, 1.1);
    for (const double alpha : {0.5, 0.8})
        expect_theory(scene, progressive(alpha), radiance_under_glass(0, 0.2, 1, 1.1), alpha);
}

// A mirror lies above the light, whose image shines from a height of 1.
TEST(ErrorOfProgressivePhotonMapping, FallsWithoutAFloorUnderAMirror) {
    const auto scene = lit_floor(shape("rectangle", to_world(scale(0.3), rotate('x', 180), translate(0, 0, 0.75)),
                                       bsdf("conductor", text("material", "none"))),
                                 1, 0.01, 0.5, 0.4);
    for (const double alpha : {0.5, 0.8})
        expect_theory(scene, progressive(alpha), reflectance / std::numbers::pi * intensity, alpha);
}

}  // namespace
}  // namespace gib::test::caustics_test
