#pragma once
// A surface whose reflected radiance is a measure of irradiance.

#include "common/materials/bsdf.h"

namespace gib {

/// A material that reflects all light diffusely on both sides: the radiance that it reflects is irradiance / pi.
inline const Bsdf& white_bsdf() {
    static const Bsdf bsdf(Diffuse{Color::Ones()}, Diffuse{Color::Ones()});
    return bsdf;
}

}  // namespace gib
