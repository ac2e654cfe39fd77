#pragma once
// A nanoflann tree over positions, the yardstick of the photon map's searches.

#include "common/core/math.h"

#include <cstdint>
#include <nanoflann.hpp>
#include <vector>

namespace gib::test {

struct NanoflannCloud {
    std::vector<Vec3> points;
    std::size_t kdtree_get_point_count() const { return points.size(); }
    float kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][static_cast<Eigen::Index>(axis)]; }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

using NanoflannTree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, NanoflannCloud>,
                                                          NanoflannCloud, 3, std::uint32_t>;

}  // namespace gib::test
