#include "experiments/analysis/table_row.h"

namespace gib {

double Analysis::resolved(const std::string& scene, const std::string& component) const {
    for (const auto& reference : references)
        if (reference.scene == scene)
            if (const auto found = reference.resolved.find(component); found != reference.resolved.end())
                return found->second;
    return 0;
}

}  // namespace gib
