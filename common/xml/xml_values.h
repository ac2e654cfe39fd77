#pragma once
// Parses values written in XML attributes: numbers, vectors and transforms, alike in every locale.

#include "common/core/math.h"
#include "common/xml/xml_document.h"

#include <cstdint>
#include <optional>

namespace gib {

/// The text with the letters of ASCII in lower case.
std::string lower_case(std::string text);
/// The parts of a text between white space and commas.
std::vector<std::string> words_of(std::string_view text);

/// A finite number. Throws InputError at the attribute.
double parse_number(const XmlAttribute& attribute);
/// Finite numbers, separated by white space or commas.
std::vector<double> parse_numbers(const XmlAttribute& attribute);
/// Numbers as parse_numbers() reads them, or the three bytes of #rrggbb over 255.
std::vector<double> parse_channels(const XmlAttribute& attribute);
/// The same as linear values: #rrggbb is a colour of HTML, which has sRGB's curve.
std::vector<double> parse_linear_channels(const XmlAttribute& attribute);
/// One beyond 64 bits is the nearest one of 64 bits.
std::int64_t parse_integer(const XmlAttribute& attribute);
/// `true` or `false` in any case.
bool parse_boolean(const XmlAttribute& attribute);

/// A <point>, <vector> or transform operation: its attributes x, y, z, or `value` (three numbers, or one for all). A
/// missing x, y or z is `fallback`, without which it is an error.
Vec3d parse_vector(const XmlElement& element, std::optional<double> fallback = std::nullopt);

/// The product of a <transform>'s operations, the first one applied first. Throws InputError at the transform if it
/// is singular, and at an operation that is not defined.
Mat4d parse_transform(const XmlElement& element);

}  // namespace gib
