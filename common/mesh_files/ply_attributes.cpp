#include "common/mesh_files/ply_attributes.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

namespace gib {

namespace {

/// The properties named so, if there are all three.
std::optional<std::vector<std::size_t>> find_all(std::span<const std::string> names,
                                                 const std::array<std::string_view, 3>& wanted) {
    std::vector<std::size_t> found;
    for (const std::string_view name : wanted) {
        const auto it = std::find(names.begin(), names.end(), name);
        if (it == names.end()) return std::nullopt;
        found.push_back(static_cast<std::size_t>(it - names.begin()));
    }
    return found;
}

/// A name such as `tint_r`, in its two parts.
struct SplitName {
    std::string_view prefix;
    char letter;
};

std::optional<SplitName> split(std::string_view name) {
    if (name.size() < 3 || name[name.size() - 2] != '_') return std::nullopt;
    return SplitName{name.substr(0, name.size() - 2), name.back()};
}

/// The number of properties, from number `first` on, whose names have one prefix and the letters of `scheme` in order.
std::size_t length_of_group(std::span<const std::string> names, std::size_t first, std::string_view scheme) {
    const auto start = split(names[first]);
    std::size_t length = 0;
    while (start && length < scheme.size() && first + length < names.size()) {
        const auto next = split(names[first + length]);
        if (!next || next->prefix != start->prefix || next->letter != scheme[length]) break;
        ++length;
    }
    return length;
}

}  // namespace

std::vector<PlyAttribute> ply_attributes(const std::string& element, std::span<const std::string> names) {
    constexpr std::array<std::string_view, 4> schemes = {"xyzw", "rgba", "0123", "1234"};
    std::vector<PlyAttribute> attributes;
    auto color = find_all(names, {"r", "g", "b"});
    if (!color) color = find_all(names, {"red", "green", "blue"});
    if (color) attributes.push_back({element + "_color", *color});
    for (std::size_t i = 0; i < names.size();) {
        std::size_t length = 0;
        std::string_view scheme;
        for (const std::string_view candidate : schemes)
            if (const std::size_t n = length_of_group(names, i, candidate); n > length) {
                length = n;
                scheme = candidate;
            }
        const bool has_alpha = length == 4 && scheme == "rgba";
        if (length == 1 || length == 3 || has_alpha) {
            PlyAttribute attribute{element + "_" + std::string(split(names[i])->prefix), {}};
            for (std::size_t k = 0; k < std::min<std::size_t>(length, 3); ++k)
                attribute.properties.push_back(i + k);
            attributes.push_back(std::move(attribute));
        }
        i += std::max<std::size_t>(length, 1);
    }
    return attributes;
}

}  // namespace gib
