#include "experiments/tuning/final_budgets.h"

#include <algorithm>
#include <numeric>

namespace gib {

std::vector<double> shared_seconds(const std::vector<double>& wanted, double seconds, double besides) {
    constexpr double least = 0.01;  // [s]; one pass always completes
    std::vector<std::size_t> order(wanted.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](auto a, auto b) { return wanted[a] < wanted[b]; });
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
    constexpr std::size_t promising = 2;
    const auto even = shared_seconds(wanted, seconds, besides);
    std::size_t reached = 0;  // by even shares
    std::vector<std::size_t> order(wanted.size()), others;
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (const std::size_t i : order)
        reached += even[i] >= needed[i] ? 1 : 0;
    std::ranges::stable_sort(order, [&](auto a, auto b) { return needed[a] < needed[b]; });
    std::vector<double> shares(wanted.size()), of_others;
    for (std::size_t n = 0; n < order.size(); ++n) {
        const std::size_t i = order[n];
        const double most = most_for_one * (seconds - besides * static_cast<double>(order.size() - n));
        if (n - others.size() < promising && needed[i] <= most) {
            shares[i] = std::clamp(wanted[i], needed[i], most);
            seconds -= shares[i] + besides;
        } else {
            others.push_back(i);
            of_others.push_back(wanted[i]);
        }
    }
    if (order.size() - others.size() <= reached) return even;
    const auto rest = shared_seconds(of_others, seconds, besides);
    for (std::size_t n = 0; n < others.size(); ++n)
        shares[others[n]] = rest[n];
    return shares;
}

}  // namespace gib
