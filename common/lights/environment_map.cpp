#include "common/lights/environment_map.h"

#include "common/core/memory_limit.h"

#include <fmt/format.h>

namespace gib {

namespace {

constexpr float uniform_share = 0.1f;
constexpr double largest_disc_share = 0.75;
constexpr std::size_t bytes_per_choice = 3 * sizeof(float);  ///< size of a DiscreteDistribution for each of its choices

/// The luminance in double, so that its product with a small solid angle does not underflow.
double luminance_d(const Color& c) { return static_cast<double>(luminance(c)); }

Color lerp(const Color& a, const Color& b, float t) { return (1.f - t) * a + t * b; }

}  // namespace

EnvironmentMap::EnvironmentMap(Image radiance, const Frame& to_world, double reach,
                               const std::optional<BrightDisc>& disc)
    : reach_(reach),
      per_reach_(static_cast<float>(1 / reach)),
      width_(static_cast<std::size_t>(radiance.width)),
      bands_(std::max<std::size_t>(static_cast<std::size_t>(radiance.height), 2) - 1),
      bands_f_(static_cast<double>(bands_)),
      quad_phi_(2 * std::numbers::pi / radiance.width),
      to_world_(to_world),
      rgb_(std::move(radiance.rgb)) {
    if (radiance.height == 1) {
        const std::vector<float> row = rgb_;
        rgb_.insert(rgb_.end(), row.begin(), row.end());
    }
    require_memory(static_cast<double>(width_ * bands_ * bytes_per_choice),
                   fmt::format("choosing directions of an environment of {} x {} pixels", width_, radiance.height));
    integrate();
    if (disc && !is_black(disc->radiance)) take_disc(*disc);
}

/// Finds the integral of the radiance, and the luminance of the quads.
void EnvironmentMap::integrate() {
    std::vector<double> rows, columns(width_);
    for (std::size_t row = 0; row < bands_; ++row) {
        const double theta0 = theta_of(row), theta1 = theta_of(row + 1);
        weights_.push_back({PolarRamp{.theta0 = theta0, .theta1 = theta1, .f0 = 1, .f1 = 0}.integral(),
                            PolarRamp{.theta0 = theta0, .theta1 = theta1, .f0 = 0, .f1 = 1}.integral()});
        double sum = 0;
        for (std::size_t column = 0; column < width_; ++column) {
            const Corners c = corners({.column = column, .row = row, .s = 0.f, .t = 0.f});
            columns[column] = luminance_of(c, row);
            sum += columns[column];
            integral_ += 0.5 * quad_phi_ *
                         ((c.c00 + c.c10).cast<double>() * weights_[row].upper +
                          (c.c01 + c.c11).cast<double>() * weights_[row].lower);
        }
        rows.push_back(sum);
        columns_.emplace_back(columns);
    }
    rows_ = DiscreteDistribution(rows);
}

/// Adds the part of the disc that is not beyond the map's reach, which is black.
void EnvironmentMap::take_disc(const BrightDisc& disc) {
    disc_ = disc;
    constexpr int steps = 128;
    int within = 0;
    for (int i = 0; i < steps * steps; ++i) {
        const Vec2 u((static_cast<float>(i / steps) + 0.5f) / steps, (static_cast<float>(i % steps) + 0.5f) / steps);
        const Vec3 w = Frame(disc.axis).to_world(square_to_cone(u, disc.one_minus_cos));
        if (quad_at(to_world_.to_local(w)).row < bands_) ++within;
    }
    const double visible = static_cast<double>(within) / (steps * steps) * static_cast<double>(disc.solid_angle());
    const Colord map = integral_;
    integral_ += visible * disc.radiance.cast<double>();
    const auto brightness = [](const Colord& c) { return c.matrix().dot(Vec3d(0.212671, 0.715160, 0.072169)); };
    const double share = 1 - brightness(map) / brightness(integral_);
    disc_share_ = rows_.total() > 0 ? static_cast<float>(std::min(share, largest_disc_share)) : 1.f;
}

Color EnvironmentMap::texel(std::size_t column, std::size_t row) const {
    const std::size_t i = 3 * (row * width_ + column);
    return {rgb_[i], rgb_[i + 1], rgb_[i + 2]};
}

EnvironmentMap::Corners EnvironmentMap::corners(const Quad& quad) const {
    const std::size_t next = quad.column + 1 < width_ ? quad.column + 1 : 0;
    return {.c00 = texel(quad.column, quad.row),
            .c10 = texel(next, quad.row),
            .c01 = texel(quad.column, quad.row + 1),
            .c11 = texel(next, quad.row + 1)};
}

Color EnvironmentMap::interpolated(const Quad& quad) const {
    if (quad.row == bands_) return Color::Zero();
    const Corners c = corners(quad);
    return lerp(lerp(c.c00, c.c10, quad.s), lerp(c.c01, c.c11, quad.s), quad.t);
}

EnvironmentMap::Quad EnvironmentMap::quad_at(const Vec3& w) const {
    // acos(y) would lose half of the digits at the poles.
    const float theta = std::atan2(std::hypot(w.x(), w.z()), w.y());
    const float share = std::max(theta * per_reach_, 0.f);
    if (share > 1.f && reach_ < std::numbers::pi) return {.column = 0, .row = bands_, .s = 0.f, .t = 0.f};
    const float v = std::min(share, 1.f) * static_cast<float>(bands_);
    const float columns = static_cast<float>(width_);
    float u = std::atan2(w.x(), -w.z()) * (0.5f * inv_pi) * columns - 0.5f;
    u -= std::floor(u / columns) * columns;
    Quad quad;
    quad.row = std::min(static_cast<std::size_t>(v), bands_ - 1);
    quad.column = std::min(static_cast<std::size_t>(u), width_ - 1);
    quad.t = std::min(v - static_cast<float>(quad.row), 1.f);
    quad.s = std::min(u - static_cast<float>(quad.column), 1.f);
    return quad;
}

Vec3 EnvironmentMap::direction_of(const Quad& quad, double theta) const {
    const double phi = quad_phi_ * (static_cast<double>(quad.column) + 0.5 + static_cast<double>(quad.s));
    const double r = std::sin(theta);
    return Vec3d(r * std::sin(phi), std::cos(theta), -r * std::cos(phi)).cast<float>();
}

double EnvironmentMap::luminance_of(const Corners& c, std::size_t row) const {
    return 0.5 * quad_phi_ *
           ((luminance_d(c.c00) + luminance_d(c.c10)) * weights_[row].upper +
            (luminance_d(c.c01) + luminance_d(c.c11)) * weights_[row].lower);
}

float EnvironmentMap::density(const Quad& quad) const {
    if (quad.row == bands_) return uniform_share * uniform_sphere_pdf_w;
    // The quad was chosen with a rounded probability; within it the density is exactly that of the luminance.
    const DiscreteDistribution& columns = columns_[quad.row];
    if (!(columns.total() > 0)) return uniform_share * uniform_sphere_pdf_w;
    const float choice = rows_.probability(quad.row) * columns.probability(quad.column);
    if (!(choice > 0.f)) return uniform_share * uniform_sphere_pdf_w;
    const Corners c = corners(quad);
    const Color here = lerp(lerp(c.c00, c.c10, quad.s), lerp(c.c01, c.c11, quad.s), quad.t);
    const auto relative = static_cast<float>(luminance_d(here) / luminance_of(c, quad.row));
    return uniform_share * uniform_sphere_pdf_w + (1.f - uniform_share) * choice * relative;
}

Vec2 EnvironmentMap::beyond_disc(const Vec2& u) const {
    return {std::clamp((u.x() - disc_share_) / (1.f - disc_share_), 0.f, 1.f - unit_roundoff), u.y()};
}

EnvironmentMap::Sample EnvironmentMap::sample(const Vec2& u) const {
    if (!disc_) return sample_map(u);
    Vec3 w;
    if (u.x() < disc_share_) {
        w = Frame(disc_->axis).to_world(square_to_cone(Vec2(u.x() / disc_share_, u.y()), disc_->one_minus_cos));
        // Rounding moves a few points of the rim out of the disc.
        if (!disc_->contains(w)) w = disc_->axis;
    } else {
        w = sample_map(beyond_disc(u)).w;
    }
    return {w, radiance(w), pdf_w(w)};
}

EnvironmentMap::Sample EnvironmentMap::sample_map(const Vec2& u) const {
    if (u.x() < uniform_share) {
        const Vec3 w = square_to_sphere(Vec2(u.x() / uniform_share, u.y()));
        const Quad quad = quad_at(w);
        return {to_world_.to_world(w), interpolated(quad), density(quad)};
    }
    const float u_column = std::min((u.x() - uniform_share) / (1.f - uniform_share), 1.f - unit_roundoff);
    const auto row = rows_.sample(u.y());
    const auto column = columns_[row.index].sample(u_column);
    Quad quad{.column = column.index, .row = row.index, .s = 0.f, .t = 0.f};
    const Corners c = corners(quad);
    const double l00 = luminance_d(c.c00), l10 = luminance_d(c.c10), l01 = luminance_d(c.c01), l11 = luminance_d(c.c11);
    const double theta0 = theta_of(row.index), theta1 = theta_of(row.index + 1);
    const double theta = PolarRamp{.theta0 = theta0, .theta1 = theta1, .f0 = l00 + l10, .f1 = l01 + l11}.sample(
        static_cast<double>(row.u));
    const double t = (theta - theta0) / (theta1 - theta0);
    quad.t = static_cast<float>(t);
    quad.s = static_cast<float>(
        sample_linear(static_cast<double>(column.u), (1 - t) * l00 + t * l01, (1 - t) * l10 + t * l11));
    return {to_world_.to_world(direction_of(quad, theta)), interpolated(quad), density(quad)};
}

DirectionCone EnvironmentMap::cone_of(const Vec2& lower, const Vec2& upper) const {
    if (!disc_) return cone_of_map(lower, upper);
    if (upper.x() <= disc_share_) {
        const double half_angle = 2 * std::asin(std::sqrt(0.5 * static_cast<double>(disc_->one_minus_cos)));
        return {disc_->axis.cast<double>().normalized(), half_angle + direction_rounding};
    }
    if (lower.x() < disc_share_) return {};
    return cone_of_map(beyond_disc(lower), beyond_disc(upper));
}

DirectionCone EnvironmentMap::cone_of_map(const Vec2& lower, const Vec2& upper) const {
    if (upper.x() <= uniform_share)
        return cone_around(square_to_sphere_patch(Vec2(lower.x() / uniform_share, lower.y()),
                                                  Vec2(std::min(upper.x() / uniform_share, 1.f), upper.y())),
                           to_world_);
    if (lower.x() < uniform_share) return {};
    // The cone holds whole texels. The row that a number finds, or the column within a row, never decreases as the
    // number increases.
    const auto in_row = [](float u) {
        return std::clamp((u - uniform_share) / (1.f - uniform_share), 0.f, 1.f - unit_roundoff);
    };
    const std::size_t first = rows_.sample(lower.y()).index;
    const std::size_t last = rows_.sample(std::min(upper.y(), 1.f - unit_roundoff)).index;
    std::size_t left = width_, right = 0;
    for (std::size_t row = first; row <= last; ++row) {
        if (!(columns_[row].total() > 0)) continue;  // never chosen
        left = std::min(left, columns_[row].sample(in_row(lower.x())).index);
        right = std::max(right, columns_[row].sample(in_row(upper.x())).index);
    }
    if (left > right) return {};
    // The azimuth turns about the map's y, from -z towards +x.
    Frame axes;
    axes.s = -to_world_.n;
    axes.t = to_world_.s;
    axes.n = to_world_.t;
    return cone_around({.theta0 = theta_of(first),
                        .theta1 = theta_of(last + 1),
                        .phi0 = quad_phi_ * (static_cast<double>(left) + 0.5),
                        .phi1 = quad_phi_ * (static_cast<double>(right) + 1.5)},
                       axes);
}

}  // namespace gib
