#include "methods/parts/density/radius.h"

#include "common/sampling/sampler.h"
#include "common/scene/scene.h"
#include "methods/parts/density/kernel.h"
#include "methods/parts/kd_tree/kd_tree_build.h"
#include "methods/parts/kd_tree/nearest.h"
#include "methods/parts/transport/pixel_samples.h"

#include <fmt/format.h>
#include <algorithm>

namespace gib {

namespace {

constexpr std::size_t wanted_paths = 8192;
constexpr std::uint64_t places_key = 0x72;  ///< keeps these paths apart from those of the passes

/// Keeps the places that one eye path shows.
struct PlacesVisitor {
    static constexpr bool wants_emission = false;
    static constexpr int splits = 0;
    SeenPlaces& places;

    void emitted(const Color&) {}
    void scattered(const EyeVertex&, const Vec3& p) { places.in_media.push_back(p); }
    void diffuse(const EyeVertex&, const SurfaceHit& hit, const VertexNumbers&) { places.on_surfaces.push_back(hit.p); }
};

/// A place where eye paths look photons up, and how much an error there counts.
struct WeighedPlace {
    Vec3 p;
    double weight;
};

/// The places with their weights. `quarter` is the disc, r^2 (or ball, r^3), of the ten nearest photons that a quarter of the
/// places falls below; 0 if no place has ten photons within `longest`.
struct WeighedPlaces {
    std::vector<WeighedPlace> places = {};
    double quarter = 0;
};
constexpr std::size_t nearest_photons = 10;

WeighedPlaces weighed(const KdTree<Photon>& photons, const std::vector<Vec3>& places, int dimensions, double longest) {
    WeighedPlaces weighed;
    std::vector<double> discs;
    std::vector<Neighbour> found;
    for (const Vec3& p : places) {
        const auto shines = [](const Photon& photon, float) { return photon.power().mean() > 0.f; };
        find_nearest(photons, p, nearest_photons, static_cast<float>(longest), shines, found);
        const bool full = found.size() == nearest_photons && found.back().distance2 > 0.f;
        const double disc = full ? std::pow(double{found.back().distance2}, 0.5 * dimensions) : double{infinity};
        weighed.places.push_back({p, disc});
        if (full) discs.push_back(disc);
    }
    if (discs.empty()) return weighed;
    std::sort(discs.begin(), discs.end());
    weighed.quarter = discs[discs.size() / 4];
    for (WeighedPlace& place : weighed.places)
        place.weight = 1 / (sqr(discs[discs.size() / 2] / place.weight) + 1);
    return weighed;
}

/// The half that a photon belongs to, 0 or 1, drawn from the bits of its place.
std::size_t random_half(const Vec3& p) {
    return combine_keys(combine_keys(std::bit_cast<std::uint32_t>(p.x()), std::bit_cast<std::uint32_t>(p.y())),
                        std::bit_cast<std::uint32_t>(p.z())) &
           1;
}

/// The part of a photon that counts.
struct Trial {
    double power;      ///< mean of the channels
    std::size_t half;  ///< random_half()
};

/// Look-ups within r around the places.
struct TriedRadius {
    double photons = 0;             ///< found in a look-up, in the mean
    double bias_over_variance = 0;  ///< squared bias over variance, of means over the passes
};

/// Tries a radius on the photons of several `passes` together; the result is that of one. `trials` are those of the
/// photons by index. Ends as soon as a look-up finds more than `most` photons in the mean.
///
/// With photons of powers w, the density S(r) = sum w / (pi r^2) has the variance sum w^2 / (pi r^2)^2, because photons come
/// as a Poisson process. Its bias is 2 (S(r) - S(r / sqrt 2)). The square of the bias is the product of those of two
/// halves of the photons, in whose expectation their noise is absent. With alpha = 2/3 the variance of a mean over N
/// passes is that of the first times N^(-2/3) / (2 - alpha), and on surfaces the squared bias is that of the first times
/// N^(-2/3) / alpha^2, so the ratio is the same for any number of passes. In media (`dimensions` = 3) balls stand for discs.
TriedRadius try_radius(double r, const KdTree<Photon>& photons, const std::vector<Trial>& trials, double passes,
                       const std::vector<WeighedPlace>& places, int dimensions, double most) {
    constexpr double alpha = 2.0 / 3;
    const double outside = 1, inside = 1 - std::pow(double{narrow_radius}, -dimensions);
    const double narrow2 = sqr(double{narrow_radius} * r);
    const double look_ups = passes * static_cast<double>(places.size());
    TriedRadius tried;
    double variance = 0, squared_bias = 0;
    for (const WeighedPlace& place : places) {
        std::array<double, 2> bias{};
        double squares = 0;
        photons.indices_within(place.p, static_cast<float>(r), [&](std::uint32_t photon, float distance2) {
            const auto& [power, half] = trials[photon];
            tried.photons += power > 0 ? 1 : 0;
            squares += sqr(power);
            bias[half] += double{bias_of_difference} * power * (distance2 < narrow2 ? inside : outside);
        });
        variance += place.weight * squares;
        squared_bias += place.weight * (2 * bias[0]) * (2 * bias[1]);
        if (tried.photons / look_ups > most) break;
    }
    tried.photons /= look_ups;
    // The sums grow with the passes: the variance of one pass is that of the sum over `passes`, its bias over `passes`^2.
    if (variance > 0) tried.bias_over_variance = squared_bias / (passes * variance) * (2 - alpha) / sqr(alpha);
    return tried;
}

}  // namespace

SeenPlaces seen_places(const Scene& scene, const WalkSettings& settings, std::uint64_t seed, std::uint64_t& rays) {
    SeenPlaces places;
    RayQueries queries(scene);
    for_paths_over_image(queries, combine_keys(seed, places_key), 0, wanted_paths, wanted_paths,
                         [&](const TracedRay& eye, const Sampler& sampler) {
                             PlacesVisitor visitor{places};
                             follow_specular_path(queries, sampler, eye, scene.camera_medium(), settings, visitor);
                         });
    rays += queries.count();
    return places;
}

std::uint64_t pilot_passes(double paths) {
    constexpr double enough = 65536;
    return static_cast<std::uint64_t>(std::max(1.0, std::ceil(enough / paths)));
}

double first_radius(const std::vector<Photon>& stored, double passes, const std::vector<Vec3>& places, double most,
                    int dimensions, float diagonal) {
    constexpr double photons_at_start = 0.05;
    const double longest = 0.1 * double{diagonal};
    const KdTree<Photon> photons(stored);
    const WeighedPlaces weighed_places = weighed(photons, places, dimensions, longest);
    if (!(weighed_places.quarter > 0)) return 0.02 * double{diagonal};
    std::vector<Trial> trials;
    for (std::size_t i = 0; i < photons.size(); ++i) {
        const Photon photon = photons[i];
        trials.push_back({double{photon.power().mean()}, random_half(photon.p)});
    }
    const double step = std::pow(2.0, 1.0 / dimensions);
    double r = std::pow(weighed_places.quarter * photons_at_start * passes / nearest_photons, 1.0 / dimensions);
    for (; r * step < longest; r *= step) {
        const TriedRadius larger =
            try_radius(r * step, photons, trials, passes, weighed_places.places, dimensions, most);
        if (larger.photons > most || larger.bias_over_variance > 4) break;
    }
    return r;
}

std::pair<std::string, std::string> radius_fact(std::string name, double radius, const Scene& scene) {
    return {std::move(name), fmt::format("{:.3g}", radius / double{scene.diagonal()})};
}

}  // namespace gib
