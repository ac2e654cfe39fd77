#pragma once
// The parameter `sampler`: the random numbers of a method's paths.

#include "common/sampling/sampler.h"
#include "methods/parameters.h"

namespace gib {

inline Parameter point_set_parameter() {
    return choice_parameter("sampler", {"sobol", "independent"},
                            "random numbers of a pixel's samples: Owen-scrambled Sobol' points, or independent ones");
}

inline PointSet point_set_of(const ParameterValues& values) {
    return values.choice("sampler") == "sobol" ? PointSet::sobol : PointSet::independent;
}

}  // namespace gib
