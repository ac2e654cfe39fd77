#include "common/lights/projector_light.h"

#include "common/sampling/sampler.h"

#include <numbers>

namespace gib {

namespace {

constexpr std::uint32_t projector_samples = 1u << 16;

}  // namespace

ProjectorLight::ProjectorLight(const Vec3& position, const Frame& axes, const Texture& image, float scale,
                               double tan_half_width, double aspect)
    : position_(position),
      axes_(axes),
      image_(image),
      scale_(scale),
      half_size_(tan_half_width, tan_half_width / aspect),
      area_(4 * half_size_.x() * half_size_.y()) {
    const double per_image = std::numbers::pi * area_ * static_cast<double>(scale_);
    power_ = per_image * image_.mean().cast<double>();
    if (image_.constant()) return;
    Colord sum = Colord::Zero();
    for (std::uint32_t i = 0; i < projector_samples; ++i)
        sum += sample(Sampler(PointSet::sobol, 0, 0, i).get_2d(0)).power;
    // If all samples met dark parts of the image, its mean colour gives the power, so that the light can be chosen.
    if (sum.maxCoeff() > 0) power_ = sum / projector_samples;
}

/// The point of the plane at distance 1, in the light's frame: columns run to the right (-x), rows downwards (-y).
Vec3d ProjectorLight::on_plane(const Vec2d& uv) const {
    return {half_size_.x() * (1 - 2 * uv.x()), half_size_.y() * (1 - 2 * uv.y()), 1};
}

Color ProjectorLight::intensity(const Vec3& w) const {
    const Vec3d local = axes_.to_local(w).cast<double>();
    if (!(local.z() > 0)) return Color::Zero();
    const Vec2d uv(0.5 - 0.5 * local.x() / (local.z() * half_size_.x()),
                   0.5 - 0.5 * local.y() / (local.z() * half_size_.y()));
    if (!((uv.array() >= 0).all() && (uv.array() <= 1).all())) return Color::Zero();
    const double per_image = std::numbers::pi * static_cast<double>(scale_) / (local.z() * sqr(local.z()));
    return static_cast<float>(per_image) * image_.color(Vec2(uv.cast<float>()));
}

ProjectorLight::Direction ProjectorLight::sample(const Vec2& u) const {
    const Vec3 w = axes_.to_world(on_plane(u.cast<double>()).normalized().cast<float>());
    const double per_image = std::numbers::pi * area_ * static_cast<double>(scale_);
    return {w, per_image * image_.color(u).cast<double>()};
}

double ProjectorLight::pdf_w(const Vec3& w) const {
    const Vec3d local = axes_.to_local(w).cast<double>();
    if (!(local.z() > 0)) return 0;
    const Vec2d c = local.head<2>().cwiseAbs() / local.z();
    // The edge is widened by the rounding of a direction that sample() finds there.
    const bool inside = ((c - half_size_).array() <= direction_rounding * (1 + c.squaredNorm())).all();
    return inside ? 1 / (area_ * local.z() * sqr(local.z())) : 0;
}

DirectionCone ProjectorLight::cone_of(const Vec2& lower, const Vec2& upper) const {
    const Vec3d axis = on_plane(0.5 * (lower + upper).cast<double>()).normalized();
    // Cones below a right angle cut the plane in convex sets, so that the largest angle is at a corner.
    double half_angle = 0;
    for (const float u : {lower.x(), upper.x()})
        for (const float v : {lower.y(), upper.y()}) {
            const Vec3d corner = on_plane(Vec2(u, v).cast<double>());
            half_angle = std::max(half_angle, std::atan2(axis.cross(corner).norm(), axis.dot(corner)));
        }
    if (half_angle >= 0.5 * std::numbers::pi) return {};
    const Vec3d world =
        axis.x() * axes_.s.cast<double>() + axis.y() * axes_.t.cast<double>() + axis.z() * axes_.n.cast<double>();
    return {world.normalized(), half_angle + direction_rounding};
}

}  // namespace gib
