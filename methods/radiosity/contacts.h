#pragma once
// Surfaces that touch. Where surfaces lie in one plane and face the same way, light meets only one of them at each
// point, so each of m surfaces has the share 1 / m of the light there. Where the fronts of two surfaces lie on each
// other, as the bottom of a block does on a floor, no light gets between them.

#include "methods/radiosity/mesh.h"

namespace gib {

class Contacts {
public:
    /// `mesh` must outlive this.
    explicit Contacts(const PatchMesh& mesh);

    /// The largest distance of surfaces that touch [scene units].
    double reach() const { return reach_; }
    /// The share of a point p of a side at which light arrives: 1 where nothing touches it, `covered` under a front.
    double share(std::uint32_t side, const Vec3d& p) const;

    /// Not 0, so that light is known also at points that are covered. They hardly count for others.
    static constexpr double covered = 1e-3;

private:
    struct Neighbour {
        const PatchPolygon* polygon;
        bool fronts_agree;  ///< the fronts of both charts face the same way
    };
    void find(std::uint32_t side);

    const PatchMesh& mesh_;
    double reach_;
    std::vector<std::vector<Neighbour>> neighbours_;  ///< parallel surfaces near each side
};

}  // namespace gib
