#pragma once
// Tells the thread sanitizer in which order in time oneTBB runs the parts of a parallel loop. The sanitizer sees
// only code that was compiled with it, which oneTBB was not. In other builds nothing is done here.
// common/CMakeLists.txt sets GIB_THREAD_SANITIZER.

#ifdef GIB_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace gib {

/// The order of a parallel loop: everything that its caller did before the loop happens before each block, and each
/// block happens before everything that the caller does afterwards. Blocks have no order among each other.
class LoopOrder {
public:
    LoopOrder() { pass(start_); }
    ~LoopOrder() { await(end_); }
    LoopOrder(const LoopOrder&) = delete;
    LoopOrder& operator=(const LoopOrder&) = delete;

    /// An object of this class lives from the beginning to the end of one block of the loop.
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
