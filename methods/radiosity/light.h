#pragma once
// The light with which the solution starts: direct irradiance of the patches, and their reflectance.
//
// Goral et al. 1984 have patches that emit, E_i. Here lights of every kind are allowed: the emission of a patch is the
// direct light that it reflects, B1 = rho E_direct, and E_direct is sampled.

#include "methods/method.h"
#include "methods/radiosity/mesh.h"

namespace gib {

/// By node of a mesh; irradiance, reflectance and points are those of leaves.
struct PatchLight {
    std::vector<Colord> irradiance;   ///< direct irradiance [W/m^2]
    std::vector<Colord> reflectance;  ///< rho, the mean over the patch, in [0, 1]
    /// Radiosity of all nodes, with an estimate of the light from other patches, and its standard deviation over the
    /// leaves of a node; mean of the channels [W/m^2].
    std::vector<double> expected, spread;
    double mean_irradiance = 0;  ///< mean over all patches, including that estimate [W/m^2]
    /// By node: the area to which light gets, which takes the place of A: less than that of the polygon where surfaces
    /// touch or where something stands on it [scene units^2].
    std::vector<double> area;

    struct Point : SurfacePoint {
        float share = 1.f;  ///< of the area around the point, that to which light gets
    };
    /// The points of leaves, evenly distributed, `samples` for each. Direct light was sampled there, and rays that
    /// test visibility start and end there.
    std::vector<Point> points;
    struct Range {
        std::uint32_t first, count;
    };
    std::vector<Range> points_of;  ///< by node: the points of a leaf that are not covered; all if all are
    std::uint32_t samples = 0;

    /// A point of a node, chosen by the number u in [0, 1): evenly from the area to which light gets, or from the whole.
    const Point& open_point(const PatchMesh& mesh, std::uint32_t node, double u) const;
    const Point& any_point(const PatchMesh& mesh, std::uint32_t node, double u) const;
};

/// Direct irradiance and mean reflectance of all leaves. Irradiance is estimated for each patch by `samples` shadow
/// rays and as many rays sampled by the bsdf, combined by the power heuristic (Veach 1997, chapter 9); the mean
/// reflectance of textured patches is taken over as many points. Adds the rays traced to `rays`.
PatchLight patch_light(const PatchMesh& mesh, std::uint32_t samples, std::uint64_t seed, std::uint64_t& rays,
                       const StageTimes& stages);

}  // namespace gib
