#pragma once
// How the radius of progressive methods shrinks from pass to pass, and where it starts.
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

#include <cmath>
#include <cstdint>

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

}  // namespace gib
