#include "experiments/results/judgement.h"

#include "common/core/number_text.h"

#include <algorithm>

namespace gib {

namespace {

void subtract(Image& from, const Image& image) {
    for (std::size_t i = 0; i < from.rgb.size(); ++i)
        from.rgb[i] -= image.rgb[i];
}

/// Subtracts what both have: the mean, the groups and the bias.
void subtract(ReferenceLayer& from, const ReferenceLayer& layer) {
    subtract(from.mean, layer.mean);
    for (std::size_t g = 0; g < std::min(from.groups.size(), layer.groups.size()); ++g)
        subtract(from.groups[g], layer.groups[g]);
    for (std::size_t b = 0; b < std::min(from.bias.size(), layer.bias.size()); ++b)
        subtract(from.bias[b], layer.bias[b]);
}

}  // namespace

Judgement::Judgement(const Reference& reference) : reference_(reference) {
    if (reference.unresolved.empty()) return;
    empty_ = std::ranges::none_of(all_components,
                                  [&](Component c) { return component(c) && !is_black(component(c)->mean); });
    ReferenceLayer total = reference.total;
    for (Component c : reference.unresolved)
        if (const auto& layer = reference[c]) subtract(total, *layer);
    if (total.groups.size() <= 1) {
        partial_total_ = std::move(total);
        return;
    }
    // Components are correlated, so only the groups give the standard error of the remaining sum.
    partial_total_ = layer_of_groups(std::move(total.groups));
    for (ReferenceLayer& bias : total.bias)
        partial_total_->bias.push_back(bias.groups.size() > 1 ? layer_of_groups(std::move(bias.groups))
                                                              : std::move(bias));
}

bool Judgement::is_resolved(Component c) const { return !contains(reference_.unresolved, c); }

const ReferenceLayer* Judgement::component(Component c) const {
    const auto& layer = reference_[c];
    return layer && is_resolved(c) ? &*layer : nullptr;
}

std::vector<std::pair<std::string, const ReferenceLayer*>> Judgement::layers() const {
    std::vector<std::pair<std::string, const ReferenceLayer*>> layers;
    if (!empty_) layers.emplace_back(total_name, &total());
    for (Component c : all_components)
        if (const auto* layer = component(c)) layers.emplace_back(name_of(c), layer);
    return layers;
}

Image Judgement::total_of(const ComponentImages& image) const {
    ComponentImages judged = image;
    for (Component c : reference_.unresolved)
        judged[c].reset();
    return judged.total();
}

Image Judgement::total_of(const LayeredImage& file) const {
    const ComponentImages parts = components_in(file);
    const Image* sum = file.find("");
    const bool has_parts = std::ranges::any_of(parts.parts, [](const auto& p) { return p.has_value(); });
    return has_parts || !sum ? total_of(parts) : *sum;
}

std::optional<double> Judgement::brightest_light() const {
    return number_from<double>(attribute_in(reference_.metadata, "brightest_light"));
}

const Denominators& Judgement::denominators(double epsilon) const {
    if (denominators_ && denominators_->epsilon() == epsilon) return *denominators_;
    truths_.clear();
    return denominators_.emplace(empty_ ? reference_.total : total(), epsilon);
}

std::map<Layer, ImageError> Judgement::errors(const ComponentImages& image, const Image& sum, double epsilon) const {
    std::map<Layer, ImageError> errors;
    const Denominators& with = denominators(epsilon);
    for (const auto& [name, layer] : layers()) {
        const auto c = component_named(name);
        const NoisyTruth& truth = truths_.try_emplace(name, *layer, with).first->second;
        if (!c || image[*c])
            errors[c ? layer_of(*c) : Layer::total] = image_error(c ? *image[*c] : sum, *layer, with, truth);
    }
    return errors;
}

}  // namespace gib
