#pragma once
// A number as the analysis hands it to the printers of CSV, Markdown, HTML and LaTeX: with its interval, its unit, and
// what is known of it. Printers write it; none of them reads a text again.

#include "experiments/metrics/statistics.h"

#include <limits>
#include <optional>

namespace gib {

enum class State {
    none,  ///< does not apply: an empty field
    measured,
    extrapolated,  ///< by the fitted law, with an interval
    at_least,      ///< a lower bound, by the fitted law
    below,         ///< an upper bound: the interval reaches 0
    some_seeds,    ///< reached by `value` of the `seeds`
    not_reached,   ///< by no seed, and without an estimate of the time
    never,         ///< the law's error floor, `value`, is above what was asked for
    unbiased,      ///< 0 by theory
    below_noise,   ///< below `value`, the reference's noise
    inconclusive,  ///< the seeds' scatter is too large
    no_image,      ///< the first image comes after `value` seconds
    no_verdict,    ///< the reference lacks this light or is contradicted in it
};

/// How a number is printed in words and tables. CSV files have the number itself.
enum class Unit {
    number,   ///< three digits
    percent,  ///< a share, in %
    root,     ///< a square, as its root in %
    whole,    ///< no decimals
    share,    ///< a share, in whole %
};

struct Field {
    State state = State::none;
    double value = std::numeric_limits<double>::quiet_NaN();
    std::optional<Interval> interval = std::nullopt;
    Unit unit = Unit::number;
    int seeds = 0;  ///< of State::some_seeds
    /// Not reached: why the time has no estimate; empty if the error has no law. Below the noise: a sentence that names
    /// what is below, if the value does not.
    const char* reason = "";

    bool is_measured() const { return state == State::measured; }
};

inline Field measured(const Estimate& e, Unit unit = Unit::number) {
    return {State::measured, e.value, e.interval, unit};
}
inline Field measured(double value, Unit unit = Unit::number) { return {State::measured, value, std::nullopt, unit}; }
/// A relative RMSE from its square. Below the reference's noise it is an upper bound: the end of its interval, but at
/// least
/// `noise_floor`; without an interval, the estimate plus `noise_floor`.
inline Field resolved(const Estimate& error2, double noise_floor) {
    if (!(noise_floor > 0 && error2.value <= noise_floor)) return measured(error2, Unit::root);
    const double end = error2.interval ? error2.interval->hi : std::max(error2.value, 0.0) + noise_floor;
    return {State::below_noise, std::max(end, noise_floor), std::nullopt, Unit::root};
}
/// An estimate of what cannot be negative: an upper bound where its interval reaches 0; inconclusive if the
/// whole interval is below 0.
inline Field positive(const Estimate& e, Unit unit = Unit::number) {
    if (e.interval && !(e.interval->hi > 0)) return {State::inconclusive};
    if (e.interval && !(e.interval->lo > 0)) return {State::below, e.interval->hi, std::nullopt, unit};
    return measured(e, unit);
}

}  // namespace gib
