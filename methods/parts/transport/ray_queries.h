#pragma once
// The ray queries of one block of work. Every method traces its rays through this class, so that all rays are
// counted, and can be recorded, in the same way.

#include "common/scene/scene.h"

#include <cstdint>
#include <span>
#include <vector>

namespace gib {

/// Rays in the order in which they were traced, for replay by a benchmark.
struct RayLog {
    struct Entry {
        Ray ray;
        bool shadow;  ///< the query asked only whether anything is hit
    };
    std::vector<Entry> entries;
};

/// A ray and its closest hit; the properties of the surface there are not computed yet.
struct TracedRay {
    Ray ray;
    std::optional<Intersection> found = {};
    bool hides_emitters = false;  ///< a ray of a camera that sees no emitters, up to the first scattering
};

/// The straight way between two points, both of them off their surfaces.
struct Segment {
    Vec3 origin, target;
    Vec3 direction;  ///< direction from the origin to the target, unit
    float distance;  ///< [scene units]; infinite if the target stands for a light at infinity
};

class RayQueries {
public:
    /// Rays are recorded in `log` unless it is null.
    explicit RayQueries(const Scene& scene, RayLog* log = nullptr) : scene_(scene), log_(log) {}

    const Scene& scene() const { return scene_; }
    std::uint64_t count() const { return count_; }

    std::optional<SurfaceHit> intersect(const Ray& ray) {
        note(ray, false);
        return scene_.intersect(ray);
    }
    /// trace() and surface_hit() are the two steps of intersect(): the first sets `traced.found`.
    void trace(TracedRay& traced) {
        note(traced.ray, false);
        scene_.accelerator().intersect(traced.ray, traced.found);
    }
    std::optional<SurfaceHit> surface_hit(const TracedRay& traced) const {
        return scene_.surface_hit(traced.ray, traced.found);
    }
    /// Traces a packet of 1 to Accelerator::packet_size rays.
    void trace(std::span<const Ray> rays, std::span<std::optional<Intersection>> found) {
        for (const Ray& ray : rays)
            note(ray, false);
        scene_.accelerator().intersect(rays, found);
        for (std::size_t i = 0; i < rays.size(); ++i)
            scene_.prefetch(found[i]);
    }
    /// The first surface that is more than the boundary of a medium: what bounds fog along a wall is no obstacle of what lies on
    /// the wall.
    std::optional<SurfaceHit> intersect_bodies(const Ray& ray) {
        TracedRay traced{ray};
        trace(traced);
        if (scene_.has_holes()) pass_boundaries(traced.ray, traced.found);
        return surface_hit(traced);
    }
    /// The same for a packet. A ray that has passed a boundary begins beyond it.
    void trace_bodies(std::span<Ray> rays, std::span<std::optional<Intersection>> found) {
        trace(rays, found);
        for (std::size_t i = 0; i < rays.size() && scene_.has_holes(); ++i)
            pass_boundaries(rays[i], found[i]);
    }
    /// Traces a packet of rays from the camera. If the camera lies on a surface, such as a lamp, its rays start
    /// beyond that surface: they are shortened accordingly.
    void trace_from_camera(std::span<Ray> rays, std::span<std::optional<Intersection>> found) {
        trace(rays, found);
        // A hit farther away than this is not under the camera, however small its angle with the ray.
        const float farthest = 1e-3f * scene_.diagonal();
        for (std::size_t i = 0; i < rays.size(); ++i)
            if (found[i] && found[i]->t <= farthest) pass_own_surfaces(rays[i], found[i], farthest);
    }
    /// Whether some ray of the camera starts on a surface, by a sample of its rays.
    bool camera_lies_on_surface() {
        const Sensor& sensor = scene_.sensor();
        for (std::uint32_t i = 0; i < 1024; ++i) {
            const Sampler u(PointSet::sobol, 0, 0, i);
            const Vec2 at = u.get_2d(dimension::first_vertex);
            Ray ray = sensor.sample_ray(static_cast<int>(at.x() * static_cast<float>(sensor.width())),
                                        static_cast<int>(at.y() * static_cast<float>(sensor.height())), u);
            const Vec3 start = ray.o;
            std::optional<Intersection> found;
            trace_from_camera(std::span(&ray, 1), std::span(&found, 1));
            if (ray.o != start) return true;
        }
        return false;
    }
    /// The share of light that passes from the light's point to the surface, by channel: 0 or 1, or a value between if
    /// there are surfaces that let light straight on (masks, thin sheets). Both ends are offset from their surfaces by
    /// the bound of their own rounding errors, so the segment between them needs no epsilon.
    Color visibility(const SurfacePoint& from, const LightSample& to) {
        return visibility({offset_origin(from, to.wi), to.target, to.wi, to.distance});
    }
    /// The same between any two points.
    Color visibility(const Segment& way) {
        if (scene_.has_holes()) return visibility_through_holes(way);
        const Ray ray{.o = way.origin, .d = way.target - way.origin, .t_max = 1.f};
        note(ray, true);
        return Color::Constant(scene_.occluded(ray) ? 0.f : 1.f);
    }

    /// The share of light that reaches `origin` in a scene with media, by channel: an unbiased estimate. `origin`
    /// lies in `medium`; null stands for vacuum.
    Color transmittance(const Vec3& origin, const Medium* medium, const LightSample& to, NumberStream& u) {
        return transmittance({origin, to.target, to.wi, to.distance}, medium, u);
    }
    /// The same between any two points; the origin lies in `medium`.
    Color transmittance(const Segment& way, const Medium* medium, NumberStream& u) {
        return transmittance(way, medium, u, [&](const SurfaceHit& hit) { return hit.straight_on(way.direction); });
    }

    /// The share of light that reaches the camera along its ray from a point at `target` off its surface, by channel.
    /// As for the rays that leave the camera, surfaces that the camera lies on do not count; `on_surface`: whether there
    /// may be any.
    Color transmittance_to_camera(Ray ray, const Vec3& target, bool on_surface, NumberStream& u) {
        const Vec3 way = target - ray.o;
        const float length = way.norm();
        ray.d = way / length;
        ray.t_max = std::min(ray.t_max, length);
        if (!on_surface && !scene_.has_holes() && !scene_.has_media() && !scene_.sensor().hides_emitters()) {
            note(ray, true);
            return Color::Constant(scene_.occluded(ray) ? 0.f : 1.f);
        }
        std::optional<Intersection> found;
        trace_from_camera(std::span(&ray, 1), std::span(&found, 1));
        const auto hit = scene_.surface_hit(ray, found);
        Color transmitted = hit ? passed_by_camera(*hit, ray.d) : Color(Color::Ones());
        if (is_black(transmitted)) return transmitted;
        const Medium* medium = scene_.camera_medium();
        if (medium)
            transmitted *=
                medium->transmittance(ray.o + ray.t_min * ray.d, ray.d, (hit ? found->t : ray.t_max) - ray.t_min, u);
        if (!hit) return transmitted;
        const Vec3 beyond = offset_origin(*hit, ray.d);
        if (is_past(beyond, target, ray.d)) return transmitted;
        const Segment rest{beyond, target, ray.d, (target - beyond).norm()};
        return transmitted * transmittance(rest, scene_.medium_beyond(*hit, ray.d, medium), u,
                                           [&](const SurfaceHit& next) { return passed_by_camera(next, ray.d); });
    }

    /// The medium at p in a scene with media; null stands for vacuum. The surfaces between the camera, whose medium
    /// is known, and p decide it.
    const Medium* medium_at(const Vec3& p) {
        const Medium* medium = scene_.camera_medium();
        const Sensor& sensor = scene_.sensor();
        const Ray middle = sensor.generate_ray(sensor.width() / 2, sensor.height() / 2, Vec2(0.5f, 0.5f));
        for (Vec3 origin = middle.o + middle.t_min * middle.d;;) {
            const Ray way{.o = origin, .d = p - origin, .t_max = 1.f};
            const auto hit = intersect(way);
            if (!hit) return medium;
            medium = scene_.medium_beyond(*hit, way.d, medium);
            if (!step_beyond(*hit, origin, p, way.d)) return medium;
        }
    }

private:
    /// The share of the camera's rays that pass a surface straight on.
    Color passed_by_camera(const SurfaceHit& hit, const Vec3& direction) const {
        return scene_.hidden_from_camera(hit) ? Color(Color::Ones()) : hit.straight_on(direction);
    }

    /// transmittance() with the share `passed(hit)` of light that each surface lets through.
    template <typename Passed>
    Color transmittance(Segment way, const Medium* medium, NumberStream& u, Passed passed) {
        for (Color transmitted = Color::Ones();;) {
            TracedRay part{Ray{.o = way.origin, .d = way.target - way.origin, .t_max = 1.f}};
            trace(part);
            const auto hit = surface_hit(part);
            if (hit) transmitted *= passed(*hit);
            if (is_black(transmitted)) return transmitted;
            if (medium) {
                const float length = hit                        ? part.found->t * part.ray.d.norm()
                                     : way.distance == infinity ? infinity
                                                                : part.ray.d.norm();
                transmitted *= medium->transmittance(way.origin, way.direction, length, u);
            }
            if (!hit) return transmitted;
            medium = scene_.medium_beyond(*hit, way.direction, medium);
            if (!step_beyond(*hit, way.origin, way.target, way.direction)) return transmitted;
        }
    }

    Color visibility_through_holes(Segment way) {
        for (Color visibility = Color::Ones();;) {
            const Ray ray{.o = way.origin, .d = way.target - way.origin, .t_max = 1.f};
            note(ray, false);
            const auto hit = scene_.intersect(ray);
            if (!hit) return visibility;
            visibility *= hit->straight_on(way.direction);
            if (is_black(visibility)) return visibility;
            if (!step_beyond(*hit, way.origin, way.target, way.direction)) return visibility;
        }
    }

    /// Moves the start of a ray beyond the surfaces that all light passes.
    void pass_boundaries(Ray& ray, std::optional<Intersection>& found) {
        while (found) {
            const auto hit = scene_.surface_hit(ray, found);
            if (hit->bsdf->pass_through() < 1.f) return;
            const Vec3 beyond = offset_origin(*hit, ray.d);
            const float part = (beyond - ray.o).dot(ray.d) / ray.d.squaredNorm();
            if (!(part > 0.f)) return;
            TracedRay rest{{.o = beyond, .d = ray.d, .t_max = std::max(ray.t_max - part, 0.f)}};
            trace(rest);
            ray = rest.ray;
            found = rest.found;
        }
    }

    /// Moves the start of a camera's ray beyond the surfaces that the camera lies on, one after the other.
    void pass_own_surfaces(Ray& ray, std::optional<Intersection>& found, float farthest) {
        const Vec3 camera = ray.o;
        while (found && found->t <= farthest) {
            const auto hit = scene_.surface_hit(ray, found);
            if (!is_under(camera, *hit, ray.d)) return;
            const Vec3 beyond = offset_origin(*hit, ray.d);
            const float way = (beyond - ray.o).dot(ray.d);
            TracedRay rest{{.o = beyond,
                            .d = ray.d,
                            .t_min = std::max(ray.t_min - way, 0.f),
                            .t_max = std::max(ray.t_max - way, 0.f)}};
            trace(rest);
            ray = rest.ray;
            found = rest.found;
        }
    }

    /// Whether the camera lies on the surface that its ray along w hits, so that only rounding makes it a hit. If the
    /// ray hits the surface from behind, the camera looks away from its front, and all rounding errors are allowed
    /// for. If it hits the front, only the rounding of the camera's own position is allowed for, since a camera close
    /// above a large floor sees the floor; and a camera on glass counts as outside of it. Boundaries of media are
    /// always hits, as their sides tell the medium beyond.
    bool is_under(const Vec3& camera, const SurfaceHit& hit, const Vec3& w) const {
        const float distance = std::abs((hit.p - camera).dot(hit.ng));
        const float rounding = 2.f * unit_roundoff * hit.ng.cwiseAbs().dot(camera.cwiseAbs());
        if (scene_.bounds_medium(hit)) return false;
        if (w.dot(hit.ng) > 0.f) return distance <= hit.offset + rounding;
        return distance <= rounding && !scene_.material_of_shape(hit.shape).traits().refraction;
    }

    /// Whether a way along w has reached its end. The end may lie in the surface that the way has just passed;
    /// without this test the next step would lead back to that surface, without end.
    static bool is_past(const Vec3& origin, const Vec3& end, const Vec3& w) { return !((end - origin).dot(w) > 0.f); }
    /// Moves a way's start beyond the surface. False if the way ends there, or if the step leads nowhere: from the edge
    /// of two surfaces, each of which it would meet again and again.
    static bool step_beyond(const SurfaceHit& hit, Vec3& origin, const Vec3& end, const Vec3& w) {
        const Vec3 from = origin;
        origin = offset_origin(hit, w);
        return !is_past(origin, end, w) && (origin - from).dot(w) > 0.f;
    }

    void note(const Ray& ray, bool shadow) {
        ++count_;
        if (log_) [[unlikely]]
            log_->entries.push_back({ray, shadow});
    }

    const Scene& scene_;
    RayLog* log_;
    std::uint64_t count_ = 0;
};

}  // namespace gib
