#pragma once
// The camera's view of a radiosity solution, by samples of the pixels.

#include "common/images/film.h"
#include "methods/radiosity/model.h"

namespace gib {

struct RadiosityViewSettings {
    int max_edges;
    bool samples_lights;
    int gather;  ///< final gather rays per sample; 0: interpolation
};

/// One sample of a pixel along the camera's ray `eye`. `model` is null if there is no indirect light to show.
PixelSample sample_radiosity(RayQueries& rays, const TracedRay& eye, const Sampler& sampler,
                             const RadiosityModel* model, const RadiosityViewSettings& settings);

}  // namespace gib
