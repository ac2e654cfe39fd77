#pragma once
// In builds with the CMake option GIB_FLOAT_TRAPS, floating-point exceptions end the program where they happen.

#if GIB_FLOAT_TRAPS
#include <cfenv>
#endif

namespace gib {

inline constexpr bool float_traps_built = GIB_FLOAT_TRAPS;

/// From this call on, invalid operations (0 / 0, infinity - infinity, the square root of -1, NaN converted to an
/// integer) and divisions by zero raise SIGFPE in this thread and in threads that it starts.
inline void trap_floating_point_errors() {
#if GIB_FLOAT_TRAPS
    ::feenableexcept(FE_INVALID | FE_DIVBYZERO);
#endif
}

/// While an object of this class lives, floating-point exceptions raise no signal in its thread. It is used around
/// libraries that compute in vector lanes whose results they ignore, and where values that are not finite are passed
/// on. With `paused` false it changes nothing.
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
    explicit FloatTrapsPaused(bool = true) {}  // not defaulted: an unused variable of a trivial type is warned about
#endif
};

/// While an object of this class lives, floating-point exceptions raise the signal again. It is used in functions of
/// ours that are called by such a library.
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
