#include "experiments/measuring/reference_store.h"

#include "common/core/number_text.h"
#include "common/core/reject.h"

namespace gib {

namespace {

template <typename Number>
Number number_in(const Reference& file, const std::string& key, const std::string& path) {
    const auto entry = file.metadata.find(key);
    const auto value = entry == file.metadata.end() ? std::nullopt : number_from<Number>(entry->second);
    if (!value) reject({path}, "not a reference of gibench: its attribute '{}' is missing or no number", key);
    return *value;
}

/// Moves the mean by this share of the way to the batch.
void move_towards(std::optional<Image>& mean, const std::optional<Image>& batch, double share) {
    if (mean.has_value() != batch.has_value()) throw RunError("the batches of a reference have different components");
    if (!mean) return;
    for (std::size_t i = 0; i < mean->rgb.size(); ++i) {
        const auto old = double{mean->rgb[i]};
        mean->rgb[i] = static_cast<float>(old + (double{batch->rgb[i]} - old) * share);
    }
}

/// The layer of one image of every group, with its bias if there is one. `image` and `bias` return an optional image.
template <typename ImageOf, typename BiasOf>
ReferenceLayer layer_of(const std::vector<ComponentImages>& groups, const ImageOf& image, const BiasOf& bias) {
    std::vector<Image> images, biases;
    for (const ComponentImages& group : groups) {
        images.push_back(image(group));
        if (auto of_group = bias(group)) biases.push_back(std::move(*of_group));
    }
    ReferenceLayer layer = layer_of_groups(std::move(images));
    if (!biases.empty()) layer.bias.push_back(layer_of_groups(std::move(biases)));
    return layer;
}

}  // namespace

void ReferenceGroups::add_round(const std::vector<ComponentImages>& batches, std::uint64_t batch_passes) {
    ++rounds;
    const double share = static_cast<double>(batch_passes) / static_cast<double>(passes + batch_passes);
    passes += batch_passes;
    if (groups_.empty()) {
        groups_ = batches;
        return;
    }
    for (std::size_t g = 0; g < groups_.size(); ++g)
        for (std::size_t c = 0; c < component_count; ++c) {
            move_towards(groups_[g].parts[c], batches[g].parts[c], share);
            move_towards(groups_[g].bias[c], batches[g].bias[c], share);
        }
}

Reference ReferenceGroups::reference() const {
    Reference reference;
    reference.total = layer_of(
        groups_, [](const auto& group) { return group.total(); }, [](const auto& group) { return group.total_bias(); });
    for (std::size_t c = 0; c < component_count; ++c)
        if (groups_.front().parts[c])
            reference.components[c] = layer_of(
                groups_, [c](const auto& group) { return *group.parts[c]; },
                [c](const auto& group) { return group.bias[c]; });
    return reference;
}

ReferenceGroups ReferenceGroups::read(const std::string& path, const std::string& key, int width, int height) {
    const Reference file = read_reference(path);
    const auto stored_key = file.metadata.find("reference_key");
    if (stored_key == file.metadata.end() || stored_key->second != key)
        throw InputError({path}, "it is not the reference of this scene and method");
    if (!is_verified(file)) throw InputError({path}, "it has no digest, so damage to it would not be seen");
    if (file.total.mean.width != width || file.total.mean.height != height)
        throw InputError({path}, "its size is not the scene's");
    ReferenceGroups groups;
    groups.rounds = number_in<std::uint32_t>(file, "rounds", path);
    groups.passes = number_in<std::uint64_t>(file, "passes", path);
    groups.seconds = number_in<double>(file, "seconds", path);
    if (file.metadata.count("work") > 0) groups.work = number_in<double>(file, "work", path);
    if (file.metadata.count("not_finite") > 0) {
        groups.dropped.count = number_in<std::uint64_t>(file, "not_finite", path);
        if (const auto first = file.metadata.find("first_not_finite"); first != file.metadata.end())
            groups.dropped.first = first->second;
    }
    groups.groups_.resize(reference_groups);
    for (auto& group : groups.groups_) {
        group.width = width;
        group.height = height;
    }
    for (std::size_t c = 0; c < component_count; ++c) {
        const auto& layer = file.components[c];
        if (!layer) continue;
        for (std::size_t g = 0; g < reference_groups; ++g) {
            groups.groups_[g].parts[c] = layer->groups.at(g);
            for (const ReferenceLayer& bias : layer->bias)
                groups.groups_[g].bias[c] = bias.groups.at(g);
        }
    }
    return groups;
}

}  // namespace gib
