#pragma once
// Directions of path tracing by the bsdf, whose light through specular chains is partly made by a ChainSampler.

#include "methods/parts/manifold/chain_light.h"
#include "methods/parts/transport/path_tracer.h"

namespace gib {

/// A class of directions for trace_path_in(). Which of the two makes a path depends on the path alone: its light, and the number
/// of vertices between its last vertex that is no delta and the light, if all of these make chains. `Told` is a function of each
/// sample of the chains, (PathWalk, Sample).
template <typename Told>
class ChainDirections : public BsdfDirections {
public:
    ChainDirections(const ChainSampler& chains, ChainCounts& counts, Told told)
        : chains_(chains), counts_(counts), told_(told) {}

    bool leaves_out(const std::optional<SurfaceHit>& hit) const { return hit && chains_.makes(hit->light, vertices_); }

    template <typename Add>
    void add_light_of_chains(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local, int edges_left, Add&& add) {
        const auto sample = chains_.sample(walk, hit, wo_local, edges_left - 1, counts_);
        if (!sample) return;
        told_(walk, *sample);
        add(LobeKind::diffuse, sample->light.diffuse);
        add(LobeKind::specular, sample->light.specular);
    }

    std::optional<ScatteredRay> scatter(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local,
                                        const VertexNumbers& u, bool sees_lights) {
        const auto next = BsdfDirections::scatter(walk, hit, wo_local, u, sees_lights);
        if (next && !next->delta) vertices_ = 0;
        else if (vertices_ != outside && makes_chains(hit)) ++vertices_;
        else vertices_ = outside;
        return next;
    }
    std::optional<Vec3> scatter_in_medium(PathWalk& walk, const VertexNumbers& u, bool sees_lights) {
        vertices_ = outside;
        return BsdfDirections::scatter_in_medium(walk, u, sees_lights);
    }

private:
    static constexpr int outside = -1;  ///< the path has come from the eye, a medium or another delta lobe

    const ChainSampler& chains_;
    ChainCounts& counts_;
    Told told_;
    int vertices_ = outside;  ///< delta vertices since the last vertex that chains are sampled at
};

}  // namespace gib
