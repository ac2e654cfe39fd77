#pragma once
// The plain display of a solution interpolates values at the corners of patches: a corner takes the mean of the patches
// around it (Cohen and Greenberg 1985, "The Hemi-Cube"). The exact one, by rays, is in view.cpp.

#include "methods/radiosity/system.h"

namespace gib {

/// The corners of patches. Those in the same place of one shape and with the same shading normal are one corner, so that
/// values are continuous over a smooth surface and jump at its edges.
class PatchCorners {
public:
    /// `mesh` must outlive this.
    explicit PatchCorners(const PatchMesh& mesh);

    std::size_t size() const { return places_.size(); }
    const std::vector<Vec3>& places() const { return places_; }
    /// The corners of a leaf, in the order of PatchNode::corners.
    const std::array<std::uint32_t, 4>& of_leaf(std::uint32_t node) const { return of_leaf_[node]; }
    /// The same, counter-clockwise as seen from the front of the leaf's side; a triangle has its last twice.
    std::array<std::uint32_t, 4> in_turn(std::uint32_t leaf) const;

    /// Values at the corners whose mean over each leaf is about the leaf's value. `areas` weighs the leaves, by node.
    std::vector<Colord> values(const PatchColors& of_leaves, const std::vector<double>& areas) const;

private:
    const PatchMesh& mesh_;
    std::vector<Vec3> places_;
    std::vector<std::array<std::uint32_t, 4>> of_leaf_;  ///< by node
};

}  // namespace gib
