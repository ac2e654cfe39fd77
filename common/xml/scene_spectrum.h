#pragma once
// Converts the <spectrum> elements of a scene file to RGB, as Mitsuba's RGB variants do.

#include "common/xml/xml_properties.h"

namespace gib {

/// The colour of
///   value="0.5"                         the same at all wavelengths: grey, but reddish as an emission (RGB's white
///                                       point is D65)
///   value="400:0.1, 700:0.2"            wavelengths [nm] and values; linear in between, 0 outside
///   filename="x.spd"                    such pairs in a file, one a line; # starts a comment
/// and of the plugins uniform (grey always), regular, irregular, srgb, d65 (white always) and, as an emission,
/// blackbody [W/(m^2 sr nm)], which also takes the `scale` of Mitsuba 0.6. Reflectances and indices are converted under
/// the illuminant D65, but not those of old files (XmlElement::old): Mitsuba 0.6 converts all spectra as it does emissions. Colours that RGB cannot hold are clamped to its gamut, as in Mitsuba: below 0 always, above 1 in
/// ColorRange::unit. `name` is the property's name, for messages. Throws InputError, also for values out of `range`.
Color parse_spectrum(const XmlElement& element, const XmlIds& ids, const std::string& name, ColorRange range);

/// A colour that a plugin takes: an <rgb>, a <float> for a grey, or a <spectrum>; linear, with sRGB's primaries.
Color color_property(Properties& properties, const std::string& name, float fallback, ColorRange range);

}  // namespace gib
