#pragma once
// Indices of refraction of dielectrics, by the names that Mitsuba accepts.

#include <optional>
#include <string_view>
#include <vector>

namespace gib {

/// The index of a material at 589 nm and 0 to 20 degrees Celsius, after Hecht, Optics, 4th edition. Empty if there is
/// no such material.
std::optional<double> dielectric_index(std::string_view name);

/// All names, for error messages.
std::vector<std::string_view> dielectric_names();

}  // namespace gib
