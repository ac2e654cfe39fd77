#pragma once
// Cameras: where the ray of a film position starts and goes. Film coordinates are pixels, (0, 0) the top left corner of
// the image.

#include "common/math.h"

#include <vector>

namespace gib {

/// How a pixel weighs the film around its centre. Filters are importance-sampled: each pixel keeps its own samples.
class ReconstructionFilter {
public:
    static ReconstructionFilter box(float radius);
    /// exp(-x^2 / (2 stddev^2)) - exp(-r^2 / (2 stddev^2)), cut off at r = 4 stddev: Mitsuba's.
    static ReconstructionFilter gaussian(float stddev);

    /// An offset from the pixel's centre in pixels, distributed like the filter.
    Vec2 sample(const Vec2& u) const { return {sample(u.x()), sample(u.y())}; }

private:
    float sample(float u) const;

    float radius_ = 0.5f;
    std::vector<float> cumulative_;  ///< of a tabulated filter over [-radius, radius]; empty: a box
};

class Sensor {
public:
    enum class Projection { perspective, orthographic };
    /// Which extent of the image `fov` spans.
    enum class FovAxis { x, y, diagonal, smaller, larger };

    struct Parameters {
        Projection projection = Projection::perspective;
        double fov = 40;  ///< [degrees], of perspective
        FovAxis fov_axis = FovAxis::x;
        float near_clip = 0;  ///< [scene units] along the view direction
        float far_clip = infinity;
        Mat4d to_world = Mat4d::Identity();            ///< camera looks along +z, +y up, +x left
        Vec2d principal_point_offset = Vec2d::Zero();  ///< added to film positions, in
                                                       ///< fractions of the film's extents
        int width = 768, height = 576;
        ReconstructionFilter filter = ReconstructionFilter::gaussian(0.5f);
    };

    explicit Sensor(const Parameters& parameters);

    int width() const { return width_; }
    int height() const { return height_; }
    /// The ray of a sample in pixel (x, y); d has unit length.
    Ray generate_ray(int x, int y, const Vec2& u_film) const;
    /// Moves the camera, for a scene that is recentred.
    void translate(const Vec3d& by);

private:
    Projection projection_;
    int width_, height_;
    ReconstructionFilter filter_;
    float near_clip_, far_clip_;
    Vec3d position_;  ///< kept in double, so that recentring a distant scene loses nothing
    Vec3 origin_;
    Vec3 left_, up_, forward_;  ///< columns of to_world's linear part
    Vec2 scale_, offset_;  ///< film position -> camera-space (x, y) at z = 1 (perspective) or at any z (orthographic)
};

}  // namespace gib
