#include "methods/parts/gathering/precomputed_irradiance.h"

#include "common/core/parallel.h"
#include "methods/method.h"
#include "methods/parts/density/surface_disc.h"
#include "methods/parts/kd_tree/kd_tree_build.h"
#include "methods/parts/kd_tree/nearest.h"
#include "methods/parts/transport/white_surface.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace gib {

namespace {

constexpr std::size_t places_per_block = 256;

/// The surface on which a photon lies, found by short rays down to it; empty if rounding keeps it from being found.
/// The first ray starts a few rounding errors of the position, or 1e-10 scene diagonals, above the photon, to stay
/// within a room that is small compared with the scene. Higher rays follow for shapes whose own rounding error
/// exceeds that of their points: up to about 1e-6 of a shape as large as the scene. There are six rays at most.
std::optional<SurfaceHit> surface_under(RayQueries& rays, const Photon& photon) {
    constexpr float growth = 8.f, lowest = 1e-10f, highest = 1e-5f;  // heights in scene diagonals
    const Vec3 normal = photon.surface_normal();
    const float diagonal = rays.scene().diagonal();
    const float nearest = std::max(8.f * unit_roundoff * photon.p.cwiseAbs().maxCoeff(), lowest * diagonal);
    for (float height = nearest; height <= highest * diagonal; height *= growth) {
        auto hit = rays.intersect({.o = photon.p + height * normal, .d = -normal, .t_max = 2.f * height});
        if (hit && normal_towards(*hit, normal).dot(normal) >= min_normal_cosine) return hit;
    }
    return std::nullopt;
}

constexpr float radius_steps = 65535.f;
std::uint16_t coded_radius(float radius, float largest) {
    return static_cast<std::uint16_t>(largest > 0.f ? radius_steps * std::min(radius / largest, 1.f) : 0.f);
}
float radius_of(const IrradiancePlace& place, float largest) {
    return largest * (static_cast<float>(place.radius) / radius_steps);
}

/// Whether a place lies in the tangent plane of the hit and a ray close above the surface meets nothing between them.
bool reaches(RayQueries& rays, const SurfaceHit& hit, const Vec3& normal, const IrradiancePlace& place) {
    constexpr float rise = 0.02f;
    const Vec3 way = place.p - hit.p;
    if (std::abs(way.dot(normal)) > 4.f * hit.offset) return false;
    const float height = rise * way.norm();
    TracedRay ray{Ray{.o = offset_origin(hit, normal), .d = way + height * normal, .t_max = 1.f}};
    rays.trace(ray);
    return !ray.found;
}

}  // namespace

std::size_t photons_per_place(std::size_t k, std::size_t photons) {
    constexpr std::size_t places_per_disc = 12, least = 8, fewest_places = 4096;
    return k == all_photons ? least : std::max(std::min(k / places_per_disc, photons / fewest_places), least);
}

std::vector<Photon> take_places(std::vector<Photon>& photons, std::size_t per_place) {
    const float rise = static_cast<float>(per_place) / static_cast<float>(per_place - 1);
    std::vector<Photon> places;
    places.reserve(photons.size() / per_place + 1);
    std::size_t left = 0;
    for (std::size_t i = 0; i < photons.size(); ++i) {
        // A hash chooses, not a count: if all paths store the same number of photons, counting would always take the
        // same vertex of a path.
        if (mix64(i) % per_place == 0) {
            places.push_back(photons[i]);
            continue;
        }
        photons[left] = photons[i];
        photons[left++].set_power(rise * photons[i].power());
    }
    photons.resize(left);
    return places;
}

PrecomputedIrradiance::PrecomputedIrradiance(const Scene& scene, const std::vector<Photon>& places,
                                             const PhotonMap& map, const DensityEstimator& estimator,
                                             int max_photon_edges, std::uint64_t seed, std::uint64_t& rays,
                                             StageProgress* progress) {
    if (places.empty()) return;
    // The unit of irradiance [W/m^2]: the mean photon's power over the square of a length, the scene's extent rounded
    // down to a power of 2.
    const float extent = scene.diagonal();
    unit_ = extent > 0.f ? std::scalbn(map.unit(), -2 * std::ilogb(extent)) : map.unit();
    std::vector<IrradiancePlace> estimated(places.size());
    std::vector<char> kept(places.size(), 0);
    std::atomic<std::uint64_t> traced = 0;
    parallel_blocks(places.size(), places_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        RayQueries queries(scene);
        for (std::size_t i = begin; i < end; ++i) {
            auto hit = surface_under(queries, places[i]);
            if (!hit) continue;
            const Vec3 normal = normal_towards(*hit, places[i].surface_normal());
            hit->bsdf = &white_bsdf();
            const Reflected light = estimator.reflected_radiance(map, queries, *hit, normal, EyePath{max_photon_edges},
                                                                 Sampler(PointSet::independent, seed, i, 0), 0);
            const Color irradiance = pi * (light.between_surfaces + light.through_media);
            estimated[i] = {places[i].p,
                            {.irradiance = PackedColor((irradiance.cast<double>() / unit_).cast<float>(),
                                                       light.near_obstacle ? 1 : 0),
                             .normal = encode_normal(normal),
                             .radius = coded_radius(light.radius, estimator.max_radius)}};
            kept[i] = 1;
        }
        traced += queries.count();
        if (progress) progress->add(end - begin);
    });
    rays += traced;
    std::size_t left = 0;
    for (std::size_t i = 0; i < estimated.size(); ++i)
        if (kept[i]) estimated[left++] = estimated[i];
    estimated.resize(left);
    places_ = KdTree<IrradiancePlace>(estimated);
}

std::optional<Color> PrecomputedIrradiance::at(RayQueries& rays, const SurfaceHit& hit, const Vec3& normal, float seen,
                                               float max_distance) const {
    // Neighbouring places mostly have the same normal, so that the last answer is kept.
    std::uint32_t judged_normal = 0xffffffffu;
    bool agrees = false;
    const auto on_surface = [&](const IrradiancePlace& place, float distance2) {
        if (!(sqr((place.p - hit.p).dot(normal)) <= sqr(max_elevation_slope) * distance2)) return false;
        if (place.normal != judged_normal) {
            judged_normal = place.normal;
            agrees = place.surface_normal().dot(normal) > min_normal_cosine;
        }
        return agrees;
    };
    const auto serves = [&](const IrradiancePlace& place, float distance2) {
        if (distance2 > sqr(radius_of(place, max_distance))) return false;
        const bool in_doubt = place.near_obstacle() || distance2 > sqr(seen);
        return !in_doubt || reaches(rays, hit, normal, place);
    };
    auto nearest = find_nearest(places_, hit.p, max_distance, on_surface);
    if (!nearest) return std::nullopt;
    // The nearest place is tested by itself, because a search that tests places on its way would trace more rays.
    if (!serves(places_[nearest->index], nearest->distance2)) {
        nearest = find_nearest(places_, hit.p, max_distance, [&](const IrradiancePlace& place, float distance2) {
            return on_surface(place, distance2) && serves(place, distance2);
        });
        if (!nearest) return std::nullopt;
    }
    return (unit_ * places_[nearest->index].irradiance.color().cast<double>()).cast<float>();
}

}  // namespace gib
