#pragma once
// Convex planar polygons cut by a plane, without allocation.

#include "common/core/math.h"

#include <algorithm>
#include <array>
#include <span>

namespace gib {

/// A convex polygon. A cut by a plane leaves at most 5 vertices of 4, or 6 if the four vertices are so far from
/// coplanar that the plane cuts all four edges.
class ConvexRegion {
public:
    static constexpr std::size_t max_vertices = 6;

    void add(const Vec3d& vertex) { vertices_[count_++] = vertex; }
    std::span<const Vec3d> vertices() const { return {vertices_.data(), count_}; }
    std::size_t size() const { return count_; }
    const Vec3d& operator[](std::size_t i) const { return vertices_[i]; }
    const Vec3d& after(std::size_t i) const { return vertices_[i + 1 == count_ ? 0 : i + 1]; }

    Vec3d mean() const {
        Vec3d sum = Vec3d::Zero();
        for (const Vec3d& vertex : vertices())
            sum += vertex;
        return sum / static_cast<double>(count_);
    }
    /// The largest distance of a vertex from the point `from`.
    double radius(const Vec3d& from) const {
        double largest = 0;
        for (const Vec3d& vertex : vertices())
            largest = std::max(largest, (vertex - from).squaredNorm());
        return std::sqrt(largest);
    }

private:
    std::array<Vec3d, max_vertices> vertices_;
    std::size_t count_ = 0;
};

/// Bound of the displacement of a point by rounding of the coordinates and of what is computed from
/// them [scene units].
inline double coordinate_rounding(std::span<const Vec3d> points) {
    double largest = 0;
    for (const Vec3d& p : points)
        largest = std::max(largest, p.cwiseAbs().maxCoeff());
    return 16 * std::numeric_limits<double>::epsilon() * largest;
}

/// A plane that is known up to rounding: it may be displaced by `offset` and turned by `slope`.
struct RoundedPlane {
    Vec3d origin, normal;
    double offset;     ///< [scene units]
    double slope = 0;  ///< [scene units per scene unit of distance from the origin]

    /// Positive on the side of the normal, 0 where rounding hides the side.
    double height(const Vec3d& p) const {
        const Vec3d way = p - origin;
        const double height = normal.dot(way);
        return std::abs(height) <= offset + slope * way.norm() ? 0 : height;
    }
};

/// The part of a polygon of at most 4 vertices that lies on the side of the plane to which the normal points.
/// Vertices of height 0 are kept; the part of a polygon that lies in the plane is empty. Source: Sutherland
/// and Hodgman 1974.
inline ConvexRegion front_part(std::span<const Vec3d> vertices, const RoundedPlane& plane) {
    std::array<double, ConvexRegion::max_vertices> heights;
    double highest = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        heights[i] = plane.height(vertices[i]);
        highest = std::max(highest, heights[i]);
    }
    ConvexRegion part;
    if (!(highest > 0)) return part;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const std::size_t next = i + 1 == vertices.size() ? 0 : i + 1;
        if (heights[i] >= 0) part.add(vertices[i]);
        if ((heights[i] < 0 && heights[next] > 0) || (heights[i] > 0 && heights[next] < 0))
            part.add(vertices[i] + heights[i] / (heights[i] - heights[next]) * (vertices[next] - vertices[i]));
    }
    return part;
}

}  // namespace gib
