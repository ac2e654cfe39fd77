// One irradiance record: its irradiance and gradients against closed forms.
#include "methods/parts/gathering/irradiance_record.h"

#include "common/sampling/sampler.h"

#include <gtest/gtest.h>

#include <functional>

namespace gib::irradiance_record_test {
namespace {

/// The corners, in order as seen from the front, of a rectangle of even radiance 1.
using Rectangle = std::array<Vec3d, 4>;

/// Irradiance due to a polygon of radiance 1 that lies entirely above the horizon of n. Source:
/// Lambert 1760, as in Baum et al. 1989, "Improving Radiosity Solutions Through the Use of
/// Analytically Determined Form-Factors", equation 8.
double lambert(const Rectangle& corners, const Vec3d& p, const Vec3d& n) {
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d a = corners[i] - p, b = corners[(i + 1) % corners.size()] - p;
        const Vec3d normal = a.cross(b);
        sum += std::atan2(normal.norm(), a.dot(b)) * normal.normalized().dot(n);
    }
    return std::abs(sum) / 2;
}

std::optional<double> hit_distance(const Rectangle& corners, const Vec3d& p, const Vec3d& w) {
    const Vec3d a = corners[1] - corners[0], b = corners[3] - corners[0], n = a.cross(b);
    const double t = (corners[0] - p).dot(n) / w.dot(n);
    const Vec3d at = p + t * w - corners[0];
    const double u = at.dot(a) / a.squaredNorm(), v = at.dot(b) / b.squaredNorm();
    return t > 0 && u >= 0 && u <= 1 && v >= 0 && v <= 1 ? std::optional(t) : std::nullopt;
}

using Scene = std::function<HemisphereSample(const Vec3d& p, const Vec3d& w)>;

IrradianceRecord record_of(const Scene& seen, const Vec3& p, const Vec3& n, const HemisphereStrata& strata,
                           std::uint64_t seed) {
    const Frame frame(n);
    const Sampler sampler(PointSet::independent, seed, 0, 0);
    std::vector<HemisphereSample> samples;
    for (int i = 0; i < strata.count(); ++i) {
        const Vec3 w = frame.to_world(strata.direction_local(i, sampler.get_2d(static_cast<std::uint32_t>(i))));
        samples.push_back(seen(p.cast<double>(), w.cast<double>().normalized()));
    }
    return irradiance_record(p, frame, strata, samples);
}

const Rectangle lamp = {Vec3d(0.2, -0.3, 1), Vec3d(1.1, -0.3, 1.2), Vec3d(1.1, 0.7, 1.2), Vec3d(0.2, 0.7, 1)};

HemisphereSample bright_lamp(const Vec3d& p, const Vec3d& w) {
    const auto t = hit_distance(lamp, p, w);
    return t ? HemisphereSample{Color::Ones(), static_cast<float>(*t)} : HemisphereSample{Color::Zero(), infinity};
}

/// A dark rectangle before a bright wall far away. The moving edges belong to
/// the nearer surface, which is the dark one.
HemisphereSample dark_lamp(const Vec3d& p, const Vec3d& w) {
    const auto t = hit_distance(lamp, p, w);
    return t ? HemisphereSample{Color::Zero(), static_cast<float>(*t)} : HemisphereSample{Color::Ones(), 1e4f};
}

/// The derivatives of E(p, n) along the frame's axes s and t, and with respect to turns of the normal about them, by
/// central differences of the closed form.
struct Derivatives {
    Vec3d translation = Vec3d::Zero(), rotation = Vec3d::Zero();
};
Derivatives derivatives_at(const Vec3d& p, const Vec3d& n, const Frame& frame) {
    constexpr double h = 1e-4;
    Derivatives d;
    for (const Vec3& axis : {frame.s, frame.t}) {
        const Vec3d e = axis.cast<double>();
        d.translation += e * (lambert(lamp, p + h * e, n) - lambert(lamp, p - h * e, n)) / (2 * h);
        const auto turned = [&](double angle) { return (n + angle * e.cross(n)).normalized(); };
        d.rotation += e * (lambert(lamp, p, turned(h)) - lambert(lamp, p, turned(-h))) / (2 * h);
    }
    return d;
}

TEST(IrradianceRecord, OfEvenLightIsPiAndHasNoGradients) {
    const auto even = [](const Vec3d&, const Vec3d&) { return HemisphereSample{Color(1, 2, 3), 2.f}; };
    const auto record = record_of(even, Vec3(1, 2, 3), Vec3(1, 2, -2) / 3, HemisphereStrata::of(300), 1);
    for (Eigen::Index c = 0; c < 3; ++c) {
        EXPECT_NEAR(record.irradiance[c], pi * static_cast<float>(c + 1), 1e-5);
        EXPECT_LT(record.rotation[static_cast<std::size_t>(c)].norm(), 1e-5f);
        EXPECT_LT(record.translation[static_cast<std::size_t>(c)].norm(), 1e-5f);
    }
    EXPECT_NEAR(record.distance, 2, 1e-5);
}

// With 90,000 strata, both gradients are those of Lambert's formula within 2 %, in length and direction together, for
// a bright polygon in the dark and for a dark one before light. For the last normal, the lamp surrounds the pole and
// the motions of its edges nearly cancel. The bound is then 2 % of E over the lamp's distance, which is the size of
// the terms that cancel.
TEST(IrradianceRecord, GradientsAreThoseOfLambertsFormula) {
    const Vec3 p(0.1f, -0.2f, 0);
    for (const Vec3& n : {Vec3(0, 0, 1), Vec3(-0.28f, 0, 0.96f), Vec3(0, -0.6f, 0.8f), Vec3(0.48f, 0.36f, 0.8f)}) {
        const auto truth = derivatives_at(p.cast<double>(), n.cast<double>(), Frame(n));
        const double E = lambert(lamp, p.cast<double>(), n.cast<double>());
        const double scale = n.y() == 0.36f ? E / 1.3 : truth.translation.norm();
        for (const bool bright : {true, false}) {
            const auto record =
                record_of(bright ? Scene(bright_lamp) : Scene(dark_lamp), p, n, HemisphereStrata::of(90000), 7);
            const double sign = bright ? 1 : -1;
            EXPECT_NEAR(record.irradiance[0], bright ? E : std::numbers::pi - E, 0.001);
            EXPECT_LT((sign * record.translation[0].cast<double>() - truth.translation).norm(), 0.02 * scale)
                << n.transpose() << ' ' << bright;
            EXPECT_LT((sign * record.rotation[0].cast<double>() - truth.rotation).norm(), 0.02 * truth.rotation.norm())
                << n.transpose() << ' ' << bright;
        }
    }
}

// An edge between strata has the distance of a sample inside one of them. The mean over records therefore has an
// error of first order, 1 / M, which is less than 15 % with 256 rays; the number of rays is proportional to M^2.
TEST(IrradianceRecord, GradientsOfFewRaysAreOffAtFirstOrder) {
    const Vec3 p(0.1f, -0.2f, 0), n(0, 0, 1);
    const auto truth = derivatives_at(p.cast<double>(), n.cast<double>(), Frame(n));
    double previous = 0.15 / 0.7;
    for (const int rays : {256, 1024, 4096}) {
        Vec3d sum = Vec3d::Zero();
        const int records = 4'000'000 / rays;
        for (int seed = 1; seed <= records; ++seed)
            sum += record_of(bright_lamp, p, n, HemisphereStrata::of(rays), static_cast<std::uint64_t>(seed))
                       .translation[0]
                       .cast<double>();
        const double error = (sum / records - truth.translation).norm() / truth.translation.norm();
        EXPECT_LT(error, 0.7 * previous) << rays;
        previous = error;
    }
}

// A record's irradiance at p' and n' is E there to first order: the error falls with the square of the step.
TEST(IrradianceRecord, ExtrapolatesToFirstOrder) {
    const Vec3 p(0.1f, -0.2f, 0), n(0, 0, 1);
    const auto record = record_of(bright_lamp, p, n, HemisphereStrata::of(90000), 3);
    const auto error = [&](float step) {
        const Vec3 q = p + step * Vec3(0.6f, 0.8f, 0), m = Vec3(0.6f * step, -0.8f * step, 1).normalized();
        const double E = lambert(lamp, q.cast<double>(), m.cast<double>());
        return std::abs(double{record.at(q, m)[0]} - E) / E;
    };
    const double without = std::abs(
        double{record.irradiance[0]} / lambert(lamp, Vec3d(0.16, -0.12, 0), Vec3d(0.06, -0.08, 1).normalized()) - 1);
    EXPECT_LT(error(0.1f), 0.02);
    EXPECT_LT(error(0.1f), 0.2 * without);
    EXPECT_LT(error(0.2f), 0.06);
}

TEST(IrradianceRecord, StrataAreEqualPartsOfTheCosine) {
    const auto strata = HemisphereStrata::of(500);
    EXPECT_NEAR(strata.count(), 500, 25);
    EXPECT_NEAR(strata.columns, std::numbers::pi * strata.rows, 4);
    for (int i = 0; i < strata.count(); ++i) {
        const Vec3 w = strata.direction_local(i, Vec2(0.5f, 0.5f));
        const float sine2 = 1 - w.z() * w.z();
        EXPECT_NEAR(sine2 * static_cast<float>(strata.rows), static_cast<float>(i / strata.columns) + 0.5f, 1e-3);
    }
}

}  // namespace
}  // namespace gib::irradiance_record_test
