#pragma once
// Where a vertex of the camera's walk is merged with vertices of light paths, and with which density.
//
// A vertex x_i of a path is merged only if its neighbour towards the light, x_{i-1}, focuses: the event there is a delta
// one, or the surface has no diffuse lobe. Elsewhere connections do as well, without a bias. The light's walk comes from
// x_{i-1} and knows the answer on arrival at x_i. The camera's walk comes from the other side and knows it only at its
// next vertex; until then the term of merging at x_i is pending. As n takes rays, the camera's walk asks for it only when the
// answer is yes, or when there is something to merge.
//
// Source: Georgiev 2012 (technique_sums.h). A merge adds its term n^2 to equations 35, 40, 41, 45 and 46 (TechniqueSums::set_from_both()),
// or one vertex later (add_earlier()). d_vm is not stored. It is d_vc / n^2 where n is the same at all vertices; here n differs
// between surfaces and media, so the weight of a merge divides the sum over the other techniques by the n^2 of its own vertex
// (light_vertex_map.cpp). In a medium each walk brings the scattering coefficient once, so a merge has it twice; n holds the second.

#include "common/media/medium.h"
#include "methods/parts/density/place_radius.h"
#include "methods/parts/vertices/path_vertex.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace gib {

/// Which vertices are merged.
enum class Merges {
    behind_focus,  ///< those whose neighbour towards the light focuses
    everywhere,
    alone  ///< behind a focus; walks end where they cannot belong any more to a path that merging alone can make
};

/// Whether a surface seen from `wo` has no diffuse lobe, so that it focuses light.
inline bool focuses(const SurfaceHit& hit, const Vec3& wo) {
    return hit.delta_only || !hit.bsdf->traits_at(hit.shading.to_local(wo).z()).diffuse;
}

/// The radii within which vertices are merged in a pass, and n, by which the density of merging exceeds that of a
/// connection: the expected number of light paths' vertices that one is merged with, for each that a path has per area (or
/// volume) there. Equation 20: eta_VCM. Both depend on the place and its side alone, so that the walks from both ends know the same n.
struct MergeRadii {
    double light_paths = 0;  ///< N: light paths in a pass
    double on_surfaces = 0;  ///< largest radius on surfaces [scene units]; 0: nothing is merged
    double in_media = 0;     ///< largest radius in media [scene units]
    float largest_by_place =
        0;  ///< place_radius.h: from which the radius of a place is found [scene units]; 0: no place bounds it

    bool any() const { return on_surfaces > 0 || in_media > 0; }

    /// n = N pi r^2 of the place's r at a hit that is seen from wo; 0 where all lobes are deltas.
    double n_at(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo) const {
        if (!(on_surfaces > 0) || hit.delta_only) return 0;
        const LobeTraits& lobes = hit.bsdf->traits_at(hit.shading.to_local(wo).z());
        if (!lobes.diffuse && !lobes.glossy) return 0;
        const float share = largest_by_place > 0.f ? share_of_radius_at(rays, hit, wo, largest_by_place) : 1.f;
        return light_paths * std::numbers::pi * sqr(on_surfaces * double{share});
    }
    double radius_of(double n) const { return std::sqrt(n / (light_paths * std::numbers::pi)); }

    /// As for photon maps (volume_estimate.h), at most a mean free path.
    double radius_at(const Medium& medium, const Vec3& p) const {
        return std::min(in_media, double{medium.mean_free_path_at(p)});
    }
    /// n = N 4/3 pi r^3 times the scattering coefficient, to which the events of both walks are in proportion.
    double n_at(const Medium& medium, const Vec3& p) const {
        if (!(in_media > 0)) return 0;
        const double r = radius_at(medium, p);
        return light_paths * 4 / 3 * std::numbers::pi * r * r * r * double{medium.scattering_at(p).maxCoeff()};
    }
};

/// The rule of a pass, and its two sides along walks: what NoMerging::Along leaves empty.
struct MergeRule {
    Merges merges;
    MergeRadii radii = {};

    bool is_alone() const { return merges == Merges::alone; }

    class AlongLight {
    public:
        AlongLight(const MergeRule& rule, bool from_delta_light) : rule_(rule), from_delta_light_(from_delta_light) {}

        void arrive(const PathWalk& walk, const Vec3& p, TechniqueSums& sums) {
            focuses_ = false;
            sums.set_from_both(is_merged() ? squared(rule_.radii.n_at(*walk.at.medium, p)) : 0);
        }
        void arrive(const PathWalk& walk, const SurfaceHit& hit, TechniqueSums& sums) {
            focuses_ = focuses(hit, walk.wo());
            sums.set_from_both(is_merged() ? squared(rule_.radii.n_at(walk.rays, hit, walk.wo())) : 0);
        }
        /// Whether only paths are wanted that merging alone can make, and another technique makes every path to here.
        bool ends(const TechniqueSums& sums) const {
            return rule_.is_alone() && (!from_delta_light_ || sums.d_vcm() > 0);
        }
        void scatters(bool by_delta) { behind_focus_ = by_delta || focuses_; }

    private:
        bool is_merged() const { return behind_focus_ || rule_.merges == Merges::everywhere; }

        const MergeRule& rule_;
        bool from_delta_light_;
        bool focuses_ = false, behind_focus_ = false;  ///< the present vertex; the last event before it
    };

    class AlongCamera {
    public:
        explicit AlongCamera(const MergeRule& rule) : rule_(rule) {}

        void arrive(const PathWalk& walk, const Vec3& p, TechniqueSums& sums) {
            n_ = rule_.radii.n_at(*walk.at.medium, p);
            sums.set_from_both(is_everywhere() ? squared(*n_) : 0);
        }
        /// A surface with this cosine. If it focuses, the vertex before is merged.
        void arrive(const PathWalk& walk, const SurfaceHit& hit, double cosine, TechniqueSums& sums) {
            pending_ /= squared(cosine);
            n_.reset();
            if (is_everywhere()) sums.set_from_both(squared(n_.emplace(rule_.radii.n_at(walk.rays, hit, walk.wo()))));
            else if (focuses(hit, walk.wo())) settle(walk.rays, sums);
        }
        bool is_alone() const { return rule_.is_alone(); }
        bool ends(const TechniqueSums& sums) const { return is_alone() && sums.d_vcm() > 0; }
        /// The present vertex will be scattered at. If a delta lobe does so, the vertex before is merged.
        void scatters(RayQueries& rays, bool by_delta, TechniqueSums& sums) {
            if (by_delta) settle(rays, sums);
        }
        /// The vertex has been scattered at, which has given earlier techniques the factor `step`.
        void scattered(const PathVertex& vertex, double step) {
            pending_ = is_everywhere() ? 0 : step;
            if (!(pending_ > 0)) return;
            last_hit_ = vertex.hit;
            last_from_ = vertex.from;
            last_n_ = n_;
        }
        /// The vertex is merged where the light's vertex focuses.
        void join(RayQueries& rays, PathVertex& vertex, const PathVertex& from_light) {
            const bool is_merged = is_everywhere() || (from_light.hit && focuses(*from_light.hit, from_light.from));
            vertex.sums.set_from_both(is_merged ? squared(n_at(rays, vertex)) : 0);
        }
        /// n at the present vertex.
        double n_at(RayQueries& rays, const PathVertex& vertex) {
            if (!n_) n_ = rule_.radii.n_at(rays, *vertex.hit, vertex.from);
            return *n_;
        }

    private:
        bool is_everywhere() const { return rule_.merges == Merges::everywhere; }
        /// Adds the merge at the vertex before, if it is pending. A path that ends here, at a light, has been merged nowhere.
        void settle(RayQueries& rays, TechniqueSums& sums) {
            if (!(pending_ > 0)) return;
            if (!last_n_) last_n_ = rule_.radii.n_at(rays, *last_hit_, last_from_);
            sums.add_earlier(std::exchange(pending_, 0.) * squared(*last_n_));
        }

        const MergeRule& rule_;
        double pending_ = 0;       ///< factor of n^2 of the vertex before; 0 if nothing is pending there
        std::optional<double> n_;  ///< of the present vertex; empty until it is asked for
        // The vertex before; it lies on a surface if its n is not known yet.
        std::optional<SurfaceHit> last_hit_;
        Vec3 last_from_ = Vec3::Zero();
        std::optional<double> last_n_;
    };
};

}  // namespace gib
