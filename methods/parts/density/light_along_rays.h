#pragma once
// Light that a medium scatters into a whole stretch of an eye path, from the density of photons around the ray.
//
// The medium equation: with the fluence distribution L(x, wi) [W/(sr m^2)], a stretch of length D along w shows
//
//     L_m = integral from 0 to D of T(t) sigma_s(x_t) integral of p(-w, wi) L(x_t, wi) over wi, dt,   x_t = o + t w.
//
// Photon points (`ray`: Jarosz, Zwicker and Jensen 2008, "The Beam Radiance Estimate for Volumetric Photon
// Mapping"; Jarosz et al. 2011, "A Comprehensive Theory of Volumetric Radiance Estimation using Photon Points and Beams":
// point x beam, 2D blur). A photon at x_i has the value F_i = Phi_i / sigma_s [W m], whose sum over a volume is
// the integral of fluence. It is spread over the disc of radius r through x_i that the ray pierces at a right angle:
//
//     L_m = sum of T(t_i) sigma_s(x_t) p(-w, wi) F_i K2(d_i),        K2 [1/m^2]: kernel_weight().
//
// Photon beams (`beams`: Jarosz et al. 2011, beam x beam, 1D blur; Jarosz, Nowrouzezahrai, Thomas, Sloan and
// Zwicker 2011, "Progressive Photon Beams"). A beam has at the distance s from its beginning the power Phi(s)
// [W], whose mean is Phi(0) T(s). It is spread, along the common perpendicular of beam and ray, over a ribbon of the width
// 2 r. The length of the ray in the ribbon's slice dd is dd / sin theta, theta the angle between beam and ray, so that
//
//     L_m = sum of T(t_i) sigma_s(x_t) p(-w, wi) Phi_i(s_i) K1(d_i) / sin theta_i,        K1 [1/m]: line_kernel_weight(),
//
// where t_i and s_i are the places at which the two lines come closest and d_i is their distance.
//
// Bias: that of the kernel alone, proportional to r^2 where fluence is smooth across the ray, and to r within r of a wall or
// the edge of a shadow. Light beyond a wall closer than r counts, and no photons lie in the wall, where a ray close to it is
// too dark. The variance of N paths falls as 1 / (N r^2) for points, 1 / (N r) for beams. That of beams nearly parallel to
// the ray, 1 / sin theta, has no finite bound; but few are. Photons in another medium than the stretch do not count.

#include "common/media/medium.h"
#include "common/shapes/near_ray_tree.h"
#include "methods/parts/density/volume_estimate.h"
#include "methods/parts/photons/photon_walk.h"
#include "methods/parts/transport/path_walk.h"

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace gib {

/// The look-up of light in media.
enum class VolumeLookUp {
    points,  ///< photons around the end of a free flight (volume_estimate.h)
    ray,     ///< photons around the eye's ray
    beams    ///< beams around the eye's ray
};
inline constexpr std::array<std::string_view, 3> volume_look_up_names = {"points", "ray", "beams"};

/// K(d) [1/length] for d^2 = `d2` <= r^2, r > 0; integrates to 1 over the line from -r to r. As a function of s = d / r,
/// K r is 1/2 (uniform), 1 - s (cone), exp(-2 s^2) / integral (gaussian), 3/4 (1 - s^2) (epanechnikov).
double line_kernel_weight(Kernel kernel, double d2, double r);

class LightAlongRays {
public:
    LightAlongRays() = default;
    /// The light of the walk's beams, if there are any, or else of its photons in media. `radius` [scene units].
    LightAlongRays(PhotonWalkResult walk, VolumeLookUp look_up, Kernel kernel, float radius,
                   bool estimates_bias = false);

    /// Radiance that the stretch scatters to its start [W/(sr m^2)], with its bias if that is asked for.
    Scattered radiance(const MediumStretch& stretch, const EyePath& eye, std::vector<std::uint32_t>& found) const;

    const std::vector<Photon>& photons() const { return walk_.photons; }
    double unit() const { return walk_.unit; }

    /// Light near the ray: `light` times kernel(d2, r) is what it adds to the radiance if it is spread over the radius r.
    struct NearLight {
        double light, d2;
    };
    /// Appends all light within the radius, the mean over the channels times `weight`.
    void collect(const MediumStretch& stretch, const EyePath& eye, const Color& weight,
                 std::vector<NearLight>& near) const;
    /// K1 or K2 for the squared distance d2 and the radius r.
    double kernel(double d2, double r) const;

private:
    /// Calls visit(light, d2), as in NearLight but by channel, for all light within the radius that `eye` accepts, in the
    /// order of the walk. `found` is scratch memory.
    template <typename Visit>
    void for_each_near(const MediumStretch& stretch, const EyePath& eye, std::vector<std::uint32_t>& found,
                       Visit&& visit) const;
    template <typename Visit>
    void show_photon(const Photon& photon, const MediumStretch& stretch, const EyePath& eye, Visit&& visit) const;
    template <typename Visit>
    void show_beam(const PhotonBeam& beam, const MediumStretch& stretch, const EyePath& eye, Visit&& visit) const;

    PhotonWalkResult walk_;
    bool beams_ = false;
    Kernel kernel_ = Kernel::uniform;
    float radius_ = 0.f;
    bool estimates_bias_ = false;
    NearRayTree tree_;
};

}  // namespace gib
