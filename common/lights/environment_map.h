#pragma once
// Radiance from all directions, given by a latitude-longitude image, and sampling of directions in proportion to it.

#include "common/images/image.h"
#include "common/sampling/direction_cone.h"
#include "common/sampling/warp.h"

#include <optional>
#include <vector>

namespace gib {

/// A disc of even radiance in front of a map, such as the sun.
struct BrightDisc {
    Vec3 axis;            ///< direction of its middle: unit, in world space
    float one_minus_cos;  ///< 1 - cosine of its angular radius; the difference keeps the digits of narrow cones
    Color radiance;       ///< [W/(sr m^2)], which is added to that of the map

    /// Whether the unit vector w points into the disc: |w - axis|^2 = 2 (1 - cos).
    bool contains(const Vec3& w) const { return (w - axis).squaredNorm() <= 2.f * one_minus_cos; }
    float solid_angle() const { return 2.f * pi * one_minus_cos; }  ///< [sr]
};

/// Mitsuba's convention: in the map's frame the column coordinate is u = atan2(x, -z) / (2 pi) and the row coordinate
/// v = acos(y) / pi. So the middle of the image is +z, its right half -x, its top +y. Texel centres stand at u =
/// (column + 1/2) / width, periodic, and at v = row / (height - 1): the first and the last row are the poles.
/// Radiance is bilinear in between.
///
/// The density of directions is proportional to the luminance, except for a tenth that is uniform over the sphere.
/// Otherwise the sky would be sampled too rarely where the sun is hidden, and never where its share is below the
/// resolution of the random numbers. With the uniform part the density is nowhere 0. A disc in front of the map is
/// chosen with a probability in proportion to its share of the luminance, but at most 3/4, for the points in its
/// shadow; it is sampled uniformly. With a disc and a black map all samples are of the disc.
class EnvironmentMap {
public:
    /// `radiance` [W/(sr m^2)] is finite and not negative; an image of one row is constant along each meridian.
    /// `to_world` holds the map's axes in world space, orthonormal; `reach` [rad] is above 0 and at most pi.
    EnvironmentMap(Image radiance, const Frame& to_world, double reach = std::numbers::pi,
                   const std::optional<BrightDisc>& disc = {});

    /// Radiance [W/(sr m^2)] towards a viewer who looks along the unit vector w.
    Color radiance(const Vec3& w) const {
        const Quad quad = quad_at(to_world_.to_local(w));
        const Color map = interpolated(quad);
        return disc_ && quad.row < bands_ && disc_->contains(w) ? Color(map + disc_->radiance) : map;
    }
    /// The density of sample() [1/sr].
    float pdf_w(const Vec3& w) const {
        const float map = density(quad_at(to_world_.to_local(w)));
        if (!disc_) return map;
        return (1.f - disc_share_) * map + (disc_->contains(w) ? disc_share_ / disc_->solid_angle() : 0.f);
    }

    struct Sample {
        Vec3 w;
        Color radiance;
        float pdf_w;
    };
    /// Samples a direction with the density pdf_w(). The map and the disc must not both be black.
    Sample sample(const Vec2& u) const;
    /// A cone that holds the directions that sample() finds for u in a box of [0, 1]^2. The map and the disc must not
    /// both be black.
    DirectionCone cone_of(const Vec2& lower, const Vec2& upper) const;

    /// The integral of the radiance over all directions [W/m^2].
    const Colord& integral() const { return integral_; }

private:
    /// A place in the quad between four texels. Beyond the map's reach the row is bands_.
    struct Quad {
        std::size_t column, row;
        float s, t;  ///< ways towards the next column and the next row, in [0, 1]
    };
    struct Corners {
        Color c00, c10, c01, c11;  ///< column, row
    };
    /// Integrals over a row of quads of the bilinear weights of its upper and its lower texels, times
    /// sin(theta) d theta.
    struct Band {
        double upper, lower;
    };

    Color texel(std::size_t column, std::size_t row) const;
    Corners corners(const Quad& quad) const;
    Color interpolated(const Quad& quad) const;
    Quad quad_at(const Vec3& w_local) const;
    Vec3 direction_of(const Quad& quad, double theta) const;
    /// Luminance of a quad [W/m^2]: that of the radiance, integrated over its directions.
    double luminance_of(const Corners& c, std::size_t row) const;
    float density(const Quad& quad) const;
    double theta_of(std::size_t row) const { return reach_ * static_cast<double>(row) / bands_f_; }
    void integrate();
    void take_disc(const BrightDisc& disc);
    Sample sample_map(const Vec2& u) const;
    DirectionCone cone_of_map(const Vec2& lower, const Vec2& upper) const;
    /// The random numbers of the map, which are those that do not choose the disc, in [0, 1).
    Vec2 beyond_disc(const Vec2& u) const;

    double reach_;  ///< angle from +y to the last row [rad]
    float per_reach_;
    std::size_t width_, bands_;  ///< columns of texels, rows of quads
    double bands_f_;
    double quad_phi_;  ///< width of a quad [rad]
    Frame to_world_;
    std::vector<float> rgb_;  ///< (bands + 1) x width x 3
    std::vector<Band> weights_;
    DiscreteDistribution rows_;
    std::vector<DiscreteDistribution> columns_;  ///< choice of the column, for every row of quads
    Colord integral_ = Colord::Zero();
    std::optional<BrightDisc> disc_;
    float disc_share_ = 0.f;  ///< share of the samples that go to the disc
};

}  // namespace gib
