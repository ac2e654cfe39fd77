#pragma once
// The one owner of Embree: closest hits and occlusion over a scene's shapes.

#include "common/shapes/instance.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace gib {

inline constexpr std::uint32_t no_instance = ~0u;

struct Intersection {
    std::uint32_t shape;
    std::uint32_t primitive;
    std::uint32_t instance;  ///< or no_instance
    // u and v lie apart: together they would be copied as one number, which waits until Embree's two are stored.
    float u;  ///< barycentric weight of a mesh's second vertex
    float t;
    float v;  ///< barycentric weight of its third vertex
};

class Accelerator {
public:
    /// Keeps pointers into `shapes` and `groups`, which must outlive it and not move. Mesh vertex arrays have their
    /// extra element.
    Accelerator(const std::vector<Shape>& shapes, const InstancedGroups& groups);
    ~Accelerator();
    Accelerator(const Accelerator&) = delete;
    Accelerator& operator=(const Accelerator&) = delete;

    std::optional<Intersection> intersect(const Ray& ray) const;
    /// As many rays as are traced at once.
    static constexpr std::size_t packet_size = 8;
    /// Writes to `found` what intersect() finds on each of 1 to packet_size rays, up to rounding in t, u and v. Faster
    /// where the rays take the same way through the tree, as those of neighbouring pixels do.
    void intersect(std::span<const Ray> rays, std::span<std::optional<Intersection>> found) const;
    bool occluded(const Ray& ray) const;

    /// The Embree scene itself, for the benchmark that measures what the code above it costs; a RTCScene.
    void* native_handle() const;

private:
    Intersection intersection_of(std::uint32_t geometry, std::uint32_t primitive, std::uint32_t instance, float u,
                                 float v, float t) const;

    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace gib
