#include "experiments/photons/surfaces.h"

#include "common/scene/scene.h"
#include "experiments/photons/stored_light.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

/// Pieces around and along curved shapes: the chords of a circle keep within 0.12 % of its radius.
constexpr std::size_t around = 64, along = 32;

const Color lamp_color(1.f, 0.85f, 0.45f), see_through_color(0.45f, 0.62f, 0.8f);

struct Corner {
    Vec3 p, n;  ///< in the coordinates of the shape
};
using Triangle = std::array<Corner, 3>;

/// A shape in its place.
struct Placed {
    std::uint32_t shape, instance;
};

std::size_t triangle_count(const Shape& shape) {
    if (const auto* mesh = std::get_if<Mesh>(&shape)) return mesh->triangles.size();
    if (std::holds_alternative<Disk>(shape)) return around;
    return std::holds_alternative<Cylinder>(shape) ? 2 * around : 2 * around * along;
}

Triangle triangle_of(const Mesh& mesh, std::size_t i) {
    const auto& indices = mesh.triangles[i];
    const Vec3 face = mesh.normal_of(i).normalized().cast<float>();
    Triangle triangle;
    for (std::size_t k = 0; k < 3; ++k)
        triangle[k] = {mesh.vertex(indices[k]), mesh.normals.empty() ? face : mesh.normals[indices[k]]};
    return triangle;
}

/// The point at `turn` of a full turn and at `height` in [0, 1] along the shape.
Corner corner_of(const Sphere& sphere, float turn, float height) {
    const float theta = pi * height, phi = 2 * pi * turn;
    const Vec3 n =
        sphere.axes * Vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
    return {sphere.center + sphere.radius * n, n};
}
Corner corner_of(const Disk& disk, float turn, float height) {
    const float phi = 2 * pi * turn;
    return {disk.center + height * (std::cos(phi) * disk.du + std::sin(phi) * disk.dv), disk.normal};
}
Corner corner_of(const Cylinder& cylinder, float turn, float height) {
    const float phi = 2 * pi * turn;
    const Vec3 n = std::cos(phi) * cylinder.s + std::sin(phi) * cylinder.t;
    return {cylinder.base + height * cylinder.axis + cylinder.radius * n, n};
}

/// Triangle i of a curved shape cut into `rows` rings of quadrilaterals.
template <typename Curved>
Triangle triangle_of(const Curved& shape, std::size_t i, std::size_t rows) {
    const std::size_t quad = i / 2, column = quad % around, row = quad / around;
    const auto at = [&](std::size_t du, std::size_t dv) {
        return corner_of(shape, static_cast<float>(column + du) / around,
                         static_cast<float>(row + dv) / static_cast<float>(rows));
    };
    return i % 2 == 0 ? Triangle{at(0, 0), at(1, 0), at(1, 1)} : Triangle{at(0, 0), at(1, 1), at(0, 1)};
}
Triangle triangle_of(const Sphere& sphere, std::size_t i) { return triangle_of(sphere, i, along); }
Triangle triangle_of(const Cylinder& cylinder, std::size_t i) { return triangle_of(cylinder, i, 1); }
Triangle triangle_of(const Disk& disk, std::size_t i) {
    const auto rim = [&](std::size_t k) { return corner_of(disk, static_cast<float>(k) / around, 1.f); };
    return {Corner{disk.center, disk.normal}, rim(i), rim(i + 1)};
}

/// Turns a triangle of a group into one of the scene.
void carry_to_scene(const Instance& instance, Triangle& triangle) {
    for (Corner& corner : triangle) {
        corner.p = (instance.linear * corner.p.cast<double>() + instance.translation).cast<float>();
        corner.n = (instance.inverse.transpose() * corner.n.cast<double>()).normalized().cast<float>();
    }
}

/// Whether a triangle has no area, so that it has no normal either.
bool is_degenerate(const Triangle& t) { return !((t[1].p - t[0].p).cross(t[2].p - t[0].p).squaredNorm() > 0.f); }

struct SurfaceColor {
    Color color;
    bool opaque;
};

/// The colour of a triangle at its middle.
SurfaceColor color_of(const Scene& scene, const Placed& placed, std::size_t primitive, const Triangle& triangle) {
    const Vec3 middle = (triangle[0].p + triangle[1].p + triangle[2].p) * (1 / 3.f);
    const Intersection at{.shape = placed.shape,
                          .primitive = static_cast<std::uint32_t>(primitive),
                          .instance = placed.instance,
                          .u = 1 / 3.f,
                          .t = 0.f,
                          .v = 1 / 3.f};
    const Vec3 ng = scene.surface_hit({middle, Vec3::UnitZ()}, at)->ng;
    const auto hit = scene.surface_hit({middle, ng}, at);  // along ng, about which the normals agree
    if (hit->emitter) return {lamp_color, true};
    const ScatteringCoefficients front = hit->bsdf->coefficients_local(Vec3::UnitZ()),
                                 back = hit->bsdf->coefficients_local(-Vec3::UnitZ());
    if (!is_black(front.diffuse)) return {front.diffuse, true};
    if (!is_black(back.diffuse)) return {back.diffuse, true};
    return {see_through_color * front.specular.max(back.specular), false};
}

void append(SurfaceTriangles& out, const Triangle& triangle, const Color& color) {
    const Color c = color.max(0.f).min(1.f);
    for (const Corner& corner : triangle) {
        out.positions.push_back({corner.p.x(), corner.p.y(), corner.p.z()});
        std::array<std::int8_t, 4> normal{};
        std::array<std::uint8_t, 4> bytes{0, 0, 0, 255};
        for (int i = 0; i < 3; ++i) {
            const auto k = static_cast<std::size_t>(i);
            normal[k] = static_cast<std::int8_t>(std::lround(127 * std::clamp(corner.n[i], -1.f, 1.f)));
            bytes[k] = static_cast<std::uint8_t>(std::lround(255 * c[i]));
        }
        out.normals.push_back(normal);
        out.colors.push_back(bytes);
    }
}

std::vector<Placed> placed_shapes(const Scene& scene) {
    const auto& begin = scene.groups().begin;
    const auto shapes = static_cast<std::uint32_t>(scene.shapes().size());
    std::vector<Placed> placed;
    for (std::uint32_t shape = 0; shape < (begin.empty() ? shapes : begin[0]); ++shape)
        placed.push_back({shape, no_instance});
    for (std::uint32_t i = 0; i < scene.instances().size(); ++i) {
        const std::uint32_t group = scene.instances()[i].group;
        const std::uint32_t end = group + 1 < begin.size() ? begin[group + 1] : shapes;
        for (std::uint32_t shape = begin[group]; shape < end; ++shape)
            placed.push_back({shape, i});
    }
    return placed;
}

template <typename T>
void extend(std::vector<T>& vector, const std::vector<T>& by) {
    vector.insert(vector.end(), by.begin(), by.end());
}

}  // namespace

SurfaceTriangles surface_triangles(const Scene& scene, std::size_t most) {
    const std::vector<Placed> placed = placed_shapes(scene);
    SurfaceTriangles opaque, other;
    std::vector<std::size_t> counts;
    for (const Placed& one : placed)
        counts.push_back(triangle_count(scene.shapes()[one.shape]));
    const std::vector<std::size_t> shown = even_shares(counts, most);
    for (std::size_t i = 0; i < placed.size(); ++i) {
        const Shape& shape = scene.shapes()[placed[i].shape];
        for (std::size_t k = 0; k < counts[i]; ++k) {
            Triangle triangle = std::visit([&](const auto& s) { return triangle_of(s, k); }, shape);
            if (is_degenerate(triangle)) continue;
            ++opaque.whole;
            if (!is_at_step(k, counts[i], shown[i])) continue;
            if (placed[i].instance != no_instance) carry_to_scene(scene.instances()[placed[i].instance], triangle);
            const bool mesh = std::holds_alternative<Mesh>(shape);
            const SurfaceColor color = color_of(scene, placed[i], mesh ? k : 0, triangle);
            append(color.opaque ? opaque : other, triangle, color.color);
        }
    }
    opaque.opaque = opaque.count();
    extend(opaque.positions, other.positions);
    extend(opaque.normals, other.normals);
    extend(opaque.colors, other.colors);
    return opaque;
}

}  // namespace gib
