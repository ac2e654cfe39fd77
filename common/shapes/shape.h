#pragma once
// Geometry: a closed set of shapes, the surface at the point where a ray hits one, and uniform points on them. Shapes
// are in world space, those of a group of instances in the group's coordinates.

#include "common/core/huge_pages.h"
#include "common/core/math.h"
#include "common/images/texture_point.h"
#include "common/sampling/warp.h"

#include <array>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

namespace gib {

/// A point on a surface, with what a ray that starts there needs.
struct SurfacePoint {
    Vec3 p;
    Vec3 ng;       ///< geometric normal, unit; it points to the front side
    float offset;  ///< [scene units] bound, along +-ng, of the rounding of p and of a ray query from p
};

/// The geometric normal on wo's side.
inline Vec3 normal_towards(const SurfacePoint& s, const Vec3& wo) { return wo.dot(s.ng) >= 0.f ? s.ng : Vec3(-s.ng); }

struct SurfaceGeometry : SurfacePoint {
    Vec3 ns;                      ///< shading normal, unit
    Vec2 uv;                      ///< of a hit only where its material or emission asks for it
    std::uint32_t primitive = 0;  ///< number of the triangle in a mesh
    Vec2 weights = Vec2::Zero();  ///< barycentric weights of the triangle's second and third vertex

    TexturePoint texture_point() const { return {uv, primitive, weights}; }
};

/// A mesh of triangles. The array of vertices has an extra element at the end, because Embree reads 16 bytes at
/// the last vertex.
struct Mesh {
    std::vector<std::array<float, 3>> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Vec3> normals;  ///< normals per vertex, unit; empty: face normals
    std::vector<Vec2> uvs;      ///< coordinates per vertex; empty: barycentric ones
    bool flip_normals = false;

    /// All data that a point of a triangle is computed from, in one cache line. In a large mesh every ray waits until
    /// these data are fetched; without facets it would wait twice, for the indices and then for the vertices. The
    /// path tracer's rate on ten million triangles rises by 5 %.
    struct alignas(64) Facet {
        using Four [[gnu::vector_size(16)]] = float;
        Four v0;      ///< the first vertex ([0] to [2]); the offset of points ([3])
        Four e1, e2;  ///< edges from there to the second and third; least b1, b2 of points ([3])
        Four ng;      ///< the unit normal; the least 1 - b1 - b2 of points ([3])

        /// The point v0 + b1 e1 + b2 e2, kept as far from the edges as rounding can move it: at a point beyond an edge
        /// of a closed mesh, a ray would start outside the mesh.
        SurfacePoint point_at(float b1, float b2) const;

    private:
        /// Moves the weights to the nearest ones, or nearly, that are no less than the least weights.
        void keep_off_edges(float& b1, float& b2) const;
    };
    HugePageVector<Facet> facets;  ///< made by prepare(); if empty, computed for each point
    /// Makes `facets`. To be called once the other members are final. Throws InputError if there is
    /// not enough memory.
    void prepare();

    /// Facet::point_at() of triangle i.
    SurfacePoint point_at(std::size_t i, float b1, float b2) const {
        return facets.empty() ? facet_of(i).point_at(b1, b2) : facets[i].point_at(b1, b2);
    }
    /// The same point with its shading normal and uv.
    SurfaceGeometry surface_at(std::size_t i, float b1, float b2) const;

    Vec3 vertex(std::uint32_t i) const { return {vertices[i][0], vertices[i][1], vertices[i][2]}; }
    /// (v1 - v0) x (v2 - v0) of triangle i, towards its front side; its length is twice the area.
    Vec3d normal_of(std::size_t i) const;

private:
    Facet facet_of(std::size_t i) const;
    /// The unit shading normal, interpolated between the vertex normals; zero if their sum is.
    Vec3 interpolated_normal(std::size_t i, float b1, float b2) const;
};

struct Sphere {
    Vec3 center;
    float radius;
    bool flip_normals = false;
    Eigen::Matrix3f axes = Eigen::Matrix3f::Identity();  ///< columns: its own x, y, z, orthonormal; uv turn with them

    /// The unit vector from the centre towards p.
    Vec3 direction_to(const Vec3& p) const;
    /// The point in the unit vector's direction from the centre.
    SurfacePoint point_at(const Vec3& direction) const;
    /// The point nearest to p.
    SurfacePoint point_near(const Vec3& p) const { return point_at(direction_to(p)); }
    /// uv of the point in the unit vector's direction: longitude and angle from the north pole in the sphere's own
    /// axes, each as a fraction of its range.
    Vec2 uv_at(const Vec3& direction) const;
};

/// The ellipse center + a du + b dv with a^2 + b^2 <= 1. du and dv are orthogonal and need not have unit length.
struct Disk {
    Vec3 center, du, dv;
    Vec3 normal;
};

/// The side of a cylinder, without its ends: base + v axis + radius (cos(phi) s + sin(phi) t) with v in [0, 1].
struct Cylinder {
    Vec3 base, axis;
    Vec3 s, t;  ///< unit, at right angles to each other and to the axis
    float radius;
    bool flip_normals = false;
};

using Shape = std::variant<Mesh, Sphere, Disk, Cylinder>;

Bounds bounds_of(const Shape& shape);
/// The area [scene units^2].
double area_of(const Shape& shape);
bool has_smooth_normals(const Shape& shape);

/// The derivatives of p with respect to u and v [scene units]. They do not depend on flip_normals.
struct SurfaceDerivatives {
    Vec3 dp_du, dp_dv;
};

/// The surface at a hit. On a mesh, it is the point of triangle `primitive` with barycentric weights (u, v) of the
/// second and third vertex. Any other shape projects `p_ray`, the point computed from the ray, back onto itself, and
/// has uv only `with_uv`, which takes it two arc tangents.
SurfaceGeometry surface_at(const Shape& shape, std::uint32_t primitive, float u, float v, const Vec3& p_ray,
                           bool with_uv = true);
/// surface_at() for a shape that is not a mesh.
SurfaceGeometry surface_at_analytic(const Shape& shape, const Vec3& p_ray, bool with_uv = true);

/// The derivatives at the point `at` of a shape. If uv do not determine them (a triangle without uv, or with all of
/// them on a line), they are an orthonormal basis of the tangent plane, as in Mitsuba. At a pole of a sphere and in
/// the centre of a disk, the point does not move with the angle; the derivative with respect to the angle keeps its
/// direction there and is tiny instead of zero.
SurfaceDerivatives derivatives_at(const Shape& shape, std::uint32_t primitive, const SurfaceGeometry& at);

/// The linear map from a step of the point `at` along its surface to the change of the unit shading normal there
/// [1/scene units]. It is zero where a mesh has no normals of its own. Steps across the edge of a triangle do not count.
Eigen::Matrix3d normal_derivative(const Shape& shape, std::uint32_t primitive, const SurfaceGeometry& at);

/// The smallest t in (t_min, t_max) at which the ray meets a shape that is not a mesh. It is computed in double,
/// because in float the difference of nearly equal terms in a quadratic equation loses half of the digits (Haines et
/// al. 2019, Ray Tracing Gems, chapter 7).
std::optional<float> intersect(const Sphere& sphere, const Ray& ray);
std::optional<float> intersect(const Disk& disk, const Ray& ray);
std::optional<float> intersect(const Cylinder& cylinder, const Ray& ray);

/// Samples uniform points on a shape. The constructor prepares what is computed only once; facets that a mesh has by then
/// must outlive this.
class AreaSampler {
public:
    explicit AreaSampler(const Shape& shape);
    /// A uniform point, with density 1 / area() [1/scene units^2].
    SurfacePoint sample(const Shape& shape, const Vec2& u) const;
    /// The same point as sample(), with its shading normal and uv.
    SurfaceGeometry sample_geometry(const Shape& shape, const Vec2& u) const;
    float area() const { return area_; }

    /// Whether the shape is a mesh that had facets, and then the same point as sample().
    bool has_facets() const { return facets_; }
    SurfacePoint sample_facets(const Vec2& u) const {
        const MeshSample at = sample_mesh(u);
        return facets_[at.triangle].point_at(at.b.x(), at.b.y());
    }

    /// For a mesh: the triangle that sample() chooses for a first number u, the smallest such number of triangle i,
    /// and the position of u among the numbers of triangle i, from 0 to 1.
    std::size_t triangle_at(float u) const { return triangles_.sample(u).index; }
    float begin_of_triangle(std::size_t i) const { return triangles_.begin(i); }
    double within_triangle(std::size_t i, float u) const {
        return static_cast<double>(u - triangles_.begin(i)) / static_cast<double>(triangles_.probability(i));
    }

private:
    struct MeshSample {
        std::size_t triangle;
        Vec2 b;  ///< barycentric weights of its second and third vertex
    };
    MeshSample sample_mesh(const Vec2& u) const {
        const auto choice = triangles_.sample(u.x());
        return {choice.index, square_to_triangle(Vec2(choice.u, u.y()))};
    }
    const Mesh::Facet* facets_ = nullptr;  ///< facets of a mesh that has them
    DiscreteDistribution triangles_;       ///< choice of a mesh's triangle, in proportion to the areas
    float area_;
};

// The functions below are called for every ray. They are inline, so that the points stay in registers.

inline Vec3 Sphere::direction_to(const Vec3& p) const {
    const Vec3 from_center = p - center;
    // A point of a sphere smaller than an ulp of its coordinates may be the centre; any direction serves there.
    return from_center.isZero(0) ? Vec3(axes.col(2)) : from_center.normalized();
}

inline SurfacePoint Sphere::point_at(const Vec3& direction) const {
    SurfacePoint s;
    s.p = center + radius * direction;
    s.ng = (flip_normals ? -1.f : 1.f) * direction;
    // The offset bounds the rounding of the sum and of the unit vector's length, in each of three coordinates.
    s.offset = 8.f * unit_roundoff * (center.cwiseAbs().sum() + 3.f * radius);
    return s;
}

inline SurfacePoint Mesh::Facet::point_at(float b1, float b2) const {
    if (b1 < e1[3] || b2 < e2[3] || 1.f - b1 - b2 < ng[3]) keep_off_edges(b1, b2);
    const Four p = v0 + (b1 * e1 + b2 * e2);
    return {Vec3(p[0], p[1], p[2]), Vec3(ng[0], ng[1], ng[2]), v0[3]};
}

inline SurfaceGeometry Mesh::surface_at(std::size_t i, float b1, float b2) const {
    SurfaceGeometry s{point_at(i, b1, b2), Vec3(), Vec2(b1, b2), static_cast<std::uint32_t>(i), Vec2(b1, b2)};
    s.ns = s.ng;
    if (!normals.empty()) {
        const Vec3 ns = interpolated_normal(i, b1, b2);
        if (!ns.isZero(0)) s.ns = ns;
    }
    if (!uvs.empty()) {
        const auto& t = triangles[i];
        s.uv = (1.f - b1 - b2) * uvs[t[0]] + b1 * uvs[t[1]] + b2 * uvs[t[2]];
    }
    return s;
}

inline SurfaceGeometry surface_at(const Shape& shape, std::uint32_t primitive, float u, float v, const Vec3& p_ray,
                                  bool with_uv) {
    const auto* mesh = std::get_if<Mesh>(&shape);
    return mesh ? mesh->surface_at(primitive, u, v) : surface_at_analytic(shape, p_ray, with_uv);
}

}  // namespace gib
