#pragma once
// The one owner of Embree: closest hits and occlusion over a scene's shapes.

#include "common/shape.h"

#include <memory>
#include <optional>
#include <vector>

namespace gib {

struct Intersection {
    std::uint32_t shape;
    std::uint32_t primitive;
    float t;
    float u, v;  ///< barycentric weights of a mesh's second and third vertex
};

class Accelerator {
public:
    /// Keeps pointers into `shapes`, which must outlive it and not move. Mesh vertex arrays have their extra element.
    explicit Accelerator(const std::vector<Shape>& shapes);
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
