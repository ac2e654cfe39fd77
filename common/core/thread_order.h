#pragma once
// What oneTBB and Embree order in time, told to the thread sanitizer, which sees only what was compiled with it;
// nothing in other builds. GIB_THREAD_SANITIZER: see common/CMakeLists.txt.

#ifdef GIB_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace gib {

/// The order of a parallel loop: all that its caller did before comes before each block, and each block before all that
/// the caller does afterwards. Blocks have no order among each other.
class LoopOrder {
public:
    LoopOrder() { pass(start_); }
    ~LoopOrder() { await(end_); }
    LoopOrder(const LoopOrder&) = delete;
    LoopOrder& operator=(const LoopOrder&) = delete;

    /// Lives as long as a block of the loop.
    class Block {
    public:
        explicit Block(LoopOrder& loop) : loop_(loop) { await(loop_.start_); }
        ~Block() { pass(loop_.end_); }
        Block(const Block&) = delete;
        Block& operator=(const Block&) = delete;

    private:
        LoopOrder& loop_;
    };

private:
#ifdef GIB_THREAD_SANITIZER
    static void pass(char& point) { __tsan_release(&point); }
    static void await(char& point) { __tsan_acquire(&point); }
#else
    static void pass(char&) {}
    static void await(char&) {}
#endif
    char start_ = 0, end_ = 0;
};

}  // namespace gib
