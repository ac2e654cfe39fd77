#include "experiments/photons/even_shares.h"

#include <algorithm>
#include <numeric>

namespace gib {

std::vector<std::size_t> even_shares(const std::vector<std::size_t>& counts, std::size_t places) {
    std::vector<std::size_t> order(counts.size()), shares(counts.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return counts[a] < counts[b]; });
    std::size_t groups = counts.size();
    for (const std::size_t group : order) {
        shares[group] = std::min(counts[group], places / groups);
        places -= shares[group];
        --groups;
    }
    return shares;
}

}  // namespace gib
