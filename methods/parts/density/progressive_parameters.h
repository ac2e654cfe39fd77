#pragma once
// The parameters of methods whose radius shrinks from pass to pass.

#include "methods/parameters.h"

namespace gib {

inline Parameter alpha_parameter() {
    return number_parameter(
        "alpha", "0.67", "", 0.01, 0.99,
        "the variance of a mean over N passes falls as N^-alpha, the bias on surfaces as N^(alpha - 1)");
}

/// The radius of the first pass; `where` says of which look-ups, and `most` how many points `auto` asks for at most.
inline Parameter first_radius_parameter(std::string name, const std::string& where, const std::string& most) {
    Parameter parameter =
        number_parameter(std::move(name), "auto", "scene diagonals", 0x1p-40, 1,
                         "radius of the first pass " + where + "; auto: that which balances bias and variance, with " +
                             most + " in the mean look-up at most");
    parameter.choices = {"auto"};
    return parameter;
}

/// The radius given [scene diagonals]; 0 stands for auto.
inline double first_radius_of(const ParameterValues& values, std::string_view name) {
    return values.number_unless_word(name).value_or(0);
}

}  // namespace gib
