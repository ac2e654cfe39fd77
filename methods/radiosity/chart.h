#pragma once
// Charts are the pieces of a scene's surfaces that radiosity divides into patches, with two coordinates u and v each.
// Two coplanar triangles of a mesh that form a convex quadrilateral (often a parallelogram) are one chart; every
// other triangle is one of its own. A sphere has six charts (the faces of a cube around it), a cylinder four, a disk
// one. If several surfaces lie in the same place, rays meet only the first of them, so only the first has a chart.

#include "methods/parts/transport/ray_queries.h"
#include "methods/radiosity/form_factors/polygon_form_factor.h"

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace gib {

/// An exact point of a chart: integer coordinates in units of 1 / chart_unit. On a triangle u + v <= chart_unit.
struct ChartPoint {
    std::uint32_t u = 0, v = 0;
    friend bool operator==(const ChartPoint&, const ChartPoint&) = default;
};
inline constexpr std::uint32_t chart_unit = 1u << 24;
inline std::uint64_t key_of(const ChartPoint& point) { return std::uint64_t{point.u} << 32 | point.v; }
inline Vec2d uv_of(const ChartPoint& point) { return Vec2d(point.u, point.v) / chart_unit; }

struct Chart {
    enum class Kind { triangle, quad, sphere, disk, cylinder };
    Kind kind;
    std::uint32_t shape, instance;  ///< as SurfaceHit has them
    std::uint32_t primitive = 0;    ///< of a mesh: the first triangle
    std::uint32_t second = 0;       ///< of a quad: the other triangle
    std::uint32_t part = 0;         ///< of a sphere: the face of the cube; of a cylinder: the quarter
    bool reversed = false;          ///< true if u turns to v clockwise, seen from the front
    /// The corners of a triangle or quad at (u, v) = (0, 0), (1, 0), (1, 1) and (0, 1); a triangle's third is at (0, 1).
    std::array<Vec3d, 4> corners = {};
    Vec2d lengths = Vec2d::Zero();  ///< the longest line along u and along v [scene units]

    bool is_flat() const { return kind != Kind::sphere && kind != Kind::cylinder; }
};

class Charts {
public:
    /// Makes the charts of all surfaces with an area, in the order of the scene's shapes and then of its instances.
    /// Only the first of several triangles with the same corners, or of several equal curved shapes, has charts.
    /// `scene` must outlive this.
    explicit Charts(const Scene& scene);

    const Scene& scene() const { return scene_; }
    std::size_t size() const { return charts_.size(); }
    const Chart& operator[](std::size_t i) const { return charts_[i]; }

    /// The point of the surface at uv in [0, 1]^2, with its material; no ray is traced.
    SurfaceHit surface_at(const Chart& chart, const Vec2d& uv) const;
    /// The position of that point [scene units], in double.
    Vec3d position(const Chart& chart, const Vec2d& uv) const;
    /// The area [scene units^2] of the piece with the corners `lower` and `upper` of a sphere's, disk's
    /// or cylinder's chart.
    double curved_area(const Chart& chart, const ChartPoint& lower, const ChartPoint& upper) const;

    struct Place {
        std::uint32_t chart;
        Vec2d uv;
    };
    /// The chart of a hit and its coordinates there; empty where there is no chart.
    std::optional<Place> locate(const SurfaceHit& hit) const;

private:
    /// Points [scene units] that tell a surface from others; the corners of a triangle are sorted.
    using Outline = std::array<std::array<double, 3>, 5>;
    using Outlines = std::map<Outline, std::uint32_t>;  ///< the first chart with each outline

    void add_shape(std::uint32_t shape, std::uint32_t instance, Outlines& known);
    void add_mesh(const Mesh& mesh, std::uint32_t shape, std::uint32_t instance, Outlines& known);
    /// The chart for hits on `twin`, a surface in the same place as the chart `known`: `known` if both face
    /// the same way, because a ray that meets the twin has met that surface; else none, because it is the back
    /// of that surface.
    std::uint32_t chart_of_twin(const Chart& twin, std::uint32_t known) const;
    void finish(Chart& chart) const;
    Vec3d to_scene(const Vec3d& p, std::uint32_t instance) const;
    Vec3d to_shape(const Vec3d& p, std::uint32_t instance) const;
    std::size_t object_of(std::uint32_t shape, std::uint32_t instance) const;

    const Scene& scene_;
    std::vector<Chart> charts_;
    /// By instance: the number of its first object. Objects are the scene's own shapes, then those of each instance.
    std::vector<std::size_t> first_object_;
    std::vector<std::size_t> first_of_;    ///< by object: for a mesh an index into chart_of_, else the first chart
    std::vector<std::uint32_t> chart_of_;  ///< by triangle
};

}  // namespace gib
