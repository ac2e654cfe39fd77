#pragma once
// Reads the emitters `sunsky`, `sky` and `sun`.

#include "common/lights/light.h"
#include "common/xml/xml_properties.h"

namespace gib {

/// Reads an emitter of one of these types, whose frame has x to the north and z upwards (Mitsuba 3's documentation of
/// `sunsky`); `axes` holds this frame in world space.
///
/// All radiance is in W/(m^2 sr nm), as in Mitsuba: the mean over wavelengths by the observer's y (rgb_of_spectrum).
/// turbidity (1 to 10, default 3) and albedo of the ground (default 0.3) of the sky (ClearSky), the sun's place as
/// sun_direction, in world space, or as latitude, longitude, timezone, year, month, day, hour, minute and second;
/// sky_scale and sun_scale, which `scale` replaces in `sky` and `sun`; and sun_aperture, the diameter of the disc
/// [degrees], or sun_radius_scale of Mitsuba 0.6, its ratio to the true one: both keep the sun's irradiance, and a
/// ratio of 0 makes parallel light. Below the horizon all is black, but for two parameters of Mitsuba 0.6: with
/// `stretch` (1 to 2) directions at the angle theta to the zenith show the sky at theta / stretch, and with `extend`
/// the radiance of the horizon goes on below it, fading towards the nadir. Throws InputError.
std::vector<Light> parse_daylight(Properties& properties, const std::string& type, const Frame& axes);

}  // namespace gib
