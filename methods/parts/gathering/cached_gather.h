#pragma once
// Indirect light on ideal diffuse surfaces through an irradiance cache. methods/parts/gathering/irradiance_cache.h says how records are
// interpolated, methods/parts/gathering/final_gather.h how they are made; this decides where.
//
// An overture fills the cache before the first pass: pixels on a coarse grid first, then on ever finer ones, each where
// the records so far do not serve what it sees. Candidates of a grid are taken in a scattered order, a few at a time,
// which are tested against all records before them, computed at once and added in order: no result depends on the
// number of threads. The last grid is that of the pixels, with the paths of the first pass. Passes interpolate with
// more slack than the overture asked for, and where there is still no record they make one, which the others see after
// the pass.

#include "methods/parameters.h"
#include "methods/parts/gathering/final_gather.h"

#include <mutex>

namespace gib {

class StageProgress;

enum class SpacingUnit { pixels, diagonals };
inline constexpr std::array<std::string_view, 2> spacing_unit_names = {"pixels", "diagonals"};

struct CacheSettings {
    float accuracy;
    SpacingUnit unit;
    double least, greatest;  ///< spacing of records, in this unit
};

/// accuracy, spacing, min_spacing and max_spacing.
std::vector<Parameter> cache_parameters();
/// Throws InputError where the least spacing is larger than the greatest.
CacheSettings cache_settings_of(const ParameterValues& values);

class CachedGather {
public:
    /// All must outlive this.
    CachedGather(const Scene& scene, const FinalGather& gather, const CacheSettings& settings);

    /// Fills the cache by the paths of the first pass. Returns the number of rays traced.
    std::uint64_t overture(const WalkSettings& walk, std::uint64_t seed, StageProgress* progress);

    /// What indirect light the ideal diffuse surface sends to the eye, at the vertex where `walk` is; empty: the
    /// surface is another, or paths are limited so that the records do not hold here.
    std::optional<Color> reflected_radiance(const SpecularWalk& walk, const SurfaceHit& hit, const Vec3& wo,
                                            DensityEstimator::Neighbours& neighbours);
    /// To be called when no thread samples: adds the records that were missing.
    void end_pass();

    const IrradianceCache& cache() const { return cache_; }

private:
    class CandidateVisitor;

    struct CachedSurface {
        Vec3 normal;                    ///< on the side that is seen
        Color radiance_per_irradiance;  ///< [1/sr]
    };
    /// Empty: it is not one that irradiance alone decides about, or a record would not hold here.
    std::optional<CachedSurface> cached_surface(const SpecularWalk& walk, const SurfaceHit& hit, const Vec3& wo) const;
    RecordSpacing spacing_at(float distance) const;
    /// Makes those records that are still missing, and adds them. Returns the number of rays traced.
    std::uint64_t add_records(const std::vector<RecordPlace>& candidates);

    const Scene& scene_;
    const FinalGather& gather_;
    CacheSettings settings_;
    Ray pixel_, next_pixel_;  ///< of neighbours in the middle of the image
    IrradianceCache cache_;

    struct Missing {
        IrradianceRecord record;
        RecordSpacing spacing;
    };
    std::mutex missing_mutex_;
    std::vector<Missing> missing_;
};

}  // namespace gib
