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
// where t_i and s_i are the places at which the two lines come closest and d_i is their distance. The ray meets such a ribbon
// in proportion to r sin theta, so the relative variance of this estimate grows as 1 / (r sin theta), and it is 0 where light
// runs along the ray. A beam of length l and a stretch of length D that diverge by less than r along the shorter of the two,
//
//     min(l, D) sin theta < r,
//
// are therefore estimated by a point of the beam instead (Jarosz et al. 2011, point x beam, 2D blur; for the variances of both
// see Krivanek et al. 2014, "Unifying Points, Beams, and Paths in Volumetric Light Transport Simulation"). The point lies at the
// distance s from the beam's beginning with the density 1 / l for 0 < s < l. As the beam ends by its transmittance, points lie
// where photons are: it has the value F_i = l Phi_i(s) [W m], with the formula above. This estimate does not depend on theta: the
// relative variance is at most that of a disc of radius r across the light. As the condition depends on the directions and
// the lengths alone, not on the distance, every pair of a beam and a stretch counts in exactly one of the two sums, and both
// converge to the same light.
//
// Both blur L at the ray across it, along the line that the ray, the photon or beam, and their shortest distance give. Where
// surfaces or the edge of the medium bound this line to the lengths a and b on its two sides, light beyond does not count, and
// the rest is divided by the kernel's share between a and b. As the mean over all lines through the ray, this keeps even light
// what it is, in corners as well as in the open.
//
// Bias: that of the kernel alone, proportional to r^2 where fluence is smooth across the ray, and to r times the slope of
// fluence within r of a wall. The variance of N paths falls as 1 / (N r^2) for points, also those of beams along the ray, and as
// 1 / (N r) for other beams. The radii of discs and of ribbons are therefore two (radius.h).

#include "common/media/medium.h"
#include "common/shapes/near_ray_tree.h"
#include "methods/parts/density/flat_regions.h"
#include "methods/parts/density/volume_estimate.h"
#include "methods/parts/photons/photon_walk.h"
#include "methods/parts/transport/path_walk.h"

#include <array>
#include <cstdint>
#include <optional>
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
/// The default number of photons for media beside so many for surfaces: as beams a tenth, because each photon has several and
/// each of these crosses many eye paths. In fog.xml with black walls (32 x 32 pixels) the squared error times the seconds is
/// 0.037, 0.017 and 0.019 for 1e3, 1e4 and 1e5 photons as beams under 8 eye paths a pixel, and 0.028, 0.011 and 0.011 for 0.1, 1
/// and 10 a pixel in each pass of progressive_photon_mapper.
constexpr std::uint64_t default_volume_photons(std::uint64_t photons, VolumeLookUp look_up) {
    return look_up == VolumeLookUp::beams ? (photons + 9) / 10 : photons;
}

/// K(d) [1/length] for d^2 = `d2` <= r^2, r > 0; integrates to 1 over the line from -r to r. As a function of s = d / r,
/// K r is 1/2 (uniform), 1 - s (cone), exp(-2 s^2) / integral (gaussian), 3/4 (1 - s^2) (epanechnikov).
double line_kernel_weight(Kernel kernel, double d2, double r);
/// The share of the kernel's integral from -s r to s r, 0 <= s <= 1.
double line_kernel_mass(Kernel kernel, double s);

/// The radii over which light is spread [scene units].
struct BlurRadii {
    float disc;    ///< of photons, and of beams along the ray
    float ribbon;  ///< of other beams
};

class LightAlongRays {
public:
    LightAlongRays() = default;
    /// The light of the walk's beams, if there are any, or else of its photons in media.
    /// `regions` must outlive this.
    LightAlongRays(PhotonWalkResult walk, Kernel kernel, const BlurRadii& radii, const FlatRegions& regions,
                   bool estimates_bias = false);

    /// Radiance that the stretch scatters to its start [W/(sr m^2)], with its bias if that is asked for. `found` is scratch
    /// memory.
    Scattered radiance(const MediumStretch& stretch, const EyePath& eye, RayQueries& rays,
                       std::vector<std::uint32_t>& found) const;

    const PhotonWalkResult& walk() const { return walk_; }

    /// The place of light near the ray: its squared distance d2, and how far one sees from the ray towards it and the other
    /// way, at most the radius [scene units]; whether it is spread over a disc or over a ribbon.
    struct Nearby {
        double d2;
        float ahead, behind;
        bool on_disc;
    };
    /// The kernel's weight there for the radius r, at most that of the look-ups: K1 or K2, over the kernel's share in sight.
    double weight(const Nearby& at, double r) const;
    /// Light near the ray: weight(at, r) times `light` is what it adds to the radiance if it is spread over the radius r.
    struct NearLight {
        double light;
        Nearby at;
    };
    /// Appends all light within the radius, the mean over the channels times `throughput`.
    void collect(const MediumStretch& stretch, const EyePath& eye, const Color& throughput, RayQueries& rays,
                 std::vector<NearLight>& near) const;

private:
    /// Calls visit(light, at), as in NearLight but by channel, for all light within the radius that `eye` accepts, photons
    /// and points of beams in the order of the walk, and then beams. `found` is scratch memory.
    template <typename Visit>
    void for_each_near(const MediumStretch& stretch, const EyePath& eye, RayQueries& rays,
                       std::vector<std::uint32_t>& found, Visit&& visit) const;
    /// Whether the beam runs so nearly along the stretch that its point stands for it.
    bool runs_along(const PhotonBeam& beam, const MediumStretch& stretch) const;
    double radius_of(const Nearby& at) const { return double{at.on_disc ? radii_.disc : radii_.ribbon}; }
    /// The place at the offset `d` along the unit vector `across` from the ray's point p; empty if a surface hides it.
    std::optional<Nearby> nearby(const Vec3& p, const Vec3& across, double d, bool on_disc, RayQueries& rays) const;

    PhotonWalkResult walk_;
    Kernel kernel_ = Kernel::uniform;
    BlurRadii radii_{};
    const FlatRegions* regions_ = nullptr;
    bool estimates_bias_ = false;
    NearRayTree points_, beams_;  ///< of photons or of a point on each beam; of beams
};

}  // namespace gib
