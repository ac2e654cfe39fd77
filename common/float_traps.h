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

/// While it lives, they do not: around libraries that compute in lanes that they do not use.
class FloatTrapsPaused {
public:
#if GIB_FLOAT_TRAPS
    FloatTrapsPaused() : before_(::fedisableexcept(FE_ALL_EXCEPT)) {}
    ~FloatTrapsPaused() {
        std::feclearexcept(FE_ALL_EXCEPT);
        ::feenableexcept(before_);
    }
    FloatTrapsPaused(const FloatTrapsPaused&) = delete;
    FloatTrapsPaused& operator=(const FloatTrapsPaused&) = delete;

private:
    int before_;
#else
    FloatTrapsPaused() {}  // not trivial: an unused variable would be warned about
#endif
};

}  // namespace gib
