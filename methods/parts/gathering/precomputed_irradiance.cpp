#include "methods/parts/gathering/precomputed_irradiance.h"

#include "common/core/parallel.h"
#include "methods/method.h"
#include "methods/parts/density/surface_disc.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace gib {

namespace {

/// One photon in this many gives its place (precomputed_irradiance.h).
constexpr std::size_t photons_per_place = 8;
constexpr std::size_t places_per_block = 256;

/// A material that reflects all light diffusely on both sides: the radiance that it reflects is irradiance / pi.
const Bsdf& white() {
    static const Bsdf bsdf(Diffuse{Color::Ones()}, Diffuse{Color::Ones()});
    return bsdf;
}

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

/// The radius of a place's estimate is kept in the bits that hold the number of edges of a photon, as a fraction of
/// the largest radius, rounded down.
constexpr float radius_steps = 65535.f;
int coded_radius(float radius, float largest) {
    return largest > 0.f ? static_cast<int>(radius_steps * std::min(radius / largest, 1.f)) : 0;
}
float radius_of(const Photon& place, float largest) {
    return largest * (static_cast<float>(place.edges) / radius_steps);
}

/// Whether the estimate at a place has met an obstacle, kept in the bit that marks photons in a medium: places
/// lie on surfaces.
bool is_near_obstacle(const Photon& place) { return place.in_medium(); }

/// Whether a place lies in the tangent plane of the hit and a ray close above the surface meets nothing between them.
bool reaches(RayQueries& rays, const SurfaceHit& hit, const Vec3& normal, const Photon& place) {
    constexpr float rise = 0.02f;
    const Vec3 way = place.p - hit.p;
    if (std::abs(way.dot(normal)) > 4.f * hit.offset) return false;
    const float height = rise * way.norm();
    return !rays.intersect({.o = offset_origin(hit, normal), .d = way + height * normal, .t_max = 1.f});
}

}  // namespace

std::vector<Photon> take_places(std::vector<Photon>& photons) {
    constexpr float rise = static_cast<float>(photons_per_place) / (photons_per_place - 1);
    std::vector<Photon> places;
    places.reserve(photons.size() / photons_per_place + 1);
    std::size_t left = 0;
    for (std::size_t i = 0; i < photons.size(); ++i) {
        // A hash chooses, not a count: if all paths store the same number of photons, counting would always take the
        // same vertex of a path.
        if (mix64(i) % photons_per_place == 0) {
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
    const double unit = extent > 0.f ? std::scalbn(map.unit(), -2 * std::ilogb(extent)) : map.unit();
    std::vector<Photon> estimated(places.size());
    std::vector<char> kept(places.size(), 0);
    std::atomic<std::uint64_t> traced = 0;
    parallel_blocks(places.size(), places_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        RayQueries queries(scene);
        DensityEstimator::Neighbours neighbours;
        for (std::size_t i = begin; i < end; ++i) {
            auto hit = surface_under(queries, places[i]);
            if (!hit) continue;
            const Vec3 normal = normal_towards(*hit, places[i].surface_normal());
            hit->bsdf = &white();
            const Reflected light =
                estimator.reflected_radiance(map, queries, *hit, normal, EyePath{max_photon_edges},
                                             Sampler(PointSet::independent, seed, i, 0), 0, neighbours);
            const Color irradiance = pi * (light.between_surfaces + light.through_media);
            estimated[i] = Photon(places[i].p, (irradiance.cast<double>() / unit).cast<float>(), normal, normal,
                                  coded_radius(light.radius, estimator.max_radius),
                                  light.near_obstacle);  // see is_near_obstacle()
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
    places_ = PhotonMap(std::move(estimated), unit);
}

std::optional<Color> PrecomputedIrradiance::at(RayQueries& rays, const SurfaceHit& hit, const Vec3& normal, float seen,
                                               float max_distance, DensityEstimator::Neighbours& neighbours) const {
    const auto on_surface = [&](const Photon& place, float distance2) {
        return place.surface_normal().dot(normal) > min_normal_cosine &&
               sqr((place.p - hit.p).dot(normal)) <= sqr(max_elevation_slope) * distance2;
    };
    places_.nearest(hit.p, 1, max_distance, on_surface, neighbours);
    if (neighbours.empty()) return std::nullopt;
    const Photon place = places_[neighbours.front().photon];
    if (neighbours.front().distance2 > sqr(radius_of(place, max_distance))) return std::nullopt;
    const bool in_doubt = is_near_obstacle(place) || neighbours.front().distance2 > sqr(seen);
    if (in_doubt && !reaches(rays, hit, normal, place)) return std::nullopt;
    return (places_.unit() * place.power().cast<double>()).cast<float>();
}

}  // namespace gib
