#pragma once
// Directions of path tracing by the bsdf, whose light through specular chains is partly made by a ChainSampler.

#include "methods/parts/manifold/chain_light.h"
#include "methods/parts/transport/path_tracer.h"

namespace gib {

/// A class of directions for trace_path_in(). `OnSample` is called for each sample of the chains: (PathWalk, Sample,
/// number of its rays).
template <typename OnSample>
class ChainDirections : public BsdfDirections {
public:
    ChainDirections(const ChainSampler& chains, ChainCounts& counts, OnSample on_sample)
        : chains_(chains), counts_(counts), on_sample_(on_sample) {}

    bool leaves_out(PathWalk& walk, const std::optional<SurfaceHit>& hit) const {
        if (!hit || !hit->emitter || !start_ || events_.length == 0) return false;
        return chains_.makes(walk, {*start_, medium_, walk.at.stratum}, wo_local_, w_, events_, *hit);
    }

    template <typename Add>
    void add_light_of_chains(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local, int edges_left, Add&& add) {
        const double samples = chains_.samples() + double{walk.flights.next()};
        for (int i = 1; i <= samples; ++i) {
            const std::uint64_t before = walk.rays.count();
            const auto sample = chains_.sample(walk, hit, wo_local, edges_left - 1, counts_);
            on_sample_(walk, sample, walk.rays.count() - before);
            for (const auto& found : sample.found) {
                if (!found) continue;
                add(LobeKind::diffuse, found->light.diffuse);
                add(LobeKind::specular, found->light.specular);
            }
        }
    }

    std::optional<ScatteredRay> scatter(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local,
                                        const VertexNumbers& u, bool sees_lights) {
        const auto next = BsdfDirections::scatter(walk, hit, wo_local, u, sees_lights);
        if (!next) return next;
        if (!next->delta) {
            start_ = hit;
            medium_ = walk.at.medium;
            wo_local_ = wo_local;
            w_ = next->wi;
            events_ = {0, 0};
        } else if (start_) {
            const bool transmits = next->wi.dot(hit.ng) * walk.wo().dot(hit.ng) < 0.f;
            if (makes_chains(hit) && events_.length < ChainSampler::longest_possible) events_.append(transmits);
            else start_.reset();
        }
        return next;
    }
    std::optional<Vec3> scatter_in_medium(PathWalk& walk, const VertexNumbers& u, bool sees_lights) {
        start_.reset();
        return BsdfDirections::scatter_in_medium(walk, u, sees_lights);
    }

private:
    const ChainSampler& chains_;
    ChainCounts& counts_;
    OnSample on_sample_;
    // The chain since the last vertex that chains are sampled at; none if the path has come from the eye, a medium or
    // another delta lobe.
    std::optional<SurfaceHit> start_;
    const Medium* medium_ = nullptr;
    Vec3 wo_local_, w_;
    ChainEvents events_ = {0, 0};
};

}  // namespace gib
