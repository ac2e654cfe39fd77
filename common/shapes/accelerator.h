#pragma once
// Closest hits and occlusion of rays among the shapes of a scene. Only this code uses Embree.

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
    std::uint32_t instance;  ///< no_instance for a shape outside all groups
    // u and v are not neighbours, because the compiler would copy two neighbouring floats as one number, and loading
    // it would wait until Embree's two separate stores are complete.
    float u;  ///< barycentric weight of a mesh's second vertex
    float t;
    float v;  ///< barycentric weight of its third vertex
};

class Accelerator {
public:
    /// Builds the trees. Keeps pointers into `shapes` and `groups`, which must outlive the accelerator and must not
    /// move. A mesh's array of vertices must have its extra element. Throws InputError if there is not enough memory
    /// and RunError if Embree fails.
    Accelerator(const std::vector<Shape>& shapes, const InstancedGroups& groups);
    ~Accelerator();
    Accelerator(const Accelerator&) = delete;
    Accelerator& operator=(const Accelerator&) = delete;

    /// The closest hit between t_min and t_max; empty if there is none.
    std::optional<Intersection> intersect(const Ray& ray) const {
        std::optional<Intersection> found;
        intersect(ray, found);
        return found;
    }
    /// Writes it to `found`. A copy would be read as whole registers, which waits until the single numbers are stored.
    void intersect(const Ray& ray, std::optional<Intersection>& found) const;
    /// The largest number of rays that are traced at once.
    static constexpr std::size_t packet_size = 8;
    /// Traces 1 to packet_size rays; found[i] is what intersect(rays[i]) returns, up to rounding in t, u and v. This
    /// is faster if the rays take the same way through the tree, as those of neighbouring pixels do.
    void intersect(std::span<const Ray> rays, std::span<std::optional<Intersection>> found) const;
    /// Whether the ray meets any shape between t_min and t_max.
    bool occluded(const Ray& ray) const;

    /// Embree's scene, an RTCScene. It is for the benchmark that measures the cost of the code above Embree.
    void* native_handle() const;

private:
    Intersection intersection_of(std::uint32_t geometry, std::uint32_t primitive, std::uint32_t instance, float u,
                                 float v, float t) const;

    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace gib
