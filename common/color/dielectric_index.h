#pragma once
// Indices of refraction of dielectrics, by the names that Mitsuba knows.

#include <optional>
#include <string_view>
#include <vector>

namespace gib {

/// At 589 nm and 0 to 20 degrees Celsius, after Hecht, Optics, 4th edition. Empty: no such material.
std::optional<double> dielectric_index(std::string_view name);

/// For messages.
std::vector<std::string_view> dielectric_names();

}  // namespace gib
