#pragma once
// The photon map: photons in a kd-tree. A photon takes 29 bytes: 16 for its payload and 13 in the tree.
// Source: Jensen 2001, chapter 6.

#include "methods/parts/kd_tree/kd_tree.h"
#include "methods/parts/photons/photon.h"

namespace gib {

extern template KdTree<Photon>::KdTree(const std::vector<Photon>& photons);

class PhotonMap : public KdTree<Photon> {
public:
    PhotonMap() = default;
    /// `unit` is the meaning of a power of 1 [W].
    PhotonMap(const std::vector<Photon>& photons, double unit) : KdTree(photons), unit_(unit) {}

    double unit() const { return unit_; }  ///< unit of the photons' power [W]

private:
    double unit_ = 1;
};

}  // namespace gib
