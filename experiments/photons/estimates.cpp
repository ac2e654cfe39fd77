#include "experiments/photons/estimates.h"

#include "common/core/number_text.h"
#include "common/scene/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace gib {

namespace {

/// The numbers of photons in an estimate beside the method's own, as multiples of it.
constexpr std::array multiples_of_k = {0.25, 0.5, 1.0, 2.0, 4.0};

const Parameter* declared_k(const ConfiguredMethod& method) {
    for (const Parameter& parameter : method.description.parameters)
        if (parameter.name == "k") return &parameter;
    return nullptr;
}

/// The method with another k.
ConfiguredMethod with_k(MethodLabel label, const std::string& k) {
    const auto given = std::ranges::find_if(label.values, [](const auto& v) { return v.first == "k"; });
    if (given != label.values.end()) given->second = k;
    else label.values.emplace_back("k", k);
    return ConfiguredMethod(std::move(label));
}

/// The value of a radius: the number of the label, the default, or what the run has measured; empty if there is none.
std::optional<double> radius_of(const ConfiguredMethod& method,
                                const std::vector<std::pair<std::string, std::string>>& facts,
                                const std::string& name) {
    for (const auto& [fact, value] : facts)
        if (fact == name) return number_from<double>(value);
    for (const Parameter& parameter : method.description.parameters)
        if (parameter.name == name) return number_from<double>(method.values.text(name));
    return std::nullopt;
}

ComponentImages rendered(const EstimateWork& work, const ConfiguredMethod& method, Estimates* own) {
    const auto chosen = method.create({work.scene.max_edges});
    const CellWork cell{.scene = *work.scene.scene,
                        .method = *chosen,
                        .seed = work.seed,
                        .spp = work.passes,
                        .budget = {},
                        .only_last = true};
    ComponentImages images;
    const auto keep = [&](const Checkpoint&, const ComponentImages& components) { images = components; };
    const Measurement measured = measure(cell, keep, {}, work.observer);
    if (own) {
        own->passes = measured.checkpoints.back().passes;
        own->emitted = measured.checkpoints.back().counts.photons;
        for (const auto& [map, name] : {std::pair("global", "radius"), {"caustic", "caustic_radius"}})
            if (const auto share = radius_of(method, measured.facts, name))
                own->radii[map] = *share * double{work.scene.scene->diagonal()};
        if (chosen->plan(*work.scene.scene).runs("final gathering")) own->gather = method.values.integer("gather");
    }
    return images;
}

}  // namespace

Estimates estimates_of(const EstimateWork& work) {
    Estimates estimates;
    const Parameter* declared = declared_k(work.method);
    const auto k = declared && work.varies_k ? work.method.values.number_unless_word("k") : std::nullopt;
    if (!k) {
        estimates.images.push_back(rendered(work, work.method, &estimates));
        return estimates;
    }
    for (const double multiple : multiples_of_k) {
        const std::string text =
            std::to_string(std::llround(std::clamp(multiple * *k, declared->lower, declared->upper)));
        if (!estimates.k.empty() && estimates.k.back() == text) continue;
        const bool is_own = multiple <= 1 && text == std::to_string(std::llround(*k));
        if (is_own) estimates.own = estimates.k.size();
        estimates.images.push_back(
            rendered(work, is_own ? work.method : with_k(work.method.label, text), is_own ? &estimates : nullptr));
        estimates.k.push_back(text);
    }
    return estimates;
}

PixelGrid::PixelGrid(int image_width, int image_height, int most) : width(image_width), height(image_height) {
    const double share = std::min(std::sqrt(double(most) / (double(width) * height)), 1.0);
    columns = std::clamp(static_cast<int>(share * width), 1, most);
    rows = std::clamp(static_cast<int>(share * height), 1, most / columns);
}

}  // namespace gib
