#include "experiments/analysis/left_out.h"

#include <algorithm>

namespace gib {

Effects effects_named(const std::string& names) {
    Effects effects;
    for (const EffectDescription& d : effect_descriptions())
        if ((";" + names + ";").find(";" + std::string(d.name) + ";") != std::string::npos) effects.add(d.effect);
    return effects;
}

std::string words_of(const Effects& effects) {
    std::string text;
    for (const Effect effect : effects.list())
        text += (text.empty() ? "" : ", ") + std::string(name_of(effect));
    std::replace(text.begin(), text.end(), '_', ' ');
    return text;
}

std::string words_of(const Components& components) {
    std::string text;
    for (const Component c : components.list())
        text += (text.empty() ? "" : ", ") + std::string(name_of(c));
    return text;
}

}  // namespace gib
