#include "common/lights/spot_light.h"

#include "common/sampling/sampler.h"

namespace gib {

namespace {

/// 1 - cos(theta) without cancellation.
double one_minus_cos(double theta) { return 2 * sqr(std::sin(0.5 * theta)); }

constexpr std::uint32_t slide_samples = 1u << 16;

}  // namespace

SpotLight::SpotLight(const Vec3& position, const Frame& axes, const Color& intensity, double cutoff_angle,
                     double beam_width, std::optional<Texture> slide)
    : position_(position),
      axes_(axes),
      intensity_(intensity),
      cutoff_(static_cast<float>(cutoff_angle)),
      beam_(static_cast<float>(beam_width)),
      beam_one_minus_cos_(static_cast<float>(one_minus_cos(beam_width))),
      edge_{.theta0 = beam_width, .theta1 = cutoff_angle, .f0 = 1, .f1 = 0},
      slide_(std::move(slide)) {
    const double beam = one_minus_cos(beam_width), all = beam + edge_.integral();
    beam_share_ = static_cast<float>(beam / all);
    solid_angle_ = 2 * std::numbers::pi * all;
    power_ = solid_angle_ * intensity_.cast<double>();
    if (!slide_) return;
    slide_scale_ = static_cast<float>(0.5 / std::tan(cutoff_angle));
    Colord sum = Colord::Zero();
    for (std::uint32_t i = 0; i < slide_samples; ++i)
        sum += sample(Sampler(PointSet::sobol, 0, 0, i).get_2d(0)).power;
    // If all samples met dark parts of the slide, its mean colour gives the power, so that the light can
    // still be chosen.
    power_ = sum.maxCoeff() > 0 ? Colord(sum / slide_samples) : Colord(power_ * slide_->mean().cast<double>());
}

float SpotLight::falloff(float theta) const {
    if (theta <= beam_) return 1.f;
    return theta < cutoff_ ? (cutoff_ - theta) / (cutoff_ - beam_) : 0.f;
}

Color SpotLight::slide_color(const Vec3& w) const {
    return slide_->color(Vec2(0.5f + slide_scale_ * (w.x() / w.z()), 0.5f + slide_scale_ * (w.y() / w.z())));
}

float SpotLight::share_of_intensity(const Vec3& w) const {
    // The angle is not taken from the cosine, which hardly changes over a narrow beam.
    return falloff(std::atan2(std::hypot(w.x(), w.y()), w.z()));
}

Color SpotLight::intensity(const Vec3& w) const {
    const Vec3 local = axes_.to_local(w);
    const float share = share_of_intensity(local);
    if (!(share > 0.f)) return Color::Zero();
    return slide_ ? Color(share * intensity_ * slide_color(local)) : Color(share * intensity_);
}

SpotLight::Direction SpotLight::sample(const Vec2& u) const {
    Vec3 local;
    if (u.x() < beam_share_) {
        local = square_to_cone(Vec2(u.x() / beam_share_, u.y()), beam_one_minus_cos_);
    } else {
        const double theta = edge_.sample(static_cast<double>((u.x() - beam_share_) / (1.f - beam_share_)));
        const double phi = 2 * std::numbers::pi * static_cast<double>(u.y());
        local = Vec3d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)).cast<float>();
    }
    const Colord power = solid_angle_ * intensity_.cast<double>();
    return {axes_.to_world(local), slide_ ? Colord(power * slide_color(local).cast<double>()) : power};
}

double SpotLight::sampled_angle(float u) const {
    if (u < beam_share_)
        return 2 * std::asin(std::sqrt(0.5 * static_cast<double>(u / beam_share_ * beam_one_minus_cos_)));
    return beam_share_ < 1.f ? edge_.sample(std::min(static_cast<double>((u - beam_share_) / (1.f - beam_share_)), 1.0))
                             : edge_.theta1;
}

DirectionCone SpotLight::cone_of(const Vec2& lower, const Vec2& upper) const {
    const double turn = 2 * std::numbers::pi;
    return cone_around({.theta0 = sampled_angle(lower.x()),
                        .theta1 = sampled_angle(upper.x()),
                        .phi0 = turn * static_cast<double>(lower.y()),
                        .phi1 = turn * static_cast<double>(upper.y())},
                       axes_);
}

}  // namespace gib
