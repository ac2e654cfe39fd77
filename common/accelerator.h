#pragma once
// The one owner of Embree: closest hits and occlusion over a scene's shapes.

#include "common/instance.h"

#include <memory>
#include <optional>
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
    /// Keeps pointers into `shapes` and `groups`, which must outlive it and not move. Mesh vertex arrays have their extra element.
    Accelerator(const std::vector<Shape>& shapes, const InstancedGroups& groups);
    ~Accelerator();
    Accelerator(const Accelerator&) = delete;
    Accelerator& operator=(const Accelerator&) = delete;

    std::optional<Intersection> intersect(const Ray& ray) const;
    bool occluded(const Ray& ray) const;

    /// The Embree scene itself, for the benchmark that measures what the code above it costs; a RTCScene.
    void* native_handle() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace gib
