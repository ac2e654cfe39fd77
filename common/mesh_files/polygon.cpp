#include "common/mesh_files/polygon.h"

#include "common/core/float_traps.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// A polygon that is cut down to a triangle.
class Polygon {
public:
    Polygon(std::span<const Vec3d> positions, std::span<Triangle> fan) : positions_(positions), fan_(fan) {
        corners_ = {fan[0][0], fan[0][1]};
        for (const Triangle& triangle : fan)
            corners_.push_back(triangle[2]);
        // The corners are taken relative to the first one, because the products of large coordinates would cancel.
        const Vec3d origin = place(0);
        for (std::size_t i = 1; i + 1 < corners_.size(); ++i)
            normal_ += (place(i) - origin).cross(place(i + 1) - origin);
        // Coordinates are rounded, so that three corners in a line may have an area just above or below 0.
        rounding_ = 1e-9 * normal_.squaredNorm();
    }

    bool is_covered_by_fan() const {
        if (!(normal_.squaredNorm() > 0)) return true;
        for (std::size_t i = 1; i + 1 < corners_.size(); ++i)
            if (facing(place(0), place(i), place(i + 1)) < -rounding_) return false;
        return true;
    }

    void cut_ears() {
        std::size_t made = 0;
        while (corners_.size() > 3) {
            std::size_t i = find_ear(rounding_);
            if (i == corners_.size()) i = find_ear(0);
            if (i == corners_.size()) break;
            fan_[made++] = {corners_[before(i)], corners_[i], corners_[after(i)]};
            corners_.erase(corners_.begin() + static_cast<std::ptrdiff_t>(i));
        }
        for (std::size_t i = 1; i + 1 < corners_.size(); ++i)
            fan_[made++] = {corners_[0], corners_[i], corners_[i + 1]};
    }

private:
    const Vec3d& place(std::size_t i) const { return positions_[corners_[i]]; }
    std::size_t before(std::size_t i) const { return i == 0 ? corners_.size() - 1 : i - 1; }
    std::size_t after(std::size_t i) const { return i + 1 == corners_.size() ? 0 : i + 1; }
    /// Twice the signed area of a triangle as seen along the polygon's area vector, times that vector's length.
    double facing(const Vec3d& a, const Vec3d& b, const Vec3d& c) const { return (b - a).cross(c - a).dot(normal_); }

    /// The first ear whose facing is above `least`; the number of corners if there is none.
    std::size_t find_ear(double least) const {
        std::size_t i = 0;
        while (i < corners_.size() && !is_ear(i, least))
            ++i;
        return i;
    }

    /// Whether corner i and its neighbours make a triangle that lies in the polygon. A corner that is nearer to it than
    /// the rounding counts as one inside; without this all corners that remain could lie in a line.
    bool is_ear(std::size_t i, double least) const {
        const Vec3d &a = place(before(i)), &b = place(i), &c = place(after(i));
        if (!(facing(a, b, c) > least)) return false;
        for (std::size_t k = 0; k < corners_.size(); ++k) {
            const Vec3d& p = place(k);
            // A corner may stand twice, where a bridge leads to a hole.
            const bool is_own = p == a || p == b || p == c;
            if (!is_own && std::min({facing(a, b, p), facing(b, c, p), facing(c, a, p)}) >= -least) return false;
        }
        return true;
    }

    std::span<const Vec3d> positions_;
    std::span<Triangle> fan_;
    std::vector<std::uint32_t> corners_;
    Vec3d normal_ = Vec3d::Zero();  ///< the area vector, times 2
    double rounding_ = 0;           ///< rounding error of facing()
};

}  // namespace

void triangulate_fans(std::span<const Vec3d> positions, std::vector<Triangle>& triangles, std::span<const Fan> fans) {
    const FloatTrapsPaused paused;  // polygons too large for squares in double are refused once the scene is known
    for (const Fan& fan : fans) {
        Polygon polygon(positions, std::span(triangles).subspan(fan.first, fan.corners - 2));
        if (!polygon.is_covered_by_fan()) polygon.cut_ears();
    }
}

}  // namespace gib
