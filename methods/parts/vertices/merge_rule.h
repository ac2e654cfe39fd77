#pragma once
// Where a vertex of the camera's walk is merged with vertices of light paths, and with which density.
//
// A vertex x_i of a path is merged only if its neighbour towards the light, x_{i-1}, focuses: the event there is a delta
// one, or the surface has no diffuse lobe. Elsewhere connections do as well, without a bias. The light's walk comes from
// x_{i-1} and knows the answer on arrival at x_i. The camera's walk comes from the other side and knows it only at its
// next vertex; until then the term of merging at x_i is pending. As n takes rays, the camera's walk asks for it only when the
// answer is yes, or when there is something to merge.

#include "common/media/medium.h"
#include "methods/parts/density/place_radius.h"

#include <algorithm>
#include <utility>

namespace gib {

/// The power heuristic of exponent 2 takes the square of every ratio of densities.
inline double squared(double ratio) { return ratio * ratio; }

/// Which vertices are merged.
enum class Merges {
    none,
    behind_focus,  ///< those whose neighbour towards the light focuses
    everywhere,
    alone  ///< behind a focus; walks end where they cannot belong any more to a path that merging alone can make
};

/// The radii within which vertices are merged in a pass, and n, by which the density of merging exceeds that of a
/// connection: the expected number of light paths' vertices that one is merged with, for each that a path has per area (or
/// volume) there. Equation 20: eta_VCM. Both depend on the place alone, so that the walks from both ends know the same n.
struct MergeRadii {
    double light_paths = 0;     ///< N: light paths in a pass
    double on_surfaces = 0;     ///< largest radius on surfaces [scene units]; 0: nothing is merged
    double in_media = 0;        ///< largest radius in media [scene units]
    PlaceRadius by_place = {};  ///< bounds the radius on surfaces

    bool any() const { return on_surfaces > 0 || in_media > 0; }

    /// n = N pi r^2 of the place's r at a hit that is seen from wo; 0 where all lobes are deltas.
    double n_at(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo) const {
        if (!(on_surfaces > 0) || hit.delta_only) return 0;
        const LobeTraits& lobes = hit.bsdf->traits_at(hit.shading.to_local(wo).z());
        if (!lobes.diffuse && !lobes.glossy) return 0;
        return light_paths * std::numbers::pi * sqr(on_surfaces * double{by_place.share(rays, hit, wo)});
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

/// The rule along one walk. It refers to the walk's last vertex.
class MergeRule {
public:
    MergeRule(Merges merges, bool from_light)
        : everywhere_(merges == Merges::everywhere),
          from_light_(from_light),
          defers_(!from_light && (merges == Merges::behind_focus || merges == Merges::alone)) {}

    double n2() const { return n2_; }  ///< n^2 of this vertex; 0 until set_n(), if that is to be told later
    void set_n(double n) { n2_ = squared(n); }
    bool focuses() const { return focuses_; }  ///< this vertex has no diffuse lobe
    /// Whether this vertex is merged. The camera's walk has to be told whether the vertex that follows focuses.
    bool applies(bool next_focuses) const { return everywhere_ || (from_light_ ? behind_focus_ : next_focuses); }

    /// The walk has reached a vertex.
    void arrive(double n, bool focuses, double cosine) {
        pending_ /= squared(cosine);
        n2_ = squared(n);
        focuses_ = focuses;
    }
    /// The path goes on from a vertex that focuses. Returns the term of the vertex before if it was pending, else 0;
    /// `pending_n` is n there. A path that ends here, at a light, has been merged nowhere.
    double settle(double pending_n) { return std::exchange(pending_, 0.) * squared(pending_n); }
    /// Whether the vertex before would be merged if this one focused or scattered by a delta lobe.
    bool is_pending() const { return pending_ > 0; }
    /// Scattering by lobes that are no delta: merging here has the term `step` n^2.
    void scatter(double step) {
        pending_ = defers_ ? step : 0;
        behind_focus_ = focuses_;
    }
    /// Scattering by a delta lobe; returns as settle() does.
    double scatter_specularly(double pending_n) {
        behind_focus_ = true;
        return settle(pending_n);
    }

private:
    double pending_ = 0;  ///< factor of n^2 of the vertex before
    double n2_ = 0;
    bool everywhere_, from_light_;
    bool defers_;  ///< whether a vertex is merged is known at the next one
    bool focuses_ = false;
    bool behind_focus_ = false;  ///< the last event before this vertex focuses
};

}  // namespace gib
