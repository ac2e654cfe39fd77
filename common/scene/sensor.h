#pragma once
// Cameras, which turn film positions into rays. Film coordinates are pixels, with (0, 0) at the top left corner of
// the image.

#include "common/core/math.h"
#include "common/sampling/sampler.h"

#include <optional>
#include <vector>

namespace gib {

/// The weight of the film around the centre of a pixel. Filters are importance-sampled: each pixel keeps
/// its own samples.
class ReconstructionFilter {
public:
    static ReconstructionFilter box(float radius);
    /// 1 - |x| / radius; radius and x in pixels.
    static ReconstructionFilter tent(float radius);
    /// exp(-x^2 / (2 stddev^2)) - exp(-r^2 / (2 stddev^2)), cut off at r = 4 stddev, as in Mitsuba.
    static ReconstructionFilter gaussian(float stddev);

    /// An offset from the pixel's centre in pixels, distributed like the filter.
    Vec2 sample(const Vec2& u) const { return {sample(u.x()), sample(u.y())}; }

    /// The largest offset from a pixel's centre, along each axis [pixels].
    float radius() const { return radius_; }

    /// A pixel whose filter covers a point of the film.
    struct Pixel {
        int x, y;
        float weight;  ///< the sum of all such filters' densities [1/px^2]: density / probability of the choice
    };
    /// Chooses among the pixels, also those beyond the image, by the density of their filters at `film` [pixels].
    Pixel choose_pixel(const Vec2& film, float u) const {
        float sum_x = 0.f, sum_y = 0.f;
        const int x = choose(film.x(), u, sum_x);
        const int y = choose(film.y(), u, sum_y);
        return {x, y, sum_x * sum_y};
    }

private:
    enum class Shape { box, tent, table };
    float sample(float u) const;
    float sample_table(float u) const;
    float density(float offset) const;
    int choose(float film, float& u, float& sum) const;

    Shape shape_ = Shape::box;
    float radius_ = 0.5f;
    std::vector<float> cumulative_;     ///< share of a tabulated filter's integral below each node of [-radius, radius]
    std::vector<std::uint16_t> first_;  ///< by u, in as many steps: the first cell that can hold u
};

class Sensor {
public:
    enum class Projection { perspective, orthographic };
    /// Which extent of the image `fov` spans.
    enum class FovAxis { x, y, diagonal, smaller, larger };

    /// The film that the image is a part of, in the image's pixels.
    struct Crop {
        Vec2d film;    ///< width and height
        Vec2d offset;  ///< distance of the image's top left corner from the film's
    };

    struct Parameters {
        Projection projection = Projection::perspective;
        double fov = 40;  ///< [degrees], of perspective
        FovAxis fov_axis = FovAxis::x;
        float near_clip = 0;  ///< [scene units] along the view direction
        float far_clip = infinity;
        Mat4d to_world = Mat4d::Identity();            ///< camera looks along +z, +y up, +x left
        Vec2d principal_point_offset = Vec2d::Zero();  ///< added to film positions, in fractions of the film's size
        double aperture_radius = 0;   ///< [scene units], of the thin lens of a perspective; 0: a pinhole
        double focus_distance = 1e4;  ///< [scene units] from the lens to the plane of sharp points, along the view
                                      ///< direction
        int width = 768, height = 576;
        std::optional<Crop> crop;  ///< none: the image is the whole film
        ReconstructionFilter filter = ReconstructionFilter::gaussian(0.5f);
    };

    /// Half the width at distance 1 of the image that a perspective's field of view spans, for an image of width /
    /// height = `aspect`.
    static double tan_half_width(double fov, FovAxis axis, double aspect);

    explicit Sensor(const Parameters& parameters);

    int width() const { return width_; }
    int height() const { return height_; }
    /// Whether rays start at different points of a lens. Without a lens `u_lens` has no effect.
    bool has_lens() const { return has_lens_; }
    /// The ray of a sample in pixel (x, y); d has unit length. The middle of `u_lens` is the middle of the lens.
    Ray generate_ray(int x, int y, const Vec2& u_film, const Vec2& u_lens = Vec2(0.5f, 0.5f)) const;
    /// The ray of a sampler's path; the sampler's index need not be the pixel.
    Ray sample_ray(int x, int y, const Sampler& sampler) const {
        return has_lens_ ? generate_ray(x, y, sampler.get_2d(dimension::film), sampler.get_2d(dimension::lens))
                         : generate_ray(x, y, sampler.get_2d(dimension::film));
    }
    /// Whether all rays have the same direction.
    bool is_orthographic() const { return projection_ == Projection::orthographic; }
    const ReconstructionFilter& filter() const { return filter_; }
    /// The start of the rays of this point of the lens; of a pinhole the pinhole. Not for an orthographic camera.
    Vec3 lens_point(const Vec2& u_lens) const { return origin_ + lens_shift(u_lens); }

    /// A point as the camera sees it.
    struct View {
        Ray ray;         ///< ray that meets the point; its t_min and t_max clip
        float distance;  ///< distance from the ray's origin to the point [scene units]
        Vec2 film;       ///< place where the ray meets the film [pixels of the image]
    };
    /// The view of p through one point of the lens; empty if p lies behind the camera.
    std::optional<View> view_of(const Vec3& p, const Vec2& u_lens) const;
    /// Density of the camera's rays, for one ray to each unit of the film's area [px^2]: [1/sr] in direction w from one
    /// point of the lens; for an orthographic camera [1/m^2] across its direction. In double, because the size of a
    /// camera is not bounded.
    double ray_density(const Vec3& w) const;

    /// Moves the camera by a vector [scene units], for a scene that is recentred.
    void translate(const Vec3d& by);

    /// Whether the camera's own rays see no emitter (Mitsuba 3's `hide_emitters`): until they are scattered, lamps are
    /// passed as if they were not there, and the environment is black.
    bool hides_emitters() const { return hides_emitters_; }
    void hide_emitters(bool hide) { hides_emitters_ = hide; }

private:
    Vec3 lens_shift(const Vec2& u_lens) const;

    Projection projection_;
    int width_, height_;
    ReconstructionFilter filter_;
    float near_clip_, far_clip_;
    Vec3d position_;  ///< kept in double, so that recentring a distant scene loses nothing
    Vec3 origin_;
    Vec3 left_, up_, forward_;  ///< columns of to_world's linear part
    Eigen::Matrix3d to_axes_;   ///< matrix from a vector to its coordinates along left, up and forward
    double volume_;             ///< |det| of these axes
    bool has_lens_, hides_emitters_ = false;
    float aperture_radius_, inv_focus_distance_;
    Vec2 crop_offset_;
    Vec2 scale_, offset_;  ///< film position -> camera-space (x, y) at z = 1 (perspective) or at any z (orthographic)
};

}  // namespace gib
