#pragma once
// Weights of multiple importance sampling over all techniques that can make one path.
//
// A path x_0 (on a light) ... x_k (on the camera) can be made from both ends in several ways: technique s takes its
// first s vertices from a walk that started at the light, and the others from a walk that started at the camera. Let
// f_i be the density of x_i [1/m^2] when the light's walk samples it from x_{i-1}, and b_i when the camera's walk does
// from x_{i+1}. The density of technique s is p_s = f_0 ... f_{s-1} b_s ... b_k, and its weight with the power
// heuristic of exponent 2 is p_s^2 / sum over j of p_j^2 (Veach 1997, sections 9.2 and 10.2). Where photons are merged,
// both walks sample x_i, and the density is f_0 ... f_i b_i ... b_k n_i: n_i is the expected number of photons that
// the vertex is merged with for each photon per area (or volume) there, N pi r^2 with N light paths (Georgiev 2012,
// "Light Transport Simulation with Vertex Connection and Merging"). The sum needs no list of densities:
// each walk carries it along in two numbers, which are updated from vertex to vertex. Source: Georgiev 2012,
// "Implementing Vertex Connection and Merging", whose names d_VCM and d_VC the numbers have; they hold squares here. The
// third number there, d_VM, is d_VC / n^2.
//
// Rules:
//  - Densities at a surface are per area, so a density per solid angle is multiplied by |cos| / d^2 with the geometric
//    normal. A vertex in a medium has no cosine. The probability of a free flight has a factor for its end, which all
//    techniques share, and the transmittance of the edge, which every technique but the one that connects this edge has;
//    it is left out of the weights, which keeps their sum at 1. So are Russian roulette, holes and wavelengths. The
//    density of events in a medium is that per length times its scattering coefficient, which merging has twice.
//  - An event at a delta lobe has density 1 both ways, and no technique connects the two edges beside it.
//  - Photons are merged at x_i only where its neighbour towards the light, x_{i-1}, focuses: the event there is a delta
//    one, or the surface has no diffuse lobe. Elsewhere connections do as well, without a bias.
//  - Instead of f_0 f_1, a technique that samples a point of a light from x_1 has the density of that sampling.
//  - A light at infinity has parallel rays: f_1 is a density across them times |cos|, without a distance.
//  - The camera's point is sampled in the same way by all techniques, and no walk of a light can find it.

#include "common/core/math.h"

namespace gib {

/// The power heuristic of exponent 2 takes the square of every ratio of densities.
inline double squared(double ratio) { return ratio * ratio; }

/// Which kinds of techniques are in use; those that are not are neither tried nor weighed.
struct Techniques {
    bool hits = true;            ///< s = 0: the camera's walk finds a light by itself
    bool light_sampling = true;  ///< s = 1: a point of a light is sampled from the end of the camera's walk
    bool connections = true;     ///< s > 1 with at least one surface or event in a medium on both sides
    bool camera = true;          ///< the end of the light's walk is connected to the camera
    /// n of the vertices on surfaces, N pi r^2 [m^2], and in media, N 4/3 pi r^3 [m^3]; 0: nothing is merged.
    double merging_on_surfaces = 0, merging_in_media = 0;
    bool merging_everywhere = false;  ///< also where nothing focuses
    /// Walks end where they cannot belong any more to a path that merging alone can make.
    bool only_merging = false;

    bool merging() const { return merging_on_surfaces > 0 || merging_in_media > 0; }
};

/// The sums over techniques that a walk carries. They always refer to the walk's last vertex.
class TechniqueSums {
public:
    /// At the start of the camera's walk. `ray_density` is Sensor::ray_density(), `light_paths` the number of light
    /// paths for each of the camera's paths of a pixel (Georgiev 2012, equations 31 to 33).
    static TechniqueSums at_camera(double ray_density, double light_paths, const Techniques& used) {
        TechniqueSums sums(used);
        sums.vcm_ = used.camera ? squared(light_paths / ray_density) : 0;
        return sums;
    }
    /// At the start of a light's walk: `emission` is Scene::emission_pdf(), `sampling` the density with which light
    /// sampling from the first vertex finds this start [1/sr]; for a point or spot light times the squared distance.
    /// `cos_light` belongs to the normal there (1 without a surface). No walk of the camera finds a light that
    /// `is_delta` (equations 34 to 36).
    static TechniqueSums at_light(double emission, double sampling, double cos_light, bool is_delta,
                                  const Techniques& used) {
        TechniqueSums sums(used);
        sums.from_light_ = true;
        sums.vcm_ = used.light_sampling ? squared(sampling * cos_light / emission) : 0;
        sums.vc_ = used.hits && !is_delta ? squared(cos_light / emission) : 0;
        sums.is_sampled_ = used.hits && !is_delta;
        return sums;
    }

    /// Whether there is any technique but the connection of a light's walk to the camera; if not, its weight is 1.
    bool has_others() const { return has_others_; }

    /// The walk has reached its next vertex: converts densities per solid angle into densities per area there.
    /// `distance2` is 1 for an edge whose rays are parallel, `cosine` is 1 in a medium. `connects`: whether a technique
    /// in use connects the edge that has been walked. `merging` is n of this vertex, which `focuses` if it has no diffuse
    /// lobe.
    void arrive(double distance2, double cosine, bool connects, double merging, bool focuses) {
        vcm_ *= squared(distance2 / cosine);
        vc_ /= squared(cosine);
        pending_ /= squared(cosine);
        if (focuses) settle();
        connects_ = connects;
        merging_ = squared(merging);
        focuses_ = focuses;
    }

    /// The sum over the techniques that take fewer vertices from this walk, relative to the one that ends it here. The
    /// other walk, which comes to this vertex, goes on to the previous one with the density `reverse` [1/sr].
    /// (Equations 37 to 40, without the density of the step to this vertex.) `next_focuses` is asked for by the camera's
    /// walk: whether the vertex that follows on this one does.
    double earlier(double reverse, bool next_focuses = false) const {
        return (merges(next_focuses) ? merging_ : 0) + besides_merging(reverse);
    }
    /// The same without merging at this vertex: the sum relative to merging here, times n^2.
    double besides_merging(double reverse) const { return connecting() + besides_connecting() * squared(reverse); }
    /// Its two parts: this one, and that which is multiplied by the squared reverse density.
    double connecting() const { return connects_ ? vcm_ : 0; }
    double besides_connecting() const { return vc_; }
    double merging() const { return merging_; }  ///< n^2 of this vertex
    bool focuses() const { return focuses_; }    ///< this vertex has no diffuse lobe
    /// Whether photons are merged at this vertex, as far as the walk knows: the camera's does not know the next vertex.
    bool merges(bool next_focuses) const { return everywhere_ || (from_light_ ? focused_ : next_focuses); }

    /// Whether a technique connects the last edge, so that other techniques than merging make every path that goes
    /// through this vertex and the last one.
    bool can_connect() const { return connecting() > 0; }
    /// Whether another technique than merging makes a path to this vertex, at which the reverse density is not 0.
    bool is_sampled() const { return can_connect() || is_sampled_; }

    /// Scattering by lobes that are no delta: `forward` is the density of the direction taken, `reverse` that of the
    /// walk the other way round, both [1/sr]; `cosine` belongs to the direction taken (equations 31 to 36).
    void scatter(double forward, double reverse, double cosine) {
        const double step = squared(cosine / forward);
        is_sampled_ = is_sampled();
        vc_ = step * earlier(reverse);
        pending_ = from_light_ || everywhere_ ? 0 : step * merging_;
        vcm_ = squared(1 / forward);
        focused_ = focuses_;
    }
    /// Scattering by a delta lobe.
    void scatter_specularly(double cosine) {
        settle();
        vc_ *= squared(cosine);
        vcm_ = 0;
        focused_ = true;
    }

    /// For the camera's walk at a point of a light: the sum over the techniques other than s = 0. `sampling` is the
    /// density of this point by light sampling from the previous vertex [1/m^2] (for an environment [1/sr]).
    double other_than_hit(double sampling, double emission, const Techniques& used) const {
        return (used.light_sampling ? vcm_ * squared(sampling) : 0) + vc_ * squared(emission);
    }

private:
    explicit TechniqueSums(const Techniques& used)
        : everywhere_(used.merging_everywhere),
          has_others_(used.hits || used.light_sampling || used.connections || used.merging()) {}

    /// The last vertex focuses, so photons can be merged at the one before.
    void settle() {
        vc_ += pending_;
        pending_ = 0;
    }

    double vcm_ = 0;      ///< (1 / density of the last direction)^2: for the technique that connects the last edge
    double vc_ = 0;       ///< sum for all techniques on earlier edges and vertices
    double pending_ = 0;  ///< part of merging at the camera's previous vertex, added if this one focuses
    double merging_ = 0;  ///< n^2 of the last vertex
    bool from_light_ = false, everywhere_;
    bool connects_ = true;
    bool focuses_ = false, focused_ = false;  ///< the last vertex, and the last event before it
    bool is_sampled_ = false;                 ///< whether there is another technique than merging on earlier edges
    bool has_others_;
};

}  // namespace gib
