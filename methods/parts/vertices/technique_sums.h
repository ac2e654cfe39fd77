#pragma once
// Weights of multiple importance sampling over all techniques that can make one path.
//
// A path x_0 (on a light) ... x_k (on the camera) can be made from both ends in several ways: technique s takes its
// first s vertices from a walk that started at the light, and the others from a walk that started at the camera. Let
// f_i be the density of x_i [1/m^2] when the light's walk samples it from x_{i-1}, and b_i when the camera's walk does
// from x_{i+1}. The density of technique s is p_s = f_0 ... f_{s-1} b_s ... b_k, and its weight with the power
// heuristic of exponent 2 is p_s^2 / sum over j of p_j^2 (Veach 1997, sections 9.2 and 10.2). The sum needs no list of
// densities: each walk carries it along in two numbers, which are updated from vertex to vertex. A method may add techniques in
// which both walks sample x_i, of density f_0 ... f_i b_i ... b_k n_i; vcm does (methods/vcm/merge_rule.h).
//
// Source: Georgiev 2012, "Implementing Vertex Connection and Merging" (technical report). Its names d_vcm and d_vc
// and its equation numbers stand at the lines. What differs from it:
//  - d_vcm and d_vc hold sums of squares, as the power heuristic needs them.
//  - Connections of the first vertex of the camera's walk that can be joined may have several samples, `first_samples`, by which
//    their density is multiplied (Veach 1997, section 9.2.1). So has the sampling of a light of one point or direction there,
//    whose light has no noise. All others have 1.
//  - A free flight has the density T sigma. All techniques share sigma, the factor of its end. T, the edge's transmittance, is
//    in all but the technique that connects the edge. Weights leave T out, so that they sum to 1; they also leave out Russian
//    roulette, holes and wavelengths. The density of events in a medium is that per length times its scattering coefficient.
//
// Rules:
//  - Densities at a surface are per area, so a density per solid angle is multiplied by |cos| / d^2 with the geometric
//    normal. A vertex in a medium has no cosine.
//  - An event at a delta lobe has density 1 both ways, and no technique connects the two edges beside it.
//  - Instead of f_0 f_1, a technique that samples a point of a light from x_1 has the density of that sampling.
//  - A light at infinity has parallel rays: f_1 is a density across them times |cos|, without a distance (section 5.1).
//  - The camera's point is sampled in the same way by all techniques, and no walk of a light can find it.

#include "common/sampling/sampler.h"

#include <cstdint>

namespace gib {

/// The power heuristic of exponent 2 takes the square of every ratio of densities.
inline double squared(double ratio) { return ratio * ratio; }

/// The rules by which the paths of a run are made and weighed.
struct PathRules {
    int max_edges;                      ///< edges of the longest path
    PointSet points = PointSet::sobol;  ///< of the random numbers
    bool light_sampling = true;         ///< s = 1: points of lights are sampled from the camera's walk
    bool connects = true;               ///< vertices of light walks are connected with the camera's walk and the camera
    bool follows_light = true;          ///< false: no light walks; only a light in view is connected with the camera
    bool weighs = true;                 ///< false: only one technique is in use, whose weight is 1
    int min_edges = 1;                  ///< edges of the shortest path that counts
    std::size_t shared_paths = 1;       ///< pixels of a group, which share their light paths (shared_vertices.h)

    /// Number of independent samples that the weights assume for a connection of the first vertex of the camera's walk that can
    /// be joined (Veach 1997, section 9.2.1). It lies between the three that are made and the number of paths. In door-ajar 4 is
    /// within a quarter of the best, 16; in cornell-box, where few vertices are hidden, 8 and 4 are best.
    double first_samples() const { return shared_paths > 1 ? 4 : 1; }
};

/// A pass of a run: its number and the run's seed.
struct Pass {
    std::uint64_t seed;
    std::uint32_t number = 0;
};

/// The sums over techniques that a walk carries. They always refer to the walk's last vertex.
class TechniqueSums {
public:
    /// At the start of the camera's walk. `ray_density` is Sensor::ray_density(), `light_paths` the number of light
    /// paths for each of the camera's paths of a pixel.
    static TechniqueSums at_camera(double ray_density, double light_paths, const PathRules& rules) {
        TechniqueSums sums(rules);
        sums.d_vcm_ = rules.connects ? squared(light_paths / ray_density) : 0;  // (31)
        return sums;
    }
    /// At the start of a light's walk: `emission` is LightEmission::density(), `sampling` the density with which light
    /// sampling from the first vertex finds this start [1/sr]; for a point or spot light times the squared distance.
    /// `cos_light` belongs to the normal there (1 without a surface). No walk of the camera finds a light that
    /// `is_delta`.
    static TechniqueSums at_light(double emission, double sampling, double cos_light, bool is_delta,
                                  const PathRules& rules) {
        TechniqueSums sums(rules);
        sums.d_vcm_ = rules.light_sampling ? squared(sampling * cos_light / emission) : 0;  // (31)
        sums.d_vc_ = is_delta ? 0 : squared(cos_light / emission);                          // (32), delta: (49)
        return sums;
    }

    /// Whether there are several techniques; if not, the weight is 1.
    bool has_others() const { return has_others_; }

    /// The walk has reached its next vertex: converts densities per solid angle into densities per area there, which
    /// completes equations 31 to 36. `distance2` is 1 for an edge whose rays are parallel, `cosine` is 1 in a medium.
    /// `samples` is the number of samples of the technique that connects the edge which has been walked; 0 if none in use does.
    void arrive(double distance2, double cosine, double samples) {
        d_vcm_ *= squared(distance2 / cosine);
        d_vc_ /= squared(cosine);
        samples2_ = squared(samples);
        n2_ = 0;
    }
    /// n^2 of a technique that takes this vertex from both walks; 0 if there is none.
    double from_both() const { return n2_; }
    void set_from_both(double n2) { n2_ = n2; }
    /// Adds such a technique at an earlier vertex.
    void add_earlier(double technique) { d_vc_ += technique; }

    /// d_vcm of the last edge, with the samples of the technique that connects it; 0 if none in use does.
    double d_vcm() const { return samples2_ * d_vcm_; }
    double d_vc() const { return d_vc_; }

    /// The sum over the techniques that take fewer vertices from this walk, relative to the one that ends it here. The
    /// other walk, which comes to this vertex, goes on to the previous one with the density `reverse` [1/sr]. It is the
    /// bracket of equations 35, 40, 41, 45 and 46.
    double earlier(double reverse) const { return n2_ + besides_both(reverse); }
    /// The same without a technique that takes this vertex from both walks.
    double besides_both(double reverse) const { return d_vcm() + d_vc_ * squared(reverse); }

    /// Scattering by lobes that are no delta: `forward` is the density of the direction taken, `reverse` that of the
    /// walk the other way round, both [1/sr]; `cosine` belongs to the direction taken. Returns the factor of earlier techniques.
    double scatter(double forward, double reverse, double cosine) {
        const double step = squared(cosine / forward);
        d_vc_ = step * earlier(reverse);  // (35)
        d_vcm_ = squared(1 / forward);    // (34)
        return step;
    }
    /// Scattering by a delta lobe.
    void scatter_specularly(double cosine) {
        d_vc_ *= squared(cosine);  // (54)
        d_vcm_ = 0;                // (53)
    }

    /// For the camera's walk at a point of a light: the sum over the techniques other than s = 0 (43). `sampling` is the
    /// density of this point by light sampling from the previous vertex [1/m^2] (for an environment [1/sr]). Light sampling has one
    /// sample, so d_vcm stands without those of a connection.
    double other_than_hit(double sampling, double emission, const PathRules& rules) const {
        return (rules.light_sampling ? d_vcm_ * squared(sampling) : 0) + d_vc_ * squared(emission);
    }

private:
    explicit TechniqueSums(const PathRules& rules) : has_others_(rules.weighs) {}

    double d_vcm_ = 0;  ///< (1 / density of the last direction)^2: for the technique that connects the last edge
    double d_vc_ = 0;   ///< sum for all techniques on earlier edges and vertices
    double n2_ = 0;
    double samples2_ = 1;  ///< (samples of the technique that connects the last edge)^2
    bool has_others_;
};

}  // namespace gib
