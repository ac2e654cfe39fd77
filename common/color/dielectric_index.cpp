#include "common/color/dielectric_index.h"

namespace gib {

namespace {

struct NamedIndex {
    std::string_view name;
    double index;
};

constexpr NamedIndex named_indices[] = {
    {"vacuum", 1.0},      {"helium", 1.000036},        {"hydrogen", 1.000132},
    {"air", 1.000277},    {"carbon dioxide", 1.00045}, {"water", 1.3330},
    {"acetone", 1.36},    {"ethanol", 1.361},          {"carbon tetrachloride", 1.461},
    {"glycerol", 1.4729}, {"benzene", 1.501},          {"silicone oil", 1.52045},
    {"bromine", 1.661},   {"water ice", 1.31},         {"fused quartz", 1.458},
    {"pyrex", 1.470},     {"acrylic glass", 1.49},     {"polypropylene", 1.49},
    {"bk7", 1.5046},      {"sodium chloride", 1.544},  {"amber", 1.55},
    {"pet", 1.5750},      {"diamond", 2.419}};

}  // namespace

std::optional<double> dielectric_index(std::string_view name) {
    for (const auto& entry : named_indices)
        if (entry.name == name) return entry.index;
    return std::nullopt;
}

std::vector<std::string_view> dielectric_names() {
    std::vector<std::string_view> names;
    for (const auto& entry : named_indices)
        names.push_back(entry.name);
    return names;
}

}  // namespace gib
