#pragma once
// Effects and components that methods leave out, in words.

#include "common/scene/effects.h"
#include "experiments/results/layer.h"

#include <algorithm>
#include <string>

namespace gib {

/// The members of a set of effects or components: "specular reflection, refraction".
template <typename Set>
std::string words_of(const Set& members, const std::string& quote = "") {
    std::string text;
    for (const auto member : members.list())
        text += (text.empty() ? "" : ", ") + quote + std::string(name_of(member)) + quote;
    std::replace(text.begin(), text.end(), '_', ' ');
    return text;
}

/// "specular reflection; light of caustic, indirect"; empty if nothing is left out.
inline std::string words_of(const LeftOut& left_out) {
    const std::string effects = words_of(left_out.effects);
    if (left_out.components.empty()) return effects;
    return effects + (effects.empty() ? "" : "; ") + "light of " + words_of(left_out.components);
}

}  // namespace gib
