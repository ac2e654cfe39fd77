#include "methods/parts/density/first_radius.h"

#include "common/sampling/sampler.h"
#include "common/scene/scene.h"
#include "methods/parts/transport/pixel_samples.h"

#include <fmt/format.h>

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

}  // namespace

SeenPlaces seen_places(const Scene& scene, const WalkSettings& settings, std::uint64_t seed, std::uint64_t& rays) {
    SeenPlaces places;
    RayQueries queries(scene);
    const Sensor& sensor = scene.sensor();
    const std::size_t pixels = static_cast<std::size_t>(sensor.width()) * static_cast<std::size_t>(sensor.height());
    const std::uint64_t key = combine_keys(seed, places_key);
    for (std::size_t i = 0; i < wanted_paths; ++i) {
        const std::size_t pixel = i * pixels / wanted_paths;
        for_each_pixel(queries, PointSet::independent, key, static_cast<std::uint32_t>(i), pixel, pixel + 1,
                       [&](std::size_t, const TracedRay& eye, const Sampler& sampler) {
                           PlacesVisitor visitor{places};
                           follow_specular_path(queries, sampler, eye, scene.camera_medium(), settings, visitor);
                       });
    }
    rays += queries.count();
    return places;
}

std::pair<std::string, std::string> radius_fact(std::string name, double radius, const Scene& scene) {
    return {std::move(name), fmt::format("{:.3g}", radius / double{scene.diagonal()})};
}

}  // namespace gib
