#pragma once
// Directions of a path that follow a radiance field or the bsdf, by one-sample multiple importance sampling (Mueller 2017,
// section 3), and their record for the field.

#include "methods/guided_path/radiance_field.h"
#include "methods/parts/transport/path_tracer.h"

#include <optional>
#include <vector>

namespace gib {

/// A class of directions for trace_path_in(). A direction has the density a q + (1 - a) p, where p is that of the bsdf
/// or phase function, q that of the field, and a the leaf's selection. The bsdf keeps its delta lobes, so q is no part of
/// theirs. Light sampling is weighed against the same density.
class GuidedDirections {
public:
    explicit GuidedDirections(const RadianceField& field) : field_(field) {}

    /// Adds what the last path has found to `field`, and forgets it.
    void tell(RadianceField& field, const Sampler& sampler);
    void forget() {
        vertices_.clear();
        found_ = Colord::Zero();
        steered_ = 1;
    }

    // The members of BsdfDirections:
    void arrive(const Vec3& p) {
        here_ = p;
        known_.emplace(field_.at(p));
    }
    LobeValues direct_light(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local, const VertexNumbers& u);
    Color direct_light(PathWalk& walk, const Vec3& p, const VertexNumbers& u);
    std::optional<ScatteredRay> scatter(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local,
                                        const VertexNumbers& u, bool sees_lights);
    std::optional<Vec3> scatter_in_medium(PathWalk& walk, const VertexNumbers& u, bool sees_lights);
    bool survives(PathWalk& walk, float most, float u, Color& lost);
    void found(const Color& light) { found_ += light.cast<double>(); }

private:
    struct Vertex {
        FollowedDirection followed;
        Color before, after;  ///< the path's throughput
        Colord found;         ///< light that the path had found before
    };

    float weight_of(const LightSample& light, float by_lobes) const;
    std::optional<ScatteredRay> scatter_by_field(const SurfaceHit& hit, const Vec3& wo_local, Vec2 u_lobe,
                                                 const Vec2& u) const;
    void follow(const PathWalk& walk, const Color& before, const FollowedDirection& followed, float unguided);

    const RadianceField& field_;
    Vec3 here_;
    std::optional<RadianceField::Distribution> known_;
    std::vector<Vertex> vertices_;
    Colord found_ = Colord::Zero();
    /// The path's throughput over that of a path by the bsdf alone which takes the same way.
    double steered_ = 1;
};

}  // namespace gib
