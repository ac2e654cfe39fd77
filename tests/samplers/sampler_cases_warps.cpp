// The test cases of the maps from the unit square in common/sampling/warp.h, of choices among
// items, and of the film's filters.

#include "common/media/phase.h"
#include "common/sampling/warp.h"
#include "common/scene/sensor.h"
#include "tests/samplers/sampler_cases.h"

#include <fmt/format.h>
#include <numeric>

namespace gib::test {

namespace {

constexpr double pi_d = std::numbers::pi;

SamplerCase disk_case() {
    return plane_case(
        "warp: disk", {{-1, 1}, {-1, 1}}, [](const RandomNumbers& r) { return square_to_disk(r.u); },
        // Points at the rim may round outwards.
        [](const Vec2d& p) { return p.squaredNorm() <= 1 + 1e-6 ? 1 / pi_d : 0.0; });
}

SamplerCase triangle_case() {
    return plane_case(
        "warp: triangle", {{0, 1}, {0, 1}}, [](const RandomNumbers& r) { return square_to_triangle(r.u); },
        [](const Vec2d& p) { return p.sum() <= 1 + 1e-6 ? 2.0 : 0.0; });
}

SamplerCase cosine_case() {
    return sphere_case(
        "warp: cosine hemisphere", SphereChart(),
        [](const RandomNumbers& r) -> std::optional<SampledDirection> {
            const Vec3 w = square_to_cosine_hemisphere(r.u);
            return SampledDirection{w, static_cast<double>(cosine_hemisphere_pdf(w.z()))};
        },
        [](const Vec3& w) { return static_cast<double>(cosine_hemisphere_pdf(w.z())); });
}

SamplerCase sphere_warp_case() {
    return sphere_case(
        "warp: sphere", SphereChart(),
        [](const RandomNumbers& r) -> std::optional<SampledDirection> {
            return SampledDirection{square_to_sphere(r.u), 1 / (4 * pi_d)};
        },
        [](const Vec3&) { return 1 / (4 * pi_d); });
}

/// The axis of the chart is the peak of the phase function.
SamplerCase phase_case(const std::string& name, const PhaseFunction& phase) {
    const Vec3 wo = Vec3(0.3f, -0.5f, 0.8f).normalized();
    const Vec3 peak = phase.g < 0.f ? wo : Vec3(-wo);
    return sphere_case(
        "phase: " + name, SphereChart(peak.cast<double>()),
        [=](const RandomNumbers& r) -> std::optional<SampledDirection> {
            const Vec3 wi = phase.sample(wo, r.u);
            return SampledDirection{wi, static_cast<double>(phase.value(wo, wi))};
        },
        [=](const Vec3& wi) { return static_cast<double>(phase.value(wo, wi)); });
}

SamplerCase phase_case(float g) { return phase_case(fmt::format("hg g={}", g), PhaseFunction{g}); }

SamplerCase cone_case(double one_minus_cos_max) {
    const SphereChart chart;
    const auto pdf = [chart, one_minus_cos_max](const Vec3& w) {
        // Directions at the rim may round outwards.
        const double versine = chart.point(w.cast<double>()).x();
        return versine <= one_minus_cos_max * (1 + 1e-5) ? 1 / (2 * pi_d * one_minus_cos_max) : 0.0;
    };
    SamplerCase test = sphere_case(
        fmt::format("warp: cone 1-cos={}", one_minus_cos_max), chart,
        [one_minus_cos_max](const RandomNumbers& r) -> std::optional<SampledDirection> {
            return SampledDirection{square_to_cone(r.u, static_cast<float>(one_minus_cos_max)),
                                    1 / (2 * pi_d * one_minus_cos_max)};
        },
        pdf);
    test.domain = SphereChart::domain({one_minus_cos_max});
    return test;
}

/// Density linear along x.
SamplerCase linear_case(double f0, double f1) {
    return plane_case(
        fmt::format("warp: linear {} {}", f0, f1), {{0, 1}, {0, 1}},
        [f0, f1](const RandomNumbers& r) {
            return Vec2(static_cast<float>(sample_linear(static_cast<double>(r.u.x()), f0, f1)), r.u.y());
        },
        [f0, f1](const Vec2d& p) { return std::max(f0 + (f1 - f0) * p.x(), 1e-9) * 2 / (f0 + f1); });
}

/// A ring of directions around an axis; x is the polar angle as a share of the ring's width.
SamplerCase polar_ramp_case(const std::string& name, const PolarRamp& ramp) {
    const double width = ramp.theta1 - ramp.theta0, integral = ramp.integral();
    return plane_case(
        "warp: polar ramp " + name, {{0, 1}, {0, 1}},
        [ramp, width](const RandomNumbers& r) {
            const double theta = ramp.sample(static_cast<double>(r.u.x()));
            return Vec2(static_cast<float>((theta - ramp.theta0) / width), r.u.y());
        },
        [ramp, width, integral](const Vec2d& p) {
            const double f = ramp.f0 + (ramp.f1 - ramp.f0) * p.x();
            return std::max(f * std::sin(ramp.theta0 + p.x() * width) * width / integral, 1e-9);
        });
}

/// Item i covers the interval [i, i + 1) of the x axis; the rest of the random number is the position within it.
SamplerCase discrete_case(const std::string& name, const std::vector<double>& weights) {
    const DiscreteDistribution items(weights);
    std::vector<double> breaks(weights.size() + 1);
    std::iota(breaks.begin(), breaks.end(), 0.0);
    SamplerCase test;
    test.name = "choice: " + name;
    test.domain = {breaks, {0, 1}};
    test.sample = [items](const RandomNumbers& r) -> std::optional<Sampled> {
        const auto choice = items.sample(r.choice.x());
        const Vec2d point(static_cast<double>(choice.index) + static_cast<double>(choice.u), r.u.x());
        return Sampled{point, static_cast<double>(choice.probability),
                       static_cast<double>(items.probability(choice.index))};
    };
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    test.pdf = [weights, sum](const Vec2d& p) { return weights.at(static_cast<std::size_t>(p.x())) / sum; };
    return test;
}

SamplerCase filter_case(const std::string& name, const ReconstructionFilter& filter, double radius,
                        const std::function<double(double)>& density) {
    return plane_case(
        "filter: " + name, {{-radius, 0, radius}, {-radius, 0, radius}},
        [filter](const RandomNumbers& r) { return filter.sample(r.u); },
        [density](const Vec2d& p) { return density(p.x()) * density(p.y()); });
}

SamplerCase gaussian_filter_case(double stddev) {
    const double radius = 4 * stddev, tail = std::exp(-8.0);
    const double integral = std::sqrt(2 * pi_d) * stddev * std::erf(4 / std::sqrt(2.0)) - 2 * radius * tail;
    // The sampled filter is a table of 512 steps, so the sampled density is not 0 at the
    // very rim, where the filter is.
    const auto density = [=](double x) {
        return std::max(std::exp(-x * x / (2 * stddev * stddev)) - tail, 1e-9) / integral;
    };
    return filter_case(fmt::format("gaussian stddev={}", stddev),
                       ReconstructionFilter::gaussian(static_cast<float>(stddev)), radius, density);
}

}  // namespace

std::vector<SamplerCase> warp_cases() {
    return {
        disk_case(),
        triangle_case(),
        cosine_case(),
        sphere_warp_case(),
        phase_case(0.f),
        phase_case(0.5f),
        phase_case(-0.85f),
        phase_case(0.99f),
        phase_case(PhaseFunction::largest_g),
        phase_case("rayleigh", PhaseFunction{.model = PhaseFunction::Model::rayleigh}),
        cone_case(1.9),
        cone_case(0.5),
        cone_case(1e-3),
        cone_case(1e-6),
        linear_case(0, 1),
        linear_case(1, 0),
        linear_case(3, 3.01),
        polar_ramp_case("from the pole", {0, 0.5, 1, 0}),
        polar_ramp_case("narrow", {1, 1.001, 0.2, 1}),
        polar_ramp_case("to the other pole", {2.5, pi_d, 0, 1}),
        discrete_case("two", {3, 1}),
        discrete_case("zeros", {0, 5, 0, 0, 1, 2, 0}),
        discrete_case("range of 1e5", {1e-2, 1, 10, 100, 1000}),
        filter_case("box 0.5", ReconstructionFilter::box(0.5f), 0.5, [](double) { return 1.0; }),
        filter_case("box 2", ReconstructionFilter::box(2.f), 2, [](double) { return 0.25; }),
        filter_case("tent 1.25", ReconstructionFilter::tent(1.25f), 1.25,
                    [](double x) { return std::max(1.25 - std::abs(x), 1e-9) / sqr(1.25); }),
        gaussian_filter_case(0.5),
        gaussian_filter_case(1.5),
    };
}

}  // namespace gib::test
