#include "experiments/analysis/table_row.h"

#include "common/core/math.h"

namespace gib {

namespace {

const ReferenceQuality* reference_of_scene(const std::vector<ReferenceQuality>& references, const std::string& scene) {
    const auto found = std::ranges::find(references, scene, &ReferenceQuality::scene);
    return found == references.end() ? nullptr : &*found;
}

}  // namespace

bool is_target_resolved(std::size_t target, double noise_floor) { return sqr(target_errors[target]) > noise_floor; }

double Analysis::noise_floor(const std::string& scene, Layer layer) const {
    const ReferenceQuality* quality = reference_of_scene(references, scene);
    if (!quality) return 0;
    const auto found = quality->noise_floors.find(layer);
    return found == quality->noise_floors.end() ? 0 : found->second;
}

Components Analysis::unjudged(const std::string& scene) const {
    const ReferenceQuality* quality = reference_of_scene(references, scene);
    return quality ? quality->unjudged : Components();
}

const std::string& Analysis::label_of(const std::string& method) const {
    const auto found = labels.find(method);
    return found == labels.end() ? method : found->second;
}

const TableRow* Analysis::row(const std::string& scene, const std::string& method, Layer layer) const {
    for (const TableRow& row : rows)
        if (row.layer == layer && row.method == method && row.scene == scene) return &row;
    return nullptr;
}

}  // namespace gib
