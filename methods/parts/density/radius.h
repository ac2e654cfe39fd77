#pragma once
// How the radius of progressive methods starts, from the photons themselves, and how it shrinks from pass to pass.
//
// With n = 2 for surfaces and for photons around a ray (or beams along it), 3 for media and 1 for other beams,
//
//     r_(i+1)^n = r_i^n (i + alpha) / (i + 1),   i = 1, 2, ...,   0 < alpha < 1
//
// (Knaus and Zwicker 2011, "Progressive Photon Mapping: A Probabilistic Approach"; beams: Jarosz, Nowrouzezahrai, Thomas,
// Sloan and Zwicker 2011, "Progressive Photon Beams"), so r_i^n falls as
// i^(alpha - 1). The variance of pass i grows as 1 / r_i^n, and its bias falls as r_i^2. The mean over N passes has the
// variance O(N^-alpha) and the bias O(N^-(1 - alpha)) on surfaces, O(N^-(2/3) (1 - alpha)) in media and
// O(N^-2 (1 - alpha)) with beams, but at most O(N^-1).

#include "methods/parameters.h"
#include "methods/parts/photons/photon.h"
#include "methods/parts/transport/specular_walk.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace gib {

class ShrinkingRadius {
public:
    explicit ShrinkingRadius(double alpha) : alpha_(alpha) {}

    /// r_i / r_1 of the pass that `passes` others precede.
    double on_surfaces(std::uint64_t passes) const { return std::sqrt(power(passes)); }
    double along_beams(std::uint64_t passes) const { return power(passes); }
    double in_media(std::uint64_t passes) const { return std::cbrt(power(passes)); }

private:
    /// (r_i / r_1)^n, the product of (j + alpha) / (j + 1) over j = 1 ... i - 1.
    double power(std::uint64_t passes) const {
        const auto p = static_cast<double>(passes);
        return std::exp(std::lgamma(p + 1 + alpha_) - std::lgamma(1 + alpha_) - std::lgamma(p + 2));
    }

    double alpha_;
};

inline Parameter alpha_parameter() {
    return number_parameter(
        "alpha", "0.67", "", 0.01, 0.99,
        "the variance of a mean over N passes falls as N^-alpha, the bias on surfaces as N^(alpha - 1)");
}

/// The parameter of a first radius. `where` names its look-ups; `most` is the largest mean number of points that `auto`
/// allows.
inline Parameter first_radius_parameter(std::string name, const std::string& where, const std::string& most) {
    Parameter parameter =
        number_parameter(std::move(name), "auto", "scene diagonals", 0x1p-40, 1,
                         "radius of the first pass " + where + "; auto: that which balances bias and variance, with " +
                             most + " in the mean look-up at most");
    parameter.choices = {"auto"};
    return parameter;
}

/// The radius given [scene diagonals]; 0 stands for auto.
inline double first_radius_of(const ParameterValues& values, std::string_view name) {
    return values.number_unless_word(name).value_or(0);
}

/// Places where eye paths look photons up.
struct SeenPlaces {
    std::vector<Vec3> on_surfaces, in_media;
};
/// The places of 8192 eye paths spread over the image; adds the rays traced to `rays`.
SeenPlaces seen_places(const Scene& scene, const WalkSettings& settings, std::uint64_t seed, std::uint64_t& rays);

/// How many passes' paths from the lights first_radius() needs, if a pass has `paths` of them.
std::uint64_t pilot_passes(double paths);

/// The radius [scene units] of a first pass for which bias and variance of the look-ups at the places are in balance, or
/// that with which a look-up finds `most` photons in the mean, if it is smaller: there more photons cost more than they
/// bring. `photons` are those of `passes` passes together, because with the few of a small image the bias would drown in
/// noise (pilot_passes()). `dimensions` is 2 for discs on surfaces and 3 for balls in media.
///
/// The squared error is least where the squared bias, which grows as r^4, is half of the variance, which falls as r^-2.
/// The search doubles the discs until it is 4 times the variance: half of that disc has the least error then. Errors are
/// relative: they count with 1 / (S^2 + the median's S^2), with S the density of the ten nearest photons. The search
/// begins with a radius within which the densest quarter of the places has 1/20 of a photon or more. Returns
/// diagonal / 50 if no place has ten photons within diagonal / 10.
double first_radius(const std::vector<Photon>& photons, double passes, const std::vector<Vec3>& places, double most,
                    int dimensions, float diagonal);

/// A radius [scene units] as a fact of a run, in scene diagonals.
std::pair<std::string, std::string> radius_fact(std::string name, double radius, const Scene& scene);

}  // namespace gib
