#include "methods/parts/gathering/irradiance_record.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gib {

HemisphereStrata HemisphereStrata::of(int rays) {
    const double rows = std::max(1.0, std::round(std::sqrt(rays / static_cast<double>(pi))));
    const double columns = std::max(3.0, std::round(rays / rows));
    return {static_cast<int>(rows), static_cast<int>(columns)};
}

Vec3 HemisphereStrata::direction_local(int stratum, const Vec2& u) const {
    const auto row = static_cast<float>(stratum / columns), column = static_cast<float>(stratum % columns);
    const float sine2 = (row + u.x()) / static_cast<float>(rows);
    const float phi = 2.f * pi * (column + u.y()) / static_cast<float>(columns);
    const float sine = std::sqrt(sine2);
    return {sine * std::cos(phi), sine * std::sin(phi), std::sqrt(std::max(1.f - sine2, 1e-12f))};
}

namespace {

using Weights = std::array<Vec3d, 3>;

void add(Weights& sum, const Color& value, const Vec3d& along) {
    for (Eigen::Index c = 0; c < 3; ++c)
        sum[static_cast<std::size_t>(c)] += double{value[c]} * along;
}

IrradianceGradient to_world(const Weights& local, const Frame& frame, double factor) {
    IrradianceGradient gradient;
    for (std::size_t c = 0; c < 3; ++c)
        gradient[c] = frame.to_world((factor * local[c]).cast<float>());
    return gradient;
}

/// The change of radiance that the motion of the edge between two strata causes, for each unit of distance by which
/// the point moves [W/(sr m^2) per scene unit].
Color change_across(const HemisphereSample& from, const HemisphereSample& to) {
    const float nearer = std::min(from.distance, to.distance);
    // If a surface touches the point the motion is unbounded; such a record is used at its own point only.
    if (nearer == infinity || nearer == 0.f || (to.radiance == from.radiance).all()) return Color::Zero();
    return (to.radiance - from.radiance) / nearer;
}

Vec3d in_plane(double phi) { return {std::cos(phi), std::sin(phi), 0}; }

/// The mean of tan(theta) over a row, sin^2(theta) = s in [j / M, (j + 1) / M]: the integral of
/// sqrt(s / (1 - s)) is theta - sin(theta) cos(theta). In the row at the horizon the mean differs much from the
/// tangent in the row's middle.
double mean_tangent(int row, int rows) {
    const auto integral = [&](int j) {
        const double s = double(j) / rows;
        return std::asin(std::sqrt(s)) - std::sqrt(s * (1 - s));
    };
    return rows * (integral(row + 1) - integral(row));
}

}  // namespace

IrradianceRecord irradiance_record(const Vec3& p, const Frame& frame, const HemisphereStrata& strata,
                                   std::span<const HemisphereSample> samples) {
    const int M = strata.rows, N = strata.columns;
    const double pi_d = std::numbers::pi, width = 2 * pi_d / N;
    // The mean over a column of a vector that turns with phi, relative to the vector in the column's middle.
    const double mean_over_column = std::sin(width / 2) / (width / 2);
    const auto sample = [&](int j, int k) -> const HemisphereSample& {
        return samples[static_cast<std::size_t>(j * N + (k + N) % N)];
    };
    std::vector<double> tangents;
    for (int j = 0; j < M; ++j)
        tangents.push_back(mean_tangent(j, M));
    Colord sum = Colord::Zero();
    double inverse_distances = 0;
    Weights rotation, translation;
    rotation.fill(Vec3d::Zero());
    translation.fill(Vec3d::Zero());
    for (int k = 0; k < N; ++k) {
        // The notation of Ward and Heckbert: u_k points along the middle of column k, v_k at right angles to it, and
        // the edge to the column before lies at phi_k-. `rotation` is the sum of their equation 1, `translation` that
        // of equation 2.
        const Vec3d u = in_plane(width * (k + 0.5)), v = in_plane(width * (k + 0.5) + pi_d / 2);
        const Vec3d v_edge = in_plane(width * k + pi_d / 2);
        for (int j = 0; j < M; ++j) {
            const HemisphereSample& here = sample(j, k);
            sum += here.radiance.cast<double>();
            inverse_distances += here.distance > 0.f ? 1 / double{here.distance} : double{infinity};
            const double sine2_lower = double(j) / M, sine2_upper = double(j + 1) / M;
            add(rotation, here.radiance, mean_over_column * tangents[static_cast<std::size_t>(j)] * v);
            if (j > 0)
                add(translation, change_across(sample(j - 1, k), here),
                    mean_over_column * width * (1 - sine2_lower) * std::sqrt(sine2_lower) * u);
            add(translation, change_across(sample(j, k - 1), here),
                (std::sqrt(sine2_upper) - std::sqrt(sine2_lower)) * v_edge);
        }
    }
    const double share = pi_d / strata.count();
    IrradianceRecord record;
    record.p = p;
    record.n = frame.n;
    record.irradiance = (share * sum).cast<float>();
    record.rotation = to_world(rotation, frame, share);
    record.translation = to_world(translation, frame, 1);
    record.distance = inverse_distances > 0 ? static_cast<float>(strata.count() / inverse_distances) : infinity;
    return record;
}

bool IrradianceRecord::is_finite() const {
    const auto finite = [](const IrradianceGradient& g) {
        return std::all_of(g.begin(), g.end(), [](const Vec3& v) { return v.array().isFinite().all(); });
    };
    return irradiance.isFinite().all() && finite(rotation) && finite(translation);
}

Color IrradianceRecord::at(const Vec3& position, const Vec3& normal) const {
    const Color turned = normal == n ? irradiance : Color(irradiance + dot(rotation, n.cross(normal)));
    return turned + dot(translation, position - p);
}

}  // namespace gib
