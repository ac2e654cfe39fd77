#pragma once
// What a photon is.

#include "common/core/math.h"

#include <array>
#include <bit>
#include <cstdint>
#include <optional>

namespace gib {

/// What a photon carries, all but its position. 16 bytes.
///
/// Power is kept as m 2^s: a whole number m below 2^16 for each channel, ROUNDED to nearest, and one s, the smallest at
/// which the largest channel fits. So a channel is off by at most 2^-16 of the largest one (half a unit of a number of
/// 2^15 or more) for largest channels from 1e-33 to 3e38, and by 2^-127 below; 0 stays 0, and the sum of many photons
/// gains or loses nothing. What 1 stands for is up to who stores it (photon_power_unit()).
class PhotonPayload {
public:
    /// A largest channel below may be kept as 0.
    static constexpr float least_power = 0x1p-126f;

    PhotonPayload() = default;
    PhotonPayload(const Color& power, const Vec3& wi, const Vec3& normal, int path_edges, bool in_medium,
                  std::optional<int> stratum);

    void set_power(const Color& power);

    Color power() const {
        const float unit = std::bit_cast<float>((exponent_ + 1u) << 23);
        return Color(mantissa_[0], mantissa_[1], mantissa_[2]) * unit;
    }
    bool in_medium() const { return (tag_ & 1) != 0; }
    std::optional<int> stratum() const { return tag_ < 2 ? std::nullopt : std::optional<int>((tag_ >> 1) - 1); }
    Vec3 direction() const;
    Vec3 surface_normal() const;
    /// The same for photons of equal normals.
    std::uint16_t normal_code() const { return normal_; }

private:
    std::array<std::uint16_t, 3> mantissa_;
    std::uint8_t exponent_;  ///< s = exponent - 126
    std::uint8_t tag_;       ///< in_medium + 2 (stratum + 1)
    std::uint32_t wi_;
    std::uint16_t normal_;

public:
    std::uint16_t edges;
};
static_assert(sizeof(PhotonPayload) == 16);

/// Power that arrived at a diffuse surface or was scattered in a medium. 28 bytes.
struct Photon : PhotonPayload {
    Vec3 p;

    Photon() = default;
    /// @param power      in some unit of power. What no photon can carry (negative, not finite, 3.4e38 or more) comes
    ///                   back not finite, so that the film counts it.
    /// @param wi         where it came from, away from here
    /// @param normal     geometric normal of the surface on the side that it arrived at; in a medium any unit vector
    /// @param path_edges of its path, from the light to here; at most 65535
    /// @param in_medium  its path was scattered in a medium
    /// @param stratum    of wavelengths, if its path was split (common/color/dispersion.h)
    Photon(const Vec3& position, const Color& power, const Vec3& wi, const Vec3& normal, int path_edges,
           bool in_medium = false, std::optional<int> stratum = std::nullopt)
        : PhotonPayload(power, wi, normal, path_edges, in_medium, stratum), p(position) {}
    Photon(const Vec3& position, const PhotonPayload& payload) : PhotonPayload(payload), p(position) {}
};
static_assert(sizeof(Photon) == 28);

/// [W] The unit for `count` > 0 photons of lights that together emit this power: the power of two next below the mean
/// photon's, so that neither faint scenes nor many photons leave a float's range. 1 where nothing is emitted.
double photon_power_unit(const Colord& emitted, std::uint64_t count);

/// A unit vector in 2 x 16 bits (and in 2 x 8): octahedral map, rounded to the nearest cell; the angle is off by at
/// most 1e-4 (0.02) radians. Source: Cigolle et al. 2014, "A Survey of Efficient Representations for Independent Unit
/// Vectors".
std::uint32_t encode_direction(const Vec3& w);
Vec3 decode_direction(std::uint32_t code);
std::uint16_t encode_normal(const Vec3& n);
Vec3 decode_normal(std::uint16_t code);

inline Vec3 PhotonPayload::direction() const { return decode_direction(wi_); }
inline Vec3 PhotonPayload::surface_normal() const { return decode_normal(normal_); }

}  // namespace gib
