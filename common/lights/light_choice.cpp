#include "common/lights/light_choice.h"

namespace gib {

DiscreteDistribution light_choice(const std::vector<Light>& lights) {
    constexpr double uniform_share = 0.1;
    std::vector<double> weights;
    double total = 0;
    std::size_t shining = 0;
    for (const auto& light : lights) {
        weights.push_back(power_of(light).mean());
        total += weights.back();
        if (weights.back() > 0) ++shining;
    }
    for (double& w : weights)
        if (w > 0) w = (1 - uniform_share) * w / total + uniform_share / static_cast<double>(shining);
    return DiscreteDistribution(weights);
}

}  // namespace gib
