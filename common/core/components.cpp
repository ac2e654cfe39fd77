#include "common/core/components.h"

namespace gib {

std::optional<Component> component_named(std::string_view name) {
    for (Component c : all_components)
        if (name_of(c) == name) return c;
    return std::nullopt;
}

}  // namespace gib
