#pragma once
// Lists of names as people read them.

#include <string>

namespace gib {

/// Names that are separated by `;`, with commas and spaces: "specular reflection, refraction".
inline std::string spaced(const std::string& names) {
    std::string text;
    for (const char c : names)
        text += c == ';' ? ", " : c == '_' ? " " : std::string(1, c);
    return text;
}

}  // namespace gib
