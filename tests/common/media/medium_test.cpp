// Tests of media against closed forms: phase functions, values on grids, free flights and transmittance.

#include "common/media/medium.h"

#include "common/core/parallel.h"
#include "tests/support/moments.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <numbers>

namespace gib::test::medium_test {
namespace {

constexpr double pi_d = std::numbers::pi;
/// Means are tested at this many standard errors: with some 100 comparisons in this file, a
/// false alarm for 1 in 10,000 seeds.
constexpr double sigmas = 5;

/// Moments of f over 100,000 samplers of this seed.
template <typename F>
Moments moments_over(std::uint64_t seed, const F& f) {
    Moments moments;
    for (std::uint32_t i = 0; i < 100000; ++i)
        moments.add(double{f(Sampler(PointSet::independent, seed, i, 0))});
    return moments;
}

TEST(PhaseFunction, HasItsMeanCosine) {
    const Vec3 wo = Vec3(1, -2, 0.5f).normalized();
    for (float g : {-0.95f, -0.4f, 0.f, 0.3f, 0.99f}) {
        const Moments cosine =
            moments_over(1, [&](const Sampler& u) { return -wo.dot(PhaseFunction{g}.sample(wo, u.get_2d(0))); });
        EXPECT_NEAR(cosine.mean(), static_cast<double>(g), sigmas * cosine.standard_error()) << g;
    }
}

TEST(PhaseFunction, IsIsotropicWithoutAMeanCosine) {
    EXPECT_FLOAT_EQ(PhaseFunction{0.f}.value(Vec3::UnitX(), Vec3::UnitZ()), 0.25f * inv_pi);
    EXPECT_FLOAT_EQ(PhaseFunction{0.f}.value(Vec3::UnitX(), -Vec3::UnitX()), 0.25f * inv_pi);
}

TEST(PhaseFunction, OfSmallParticlesIsRayleighs) {
    const PhaseFunction rayleigh{.model = PhaseFunction::Model::rayleigh};
    const Vec3 wo = Vec3(1, 2, -2) / 3, across = Vec3(2, 1, 2) / 3;
    EXPECT_NEAR(rayleigh.value(wo, across), 3 / (16 * pi_d), 1e-7);
    EXPECT_NEAR(rayleigh.value(wo, wo), 6 / (16 * pi_d), 1e-7);
    EXPECT_NEAR(rayleigh.value(wo, -wo), 6 / (16 * pi_d), 1e-7);
    // The integral of 3 (1 + c^2) c^2 / 8 over the cosine c is 2/5.
    const Moments squared =
        moments_over(1, [&](const Sampler& u) { return sqr(wo.dot(rayleigh.sample(wo, u.get_2d(0)))); });
    EXPECT_NEAR(squared.mean(), 0.4, sigmas * squared.standard_error());
}

TEST(PhaseFunction, PrefersToGoOnForwards) {
    const Vec3 wo = Vec3::UnitX();
    EXPECT_GT(PhaseFunction{0.5f}.value(wo, -wo), PhaseFunction{0.5f}.value(wo, wo));
    // Henyey and Greenstein's function is (1 - g^2) / (4 pi (1 -+ g)^3) forwards and backwards.
    EXPECT_NEAR(PhaseFunction{0.5f}.value(wo, -wo), 0.75 / (4 * pi_d * 0.125), 1e-6);
    EXPECT_NEAR(PhaseFunction{0.5f}.value(wo, wo), 0.75 / (4 * pi_d * 3.375), 1e-6);
}

/// A grid of n voxels along x that covers x in [at, at + length].
GridVolume layers(const std::vector<float>& values, int channels, double at, double length,
                  VolumeFilter filter = VolumeFilter::trilinear) {
    GridVolume::Data data{{static_cast<int>(values.size()) / channels, 1, 1}, channels, values, {}};
    const Eigen::Affine3d from_grid = Eigen::Translation3d(at, -1, -1) * Eigen::Scaling(length, 2.0, 2.0);
    return {std::move(data), from_grid.inverse(), filter, Wrap::clamp};
}

TEST(GridVolume, InterpolatesBetweenTheCentresOfVoxels) {
    const GridVolume volume = layers({1, 3, 2}, 1, 10, 6);  // centres at 11, 13, 15
    const auto at = [&](float x) { return volume.at(Vec3(x, 0, 0))[1]; };
    EXPECT_FLOAT_EQ(at(11), 1);
    EXPECT_FLOAT_EQ(at(12), 2);
    EXPECT_FLOAT_EQ(at(13), 3);
    EXPECT_FLOAT_EQ(at(14.5f), 2.25f);
    EXPECT_FLOAT_EQ(at(10.2f), 1);
    EXPECT_FLOAT_EQ(at(20), 2);
    EXPECT_FLOAT_EQ(volume.lowest()[0], 1);
    EXPECT_FLOAT_EQ(volume.highest()[0], 3);
    const GridVolume steps = layers({1, 3, 2}, 1, 10, 6, VolumeFilter::nearest);
    EXPECT_FLOAT_EQ(steps.at(Vec3(11.9f, 0, 0))[0], 1);
    EXPECT_FLOAT_EQ(steps.at(Vec3(12.1f, 0, 0))[0], 3);
}

TEST(GridVolume, RepeatsAndMirrors) {
    const auto wrapped = [](Wrap wrap, float x) {
        const GridVolume::Data data{{3, 1, 1}, 1, {1, 3, 2}, {}};
        return GridVolume(data, Eigen::Affine3d::Identity(), VolumeFilter::nearest, wrap).at(Vec3(x, 0, 0))[0];
    };
    EXPECT_FLOAT_EQ(wrapped(Wrap::repeat, 1.1f), 1);
    EXPECT_FLOAT_EQ(wrapped(Wrap::repeat, -0.1f), 2);
    EXPECT_FLOAT_EQ(wrapped(Wrap::mirror, 1.1f), 2);
    EXPECT_FLOAT_EQ(wrapped(Wrap::mirror, 1.5f), 3);
    EXPECT_FLOAT_EQ(wrapped(Wrap::mirror, -0.1f), 1);
    EXPECT_FLOAT_EQ(wrapped(Wrap::clamp, 1.1f), 2);
}

/// A medium on a stretch along x in closed form: the optical depth up to x, and the extinction and the albedo at x.
struct Stretch {
    std::string name;
    Medium medium;
    std::function<Color(double)> depth, extinction, albedo;
};

std::vector<Stretch> stretches() {
    const Color sigma(0.5f, 1.5f, 3.f), grey(0.8f, 0.8f, 0.8f), albedo(0.9f, 0.5f, 0.2f);
    const auto constant = [](const Color& c) { return [c](double) { return c; }; };
    const auto times_x = [](const Color& c) { return [c](double x) { return Color(c * static_cast<float>(x)); }; };
    // The extinction from 0 to 2 is 0.2 up to the first centre at 0.5, linear up to 2.2
    // at 1.5, and 2.2 from there on.
    const auto ramp = [](double x) { return static_cast<float>(0.2 + 2 * std::clamp(x - 0.5, 0.0, 1.0)); };
    const auto ramp_depth = [](double x) {
        const double y = std::clamp(x - 0.5, 0.0, 1.0);
        return static_cast<float>(0.2 * x + y * y + 2 * std::max(x - 1.5, 0.0));
    };
    std::vector<Stretch> all;
    const auto add = [&](const std::string& name, const GridVolume& extinction, float scale, const Color& a) {
        const Color c = scale * extinction.highest();
        all.push_back({name, Medium(extinction, scale, GridVolume(a), {}), times_x(c), constant(c), constant(a)});
    };
    const auto add_ramp = [&](const std::string& name, const std::vector<float>& ends, const Color& tint, double base,
                              const Color& a) {
        const int channels = static_cast<int>(ends.size()) / 2;
        all.push_back({name, Medium(layers(ends, channels, 0, 2), 1.f, GridVolume(a), {}),
                       [=](double x) { return Color(static_cast<float>(base * x) + tint * ramp_depth(x)); },
                       [=](double x) { return Color(static_cast<float>(base) + tint * ramp(x)); }, constant(a)});
    };
    add("coloured", GridVolume(sigma), 1.f, albedo);
    add("scaled", GridVolume(sigma), 0.5f, grey);
    add("one channel passes", GridVolume(Color(0, 1, 2)), 1.f, grey);
    add("absorbing", GridVolume(sigma), 1.f, Color::Zero());
    add_ramp("ramp", {0.2f, 2.2f}, Color::Ones(), 0, albedo);
    add_ramp("coloured ramp", {0.2f, 0.1f, 0.02f, 2.2f, 1.1f, 0.22f}, Color(1.f, 0.5f, 0.1f), 0, albedo);
    add_ramp("absorbing ramp", {0.2f, 2.2f}, Color::Ones(), 0, Color::Zero());
    // From 8 to 16 in the same way. Much of the light that passes the first 0.3 survives roulette.
    add_ramp("dense ramp", {8.f, 16.f}, Color::Constant(4), 7.2, albedo);
    add("grid of one value", layers({1.5f, 1.5f, 1.5f}, 1, 0, 2), 2.f, grey);
    return all;
}

// Compares means over flights with integrals in each channel: the transmitted light, and the scattered light weighted
// by 1 and by its place.
TEST(Medium, FlightsHaveTheMeansOfTheIntegrals) {
    constexpr double length = 2;
    const Color before(0.5f, 1.f, 3.f);
    for (const Stretch& stretch : stretches()) {
        std::array<Moments, 3> passed, scattered, place;
        for (std::uint32_t i = 0; i < 200000; ++i) {
            const Sampler sampler(PointSet::independent, 2, i, 0);
            NumberStream u(sampler);
            Color throughput = before;
            const auto t =
                stretch.medium.sample_flight(Vec3::Zero(), Vec3::UnitX(), static_cast<float>(length), u, throughput);
            for (std::size_t c = 0; c < 3; ++c) {
                const auto weight = static_cast<double>((throughput / before)[static_cast<int>(c)]);
                passed[c].add(t ? 0 : weight);
                scattered[c].add(t ? weight : 0);
                place[c].add(t ? weight * double{*t} : 0);
            }
        }
        for (int c = 0; c < 3; ++c) {
            const auto at = [c](const auto& f, double x) { return static_cast<double>(f(x)[c]); };
            double sum = 0, first = 0;
            constexpr int steps = 20000;
            for (int i = 0; i < steps; ++i) {
                const double x = (i + 0.5) * length / steps;
                const double light =
                    at(stretch.extinction, x) * at(stretch.albedo, x) * std::exp(-at(stretch.depth, x));
                sum += light * length / steps;
                first += light * x * length / steps;
            }
            const auto k = static_cast<std::size_t>(c);
            const auto expect = [&](const char* what, const Moments& found, double value) {
                EXPECT_NEAR(found.mean(), value, sigmas * found.standard_error() + 2e-6)
                    << stretch.name << ", " << what << ", channel " << c;
            };
            expect("passed", passed[k], std::exp(-at(stretch.depth, length)));
            expect("scattered", scattered[k], sum);
            expect("place", place[k], first);
        }
    }
}

// The probability of an event is the optical depth, here 1e-11, so none of 5e7 flights has an event (alpha = 5e-4).
// If flights were sampled by a single number of 24 bits, three would.
TEST(Medium, ThinOnesScatterAsRarelyAsTheyShould) {
    const Medium medium(GridVolume(Color::Constant(1e-11f)), 1.f, GridVolume(Color::Ones()), {});
    std::atomic<int> events = 0;
    parallel_blocks(50000000, 1 << 16, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            const Sampler sampler(PointSet::independent, 5, i, 0);
            NumberStream u(sampler);
            Color throughput = Color::Ones();
            if (medium.sample_flight(Vec3::Zero(), Vec3::UnitX(), 1.f, u, throughput)) ++events;
        }
    });
    EXPECT_EQ(events, 0);
}

TEST(Medium, TransmittanceHasItsMean) {
    for (const Stretch& stretch : stretches())
        for (double length : {0.3, 2.0}) {
            std::array<Moments, 3> moments;
            for (std::uint32_t i = 0; i < 100000; ++i) {
                const Sampler sampler(PointSet::independent, 3, i, 0);
                NumberStream u(sampler);
                const Color t =
                    stretch.medium.transmittance(Vec3::Zero(), Vec3::UnitX(), static_cast<float>(length), u);
                for (std::size_t c = 0; c < 3; ++c)
                    moments[c].add(static_cast<double>(t[static_cast<int>(c)]));
            }
            for (int c = 0; c < 3; ++c) {
                const Moments& found = moments[static_cast<std::size_t>(c)];
                EXPECT_NEAR(found.mean(), std::exp(-static_cast<double>(stretch.depth(length)[c])),
                            sigmas * found.standard_error() + 1e-6)
                    << stretch.name << ' ' << length << ' ' << c;
            }
        }
}

// At every place of a stretch, the estimates of the light that reaches it have the mean exp(-depth): the one of the whole
// stretch, and the power of beams that hold the place.
TEST(Medium, BeamsReachEveryPlaceInProportionToTheTransmittance) {
    const Color before(0.5f, 1.f, 3.f);
    constexpr float length = 2;
    for (const Stretch& stretch : stretches())
        for (const double place : {0.3, 1.9}) {
            std::array<Moments, 3> transmitted, beams;
            const auto at = static_cast<float>(place);
            for (std::uint32_t i = 0; i < 50000; ++i) {
                const Sampler sampler(PointSet::independent, 4, i, 0);
                NumberStream u(sampler);
                const Color t = stretch.medium.transmittance_along(Vec3::Zero(), Vec3::UnitX(), length, u).at(at);
                Color power = before;
                const auto reach = stretch.medium.sample_reach(Vec3::Zero(), Vec3::UnitX(), length, u, power);
                const bool holds = reach && reach->begin <= at && at < reach->end;
                const Color here =
                    holds ? Color(stretch.medium.power_along(power, at - reach->begin) / before) : Color(Color::Zero());
                for (std::size_t c = 0; c < 3; ++c) {
                    transmitted[c].add(static_cast<double>(t[static_cast<int>(c)]));
                    beams[c].add(static_cast<double>(here[static_cast<int>(c)]));
                }
            }
            for (std::size_t c = 0; c < 3; ++c)
                for (const Moments* found : {&transmitted[c], &beams[c]})
                    EXPECT_NEAR(found->mean(),
                                std::exp(-static_cast<double>(stretch.depth(place)[static_cast<int>(c)])),
                                sigmas * found->standard_error() + 1e-6)
                        << stretch.name << ' ' << place << ' ' << c << (found == &beams[c] ? " beams" : "");
        }
}

// The medium of a grid ends with the grid's cube, from whichever side a ray comes.
TEST(Medium, OnAGridEndsWithTheGrid) {
    const Medium medium(layers({1, 1}, 1, 3, 2), 1.f, GridVolume(Color::Ones()), {});
    const Sampler sampler(PointSet::independent, 1, 0, 0);
    const auto passes = [&](const Vec3& from, const Vec3& w) {
        NumberStream u(sampler);
        return (medium.transmittance(from, w, infinity, u) == 1.f).all();
    };
    EXPECT_TRUE(passes(Vec3(0, 0, 0), -Vec3::UnitX()));
    EXPECT_TRUE(passes(Vec3(0, 2, 0), Vec3::UnitX()));
    EXPECT_TRUE(passes(Vec3(0, 0, 0), Vec3::UnitY()));
    const Moments through = moments_over(4, [&](const Sampler& own) {
        NumberStream u(own);
        return medium.transmittance(Vec3(9, 0, 0), -Vec3::UnitX(), infinity, u)[0];
    });
    EXPECT_NEAR(through.mean(), std::exp(-2.0), sigmas * through.standard_error());
}

// An ulp of the distance to the far grid is longer than a flight between collisions.
TEST(Medium, OfAFarGridIsThatOfANearOne) {
    const Medium medium(layers({1, 1000}, 1, 0, 2, VolumeFilter::nearest), 1.f, GridVolume(Color::Ones()), {});
    for (const float distance : {0.f, 1e5f}) {
        Moments through, scattered;
        for (std::uint32_t i = 0; i < 20000; ++i) {
            const Sampler own(PointSet::independent, 5, i, 0);
            NumberStream u(own);
            const Vec3 from(0.5f, -1 - distance, 0);
            through.add(static_cast<double>(medium.transmittance(from, Vec3::UnitY(), infinity, u)[0]));
            Color throughput = Color::Ones();
            scattered.add(medium.sample_flight(from, Vec3::UnitY(), infinity, u, throughput) ? 1 : 0);
        }
        EXPECT_NEAR(through.mean(), std::exp(-2.0), sigmas * through.standard_error()) << distance;
        EXPECT_NEAR(scattered.mean(), 1 - std::exp(-2.0), sigmas * scattered.standard_error()) << distance;
    }
}

}  // namespace
}  // namespace gib::test::medium_test
