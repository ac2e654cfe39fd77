#include "methods/parts/gathering/final_gather.h"

#include "methods/parts/transport/scattered_ray.h"

namespace gib {

namespace {

/// Random dimensions of a gather ray's direction and lobe. For an eye path these dimensions choose the place in the
/// pixel and on the lens, which a gather ray does not have.
constexpr std::uint32_t gather_direction = dimension::film, gather_lobe = dimension::lens;
/// Random dimension that places a record's ray in its stratum. It lies beyond the dimensions of the Sobol' points, so
/// that strata are independent.
constexpr std::uint32_t in_stratum = dimension::at_vertex(1 << 16, 2);

/// Tags that give the gather rays and the records' rays from one vertex different random numbers.
constexpr std::uint64_t gather_tag(int vertex) { return 2 * static_cast<std::uint64_t>(vertex); }
constexpr std::uint64_t record_tag(int vertex) { return 2 * static_cast<std::uint64_t>(vertex) + 1; }

}  // namespace

Color FinalGather::reflected_radiance(const SpecularWalk& walk, const SurfaceHit& hit, const Vec3& wo,
                                      DensityEstimator::Neighbours& neighbours) const {
    RayQueries& rays = walk.rays();
    const Vec3 wo_local = hit.shading.to_local(wo);
    const auto n = static_cast<std::uint32_t>(rays_);
    Colord sum = Colord::Zero();
    for (std::uint32_t i = 0; i < n; ++i) {
        const Sampler u = walk.sampler().split(i, n, gather_tag(walk.vertex()));
        const auto next = sample_scattering(hit, wo_local, u.get_2d(gather_lobe), u.get_2d(gather_direction),
                                            Transport::radiance, Lobes::diffuse);
        if (!next) continue;
        TracedRay ray{hit.spawn_ray(next->wi)};
        rays.trace(ray);
        const Color arriving = light_.arriving(rays, ray, u, walk.edges_left(), neighbours);
        sum += (next->weight * arriving).cast<double>();
    }
    return (sum / n).cast<float>();
}

IrradianceRecord FinalGather::record_at(RayQueries& rays, const RecordPlace& place,
                                        DensityEstimator::Neighbours& neighbours) const {
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
        sample = {light_.arriving(rays, ray, u, light_.max_edges - 1, neighbours), ray.found ? ray.found->t : infinity};
    }
    return irradiance_record(place.point.p, frame, strata_, samples);
}

}  // namespace gib
