#pragma once
// Weights of multiple importance sampling over all techniques that can make one path.
//
// A path x_0 (on a light) ... x_k (on the camera) can be made from both ends in several ways: technique s takes its
// first s vertices from a walk that started at the light, and the others from a walk that started at the camera. Let
// f_i be the density of x_i [1/m^2] when the light's walk samples it from x_{i-1}, and b_i when the camera's walk does
// from x_{i+1}. The density of technique s is p_s = f_0 ... f_{s-1} b_s ... b_k, and its weight with the power
// heuristic of exponent 2 is p_s^2 / sum over j of p_j^2 (Veach 1997, sections 9.2 and 10.2). Where photons are merged,
// both walks sample x_i, and the density is f_0 ... f_i b_i ... b_k n_i (merge_rule.h). The sum needs no list of
// densities: each walk carries it along in two numbers, which are updated from vertex to vertex.
//
// Source: Georgiev 2012, "Implementing Vertex Connection and Merging" (technical report). Its names d_vcm, d_vc and d_vm
// and its equation numbers stand at the lines. What differs from it:
//  - d_vcm and d_vc hold sums of squares, as the power heuristic needs them.
//  - d_vm is not stored. It is d_vc / n^2 where n is the same at all vertices; here n differs between surfaces and media, so
//    the weight of a merge divides the sum over the other techniques by the n^2 of its own vertex (light_vertex_map.cpp).
//  - Connections of the first vertex of the camera's walk that can be joined may have several samples, `first_samples`, by which
//    their density is multiplied (Veach 1997, section 9.2.1); all others have 1.
//  - A vertex is merged only behind a surface that focuses, so the term n^2 of equations 35, 40 and 41 may be absent, or
//    may come one vertex later (merge_rule.h).
//  - The probability of a free flight has a factor for its end, which all techniques share, and the transmittance of the
//    edge, which every technique but the one that connects this edge has; it is left out of the weights, which keeps
//    their sum at 1. So are Russian roulette, holes and wavelengths. The density of events in a medium is that per
//    length times its scattering coefficient, which merging has twice.
//
// Rules:
//  - Densities at a surface are per area, so a density per solid angle is multiplied by |cos| / d^2 with the geometric
//    normal. A vertex in a medium has no cosine.
//  - An event at a delta lobe has density 1 both ways, and no technique connects the two edges beside it.
//  - Instead of f_0 f_1, a technique that samples a point of a light from x_1 has the density of that sampling.
//  - A light at infinity has parallel rays: f_1 is a density across them times |cos|, without a distance (section 5.1).
//  - The camera's point is sampled in the same way by all techniques, and no walk of a light can find it.

#include "methods/parts/vertices/merge_rule.h"

namespace gib {

/// Which kinds of techniques are in use; those that are not are neither tried nor weighed.
struct Techniques {
    bool hits = true;            ///< s = 0: the camera's walk finds a light by itself
    bool light_sampling = true;  ///< s = 1: a point of a light is sampled from the end of the camera's walk
    bool connections = true;     ///< s > 1 with at least one surface or event in a medium on both sides
    bool camera = true;          ///< the end of the light's walk is connected to the camera
    Merges merges = Merges::none;

    bool only_merging() const { return merges == Merges::alone; }
};

/// The rules by which the paths of a pass are made and weighed.
struct PathRules {
    int max_edges;  ///< edges of the longest path
    Techniques used = {};
    MergeRadii merging = {};
    int min_edges = 1;  ///< edges of the shortest path that counts
    /// Number of independent samples that the weights assume for a connection of the first vertex of the camera's walk that can
    /// be joined (Veach 1997, section 9.2.1; shared_vertices.h).
    double first_samples = 1;

    /// Whether there is any technique but the connection of a light's walk to the camera.
    bool have_others() const { return used.hits || used.light_sampling || used.connections || merging.any(); }
};

/// The sums over techniques that a walk carries. They always refer to the walk's last vertex.
class TechniqueSums {
public:
    /// At the start of the camera's walk. `ray_density` is Sensor::ray_density(), `light_paths` the number of light
    /// paths for each of the camera's paths of a pixel.
    static TechniqueSums at_camera(double ray_density, double light_paths, const PathRules& rules) {
        TechniqueSums sums(rules, false);
        sums.d_vcm_ = rules.used.camera ? squared(light_paths / ray_density) : 0;  // (31)
        return sums;
    }
    /// At the start of a light's walk: `emission` is Scene::emission_pdf(), `sampling` the density with which light
    /// sampling from the first vertex finds this start [1/sr]; for a point or spot light times the squared distance.
    /// `cos_light` belongs to the normal there (1 without a surface). No walk of the camera finds a light that
    /// `is_delta`.
    static TechniqueSums at_light(double emission, double sampling, double cos_light, bool is_delta,
                                  const PathRules& rules) {
        TechniqueSums sums(rules, true);
        sums.d_vcm_ = rules.used.light_sampling ? squared(sampling * cos_light / emission) : 0;  // (31)
        sums.d_vc_ = rules.used.hits && !is_delta ? squared(cos_light / emission) : 0;           // (32), delta: (49)
        return sums;
    }

    /// Whether there is any technique but the connection of a light's walk to the camera; if not, its weight is 1.
    bool has_others() const { return has_others_; }
    const MergeRule& merging() const { return merging_; }
    MergeRule& merging() { return merging_; }

    /// The walk has reached its next vertex: converts densities per solid angle into densities per area there, which
    /// completes equations 31 to 36. `distance2` is 1 for an edge whose rays are parallel, `cosine` is 1 in a medium.
    /// `samples` is the number of samples of the technique that connects the edge which has been walked; 0 if none in use does.
    /// `n` is that of merging at this vertex, which `focuses` if it has no diffuse lobe.
    void arrive(double distance2, double cosine, double samples, double n, bool focuses) {
        d_vcm_ *= squared(distance2 / cosine);
        d_vc_ /= squared(cosine);
        merging_.arrive(n, focuses, cosine);
        samples2_ = squared(samples);
    }
    /// The path goes on from this vertex, which focuses: see MergeRule::settle().
    void settle(double pending_n) { d_vc_ += merging_.settle(pending_n); }

    /// d_vcm of the last edge, with the samples of the technique that connects it; 0 if none in use does.
    double d_vcm() const { return samples2_ * d_vcm_; }
    double d_vc() const { return d_vc_; }

    /// The sum over the techniques that take fewer vertices from this walk, relative to the one that ends it here. The
    /// other walk, which comes to this vertex, goes on to the previous one with the density `reverse` [1/sr]. It is the
    /// bracket of equations 35, 40, 41, 45 and 46. `next_focuses`: see MergeRule::applies().
    double earlier(double reverse, bool next_focuses = false) const {
        return (merging_.applies(next_focuses) ? merging_.n2() : 0) + besides_merging(reverse);
    }
    /// The same without merging at this vertex: n^2 times the partial weight of a merge here, d_vcm / n^2 + d_vm reverse^2
    /// (38, 39).
    double besides_merging(double reverse) const { return d_vcm() + d_vc_ * squared(reverse); }

    /// Scattering by lobes that are no delta: `forward` is the density of the direction taken, `reverse` that of the
    /// walk the other way round, both [1/sr]; `cosine` belongs to the direction taken.
    void scatter(double forward, double reverse, double cosine) {
        const double step = squared(cosine / forward);
        d_vc_ = step * earlier(reverse);  // (35)
        merging_.scatter(step);
        d_vcm_ = squared(1 / forward);  // (34)
    }
    /// Scattering by a delta lobe.
    void scatter_specularly(double cosine, double pending_n = 0) {
        d_vc_ += merging_.scatter_specularly(pending_n);
        d_vc_ *= squared(cosine);  // (54)
        d_vcm_ = 0;                // (53)
    }

    /// For the camera's walk at a point of a light: the sum over the techniques other than s = 0 (43). `sampling` is the
    /// density of this point by light sampling from the previous vertex [1/m^2] (for an environment [1/sr]). Light sampling has one
    /// sample, so d_vcm stands without those of a connection.
    double other_than_hit(double sampling, double emission, const Techniques& used) const {
        return (used.light_sampling ? d_vcm_ * squared(sampling) : 0) + d_vc_ * squared(emission);
    }

private:
    TechniqueSums(const PathRules& rules, bool from_light)
        : merging_(rules.used.merges, from_light), has_others_(rules.have_others()) {}

    double d_vcm_ = 0;  ///< (1 / density of the last direction)^2: for the technique that connects the last edge
    double d_vc_ = 0;   ///< sum for all techniques on earlier edges and vertices
    MergeRule merging_;
    double samples2_ = 1;  ///< (samples of the technique that connects the last edge)^2
    bool has_others_;
};

}  // namespace gib
