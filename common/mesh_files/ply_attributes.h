#pragma once
// Finds the attributes of vertices and faces among the properties of a PLY file.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace gib {

/// An attribute and the properties that hold it, by their numbers in the element: one for a number, three for a colour.
struct PlyAttribute {
    std::string name;
    std::vector<std::size_t> properties;
};

/// The attributes of the element `vertex` or `face`, by the rules of Mitsuba 3 (its documentation of `ply`):
/// - `r`, `g`, `b` or `red`, `green`, `blue` are the attribute `vertex_color` or `face_color`;
/// - neighbours PREFIX_x, PREFIX_y, PREFIX_z, or with r g b, 0 1 2 or 1 2 3 in the place of x y z, are `vertex_PREFIX`
///   or `face_PREFIX`, and so is the first of these alone.
/// The alpha of a colour is left out. Groups of two or of another four, and all other properties, are no attributes.
/// `names` has the name of each property; an empty one stands for a property that means something else.
std::vector<PlyAttribute> ply_attributes(const std::string& element, std::span<const std::string> names);

}  // namespace gib
