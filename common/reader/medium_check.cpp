#include "common/reader/medium_check.h"

#include "common/sampling/warp.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <tuple>
#include <utility>

namespace gib {

namespace {

constexpr std::uint32_t rays_of_camera = 256, rays_of_lamp = 64;
constexpr std::size_t most_lamps = 256;
constexpr int most_crossings = 64;
/// Rounding may lead a single ray through an edge.
constexpr int rays_to_be_sure = 2;

bool lets_light_pass(const Scene& scene, const SurfaceHit& hit) {
    const Material& material = scene.material_of_shape(hit.shape);
    return material.has_holes() || material.traits().transmission;
}

/// Follows rays from boundary to boundary and collects the contradictions that they meet.
class Tracker {
public:
    Tracker(const Scene& scene, const NamedMedia& media) : scene_(scene), media_(media) {}

    void follow(Ray ray, std::uint32_t medium, const char* source) {
        std::optional<std::uint32_t> entered;  // the boundary that the ray has crossed last
        for (int crossings = 0; crossings < most_crossings; ++crossings) {
            const auto hit = scene_.intersect(ray);
            if (!hit) return;
            const MediumSides& sides = media_.shapes[hit->shape].sides;
            const bool from_inside = ray.d.dot(hit->ng) > 0.f;
            if (sides.boundary) {
                const std::uint32_t named = from_inside ? sides.interior : sides.exterior;
                if (named != medium) return note({hit->shape, from_inside, medium}, entered, source);
                medium = from_inside ? sides.exterior : sides.interior;
                entered = hit->shape;
            }
            if (!lets_light_pass(scene_, *hit)) return;
            ray = hit->spawn_ray(ray.d);
        }
    }

    /// Finds the medium inside the first boundary that a ray from the camera leaves. It is no_medium where the ray escapes, or enters
    /// a boundary without a medium outside, and empty where the ray ends on a surface or enters another boundary.
    std::optional<std::uint32_t> left_by(Ray ray) const {
        for (int crossings = 0; crossings < most_crossings; ++crossings) {
            const auto hit = scene_.intersect(ray);
            if (!hit) return no_medium;
            const MediumSides& sides = media_.shapes[hit->shape].sides;
            if (sides.boundary && ray.d.dot(hit->ng) > 0.f) return sides.interior;
            if (sides.boundary) return sides.exterior == no_medium ? std::optional(no_medium) : std::nullopt;
            if (!lets_light_pass(scene_, *hit)) return std::nullopt;
            ray = hit->spawn_ray(ray.d);
        }
        return std::nullopt;
    }

    /// The medium at p by the boundaries between the camera and p.
    std::uint32_t medium_at(const Vec3& p) const {
        std::uint32_t medium = media_.camera;
        Vec3 origin = camera();
        for (int crossings = 0; crossings < most_crossings; ++crossings) {
            const Ray way{.o = origin, .d = p - origin, .t_max = 1.f};
            const auto hit = scene_.intersect(way);
            if (!hit) break;
            const MediumSides& sides = media_.shapes[hit->shape].sides;
            if (sides.boundary) medium = way.d.dot(hit->ng) > 0.f ? sides.exterior : sides.interior;
            origin = offset_origin(*hit, way.d);
            if (!((p - origin).dot(way.d) > 0.f)) break;
        }
        return medium;
    }

    /// A ray from infinity begins in this medium.
    void note_endless(std::uint32_t medium) { ++endless_[medium]; }

    std::vector<std::string> warnings() const {
        std::vector<std::string> texts;
        for (const auto& [medium, rays] : endless_)
            if (rays >= rays_to_be_sure)
                texts.push_back(fmt::format(
                    "{} has no boundary around the scene, so that no light comes through it from infinity (emitters "
                    "directional, constant, envmap and skies)",
                    name(medium)));
        for (const auto& [at, found] : found_)
            if (found.rays >= rays_to_be_sure) texts.push_back(text(at, found));
        return texts;
    }

    /// The start of the camera's middle ray.
    Vec3 camera() const {
        const Sensor& sensor = scene_.sensor();
        const Ray middle = sensor.generate_ray(sensor.width() / 2, sensor.height() / 2, Vec2(0.5f, 0.5f));
        return middle.o + middle.t_min * middle.d;
    }

private:
    struct Contradiction {
        std::uint32_t shape;
        bool from_inside;
        std::uint32_t medium;  ///< medium in which the rays arrive
        bool operator<(const Contradiction& other) const {
            return std::tie(shape, from_inside, medium) < std::tie(other.shape, other.from_inside, other.medium);
        }
    };
    struct Found {
        int rays = 0;
        std::optional<std::uint32_t> entered;
        const char* source;
    };

    void note(const Contradiction& at, const std::optional<std::uint32_t>& entered, const char* source) {
        Found& found = found_.try_emplace(at, Found{0, entered, source}).first->second;
        ++found.rays;
    }

    std::string name(std::uint32_t medium) const { return medium == no_medium ? "no medium" : media_.names[medium]; }

    std::string text(const Contradiction& at, const Found& found) const {
        const NamedMedia::Boundary& boundary = media_.shapes[at.shape];
        const std::uint32_t named = at.from_inside ? boundary.sides.interior : boundary.sides.exterior;
        const std::string since =
            found.entered
                ? fmt::format("since {}", format_location(media_.shapes[*found.entered].where, "the boundary"))
                : fmt::format("from the {}", found.source);
        return format_location(
            boundary.where,
            fmt::format(
                "media contradict each other: rays of the {} arrive here in {} ({}), but the {} of this shape is "
                "{}",
                found.source, name(at.medium), since, at.from_inside ? "interior" : "exterior", name(named)));
    }

    const Scene& scene_;
    const NamedMedia& media_;
    std::map<Contradiction, Found> found_;
    std::map<std::uint32_t, int> endless_;  ///< rays from infinity that begin in a medium
};

void follow_camera(const Scene& scene, const NamedMedia& media, Tracker& tracker) {
    const Sensor& sensor = scene.sensor();
    for (std::uint32_t i = 0; i < rays_of_camera; ++i) {
        const Sampler u(PointSet::sobol, 0, 0, i);
        const Vec2 at = u.get_2d(dimension::first_vertex);
        tracker.follow(sensor.sample_ray(static_cast<int>(at.x() * static_cast<float>(sensor.width())),
                                         static_cast<int>(at.y() * static_cast<float>(sensor.height())), u),
                       media.camera, "camera");
    }
}

void follow_lamps(const Scene& scene, Tracker& tracker) {
    const auto& lights = scene.lights();
    const std::size_t step = lights.size() / most_lamps + 1;
    for (std::size_t light = 0; light < lights.size(); light += step)
        for (std::uint32_t i = 0; i < rays_of_lamp; ++i) {
            const Sampler u(PointSet::sobol, 0, light, i);
            const Ray ray = sample_emission(lights[light], scene.shapes(), u.get_2d(dimension::emission_position),
                                            u.get_2d(dimension::emission_direction))
                                .ray;
            const std::uint32_t medium = tracker.medium_at(ray.o);
            if (medium != no_medium && is_at_infinity(lights[light])) tracker.note_endless(medium);
            tracker.follow(ray, medium, "lamp");
        }
}

using Corner = std::array<float, 3>;
using Edge = std::pair<Corner, Corner>;

/// Adds the edges of a mesh by the places of their ends, as meshes repeat a vertex that has several normals. Edges of no
/// length are left out.
void add_edges(const Mesh& mesh, std::vector<Edge>& edges) {
    for (const auto& triangle : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            Edge edge{mesh.vertices[triangle[i]], mesh.vertices[triangle[(i + 1) % 3]]};
            for (Corner* corner : {&edge.first, &edge.second})
                for (float& x : *corner)
                    x += 0.f;  // -0 becomes 0
            if (edge.second < edge.first) std::swap(edge.first, edge.second);
            if (edge.first != edge.second) edges.push_back(edge);
        }
}

std::size_t open_edges(std::vector<Edge>& edges) {
    std::sort(edges.begin(), edges.end());
    std::size_t open = 0;
    for (auto from = edges.begin(); from != edges.end();) {
        const auto to = std::find_if(from, edges.end(), [&](const Edge& edge) { return edge != *from; });
        if (to - from == 1) ++open;
        from = to;
    }
    return open;
}

}  // namespace

std::vector<std::string> contradictions(const Scene& scene, const NamedMedia& media) {
    if (!scene.has_media()) return {};
    Tracker tracker(scene, media);
    follow_camera(scene, media, tracker);
    follow_lamps(scene, tracker);
    return tracker.warnings();
}

std::optional<std::uint32_t> medium_around_camera(const Scene& scene, const NamedMedia& media) {
    if (!scene.has_media() || media.camera != no_medium) return std::nullopt;
    const Tracker tracker(scene, media);
    std::optional<std::uint32_t> around;
    for (std::uint32_t i = 0; i < rays_of_camera; ++i) {
        const Vec2 u = Sampler(PointSet::sobol, 0, 0, i).get_2d(dimension::first_vertex);
        const auto left = tracker.left_by({.o = tracker.camera(), .d = square_to_sphere(u)});
        if (!left) continue;
        if (*left == no_medium || (around && *around != *left)) return std::nullopt;
        around = left;
    }
    return around;
}

std::vector<std::string> open_boundaries(const Scene& scene, const NamedMedia& media) {
    std::vector<std::string> warnings;
    std::set<std::uint32_t> done;
    for (const auto& [where, sides] : media.shapes) {
        const std::uint32_t medium = sides.interior;
        if (medium == no_medium || !done.insert(medium).second) continue;
        std::vector<Edge> edges;
        for (std::size_t i = 0; i < media.shapes.size(); ++i)
            if (const auto* mesh = std::get_if<Mesh>(&scene.shapes()[i]);
                mesh && media.shapes[i].sides.interior == medium)
                add_edges(*mesh, edges);
        if (const std::size_t open = open_edges(edges); open > 0)
            warnings.push_back(format_location(
                where,
                fmt::format("the boundary of {} is open: {} of its edges belong to one triangle only. Light that "
                            "passes a hole stays in the medium that it was in",
                            media.names[medium], open)));
    }
    return warnings;
}

}  // namespace gib
