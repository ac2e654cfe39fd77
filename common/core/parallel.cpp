#include "common/core/parallel.h"

#include "common/core/thread_order.h"

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
    // The control lets oneTBB's pool exceed the number of processors; the arena limits this body to n threads.
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(n));
    tbb::task_arena arena(n);
    LoopOrder order;
    arena.execute([&] {
        const LoopOrder::Block block(order);
        body();
    });
}

void parallel_blocks(std::size_t count, std::size_t block_size,
                     const std::function<void(std::size_t, std::size_t, std::size_t)>& body) {
    const std::size_t blocks = (count + block_size - 1) / block_size;
    LoopOrder order;
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, blocks, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t b = range.begin(); b != range.end(); ++b) {
                const LoopOrder::Block block(order);
                body(b * block_size, std::min(count, (b + 1) * block_size), b);
            }
        },
        tbb::simple_partitioner());
}

void parallel_pair(const std::function<void()>& first, const std::function<void()>& second) {
    LoopOrder order;
    const auto run = [&](const std::function<void()>& body) {
        const LoopOrder::Block block(order);
        body();
    };
    tbb::parallel_invoke([&] { run(first); }, [&] { run(second); });
}

}  // namespace gib
