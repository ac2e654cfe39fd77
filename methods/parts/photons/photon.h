#pragma once
// The photon as it is stored: power, directions and path length in 16 bytes, and a position (Jensen 2001, section 6.2).
// Then the rule by which photons are joined with an eye path, the weight of the joined path, and the photon's direction
// where interpolated normals or curved surfaces disagree with the geometry.

#include "common/core/math.h"
#include "methods/parts/transport/dispersed_path.h"

#include <array>
#include <bit>
#include <cstdint>
#include <optional>

namespace gib {

/// A colour in 7 bytes, with one byte more for its owner.
///
/// Each channel is kept as m 2^s. The number m is whole, below 2^16 and ROUNDED to nearest; the exponent s is common
/// to the channels and the smallest at which the largest channel fits. So a channel is off by at most 2^-16 of the
/// largest one (half a unit of a number of 2^15 or more) if that is between 1e-33 and 3e38, and by at most 2^-127
/// below; 0 stays 0. The sum of many such colours gains or loses nothing.
class PackedColor {
public:
    /// A colour whose largest channel is smaller may be kept as 0.
    static constexpr float least = 0x1p-126f;

    PackedColor() = default;
    /// A colour that is negative, not finite, or 3.4e38 or more comes back not finite.
    explicit PackedColor(const Color& color, std::uint8_t tag = 0);

    Color color() const {
        const float unit = std::bit_cast<float>((exponent_ + 1u) << 23);
        return Color(mantissa_[0], mantissa_[1], mantissa_[2]) * unit;
    }
    std::uint8_t tag() const { return tag_; }

private:
    std::array<std::uint16_t, 3> mantissa_;
    std::uint8_t exponent_;  ///< s = exponent - 126
    std::uint8_t tag_;       ///< the owner's
};

/// All data of a photon but its position. 16 bytes. The unit of power is the choice of the map that stores the photon
/// (photon_power_unit()).
class PhotonPayload {
public:
    /// A photon whose largest channel is smaller may be kept with power 0.
    static constexpr float least_power = PackedColor::least;

    PhotonPayload() = default;
    PhotonPayload(const Color& power, const Vec3& wi, const Vec3& normal, int path_edges, bool in_medium,
                  std::optional<int> stratum);

    void set_power(const Color& power) { power_ = PackedColor(power, power_.tag()); }

    Color power() const { return power_.color(); }
    bool in_medium() const { return (power_.tag() & 1) != 0; }
    std::optional<int> stratum() const {
        const std::uint8_t tag = power_.tag();
        return tag < 2 ? std::nullopt : std::optional<int>((tag >> 1) - 1);
    }
    /// Direction that the photon came from, pointing away from the surface.
    Vec3 direction() const;
    /// Geometric normal of the surface, on the side where the photon arrived.
    Vec3 surface_normal() const;
    /// The encoded normal; photons of equal normals have equal codes.
    std::uint16_t normal_code() const { return normal_; }

private:
    PackedColor power_;  ///< power with the tag in_medium + 2 (stratum + 1)
    std::uint32_t wi_;
    std::uint16_t normal_;

public:
    std::uint16_t edges;  ///< number of edges of the path from the light to the photon
};
static_assert(sizeof(PhotonPayload) == 16);

/// A photon: power that arrived at a diffuse surface or was scattered in a medium. 28 bytes.
struct Photon : PhotonPayload {
    using Payload = PhotonPayload;
    Vec3 p;

    Photon() = default;
    /// @param power      in some unit of power. A power that a photon cannot carry (negative, not finite, 3.4e38 or
    ///                   more) comes back not finite, so that the film counts it.
    /// @param wi         where the photon came from, pointing away from the surface
    /// @param normal     geometric normal of the surface on the side where the photon arrived; in
    ///                   a medium any unit vector
    /// @param path_edges number of edges of its path from the light to here; at most 65535
    /// @param in_medium  whether a medium has scattered its path
    /// @param stratum    of wavelengths, if its path was split (common/color/dispersion.h)
    Photon(const Vec3& position, const Color& power, const Vec3& wi, const Vec3& normal, int path_edges,
           bool in_medium = false, std::optional<int> stratum = std::nullopt)
        : PhotonPayload(power, wi, normal, path_edges, in_medium, stratum), p(position) {}
    Photon(const Vec3& position, const PhotonPayload& payload) : PhotonPayload(payload), p(position) {}
};
static_assert(sizeof(Photon) == 28);

/// Unit of power [W] for `count` > 0 photons of lights that together emit this power: the largest power of two that
/// is at most the mean photon's power, so that neither faint scenes nor large numbers of photons leave the range of a
/// float. 1 where nothing is emitted.
double photon_power_unit(const Colord& emitted, std::uint64_t count);

/// Unit vectors in 2 x 16 bits, and normals in 2 x 8 bits, by the octahedral map, rounded to the nearest grid point.
/// The angle is off by at most 1e-4 radians, for normals 0.02. Source: Cigolle et al. 2014, "A Survey of Efficient
/// Representations for Independent Unit Vectors".
std::uint32_t encode_direction(const Vec3& w);
Vec3 decode_direction(std::uint32_t code);
std::uint16_t encode_normal(const Vec3& n);
Vec3 decode_normal(std::uint16_t code);

inline Vec3 PhotonPayload::direction() const { return decode_direction(wi_); }
inline Vec3 PhotonPayload::surface_normal() const { return decode_normal(normal_); }

/// The part of a path between the eye and the point where photons are looked up.
struct EyePath {
    int max_photon_edges;             ///< largest number of edges of a photon's path, as whole paths are limited
    std::optional<int> stratum = {};  ///< stratum of wavelengths, if the eye path was split

    /// Whether the photon's path may be joined with this one.
    bool accepts(const PhotonPayload& photon) const {
        return photon.edges <= max_photon_edges && can_join(stratum, photon.stratum());
    }
    /// Factor for the photon's power, by channel: see joint_weight().
    Color weight(const PhotonPayload& photon) const { return joint_weight(stratum, photon.stratum()); }
};

/// wi_local, moved to just above the horizon if it lies below it. A photon that passed the test of its normal arrived
/// on wo's side of its own surface. On a curved surface its direction may still lie below the horizon of the
/// look-up's point, and dropping such photons would darken every curved surface.
inline Vec3 lifted_above_horizon(const Vec3& wo_local, Vec3 wi_local) {
    constexpr float horizon = 1e-4f;
    if (wi_local.z() * wo_local.z() <= 0.f) wi_local.z() = std::copysign(horizon, wo_local.z());
    return wi_local;
}

/// |wi.ns| / |wi.ng|, at most 100. The density of photons measures irradiance on the geometric surface, which is in
/// proportion to |wi.ng|; reflection at an interpolated normal is in proportion to |wi.ns|.
inline float shading_normal_factor(const SurfaceHit& hit, const Vec3& wi) {
    if (hit.ns == hit.ng) return 1.f;
    const float towards = std::abs(wi.dot(hit.ns));
    const float of_surface = std::max(std::abs(wi.dot(hit.ng)), 0.01f * towards);
    return of_surface > 0.f ? towards / of_surface : 1.f;
}

}  // namespace gib
