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
        for (Component c : all_components) {
            auto& mean = groups_[g][c];
            const auto& batch = batches[g][c];
            if (mean.has_value() != batch.has_value())
                throw RunError("the batches of a reference have different components");
            if (!mean) continue;
            for (std::size_t i = 0; i < mean->rgb.size(); ++i) {
                const auto old = static_cast<double>(mean->rgb[i]);
                mean->rgb[i] = static_cast<float>(old + (static_cast<double>(batch->rgb[i]) - old) * share);
            }
        }
}

Reference ReferenceGroups::reference() const {
    Reference reference;
    std::vector<Image> totals;
    for (const auto& group : groups_)
        totals.push_back(group.total());
    reference.total = layer_of_groups(std::move(totals));
    for (Component c : all_components) {
        if (!groups_.front()[c]) continue;
        std::vector<Image> images;
        for (const auto& group : groups_)
            images.push_back(*group[c]);
        reference.components[static_cast<std::size_t>(index_of(c))] = layer_of_groups(std::move(images));
    }
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
    for (Component c : all_components) {
        if (!file[c]) continue;
        for (std::size_t g = 0; g < reference_groups; ++g)
            groups.groups_[g][c] = file[c]->groups.at(g);
    }
    return groups;
}

}  // namespace gib
