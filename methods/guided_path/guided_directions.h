#pragma once
// Directions of a path that follow a radiance field or the bsdf, by one-sample multiple importance sampling (Mueller 2017,
// section 3), roulette by what a path is expected to find, and the record of what it found.

#include "methods/guided_path/guided_scattering.h"
#include "methods/parts/transport/path_tracer.h"

#include <optional>
#include <vector>

namespace gib {

/// A class of directions for trace_path_in(). A direction has the density a q + (1 - a) p, where p is that of the bsdf
/// or phase function, q that of the field, and a the leaf's selection. The bsdf keeps its delta lobes, so q is no part of
/// theirs.
class GuidedDirections : public NoChains {
public:
    explicit GuidedDirections(const RadianceField& field) : field_(field) {}

    /// A new path begins.
    void start() {
        vertices_.clear();
        found_ = Colord::Zero();
        at_first_ = 0.f;
    }
    /// Adds what the path has found to `field`.
    void tell(RadianceField& field, const Sampler& sampler) const;

    // The members of BsdfDirections:
    void arrive(const Vec3& p, const Vec3& normal) {
        place_ = field_.place(p, normal);
        known_.emplace(field_.at(place_));
        found_on_arrival_ = found_;
    }
    std::optional<ScatteredRay> scatter(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local,
                                        const VertexNumbers& u, bool sees_lights);
    std::optional<Vec3> scatter_in_medium(PathWalk& walk, const VertexNumbers& u, bool sees_lights);
    bool survives(PathWalk& walk, float most, float u, Color& lost);
    void found(const Color& light) { found_ += light.cast<double>(); }

private:
    /// A vertex where the path had a choice.
    struct Vertex {
        RadianceField::Place place;
        float reflected;                 ///< as the field knows it
        Color before, after;             ///< throughput
        Colord found_on_arrival, found;  ///< light that the path had found when it came, and when it left
        Vec3 wi = Vec3::Zero();
        std::optional<float> pdf_w = {};  ///< [1/sr] of wi; none where the path ended or followed a delta lobe
    };

    float selection(const PathWalk& walk) const;
    void stand(const PathWalk& walk);
    void leave(const PathWalk& walk, const Vec3& wi, float pdf_w);

    const RadianceField& field_;
    RadianceField::Place place_;
    std::optional<RadianceField::Distribution> known_;
    std::vector<Vertex> vertices_;
    Colord found_ = Colord::Zero(), found_on_arrival_ = Colord::Zero();
    bool has_left_ = false;  ///< the last scattering was at the last of the vertices, and chose its direction
    float unguided_ = 1.f;   ///< weight of the last scattering, had the bsdf alone chosen the direction
    float expected_ = 0.f;   ///< light that is left to find, times the throughput; 0 if it is not known
    float at_first_ = 0.f;   ///< the same at the path's first vertex where it is known
};

}  // namespace gib
