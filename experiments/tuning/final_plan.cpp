#include "experiments/tuning/final_plan.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

constexpr double fair_times = 3, least_times = 1.5;  // of the shortest time
constexpr int fewest_seeds = 3;                      // that of the search and two fresh ones, which have an interval
constexpr double shortest_budget = 0.01;             // [s]; one pass always completes

}  // namespace

FinalPlan plan_finals(const FinalNeeds& needs) {
    const auto share = [&](std::size_t labels, int seeds) {
        return needs.left / (static_cast<double>(seeds) * static_cast<double>(labels)) - needs.besides;
    };
    if (!std::isfinite(needs.shortest)) {
        const double longest = std::max(share(needs.least, needs.seeds), shortest_budget);
        return {needs.least, longest};
    }
    std::size_t labels = needs.labels;
    while (labels > needs.least && share(labels, needs.seeds) < least_times * needs.shortest)
        --labels;
    const double fair =
        std::clamp(share(labels, needs.seeds), least_times * needs.shortest, fair_times * needs.shortest);
    return {labels, std::max(std::min(fair, share(labels, fewest_seeds)), shortest_budget)};
}

double longest_final(double seconds, std::size_t labels) {
    return seconds / (fewest_seeds * static_cast<double>(labels));
}

}  // namespace gib
