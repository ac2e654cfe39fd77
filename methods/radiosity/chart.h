#pragma once
// The surfaces of a scene as charts: pieces with two coordinates each, which radiosity divides into patches. A
// parallelogram or another convex quadrilateral of two coplanar triangles of a mesh is one chart, every other
// triangle is one of its own; a sphere has six (the faces of a cube around it), a cylinder four, a disk one. Of
// surfaces in the same place no ray meets any but the first, so only that one has a chart.

#include "methods/parts/transport/ray_queries.h"
#include "methods/radiosity/form_factors/polygon_form_factor.h"

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace gib {

/// A place on a chart, exactly: coordinates in units of 1 / chart_unit. On a triangle u + v <= chart_unit.
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
    bool reversed = false;          ///< its front is the side from which u turns to v clockwise
    std::array<Vec3d, 4> corners =
        {};  ///< of a triangle or quad, at (0, 0), (1, 0), (1, 1) and (0, 1); a triangle's third at (0, 1)
    Vec2d lengths = Vec2d::Zero();  ///< the longest way along u and along v [scene units]

    bool is_flat() const { return kind != Kind::sphere && kind != Kind::cylinder; }
};

class Charts {
public:
    /// Of all surfaces with an area, in the order of the scene's shapes and then of its instances; of triangles with
    /// the same corners and of equal curved shapes, of the first. `scene` must outlive this.
    explicit Charts(const Scene& scene);

    const Scene& scene() const { return scene_; }
    std::size_t size() const { return charts_.size(); }
    const Chart& operator[](std::size_t i) const { return charts_[i]; }

    /// The point of the surface at uv in [0, 1]^2, with its material; no ray is traced.
    SurfaceHit surface_at(const Chart& chart, const Vec2d& uv) const;
    /// The same place on the surface, in double and without its material.
    Vec3d position(const Chart& chart, const Vec2d& uv) const;
    /// [scene units^2] of the piece with the corners lower and upper of a chart that is no triangle or quad.
    double curved_area(const Chart& chart, const ChartPoint& lower, const ChartPoint& upper) const;

    struct Place {
        std::uint32_t chart;
        Vec2d uv;
    };
    /// Where a hit lies; empty where there is no chart.
    std::optional<Place> locate(const SurfaceHit& hit) const;

private:
    /// The places [scene units] that tell a surface from others; those of a triangle in an order of their own.
    using Outline = std::array<std::array<double, 3>, 5>;
    using Outlines = std::map<Outline, std::uint32_t>;  ///< to the first chart there

    void add_shape(std::uint32_t shape, std::uint32_t instance, Outlines& known);
    void add_mesh(const Mesh& mesh, std::uint32_t shape, std::uint32_t instance, Outlines& known);
    /// That of the surface in whose place the twin lies, where a ray that meets the twin has met that surface: if both
    /// face the same way. Else none: the twin is seen from the side that lies behind.
    std::uint32_t chart_of_twin(const Chart& twin, std::uint32_t known) const;
    void finish(Chart& chart) const;
    Vec3d to_scene(const Vec3d& p, std::uint32_t instance) const;
    Vec3d to_shape(const Vec3d& p, std::uint32_t instance) const;
    std::size_t object_of(std::uint32_t shape, std::uint32_t instance) const;

    const Scene& scene_;
    std::vector<Chart> charts_;
    std::vector<std::size_t>
        first_object_;  ///< by instance: its first among the objects; those of the scene itself come first
    std::vector<std::size_t> first_of_;    ///< by object: of a mesh into chart_of_, else the first chart
    std::vector<std::uint32_t> chart_of_;  ///< by triangle
};

}  // namespace gib
