#include "experiments/analysis/table_row.h"

#include "common/core/math.h"

namespace gib {

bool is_target_resolved(std::size_t target, double noise_floor) { return sqr(target_errors[target]) > noise_floor; }

double Analysis::noise_floor(const std::string& scene, const std::string& component) const {
    for (const auto& reference : references)
        if (reference.scene == scene)
            if (const auto found = reference.noise_floors.find(component); found != reference.noise_floors.end())
                return found->second;
    return 0;
}

std::string Analysis::unjudged(const std::string& scene) const {
    for (const auto& reference : references)
        if (reference.scene == scene) return reference.unjudged;
    return "";
}

}  // namespace gib
