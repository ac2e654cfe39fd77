#pragma once
// A projector: a pinhole that throws an image into the scene, as a perspective camera takes one. Source: the
// documentation of Mitsuba 3's `projector`.

#include "common/images/texture.h"
#include "common/sampling/direction_cone.h"

namespace gib {

/// The light shines along z of its frame, with +x left and +y up, as a camera looks. On the plane at distance 1 the
/// image is a rectangle of half width a; its top left corner is uv = (0, 0). A surface in this plane receives the
/// irradiance pi B(uv) [W/m^2], where B is the image: a white diffuse screen shows the radiance B. In the direction with
/// the cosine c to the axis the intensity therefore is pi B / c^3 [W/sr].
class ProjectorLight {
public:
    /// `axes` are in world space, orthonormal, of either handedness. `tan_half_width` is a; `aspect` is width / height
    /// of the rectangle.
    ProjectorLight(const Vec3& position, const Frame& axes, const Texture& image, float scale, double tan_half_width,
                   double aspect);

    const Vec3& position() const { return position_; }
    bool is_textured() const { return !image_.constant(); }
    /// Intensity [W/sr] in the direction of the unit vector w; 0 beside the image.
    Color intensity(const Vec3& w) const;

    struct Direction {
        Vec3 w;
        Colord power;  ///< intensity / density [W]
    };
    /// A direction to a uniform point of the rectangle.
    Direction sample(const Vec2& u) const;
    /// The density of sample() at the unit vector w [1/sr]: 1 / (area c^3).
    double pdf_w(const Vec3& w) const;
    /// A cone that holds the directions that sample() finds for u in a box of [0, 1]^2.
    DirectionCone cone_of(const Vec2& lower, const Vec2& upper) const;

    /// Emitted power [W] per channel: pi times the integral of B over the rectangle.
    const Colord& power() const { return power_; }

private:
    Vec3d on_plane(const Vec2d& uv) const;

    Vec3 position_;
    Frame axes_;
    Texture image_;
    float scale_;
    Vec2d half_size_;  ///< half the width and height of the rectangle at distance 1
    double area_;
    Colord power_;
};

}  // namespace gib
