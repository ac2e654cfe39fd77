#pragma once
// The targets of projection maps: a tree of balls around the surfaces that photons are to reach. The tree decides
// whether a bundle of rays can meet a target.

#include "common/lights/emission_bounds.h"
#include "methods/parts/emission/aimed_emission.h"

#include <cstdint>
#include <vector>

namespace gib {

/// The tree of balls. Meshes, with their large triangles, are cut into the pieces that lie in the voxels of a grid;
/// shapes of instances are carried into the scene. Each piece lies inside its ball.
class ProjectionTargets {
public:
    static constexpr std::uint32_t no_shape = ~0u;
    struct Ball {
        Vec3 center;
        float radius;
        std::uint32_t shape;  ///< index among the scene's shapes; no_shape for shapes of instances
        bool whole_sphere;    ///< the target is the whole surface of the ball
    };

    explicit ProjectionTargets(std::vector<Ball> balls);
    /// Makes about `wanted_balls` balls, but at least one for each shape.
    ProjectionTargets(const Scene& scene, TargetSurfaces surfaces, std::size_t wanted_balls);

    bool empty() const { return nodes_.empty(); }
    std::size_t balls() const { return (nodes_.size() + 1) / 2; }
    /// Centre and radius of a ball around all targets.
    const Vec3& center() const { return nodes_.front().center; }
    float radius() const { return nodes_.front().radius; }

    enum class Reach {
        none,     ///< no ray of the bundle meets a ball
        some,     ///< some ray may meet a ball
        all_meet  ///< every ray meets a target, which is a whole sphere
    };
    /// Whether the bundle can reach a target; targets of the shape `except` do not count. `hint` is the number of
    /// a node that is tested first, 0 at the start; it is set to the node that was met.
    Reach reach(const RayBundle& bundle, std::uint32_t except, std::uint32_t& hint) const;

private:
    struct Node {
        Vec3 center;
        float radius;
        std::uint32_t next;  ///< the node after its subtree; nodes stand in preorder
        std::uint32_t shape;
        bool leaf, whole_sphere;
    };
    void build(std::vector<Ball>& balls, std::size_t begin, std::size_t end);

    std::vector<Node> nodes_;
};

}  // namespace gib
