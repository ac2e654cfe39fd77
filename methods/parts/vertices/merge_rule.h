#pragma once
// Where a vertex of the camera's walk is merged with vertices of light paths, and with which density.
//
// A vertex x_i of a path is merged only if its neighbour towards the light, x_{i-1}, focuses: the event there is a delta
// one, or the surface has no diffuse lobe. Elsewhere connections do as well, without a bias. The light's walk comes from
// x_{i-1} and knows the answer on arrival at x_i. The camera's walk comes from the other side and knows it only at its
// next vertex; until then the term of merging at x_i is pending.

#include "common/media/medium.h"

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

/// n of a pass, by which the density of merging exceeds that of a connection: the expected number of light paths' vertices
/// that one is merged with, for each that a path has per area (or volume) there. Equation 20: eta_VCM.
struct MergeDensities {
    double on_surfaces = 0;  ///< N pi r^2 with N light paths [scene units^2]; 0: nothing is merged
    double in_media = 0;     ///< N 4/3 pi r^3 [scene units^3]

    bool any() const { return on_surfaces > 0 || in_media > 0; }
    /// n at p in a medium, where both walks have events in proportion to the scattering coefficient.
    double at(const Medium& medium, const Vec3& p) const {
        return in_media > 0 ? in_media * double{medium.scattering_at(p).maxCoeff()} : 0;
    }
};

/// The rule along one walk. It refers to the walk's last vertex.
class MergeRule {
public:
    MergeRule(Merges merges, bool from_light) : everywhere_(merges == Merges::everywhere), from_light_(from_light) {}

    double n2() const { return n2_; }          ///< n^2 of this vertex
    bool focuses() const { return focuses_; }  ///< this vertex has no diffuse lobe
    /// Whether this vertex is merged. The camera's walk has to be told whether the vertex that follows focuses.
    bool applies(bool next_focuses) const { return everywhere_ || (from_light_ ? behind_focus_ : next_focuses); }

    /// The walk has reached a vertex. Returns the term of the vertex before if it was pending and counts now, else 0.
    double arrive(double n, bool focuses, double cosine) {
        pending_ /= squared(cosine);
        n2_ = squared(n);
        focuses_ = focuses;
        return focuses ? settled() : 0;
    }
    /// Scattering by lobes that are no delta: merging here has the term `step` n^2.
    void scatter(double step) {
        pending_ = from_light_ || everywhere_ ? 0 : step * n2_;
        behind_focus_ = focuses_;
    }
    /// Scattering by a delta lobe; returns as arrive() does.
    double scatter_specularly() {
        behind_focus_ = true;
        return settled();
    }

private:
    double settled() { return std::exchange(pending_, 0.); }

    double pending_ = 0, n2_ = 0;
    bool everywhere_, from_light_;
    bool focuses_ = false;
    bool behind_focus_ = false;  ///< the last event before this vertex focuses
};

}  // namespace gib
