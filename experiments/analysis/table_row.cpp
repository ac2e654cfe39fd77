#include "experiments/analysis/table_row.h"

namespace gib {

double Analysis::noise_floor(const std::string& scene, const std::string& component) const {
    for (const auto& reference : references)
        if (reference.scene == scene)
            if (const auto found = reference.noise_floors.find(component); found != reference.noise_floors.end())
                return found->second;
    return 0;
}

}  // namespace gib
