#include "methods/parts/gathering/cached_gather.h"

#include "common/core/parallel.h"
#include "methods/method.h"
#include "methods/parts/transport/pixel_samples.h"

#include <algorithm>
#include <atomic>
#include <numeric>

namespace gib {

namespace {

/// Passes multiply the reach of records by this factor, compared with the overture (Radiance's name for filling the
/// cache ahead of rendering).
constexpr float slack = IrradianceCache::most_slack;
/// Number of records made in parallel. They do not serve each other, so some of them turn out to be unnecessary.
constexpr std::size_t records_at_once = 32;
constexpr std::size_t points_per_block = 256;
constexpr float least_spacing = 1.5f, greatest_spacing = 40.f;  // of records [pixels]

/// The ray through the pixel `dx` pixels beside the middle of the image.
Ray middle_ray(const Sensor& sensor, int dx) {
    return sensor.generate_ray((sensor.width() - 1) / 2 + dx, sensor.height() / 2, Vec2(0.5f, 0.5f));
}

}  // namespace

Parameter accuracy_parameter() {
    return tuned(number_parameter("accuracy", "0.15", "", 0.001, 1,
                                  "irradiance cache: the largest estimated relative error with which a record is used"),
                 {0.05, 0.6});
}

/// Collects the points of eye paths. Points that the cache does not serve are candidates for records.
class CachedGather::GridVisitor {
public:
    static constexpr bool wants_emission = false;
    static constexpr int splits = 0;

    GridVisitor(const CachedGather& gather, std::size_t pixel, GridRow& row)
        : gather_(gather), pixel_(pixel), row_(row) {}

    void diffuse(const EyeVertex& vertex, const SurfaceHit& hit, const VertexNumbers&) {
        const auto surface = gather_.cached_surface(vertex, hit);
        if (!surface) return;
        const float cosine = std::max(surface->normal.dot(vertex.wo), least_cosine);
        row_.seen.push_back({pixel_, hit.p, surface->normal, gather_.pixel_width_at(vertex.length) / cosine});
        if (!gather_.cache_.covers(hit.p, surface->normal))
            row_.candidates.push_back(gather_.place_at(vertex, hit, *surface));
    }
    void emitted(const Color&) {}  // called only if not finite: no record can be made there
    void scattered(const EyeVertex&, const Vec3&) {}

private:
    /// Pixels whose surface is seen at a smaller angle than this count as if it were seen at this one.
    static constexpr float least_cosine = 0.05f;

    const CachedGather& gather_;
    std::size_t pixel_;
    GridRow& row_;
};

CachedGather::CachedGather(const Scene& scene, const FinalGather& gather, float accuracy)
    : scene_(scene),
      gather_(gather),
      pixel_(middle_ray(scene.sensor(), 0)),
      next_pixel_(middle_ray(scene.sensor(), 1)),
      cache_(scene.bounds(), accuracy),
      missing_(pixel_blocks(scene.sensor())) {}

float CachedGather::pixel_width_at(float distance) const {
    return ((next_pixel_.o + distance * next_pixel_.d) - (pixel_.o + distance * pixel_.d)).norm();
}

RecordSpacing CachedGather::spacing_at(float distance) const {
    const float width = pixel_width_at(distance);
    return {least_spacing * width, greatest_spacing * width};
}

RecordPlace CachedGather::place_at(const EyeVertex& vertex, const SurfaceHit& hit, const CachedSurface& surface) const {
    return {.point = hit,
            .normal = surface.normal,
            .spacing = spacing_at(vertex.length),
            .sampler = vertex.walk.sampler,
            .vertex = vertex.walk.at.vertex};
}

std::optional<CachedGather::CachedSurface> CachedGather::cached_surface(const EyeVertex& vertex,
                                                                        const SurfaceHit& hit) const {
    const float cosine = hit.shading.to_local(vertex.wo).z();
    const auto reflectance = hit.bsdf->ideal_diffuse_reflectance(cosine);
    if (!reflectance) return std::nullopt;
    const GatheredLight& light = gather_.light();
    const auto share = light.lengths.share(vertex.edges_left - 1, light.longest_photon_path());
    if (!share) return std::nullopt;
    return CachedSurface{cosine > 0.f ? hit.ns : Vec3(-hit.ns), *reflectance * (*share * inv_pi)};
}

std::optional<Color> CachedGather::reflected_radiance(const EyeVertex& vertex, const SurfaceHit& hit,
                                                      std::size_t pixel) {
    const auto surface = cached_surface(vertex, hit);
    if (!surface) return std::nullopt;
    auto irradiance = cache_.interpolate(hit.p, surface->normal, slack);
    if (!irradiance) {
        const RecordPlace place = place_at(vertex, hit, *surface);
        const IrradianceRecord record = gather_.record_at(vertex.walk.rays, place);
        irradiance = record.irradiance;
        // If it is not finite, only this sample suffers, and the film counts it.
        if (record.is_finite()) missing_[pixel / pixels_per_block].push_back({record, place.spacing});
    }
    return Color(surface->radiance_per_irradiance * *irradiance);
}

void CachedGather::end_pass() {
    for (std::vector<Missing>& of_block : missing_) {
        for (const Missing& m : of_block)
            if (!cache_.covers(m.record.p, m.record.n)) cache_.insert(m.record, m.spacing);
        of_block.clear();
    }
}

std::uint64_t CachedGather::add_records(const std::vector<RecordPlace>& candidates) {
    std::atomic<std::uint64_t> traced = 0;
    // The order is scattered, so that records made in parallel are rarely close to each other.
    std::vector<std::size_t> order(candidates.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [](std::size_t a, std::size_t b) { return mix64(a) < mix64(b); });
    for (std::size_t next = 0; next < order.size();) {
        std::vector<const RecordPlace*> chosen;
        for (; next < order.size() && chosen.size() < records_at_once; ++next) {
            const RecordPlace& place = candidates[order[next]];
            if (!cache_.covers(place.point.p, place.normal)) chosen.push_back(&place);
        }
        std::vector<IrradianceRecord> records(chosen.size());
        parallel_blocks(chosen.size(), 1, [&](std::size_t begin, std::size_t end, std::size_t) {
            RayQueries rays(scene_);
            for (std::size_t i = begin; i < end; ++i)
                records[i] = gather_.record_at(rays, *chosen[i]);
            traced += rays.count();
        });
        for (std::size_t i = 0; i < records.size(); ++i)
            if (records[i].is_finite() && !cache_.covers(records[i].p, records[i].n))
                cache_.insert(records[i], chosen[i]->spacing);
    }
    return traced;
}

CachedGather::GridRow CachedGather::look_at_row(const RefinedGrid& grid, std::size_t y, const WalkSettings& settings,
                                                std::uint64_t seed) const {
    GridRow row;
    const Sensor& sensor = scene_.sensor();
    RayQueries rays(scene_);
    std::vector<std::size_t> columns;
    for (std::size_t x = 0; x < grid.width(); x += grid.step())
        if (grid.looks_at(x, y)) columns.push_back(x);
    const auto pixel_of = [&](std::size_t i) { return y * grid.width() + columns[i]; };
    const auto sampler_of = [&](std::size_t i) { return Sampler(PointSet::sobol, seed, pixel_of(i), 0); };
    const auto ray_of = [&](std::size_t i) {
        return sensor.sample_ray(static_cast<int>(columns[i]), static_cast<int>(y), sampler_of(i));
    };
    for_each_camera_ray(rays, columns.size(), ray_of, [&](std::size_t i, const TracedRay& eye) {
        const Sampler sampler = sampler_of(i);
        GridVisitor visitor(*this, pixel_of(i), row);
        follow_specular_path(rays, sampler, eye, nullptr, settings, visitor);
    });
    if (grid.step() == 1) row.seen = {};  // no finer grid follows, and there may be as many points as pixels
    row.rays = rays.count();
    return row;
}

std::uint64_t CachedGather::overture(const WalkSettings& settings, std::uint64_t seed, StageProgress* progress) {
    RefinedGrid grid(static_cast<std::size_t>(scene_.sensor().width()),
                     static_cast<std::size_t>(scene_.sensor().height()));
    std::vector<SeenPoint> seen;
    std::uint64_t traced = 0, done = 0;
    do {
        std::vector<GridRow> rows((grid.height() - 1) / grid.step() + 1);
        parallel_blocks(rows.size(), 1, [&](std::size_t begin, std::size_t, std::size_t) {
            rows[begin] = look_at_row(grid, begin * grid.step(), settings, seed);
        });
        for (const GridRow& row : rows)
            traced += row.rays;
        traced += add_records(joined(rows, &GridRow::candidates));
        const auto of_rows = joined(rows, &GridRow::seen);
        seen.insert(seen.end(), of_rows.begin(), of_rows.end());
        if (grid.next_leaves_out()) settle(grid, seen);
        const std::uint64_t pixels = grid.width() * grid.height() / (grid.step() * grid.step());
        if (progress) progress->add(pixels - done);
        done = pixels;
    } while (grid.refine());
    return traced;
}

void CachedGather::settle(RefinedGrid& grid, const std::vector<SeenPoint>& seen) const {
    // The pixels between four of the grid are at most this many steps away from the nearest one.
    constexpr float half_diagonal = 0.71f;
    const float around = half_diagonal * static_cast<float>(grid.step());
    std::vector<char> is_served(seen.size());
    parallel_blocks(seen.size(), points_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i)
            is_served[i] = cache_.covers_around(seen[i].p, seen[i].normal, around * seen[i].pixel_width, slack) ? 1 : 0;
    });
    for (const SeenPoint& point : seen)
        grid.settle(point.pixel, true);
    for (std::size_t i = 0; i < seen.size(); ++i)
        if (!is_served[i]) grid.settle(seen[i].pixel, false);
}

}  // namespace gib
