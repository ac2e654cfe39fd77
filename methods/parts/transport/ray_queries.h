#pragma once
// The ray queries of one block of work: every method traces through this, so that rays are counted, and can be
// recorded, alike.

#include "common/scene/scene.h"

#include <cstdint>
#include <span>
#include <vector>

namespace gib {

/// Rays in the order in which they were traced, for replay by a benchmark.
struct RayLog {
    struct Entry {
        Ray ray;
        bool shadow;  ///< asked whether anything is hit, not what
    };
    std::vector<Entry> entries;
};

/// A ray and its closest hit, of which the surface is not computed yet.
struct TracedRay {
    Ray ray;
    std::optional<Intersection> found = {};
};

class RayQueries {
public:
    /// `log` may be null: nothing is recorded.
    explicit RayQueries(const Scene& scene, RayLog* log = nullptr) : scene_(scene), log_(log) {}

    const Scene& scene() const { return scene_; }
    std::uint64_t count() const { return count_; }

    std::optional<SurfaceHit> intersect(const Ray& ray) {
        note(ray, false);
        return scene_.intersect(ray);
    }
    /// intersect() in two steps: the first sets `found`.
    void trace(TracedRay& traced) {
        note(traced.ray, false);
        traced.found = scene_.accelerator().intersect(traced.ray);
    }
    std::optional<SurfaceHit> surface_hit(const TracedRay& traced) const {
        return scene_.surface_hit(traced.ray, traced.found);
    }
    /// trace() of 1 to Accelerator::packet_size rays at once.
    void trace(std::span<const Ray> rays, std::span<std::optional<Intersection>> found) {
        for (const Ray& ray : rays)
            note(ray, false);
        scene_.accelerator().intersect(rays, found);
        for (std::size_t i = 0; i < rays.size(); ++i)
            scene_.prefetch(found[i]);
    }
    /// The same for rays from the camera. They go past a surface that the camera itself lies on, a lamp say: what it
    /// sees begins beyond it.
    void trace_from_camera(std::span<Ray> rays, std::span<std::optional<Intersection>> found) {
        trace(rays, found);
        for (std::size_t i = 0; i < rays.size(); ++i)
            pass_own_surfaces(rays[i], found[i]);
    }
    /// The share of light that passes from the light's point to the surface: 0 or 1, except through surfaces with holes
    /// (masks). Both ends are off their surfaces by the bound of their own rounding errors, so the segment between them
    /// needs no epsilon.
    float visibility(const SurfacePoint& from, const LightSample& to) {
        const Vec3 origin = offset_origin(from, to.wi);
        if (scene_.has_holes()) return visibility_through_holes(origin, to);
        const Ray ray{origin, to.target - origin, 0.f, 1.f};
        note(ray, true);
        return scene_.occluded(ray) ? 0.f : 1.f;
    }

    /// The same in a scene with media, by channel: an unbiased estimate of the share that reaches `origin`, which lies
    /// in `medium` (null: in nothing).
    Color transmittance(Vec3 origin, const Medium* medium, const LightSample& to, NumberStream& u) {
        for (Color transmitted = Color::Ones();;) {
            TracedRay way{Ray{origin, to.target - origin, 0.f, 1.f}};
            trace(way);
            const auto hit = surface_hit(way);
            if (hit) transmitted *= hit->bsdf->pass_through();
            if (is_black(transmitted)) return transmitted;
            if (medium) {
                const float length = hit                       ? way.found->t * way.ray.d.norm()
                                     : to.distance == infinity ? infinity
                                                               : way.ray.d.norm();
                transmitted *= medium->transmittance(origin, to.wi, length, u);
            }
            if (!hit) return transmitted;
            medium = scene_.medium_beyond(*hit, to.wi, medium);
            origin = offset_origin(*hit, to.wi);
            if (is_past(origin, to.target, to.wi)) return transmitted;
        }
    }

    /// What a point of a scene with media lies in, found along the way from the camera: the boundaries on it decide.
    const Medium* medium_at(const Vec3& p) {
        const Medium* medium = scene_.camera_medium();
        const Sensor& sensor = scene_.sensor();
        const Ray middle = sensor.generate_ray(sensor.width() / 2, sensor.height() / 2, Vec2(0.5f, 0.5f));
        for (Vec3 origin = middle.o + middle.t_min * middle.d;;) {
            const Ray way{origin, p - origin, 0.f, 1.f};
            const auto hit = intersect(way);
            if (!hit) return medium;
            medium = scene_.medium_beyond(*hit, way.d, medium);
            origin = offset_origin(*hit, way.d);
            if (is_past(origin, p, way.d)) return medium;
        }
    }

private:
    float visibility_through_holes(Vec3 origin, const LightSample& to) {
        for (float visibility = 1.f;;) {
            const Ray ray{origin, to.target - origin, 0.f, 1.f};
            note(ray, false);
            const auto hit = scene_.intersect(ray);
            if (!hit) return visibility;
            if (!injected(Fault::mask_opacity) || hit->bsdf->pass_through() == 0.f)
                visibility *= hit->bsdf->pass_through();
            if (visibility == 0.f) return 0.f;
            origin = offset_origin(*hit, to.wi);
            if (is_past(origin, to.target, to.wi)) return visibility;
        }
    }

    /// One surface after the other, where several lie in the camera's place.
    void pass_own_surfaces(Ray& ray, std::optional<Intersection>& found) {
        // What is farther away is not under the camera, however small its angle with the ray.
        const float farthest = 1e-3f * scene_.diagonal();
        const Vec3 camera = ray.o;
        while (found && found->t <= farthest) {
            const auto hit = scene_.surface_hit(ray, found);
            if (!is_under(camera, *hit, ray.d)) return;
            const Vec3 beyond = offset_origin(*hit, ray.d);
            const float way = (beyond - ray.o).dot(ray.d);
            TracedRay rest{{beyond, ray.d, std::max(ray.t_min - way, 0.f), std::max(ray.t_max - way, 0.f)}};
            trace(rest);
            ray = rest.ray;
            found = rest.found;
        }
    }

    /// Whether the camera lies on the surface that its ray along w hits, so that there is a hit only by rounding. If it
    /// hits it from behind, the camera looks away from its front, and all that may be rounded counts. From the front it
    /// is the rounding of the camera's own place only: one that is close above a large floor sees it. Nor is it in
    /// glass then. Boundaries of media are hit always: their sides tell what is beyond.
    bool is_under(const Vec3& camera, const SurfaceHit& hit, const Vec3& w) const {
        const float distance = std::abs((hit.p - camera).dot(hit.ng));
        const float rounding = 2.f * unit_roundoff * hit.ng.cwiseAbs().dot(camera.cwiseAbs());
        if (scene_.bounds_medium(hit)) return false;
        if (w.dot(hit.ng) > 0.f) return distance <= hit.offset + rounding;
        return distance <= rounding && !scene_.material_of_shape(hit.shape).traits().refraction;
    }

    /// Whether a way along w has come to its end, which may lie in the surface that it has just left behind: the next
    /// step would lead back to it, again and again.
    static bool is_past(const Vec3& origin, const Vec3& end, const Vec3& w) { return !((end - origin).dot(w) > 0.f); }

    void note(const Ray& ray, bool shadow) {
        ++count_;
        if (log_) log_->entries.push_back({ray, shadow});
    }

    const Scene& scene_;
    RayLog* log_;
    std::uint64_t count_ = 0;
};

}  // namespace gib
