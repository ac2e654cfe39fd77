#include "common/parallel.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <thread>

namespace gib {

void with_threads(int threads, const std::function<void()>& body) {
    const int n = threads > 0 ? threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    // The control lets the pool grow past the processors; the arena holds this body to n of the pool's threads.
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(n));
    tbb::task_arena arena(n);
    arena.execute(body);
}

void parallel_blocks(std::size_t count, std::size_t block_size,
                     const std::function<void(std::size_t, std::size_t, std::size_t)>& body) {
    const std::size_t blocks = (count + block_size - 1) / block_size;
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, blocks, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t b = range.begin(); b != range.end(); ++b)
                body(b * block_size, std::min(count, (b + 1) * block_size), b);
        },
        tbb::simple_partitioner());
}

void parallel_pair(const std::function<void()>& first, const std::function<void()>& second) {
    tbb::parallel_invoke(first, second);
}

}  // namespace gib
