#pragma once
// Indirect light on ideal diffuse surfaces by final gathering with an irradiance cache. This file decides where
// records are made; methods/parts/gathering/final_gather.h makes them, and methods/parts/gathering/irradiance_cache.h
// interpolates between them.
//
// An overture (Radiance's name for filling the cache ahead of rendering) runs before the first pass. It goes through
// the pixels of a coarse grid, then of ever finer ones, and makes a record where the earlier records do not serve the
// surface that a pixel sees. The candidates of a grid are taken in a scattered order, a few at a time: these are
// tested against all earlier records, computed in parallel and added in order, so no result depends on the number of
// threads. The last grid is that of all pixels, with the paths of the first pass. Passes interpolate with more slack
// than the overture. Where they still find no record they make one, which serves other samples only after the pass.

#include "methods/parameters.h"
#include "methods/parts/gathering/final_gather.h"
#include "methods/parts/gathering/refined_grid.h"

namespace gib {

class StageProgress;

/// The parameter accuracy.
Parameter accuracy_parameter();

class CachedGather {
public:
    /// All arguments must outlive this.
    CachedGather(const Scene& scene, const FinalGather& gather, float accuracy);

    /// Fills the cache by paths of the first pass: those of a grid of pixels, which becomes finer where neighbouring
    /// pixels may not be served yet. Returns the number of rays traced.
    std::uint64_t overture(const WalkSettings& walk, std::uint64_t seed, StageProgress* progress);

    /// Indirect radiance [W/(sr m^2)] that an ideal diffuse surface sends back along the eye path that has reached
    /// `hit` through this pixel. Empty if the surface is of another kind, or if the limit on the length of paths
    /// makes records invalid here.
    std::optional<Color> reflected_radiance(const EyeVertex& vertex, const SurfaceHit& hit, std::size_t pixel);
    /// Adds the records that were missing in the pass. Call it while no thread samples.
    void end_pass();

    const IrradianceCache& cache() const { return cache_; }

private:
    class GridVisitor;
    /// A point that the path of a pixel of the grid has reached.
    struct SeenPoint {
        std::size_t pixel;
        Vec3 p, normal;
        float pixel_width;  ///< width of a pixel's image on the surface, along its longer side [scene units]
    };
    /// The finds of the paths of one row of the grid.
    struct GridRow {
        std::vector<RecordPlace> candidates;  ///< points that the cache does not serve
        std::vector<SeenPoint> seen;
        std::uint64_t rays = 0;
    };

    struct CachedSurface {
        Vec3 normal;                    ///< normal on the side that is seen
        Color radiance_per_irradiance;  ///< [1/sr]
    };
    /// Empty if irradiance alone does not determine the reflected radiance, or if a record would be invalid here.
    std::optional<CachedSurface> cached_surface(const EyeVertex& vertex, const SurfaceHit& hit) const;
    RecordPlace place_at(const EyeVertex& vertex, const SurfaceHit& hit, const CachedSurface& surface) const;
    /// The spacing of records on a surface at this distance from the eye [scene units].
    RecordSpacing spacing_at(float distance) const;
    /// The width of a pixel's image on a surface at this distance that faces the eye [scene units].
    float pixel_width_at(float distance) const;
    /// Follows the paths of the pixels of row y that the grid still has to look at.
    GridRow look_at_row(const RefinedGrid& grid, std::size_t y, const WalkSettings& settings, std::uint64_t seed) const;
    /// Settles those pixels whose points the cache serves together with what lies around them.
    void settle(RefinedGrid& grid, const std::vector<SeenPoint>& seen) const;
    /// Makes and adds records at those candidates that the cache does not serve. Returns the number of rays traced.
    std::uint64_t add_records(const std::vector<RecordPlace>& candidates);

    const Scene& scene_;
    const FinalGather& gather_;
    Ray pixel_, next_pixel_;  ///< rays of two neighbouring pixels in the middle of the image
    IrradianceCache cache_;

    struct Missing {
        IrradianceRecord record;
        RecordSpacing spacing;
    };
    std::vector<std::vector<Missing>> missing_;  ///< by block of pixels, each of which one thread samples
};

}  // namespace gib
