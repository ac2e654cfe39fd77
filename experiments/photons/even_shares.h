#pragma once
// Divides a limited number of places among groups.

#include <cstddef>
#include <vector>

namespace gib {

/// The places of each group if there are `places` in all: as many for each group as for every other, but no more than
/// its `counts`; what small groups leave goes to the others. Groups at the end get what does not divide evenly.
std::vector<std::size_t> even_shares(const std::vector<std::size_t>& counts, std::size_t places);

/// Whether item i of `count` is among `shown` items taken at even steps. The product of both numbers is below 2^64.
inline bool is_at_step(std::size_t i, std::size_t count, std::size_t shown) {
    return (i + 1) * shown / count > i * shown / count;
}

}  // namespace gib
