#pragma once
// Where a scene is flat: a coarse grid of how far around a point of a plane there is nothing but this plane.
// Look-ups there need none of the rays that look for obstacles, layers and the ends of the surface (surface_disc.h),
// because none of these rays would find anything.
//
// A voxel has a label if surfaces touch it: one plane of one mesh, or `mixed` if there is more than one plane, if the
// plane ends there, or if the surface is curved. Labels spread from their voxels to all neighbours, one step after the
// other, and each voxel keeps the first two different labels that reach it. Let the second label reach the voxel of a
// plane in step s. Then s is the distance, in voxels and in the maximum norm, to the nearest voxel with another label:
// on the shortest way from there, a voxel that does not keep a label has two others, which came no later and go on
// along the same way. So within s - 1 voxels of any point of the voxel there is only the plane, without an end.

#include "common/scene/scene.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gib {

class FlatRegions {
public:
    /// `resolution` is the number of voxels along the longest side of the scene.
    FlatRegions(const Scene& scene, int resolution);
    /// The resolution for look-ups among so many photons: in the Cornell box voxels are 1.6 times as wide as the radius
    /// of a look-up of 50 photons, but no wider than an eighth and no narrower than a 32nd of the scene.
    static int resolution_for(std::uint64_t photons);

    /// Whether all surfaces within `reach` [scene units] of a hit lie in its plane, are of its shape and material, and
    /// cover the plane there. False if the grid is too coarse to decide.
    bool flat_around(const SurfaceHit& hit, float reach) const;
    /// Whether no surface lies within `reach` [scene units] of a point. False if the grid is too coarse to decide.
    bool empty_around(const Vec3& p, float reach) const;

private:
    static constexpr std::uint32_t empty = 0, mixed = 1;  ///< other labels: a plane's number + 2
    static constexpr std::uint8_t most_steps = 6;

    struct Voxel {
        std::array<std::uint32_t, 2> labels = {empty, empty};
        std::array<std::uint8_t, 2> steps = {most_steps + 1, most_steps + 1};  ///< in which the labels came
    };

    using Index = std::array<int, 3>;

    void add_mesh(const Mesh& mesh, std::uint32_t shape);
    /// Gives the voxels of a triangle's, or an edge's, pieces the label. Pieces larger than a voxel are halved.
    void add_triangle(const Vec3& a, const Vec3& b, const Vec3& c, std::uint32_t label);
    void add_box(const Bounds& box, std::uint32_t label);
    void spread();
    Index index_of(const Vec3& p) const;
    /// Whether what came in this step lies beyond `reach`.
    bool is_beyond(float reach, std::uint8_t step) const {
        return reach + rounding_ <= static_cast<float>(step - 1) * voxel_;
    }
    std::size_t at(const Index& i) const {
        return (static_cast<std::size_t>(i[2]) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(i[1])) *
                   static_cast<std::size_t>(size_[0]) +
               static_cast<std::size_t>(i[0]);
    }

    Vec3 lower_;
    float voxel_;     ///< side of a voxel [scene units]
    float rounding_;  ///< bound of the rounding of positions [scene units]
    Index size_;
    std::vector<Voxel> voxels_;
    std::vector<std::uint32_t> shape_of_plane_;
};

}  // namespace gib
