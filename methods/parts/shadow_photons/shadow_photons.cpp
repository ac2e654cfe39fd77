#include "methods/parts/shadow_photons/shadow_photons.h"

#include "common/lights/light_choice.h"
#include "common/sampling/sampler.h"
#include "methods/method.h"
#include "methods/parts/density/surface_disc.h"
#include "methods/parts/photons/blocks_within_memory.h"
#include "methods/parts/photons/photon.h"
#include "methods/parts/transport/ray_queries.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace gib {

namespace {

constexpr std::size_t photons_per_block = 4096;
/// Distinguishes the random numbers of shadow photons from those of the other maps of the same seed.
constexpr std::uint64_t key_of_shadow_photons = 0x5ad0;

/// Number of the first photon of each light, followed by the number of all photons.
std::vector<std::uint64_t> shares_of_lights(const Scene& scene, std::uint64_t count) {
    const DiscreteDistribution choice = light_choice(scene.lights());
    std::vector<std::uint64_t> begin;
    double cumulated = 0;
    for (std::size_t i = 0; i < scene.lights().size(); ++i) {
        begin.push_back(std::min(count, static_cast<std::uint64_t>(std::llround(cumulated))));
        cumulated += static_cast<double>(choice.probability(i)) * static_cast<double>(count);
    }
    begin.push_back(count);
    return begin;
}

/// Follows a photon straight on through all surfaces, and stores it on each diffuse one with the share that no
/// surface before has stopped.
void cross_surfaces(RayQueries& rays, const Ray& start, ShadowPhoton photon, std::vector<ShadowPhoton>& photons) {
    const Vec3 wo = -start.d;
    photon.visibility = 1.f;
    for (Ray ray = start;;) {
        const auto hit = rays.intersect(ray);
        if (!hit) return;
        if (hit->bsdf->traits_at(hit->shading.to_local(wo).z()).diffuse) {
            photon.p = hit->p;
            photon.surface = SurfaceSide(*hit, wo).key();
            photons.push_back(photon);
        }
        photon.visibility *= hit->straight_on(start.d).mean();
        ray = hit->spawn_ray(start.d);
    }
}

}  // namespace

Parameter shadow_photons_parameter() {
    return count_parameter("shadow_photons", "0", "photons",
                           "emitted to choose among lights by what they add nearby; 0: lights are chosen without them");
}

void add_shadow_map(Plan& plan, const Scene& scene, std::uint64_t photons) {
    std::string reason;
    if (photons == 0) reason = "no photons are asked for";
    else if (!plan.runs(step_light_sampling)) reason = "lights are not sampled";
    else if (scene.has_media()) reason = "media attenuate light, and only rays account for it";
    plan.add(step_shadow_map, reason);
}

SurfaceSide::SurfaceSide(const SurfaceHit& hit, const Vec3& wo) : shape(hit.shape), instance(hit.instance) {
    const Vec3 normal = normal_towards(hit, wo);
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    side = 2 * static_cast<std::uint32_t>(axis) + (normal[axis] < 0.f ? 1u : 0u);
}

ShadowPhotonResult trace_shadow_photons(const Scene& scene, std::uint64_t count, std::uint64_t seed,
                                        StageProgress* progress) {
    ShadowPhotonResult result;
    if (count == 0 || !scene.has_light()) return result;
    result.emitted = count;
    result.unit = photon_power_unit(scene.emitted_power(), count);
    const std::vector<std::uint64_t> begin_of = shares_of_lights(scene, count);
    const std::uint64_t key = combine_keys(seed, key_of_shadow_photons);

    struct Block {
        std::vector<ShadowPhoton> photons;
        std::uint64_t rays = 0;
    };
    const auto trace_block = [&](Block& block, std::size_t begin, std::size_t end) {
        RayQueries rays(scene);
        for (std::size_t i = begin; i < end; ++i) {
            const auto light = static_cast<std::uint32_t>(std::upper_bound(begin_of.begin(), begin_of.end() - 1, i) -
                                                          begin_of.begin() - 1);
            const std::uint64_t number = i - begin_of[light], emitted = begin_of[light + 1] - begin_of[light];
            const Sampler sampler(PointSet::sobol, key, light, static_cast<std::uint32_t>(number));
            const EmissionSample start =
                sample_emission(scene.lights()[light], scene.shapes(), sampler.get_2d(dimension::emission_position),
                                sampler.get_2d(dimension::emission_direction));
            const auto power = static_cast<float>(start.power.mean() / (static_cast<double>(emitted) * result.unit));
            if (power > 0.f)
                cross_surfaces(rays, start.ray,
                               {.p = Vec3::Zero(), .power = power, .visibility = 1.f, .light = light, .surface = 0},
                               block.photons);
        }
        block.rays = rays.count();
        if (progress) progress->add(end - begin);
    };
    auto blocks = blocks_within_memory(count, photons_per_block, &Block::photons, sizeof(ShadowPhoton),
                                       "shadow_photons=" + std::to_string(count), trace_block);

    result.photons = joined(blocks, &Block::photons);
    for (const Block& block : blocks)
        result.rays += block.rays;
    return result;
}

}  // namespace gib
