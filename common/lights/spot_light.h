#pragma once
// A spot light: full intensity in the beam, a linear fall-off in angle from there to the cut-off, and an optional
// slide, an image that the light projects.

#include "common/images/texture.h"
#include "common/sampling/direction_cone.h"
#include "common/sampling/warp.h"

#include <optional>

namespace gib {

/// As in Mitsuba, the light shines along z of its frame.
class SpotLight {
public:
    /// Angles from the axis [rad]: 0 <= beam_width <= cutoff_angle <= pi and cutoff_angle > 0; with a slide
    /// cutoff_angle is below pi / 2. `axes` are in world space, orthonormal, of either handedness.
    SpotLight(const Vec3& position, const Frame& axes, const Color& intensity, double cutoff_angle, double beam_width,
              std::optional<Texture> slide);

    const Vec3& position() const { return position_; }
    /// The angle from the axis [rad] up to which the intensity is full.
    double beam_width() const { return double{beam_}; }
    bool is_textured() const { return slide_.has_value(); }
    /// Intensity [W/sr] in the direction of the unit vector w.
    Color intensity(const Vec3& w) const;

    struct Direction {
        Vec3 w;
        Colord power;  ///< intensity / density [W]
    };
    /// A direction with a density in proportion to the fall-off.
    Direction sample(const Vec2& u) const;
    /// That density at the unit vector w [1/sr].
    double pdf_w(const Vec3& w) const { return double{share_of_intensity(axes_.to_local(w))} / solid_angle_; }
    /// A cone that holds the directions that sample() finds for u in a box of [0, 1]^2.
    DirectionCone cone_of(const Vec2& lower, const Vec2& upper) const;

    /// Emitted power [W] per channel.
    const Colord& power() const { return power_; }

private:
    float falloff(float theta) const;
    /// The fall-off in a direction of the light's frame.
    float share_of_intensity(const Vec3& w_local) const;
    /// The angle from the axis [rad] that sample() finds; it increases with u.
    double sampled_angle(float u) const;
    /// The colour of the slide, which fills the square around the cut-off circle.
    Color slide_color(const Vec3& w_local) const;

    Vec3 position_;
    Frame axes_;
    Color intensity_;
    float cutoff_, beam_;  ///< [rad]
    float beam_one_minus_cos_;
    float beam_share_;       ///< the beam's share of the power without a slide
    float slide_scale_ = 0;  ///< 1 / (2 tan(cutoff))
    PolarRamp edge_;         ///< the fall-off from the beam to the cut-off
    std::optional<Texture> slide_;
    double solid_angle_;  ///< [sr] of all directions, weighted by the fall-off
    Colord power_;
};

}  // namespace gib
