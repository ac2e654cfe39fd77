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

}  // namespace gib
