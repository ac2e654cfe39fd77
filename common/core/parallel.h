#pragma once
// Parallel loops on oneTBB. The number of threads never changes a result: work is cut into blocks of a fixed size,
// whose results the caller merges in block order.

#include <cstddef>
#include <functional>
#include <vector>

namespace gib {

/// Runs `body` and the parallel loops inside it on `threads` threads (0: one per processor). More threads than
/// processors are allowed and are real threads: the tests of determinism run five threads on two cores.
void with_threads(int threads, const std::function<void()>& body);

/// Calls body(begin, end, block) for [0, count) in blocks of `block_size`; each block is one task.
void parallel_blocks(std::size_t count, std::size_t block_size,
                     const std::function<void(std::size_t begin, std::size_t end, std::size_t block)>& body);

/// Runs both functions, possibly at the same time, and returns when both have ended.
void parallel_pair(const std::function<void()>& first, const std::function<void()>& second);

/// Joins the items of all blocks of a loop into one vector, in block order, so that the result does not depend on the
/// threads. The items of a block are freed once they are copied, so that memory never holds all items twice.
template <typename Block, typename Item>
std::vector<Item> joined(std::vector<Block>& blocks, std::vector<Item> Block::*items) {
    std::size_t count = 0;
    for (const Block& block : blocks)
        count += (block.*items).size();
    std::vector<Item> all;
    all.reserve(count);
    for (Block& block : blocks) {
        all.insert(all.end(), (block.*items).begin(), (block.*items).end());
        std::vector<Item>().swap(block.*items);
    }
    return all;
}

}  // namespace gib
