#pragma once
// Charts are the flat pieces of a scene's surfaces that radiosity divides into patches, with two coordinates u and v
// each. Two coplanar triangles of a mesh that form a convex quadrilateral (often a parallelogram) are one chart; every
// other triangle is one of its own. Spheres, disks and cylinders are cut into quadrilaterals at the start; those at a
// pole have two corners in the same place. If several surfaces lie in the same place, rays meet only the first of
// them, so only the first has a chart.

#include "methods/parts/transport/ray_queries.h"
#include "methods/radiosity/form_factors/polygon_form_factor.h"

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace gib {

struct Chart {
    std::uint32_t shape, instance;                       ///< as SurfaceHit has them
    std::uint32_t primitive = 0;                         ///< number of the first triangle in a mesh
    std::uint32_t second = 0;                            ///< number of the other triangle of a mesh's quadrilateral
    bool triangle = false;                               ///< three corners: u + v <= 1
    bool curved = false;                                 ///< cut from a sphere, disk or cylinder
    bool reversed = false;                               ///< true if u turns to v clockwise, seen from the front
    Vec2d lower = Vec2d::Zero(), upper = Vec2d::Zero();  ///< coordinates on a curved shape, turns first
    /// The corners at (u, v) = (0, 0), (1, 0), (1, 1) and (0, 1) [scene units]; a triangle's third is at (0, 1).
    std::array<Vec3d, 4> corners = {};

    /// The point of the flat chart [scene units].
    Vec3d position(const Vec2d& uv) const;
    /// The lengths of the longer edges along u and along v [scene units].
    Vec2d lengths() const;
};

class Charts {
public:
    /// Makes the charts of all surfaces with an area, in the order of the scene's shapes and then of its instances.
    /// Pieces of curved shapes have edges of at most about `size` [scene units], and their normals differ by at most
    /// 0.5 rad. Only the first of several charts with the same corners is kept. `scene` must outlive this.
    Charts(const Scene& scene, double size);

    const Scene& scene() const { return scene_; }
    std::size_t size() const { return charts_.size(); }
    const Chart& operator[](std::size_t i) const { return charts_[i]; }

    /// The point of the surface at uv in [0, 1]^2, with its material; no ray is traced. It lies on a curved shape
    /// itself, not on the chart.
    SurfaceHit surface_at(const Chart& chart, const Vec2d& uv) const;

    struct Place {
        std::uint32_t chart;
        Vec2d uv;
    };
    /// The chart of a hit and its coordinates there; empty where there is no chart.
    std::optional<Place> locate(const SurfaceHit& hit) const;

private:
    using Outline = std::array<std::array<double, 3>, 4>;  ///< sorted corners, which identify a chart
    /// A shape, or a shape in an instance: its first entry in chart_of_, and the number of pieces around and along it.
    struct Object {
        std::size_t first;
        std::uint32_t around = 0, along = 0;
    };

    void add_shape(std::uint32_t shape, std::uint32_t instance);
    void add_mesh(const Mesh& mesh, std::uint32_t shape, std::uint32_t instance);
    void add_curved(std::uint32_t shape, std::uint32_t instance);
    /// Adds a chart and returns its number. Instead of one in the place of another, it returns the number of the other
    /// if both face the same way, because a ray that meets the twin has met that surface; else none, because the twin
    /// is the back of that surface.
    std::uint32_t add(Chart chart);
    Vec3d to_scene(const Vec3d& p, std::uint32_t instance) const;

    const Scene& scene_;
    double size_;
    std::vector<Chart> charts_;
    std::map<Outline, std::uint32_t> known_;  ///< the first chart with each outline
    std::vector<std::size_t> first_object_;   ///< by instance; objects are the scene's own shapes, then the instances'
    std::vector<Object> objects_;
    std::vector<std::uint32_t> chart_of_;  ///< by triangle or piece
};

}  // namespace gib
