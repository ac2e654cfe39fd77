#pragma once
// The ray queries of one block of work: every method traces through this, so that rays are counted, and can be
// recorded, alike.

#include "common/scene.h"

#include <cstdint>
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
    /// Whether nothing lies between the surface and the light's point. Both ends are off their surfaces by the bound of
    /// their own rounding errors, so the segment between them needs no epsilon.
    bool visible(const SurfacePoint& from, const LightSample& to) {
        const Vec3 origin = offset_origin(from, to.wi);
        const Ray ray{origin, to.target - origin, 0.f, 1.f};
        note(ray, true);
        return !scene_.occluded(ray);
    }

private:
    void note(const Ray& ray, bool shadow) {
        ++count_;
        if (log_) log_->entries.push_back({ray, shadow});
    }

    const Scene& scene_;
    RayLog* log_;
    std::uint64_t count_ = 0;
};

}  // namespace gib
