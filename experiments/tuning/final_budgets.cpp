#include "experiments/tuning/final_budgets.h"

#include <algorithm>
#include <numeric>

namespace gib {

std::vector<double> shared_seconds(const std::vector<double>& wanted, double seconds, double besides) {
    constexpr double least = 0.01;  // [s]; one pass always completes
    std::vector<std::size_t> order(wanted.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return wanted[a] < wanted[b]; });
    std::vector<double> shares(wanted.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const double even = seconds / static_cast<double>(order.size() - i) - besides;
        shares[order[i]] = std::max(least, std::min(wanted[order[i]], even));
        seconds -= shares[order[i]] + besides;
    }
    return shares;
}

std::vector<double> promising_seconds(const std::vector<double>& wanted, const std::vector<double>& needed,
                                      double seconds, double besides) {
    constexpr double most_for_one = 0.8;
    const auto even = shared_seconds(wanted, seconds, besides);
    for (std::size_t i = 0; i < even.size(); ++i)
        if (even[i] >= needed[i]) return even;
    const auto first = std::min_element(needed.begin(), needed.end());
    const double most = most_for_one * (seconds - besides * static_cast<double>(wanted.size()));
    if (first == needed.end() || !(most >= *first)) return even;
    const auto promising = first - needed.begin();
    const double own = std::clamp(wanted[static_cast<std::size_t>(promising)], *first, most);
    std::vector<double> others = wanted;
    others.erase(others.begin() + promising);
    std::vector<double> shares = shared_seconds(others, seconds - own - besides, besides);
    shares.insert(shares.begin() + promising, own);
    return shares;
}

}  // namespace gib
