#include "methods/parts/photons/photon_map.h"

#include "methods/parts/kd_tree/kd_tree_build.h"

namespace gib {

template KdTree<Photon>::KdTree(const std::vector<Photon>& photons);

}  // namespace gib
