#pragma once
// <spectrum> elements of a scene file, as the RGB that Mitsuba's RGB variants make of them.

#include "common/xml/xml_properties.h"

namespace gib {

/// The colour of
///   value="0.5"                         the same at all wavelengths: grey, but reddish as an emission (the white point
///                                       of RGB is D65)
///   value="400:0.1, 700:0.2"            wavelengths [nm] and values; straight lines between, 0 outside
///   filename="x.spd"                    the same, a pair of numbers a line; # starts a comment
/// and of the plugins uniform (grey always), regular, irregular, srgb, d65 (white always) and, as an emission,
/// blackbody [W/(m^2 sr nm)]. A reflectance and an index are seen under D65. Colours that RGB cannot hold are clamped
/// to its gamut, as in Mitsuba: below 0 always, above 1 in ColorRange::unit. `name` is the property's, for messages.
/// Throws InputError, also for values out of `range`.
Color parse_spectrum(const XmlElement& element, const XmlIds& ids, const std::string& name, ColorRange range);

/// A colour that a plugin takes: an <rgb>, a <float> for a grey, or a <spectrum>. Linear, sRGB's primaries.
Color color_property(Properties& properties, const std::string& name, float fallback, ColorRange range);

}  // namespace gib
