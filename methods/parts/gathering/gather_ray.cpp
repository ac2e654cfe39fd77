#include "methods/parts/gathering/gather_ray.h"

#include "methods/parts/density/surface_disc.h"
#include "methods/parts/transport/specular_walk.h"

#include <numeric>

namespace gib {

namespace {

/// The largest share of the photons' power that a limit on the length of paths may cut off where
/// estimates are rescaled.
constexpr double most_cut_off = 0.05;
/// Random dimension that places the rays that probe the disc where a gather ray ends.
constexpr std::uint32_t gathered_disc = dimension::at_vertex(1 << 16, 3);

/// Sums the radiance that diffuse surfaces send along the ray.
class GatherVisitor {
public:
    static constexpr bool wants_emission = false;
    static constexpr int splits = 0;

    explicit GatherVisitor(const GatheredLight& light) : light_(light) {}

    const Color& radiance() const { return radiance_; }

    void diffuse(const EyeVertex& vertex, const SurfaceHit& hit, const VertexNumbers&) {
        radiance_ += vertex.throughput() * reflected(vertex, hit);
    }
    void emitted(const Color& not_finite) { radiance_ += not_finite; }
    void scattered(const EyeVertex&, const Vec3&) {}  // there is no final gathering in scenes with media

private:
    Color reflected(const EyeVertex& vertex, const SurfaceHit& hit) const {
        RayQueries& rays = vertex.walk.rays;
        if (light_.source == GatherSource::irradiance) {
            const auto reflectance = hit.bsdf->ideal_diffuse_reflectance(hit.shading.to_local(vertex.wo).z());
            const auto share = light_.lengths.share(vertex.edges_left, light_.longest_photon_path());
            if (reflectance && share) {
                const auto E = light_.irradiance.at(rays, hit, normal_towards(hit, vertex.wo), vertex.length,
                                                    light_.estimator.max_radius);
                if (E) return *reflectance * *E * (*share * inv_pi);
            }
        }
        return light_.estimator
            .reflected_radiance(light_.map, rays, hit, vertex.wo, EyePath{vertex.edges_left}, vertex.walk.sampler,
                                gathered_disc)
            .between_surfaces;
    }

    const GatheredLight& light_;
    Color radiance_ = Color::Zero();
};

}  // namespace

PhotonLengths::PhotonLengths(const std::vector<Photon>& photons) {
    for (const Photon& photon : photons) {
        if (photon.edges >= power_.size()) power_.resize(std::size_t{photon.edges} + 1, 0.0);
        power_[photon.edges] += static_cast<double>(photon.power().sum());
    }
    std::partial_sum(power_.begin(), power_.end(), power_.begin());
}

std::optional<float> PhotonLengths::share(int limit, int longest) const {
    constexpr int longest_of_all = 0xffff;  // no photon holds a larger number, and paths in practice are much shorter
    if (limit >= std::min(longest, longest_of_all)) return 1.f;
    if (power_.empty() || limit < 0) return std::nullopt;
    const auto up_to = [&](int edges) { return power_[std::min(static_cast<std::size_t>(edges), power_.size() - 1)]; };
    if (!(up_to(longest) > 0)) return 1.f;
    const double share = up_to(limit) / up_to(longest);
    if (share < 1 - most_cut_off) return std::nullopt;
    return static_cast<float>(share);
}

Color GatheredLight::arriving(RayQueries& rays, const TracedRay& ray, const Sampler& sampler, int edges) const {
    if (source == GatherSource::paths) {
        const PixelSample sample = trace_path(rays, ray, sampler, {edges, samples_lights});
        Color radiance = Color::Zero();
        for (const Component c : {Component::direct, Component::caustic, Component::indirect})
            radiance += sample[c];
        return radiance;
    }
    GatherVisitor visitor(*this);
    follow_specular_path(rays, sampler, ray, nullptr, {edges, samples_lights, follows_specular}, visitor);
    return visitor.radiance();
}

}  // namespace gib
