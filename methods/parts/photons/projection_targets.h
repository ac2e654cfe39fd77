#pragma once
// Balls around the surfaces that photons are to reach, in a tree, and the question whether a bundle of rays can meet
// them.

#include "common/lights/emission_bounds.h"

#include <cstdint>
#include <vector>

namespace gib {

class Scene;

enum class TargetSurfaces {
    all,
    specular  ///< those whose material has a lobe that counts as S
};

/// Meshes are cut into the pieces that lie in the voxels of a grid, large triangles too; what instances show is carried
/// to the scene. Each piece lies inside its ball.
class ProjectionTargets {
public:
    ProjectionTargets(const Scene& scene, TargetSurfaces surfaces);

    bool empty() const { return nodes_.empty(); }
    std::size_t balls() const { return (nodes_.size() + 1) / 2; }
    /// Of a ball around everything.
    const Vec3& center() const { return nodes_.front().center; }
    float radius() const { return nodes_.front().radius; }

    enum class Reach {
        none,     ///< no ray of the bundle meets a ball
        some,     ///< some may
        all_meet  ///< every ray meets a target, which is a whole sphere
    };
    static constexpr std::uint32_t no_shape = ~0u;
    /// Targets of the shape `except` do not count. `hint`: a node that is tried first, and set to the one that was
    /// met; 0 at first.
    Reach reach(const RayBundle& bundle, std::uint32_t except, std::uint32_t& hint) const;

    struct Ball {
        Vec3 center;
        float radius;
        std::uint32_t shape;  ///< index into the scene's; no_shape for what an instance shows
        bool whole_sphere;    ///< the target is the ball's surface itself
    };

private:
    struct Node {
        Vec3 center;
        float radius;
        std::uint32_t next;  ///< after all below it; nodes stand in preorder
        std::uint32_t shape;
        bool leaf, whole_sphere;
    };
    void build(std::vector<Ball>& balls, std::size_t begin, std::size_t end);

    std::vector<Node> nodes_;
};

}  // namespace gib
