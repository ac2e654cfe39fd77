// A library to be preloaded into a program: the program's wall clock jumps by years, forwards and back, each time
// that it is read. The steady clock stays the system's.

#include <dlfcn.h>
#include <sys/time.h>
#include <atomic>
#include <ctime>

namespace {

constexpr time_t year = 365 * 24 * 3600;

/// December 2000 or December 2069, by turns [s since 1970].
time_t jump() {
    static std::atomic<unsigned> reads = 0;
    const unsigned n = reads++;
    return n % 2 == 0 ? 31 * year + static_cast<time_t>(n) : 100 * year - static_cast<time_t>(n);
}

}  // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* now) noexcept {
    using Function = int (*)(clockid_t, timespec*);
    static const auto system = reinterpret_cast<Function>(dlsym(RTLD_NEXT, "clock_gettime"));
    const int result = system(clock, now);
    if (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE) now->tv_sec = jump();
    return result;
}

extern "C" time_t time(time_t* now) noexcept {
    const time_t t = jump();
    if (now) *now = t;
    return t;
}

extern "C" int gettimeofday(timeval* now, void*) noexcept {
    *now = {jump(), 0};
    return 0;
}
