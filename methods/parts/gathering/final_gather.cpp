#include "methods/parts/gathering/final_gather.h"

namespace gib {

namespace {

/// Random dimension that places a record's ray in its stratum. It lies beyond the dimensions of the Sobol' points, so
/// that strata are independent.
constexpr std::uint32_t in_stratum = dimension::at_vertex(1 << 16, 2);

/// Tags that give the gather rays and the records' rays from one vertex different random numbers.
constexpr std::uint64_t gather_tag(int vertex) { return 2 * static_cast<std::uint64_t>(vertex); }
constexpr std::uint64_t record_tag(int vertex) { return 2 * static_cast<std::uint64_t>(vertex) + 1; }

}  // namespace

Color FinalGather::reflected_radiance(const EyeVertex& vertex, const SurfaceHit& hit) const {
    return gather_by_rays(vertex, hit, rays_, gather_tag(vertex.walk.at.vertex),
                          [&](const TracedRay& ray, const Sampler& u) {
                              return light_.arriving(vertex.walk.rays, ray, u, vertex.edges_left);
                          });
}

IrradianceRecord FinalGather::record_at(RayQueries& rays, const RecordPlace& place) const {
    const Frame frame(place.normal);
    std::vector<HemisphereSample> samples(static_cast<std::size_t>(strata_.count()));
    for (int i = 0; i < strata_.count(); ++i) {
        const Sampler u = place.sampler.split(static_cast<std::uint32_t>(i),
                                              static_cast<std::uint32_t>(strata_.count()), record_tag(place.vertex));
        const Vec3 w = frame.to_world(strata_.direction_local(i, u.get_2d(in_stratum)));
        HemisphereSample& sample = samples[static_cast<std::size_t>(i)];
        sample = {Color::Zero(), infinity};
        if (place.point.ng.dot(w) * place.point.ng.dot(place.normal) < 0.f) continue;  // leads into the surface
        TracedRay ray{Ray{offset_origin(place.point, w), w}};
        rays.trace(ray);
        sample = {light_.arriving(rays, ray, u, light_.max_edges - 1), ray.found ? ray.found->t : infinity};
    }
    return irradiance_record(place.point.p, frame, strata_, samples);
}

}  // namespace gib
