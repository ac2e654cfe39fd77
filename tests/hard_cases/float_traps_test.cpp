// Floating-point exceptions end the program, in whichever thread they happen. These
// tests need a build with GIB_FLOAT_TRAPS.

#include "common/core/float_traps.h"

#include "common/core/parallel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <functional>
#include <latch>
#include <limits>
#include <thread>

namespace gib::test::float_traps_test {
namespace {

/// Operands that are volatile, so that the compiler cannot evaluate the invalid operations beforehand.
volatile double zero = 0, one = 1;
volatile double result = 0;

void divide_zero_by_zero() { result = zero / zero; }
void divide_by_zero() { result = one / zero; }
void take_root_of_minus_one() { result = std::sqrt(-one); }
void subtract_infinities() {
    const double infinite = std::numeric_limits<double>::infinity() * one;
    result = infinite - infinite;
}

/// Runs `body` in a thread of the pool that is not the calling thread.
void in_worker(const std::function<void()>& body) {
    with_threads(2, [&] {
        std::latch both_run(2);
        const auto caller = std::this_thread::get_id();
        parallel_blocks(2, 1, [&](std::size_t, std::size_t, std::size_t) {
            both_run.arrive_and_wait();
            if (std::this_thread::get_id() != caller) body();
        });
    });
}

/// Expects `body` to die by SIGFPE. The default handler is restored, because sanitizers would catch the signal and
/// end the program in a way of their own.
void expect_sigfpe(const std::function<void()>& body) {
    EXPECT_EXIT(
        {
            std::signal(SIGFPE, SIG_DFL);
            body();
            std::exit(0);
        },
        testing::KilledBySignal(SIGFPE), "");
}

class FloatTraps : public ::testing::Test {
protected:
    // The child process starts anew, because threads do not survive a fork.
    FloatTraps() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

TEST_F(FloatTraps, EndTheCallingThread) {
    expect_sigfpe(divide_zero_by_zero);
    expect_sigfpe(divide_by_zero);
    expect_sigfpe(take_root_of_minus_one);
    expect_sigfpe(subtract_infinities);
}

TEST_F(FloatTraps, EndAWorker) {
    expect_sigfpe([] { in_worker(divide_zero_by_zero); });
    expect_sigfpe([] { in_worker(divide_by_zero); });
}

TEST_F(FloatTraps, EndAWorkerThatWasBornWhileTheyWerePaused) {
    expect_sigfpe([] {
        {
            const FloatTrapsPaused paused;
            in_worker(divide_by_zero);
        }
        in_worker(divide_by_zero);
    });
}

TEST_F(FloatTraps, LetPassWhatIsPausedAndWhatIsExact) {
    EXPECT_EXIT(
        {
            std::signal(SIGFPE, SIG_DFL);
            {
                const FloatTrapsPaused paused;
                divide_zero_by_zero();
                in_worker(divide_by_zero);
            }
            result = zero / one;
            // Overflow, underflow and rounding are no mistakes.
            result = std::numeric_limits<double>::max() * (one + one);
            result = std::numeric_limits<double>::min() * 0.1 * one;
            result = one / 3;
            std::exit(0);
        },
        testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace gib::test::float_traps_test
