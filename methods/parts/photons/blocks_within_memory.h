#pragma once
// A parallel loop whose blocks store results of unknown number, such as photons, and which stops early if memory
// cannot hold them: their number is extrapolated from the first blocks.

#include "common/core/memory_limit.h"
#include "common/core/parallel.h"

#include <algorithm>
#include <string>
#include <vector>

namespace gib {

/// Runs body(block, begin, end) over [0, count) with all threads; the body fills `block.*items`. After the first
/// blocks the memory of all of them is extrapolated, at `bytes_per_item` for each item. If it exceeds the memory that
/// is free, throws InputError without beginning the rest; `what` names the request in the message.
template <typename Block, typename Item, typename Body>
std::vector<Block> blocks_within_memory(std::size_t count, std::size_t block_size, std::vector<Item> Block::*items,
                                        double bytes_per_item, const std::string& what, const Body& body) {
    constexpr std::size_t first_part = std::size_t{1} << 17;
    const std::size_t block_count = count / block_size + (count % block_size > 0 ? 1 : 0);
    require_memory(static_cast<double>(block_count) * sizeof(Block), what);
    std::vector<Block> blocks(block_count);
    const std::size_t first_blocks = std::max<std::size_t>(1, first_part / block_size);
    const std::size_t begin_of_rest = std::min(count, first_blocks * block_size);
    parallel_blocks(begin_of_rest, block_size,
                    [&](std::size_t begin, std::size_t end, std::size_t block) { body(blocks[block], begin, end); });
    if (begin_of_rest == count) return blocks;

    double found = 0;
    for (const Block& block : blocks)
        found += static_cast<double>((block.*items).size());
    require_memory(found / static_cast<double>(begin_of_rest) * static_cast<double>(count) * bytes_per_item, what);
    parallel_blocks(count - begin_of_rest, block_size, [&](std::size_t begin, std::size_t end, std::size_t block) {
        body(blocks[first_blocks + block], begin_of_rest + begin, begin_of_rest + end);
    });
    return blocks;
}

}  // namespace gib
