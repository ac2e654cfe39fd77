#include "methods/precomputed_irradiance.h"

#include "common/parallel.h"
#include "methods/method.h"
#include "methods/surface_disc.h"

#include <atomic>

namespace gib {

namespace {

/// One photon in so many gives its place.
constexpr std::size_t photons_per_place = 8;
constexpr std::size_t places_per_block = 256;

/// Both sides of a surface that reflects all light diffusely: the radiance that it reflects is irradiance / pi.
const Bsdf& white() {
    static const Bsdf bsdf(Diffuse{Color::Ones()}, Diffuse{Color::Ones()});
    return bsdf;
}

/// The surface that a photon lies on, found by a short ray down to it; empty if rounding keeps it from being found.
std::optional<SurfaceHit> surface_under(RayQueries& rays, const Photon& photon) {
    const Vec3 normal = photon.surface_normal();
    const float height = 1e-5f * rays.scene().diagonal();
    auto hit = rays.intersect({photon.p + height * normal, -normal, 0.f, 2.f * height});
    if (!hit || normal_towards(*hit, normal).dot(normal) < min_normal_cosine) return std::nullopt;
    return hit;
}

}  // namespace

std::vector<Photon> take_places(std::vector<Photon>& photons) {
    constexpr float rise = static_cast<float>(photons_per_place) / (photons_per_place - 1);
    std::vector<Photon> places;
    places.reserve(photons.size() / photons_per_place + 1);
    std::size_t left = 0;
    for (std::size_t i = 0; i < photons.size(); ++i) {
        if (i % photons_per_place == 0) {
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
    std::vector<Photon> estimated(places.size());
    std::vector<char> found(places.size(), 0);
    std::atomic<std::uint64_t> traced = 0;
    parallel_blocks(places.size(), places_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        RayQueries queries(scene);
        DensityEstimator::Found neighbours;
        for (std::size_t i = begin; i < end; ++i) {
            auto hit = surface_under(queries, places[i]);
            if (!hit) continue;
            const Vec3 normal = normal_towards(*hit, places[i].surface_normal());
            hit->bsdf = &white();
            const Reflected light =
                estimator.reflected_radiance(map, queries, *hit, normal, EyePath{max_photon_edges},
                                             Sampler(PointSet::independent, seed, i, 0), 0, neighbours);
            estimated[i] = Photon(places[i].p, pi * (light.between_surfaces + light.through_media), normal, normal, 0);
            found[i] = 1;
        }
        traced += queries.count();
        if (progress) progress->add(end - begin);
    });
    rays += traced;
    std::size_t left = 0;
    for (std::size_t i = 0; i < estimated.size(); ++i)
        if (found[i]) estimated[left++] = estimated[i];
    estimated.resize(left);
    places_ = PhotonMap(std::move(estimated));
}

std::optional<Color> PrecomputedIrradiance::at(const SurfaceHit& hit, const Vec3& normal, float max_distance,
                                               DensityEstimator::Found& found) const {
    const auto on_surface = [&](const Photon& place, float distance2) {
        return place.surface_normal().dot(normal) > min_normal_cosine &&
               sqr((place.p - hit.p).dot(normal)) <= sqr(max_elevation_slope) * distance2;
    };
    places_.nearest(hit.p, 1, max_distance, on_surface, found);
    if (found.empty()) return std::nullopt;
    return places_[found.front().photon].power();
}

}  // namespace gib
