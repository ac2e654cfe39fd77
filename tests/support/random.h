#pragma once
// Random numbers for tests.

#include "common/sampling/sampler.h"
#include "common/sampling/warp.h"

#include <cstdint>

namespace gib::test {

/// A sequence of random numbers that is a pure function of its seed.
class Random {
public:
    explicit Random(std::uint64_t seed) : seed_(seed) {}
    Vec2 next_2d() { return Sampler(PointSet::independent, seed_, index_++, 0).get_2d(dimension::film); }
    float next() { return next_2d().x(); }
    Vec3 direction() { return square_to_sphere(next_2d()); }

private:
    std::uint64_t seed_;
    std::uint64_t index_ = 0;
};

}  // namespace gib::test
