#pragma once
// A tree of many points, or of many segments, finds all that a ray passes within their radius, not only the closest. Embree
// finds them as discs that face the ray and as flat curves.

#include "common/shapes/shape.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gib {

class NearRayTree {
public:
    NearRayTree();
    /// `items` are points (`ends` = 1) or the ends of segments, two by two (`ends` = 2). Throws InputError if there is
    /// not enough memory.
    NearRayTree(std::span<const Vec3> items, std::size_t ends, float radius);
    ~NearRayTree();
    NearRayTree(NearRayTree&&) noexcept;
    NearRayTree& operator=(NearRayTree&&) noexcept;

    /// Sets `found` to the numbers of the items closer to the ray than the radius, in ascending order, and of some
    /// that lie close to it or to the lines beyond its ends. `d` is a unit vector.
    void find(const Ray& ray, std::vector<std::uint32_t>& found) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace gib
