#pragma once
// Floating-point exceptions that end the program where they happen, in builds with the CMake option GIB_FLOAT_TRAPS.

#if GIB_FLOAT_TRAPS
#include <cfenv>
#endif

namespace gib {

inline constexpr bool float_traps_built = GIB_FLOAT_TRAPS;

/// From here on, invalid operations (0 / 0, infinity - infinity, the root of -1, NaN to an integer) and divisions by
/// zero raise SIGFPE in this thread and in those that it starts.
inline void trap_floating_point_errors() {
#if GIB_FLOAT_TRAPS
    ::feenableexcept(FE_INVALID | FE_DIVBYZERO);
#endif
}

/// While it lives, they do not: around libraries that compute in lanes that they do not use, and where values that are
/// not finite are given and passed on. With `paused` false it changes nothing.
class FloatTrapsPaused {
public:
#if GIB_FLOAT_TRAPS
    explicit FloatTrapsPaused(bool paused = true)
        : before_(paused ? ::fedisableexcept(FE_ALL_EXCEPT) : ::fegetexcept()) {}
    ~FloatTrapsPaused() {
        std::feclearexcept(FE_ALL_EXCEPT);
        ::feenableexcept(before_);
    }
    FloatTrapsPaused(const FloatTrapsPaused&) = delete;
    FloatTrapsPaused& operator=(const FloatTrapsPaused&) = delete;

private:
    int before_;
#else
    explicit FloatTrapsPaused(bool = true) {}  // not trivial: an unused variable would be warned about
#endif
};

/// While it lives, they do again: in our own functions that such a library calls.
class FloatTrapsResumed {
public:
#if GIB_FLOAT_TRAPS
    FloatTrapsResumed() : before_(::fegetexcept()) {
        std::feclearexcept(FE_ALL_EXCEPT);
        trap_floating_point_errors();
    }
    ~FloatTrapsResumed() {
        ::fedisableexcept(FE_ALL_EXCEPT);
        ::feenableexcept(before_);
    }
    FloatTrapsResumed(const FloatTrapsResumed&) = delete;
    FloatTrapsResumed& operator=(const FloatTrapsResumed&) = delete;

private:
    int before_;
#else
    FloatTrapsResumed() {}
#endif
};

}  // namespace gib
