#pragma once
// The page of stored light (photons_page/) and three.js, embedded by the build.

#include <string>
#include <string_view>

namespace gib {

/// The template of the page; page.cpp makes its data.
std::string_view photons_template();
/// The CSS of the page.
std::string_view photons_style();
/// The page's own script, a module.
std::string photons_script();
/// The modules of three.js, with its licence, and of its OrbitControls, which imports "three".
std::string_view three_script();
std::string_view orbit_script();

}  // namespace gib
