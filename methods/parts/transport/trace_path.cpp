#include "methods/parts/transport/trace_path.h"

#include "methods/parts/transport/path_tracer.h"

namespace gib {

PixelSample trace_path(RayQueries& rays, const TracedRay& eye, const Sampler& sampler, const PathSettings& settings) {
    BsdfDirections directions;
    return trace_path_in(directions, rays, eye, sampler, settings.max_edges, settings.light_sampling);
}

}  // namespace gib
