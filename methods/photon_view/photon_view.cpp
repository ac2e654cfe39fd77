// A view of the stored photons: a point of a surface lights up where one of them is near.
//
// Computes: no radiance. Each sample follows the eye path through specular surfaces to the first diffuse surface. If
// the nearest photon of the map lies within `size` there, the sample is the photon's power divided by the map's mean
// power, in the component that the map serves. For the volume map, points along the whole path are looked up.
// Surfaces without a photon near are dim grey, in the component `emission`, so that the photons can be located.
// Parameters: map = global | caustic | volume; photons [emitted]; size [fraction of the scene's diagonal]; spp and
// max_depth as for all methods.
// Bias: does not apply, as nothing is estimated.
// A pass: one sample of every pixel. The map is filled at the start, with the same photons as in photon_mapper with
// the same seed and projection=off.
// Fails: never; an empty map shows no photon.
#include "methods/method.h"
#include "methods/parts/kd_tree/nearest.h"
#include "methods/parts/photons/photon_map.h"
#include "methods/parts/photons/photon_walk.h"
#include "methods/parts/transport/eye_sample_run.h"
#include "methods/parts/transport/scattered_ray.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace gib {

namespace {

/// Grey level [W/(sr m^2)] of a surface that is seen face on.
constexpr float grey = 0.05f;
/// Largest number of specular surfaces that an eye path passes.
constexpr int max_specular_vertices = 16;

struct PhotonViewSettings {
    PhotonMapKind kind;
    std::uint64_t photons;  ///< emitted
    double size;            ///< radius of a point, as a fraction of the scene's diagonal
    int max_edges;
};

Component component_of(PhotonMapKind kind) {
    return kind == PhotonMapKind::caustic  ? Component::caustic
           : kind == PhotonMapKind::volume ? Component::volume
                                           : Component::indirect;
}

Plan photon_view_plan(const Scene& scene, const PhotonViewSettings& settings) {
    Plan plan;
    plan.called_for = effects_of(scene);
    plan.unresolved.assign(all_components.begin(), all_components.end());
    const bool has_scattering = settings.kind != PhotonMapKind::volume || scene.has_scattering_media();
    plan.add("photon map", scene.has_light() && has_scattering,
             scene.has_light() ? "no medium scatters light" : "nothing emits light");
    plan.add(step_eye_paths, "");
    return plan;
}

/// The photons that are shown.
struct ShownPoints {
    const Scene& scene;
    PhotonMapKind kind;
    float size;  ///< radius of a point [scene units]
    PhotonMap map = {};
    float per_mean_power = 0.f;  ///< 1 / mean over photons and channels [1/unit]; 0 without photons
};

/// The estimate of a pixel: shows the first photon on an eye path.
class View {
public:
    explicit View(std::shared_ptr<const ShownPoints> shown) : shown_(std::move(shown)) {}

    /// One sample of a pixel: follows the eye path `traced` to the first diffuse surface or photon.
    PixelSample operator()(RayQueries& rays, TracedRay traced, const Sampler& sampler) {
        PixelSample sample;
        for (int vertex = 0; vertex < max_specular_vertices; ++vertex) {
            const auto hit = rays.surface_hit(traced);
            if (shown_->kind == PhotonMapKind::volume) {
                const float end = hit ? traced.found->t : std::min(traced.ray.t_max, 2.f * shown_->scene.diagonal());
                if (light_up_along(traced.ray, end, sample)) return sample;
            }
            if (!hit) return sample;
            const Vec3 wo = -traced.ray.d, wo_local = hit->shading.to_local(wo);
            if (hit->bsdf->traits_at(wo_local.z()).diffuse) {
                const Vec3 side = wo.dot(hit->ng) >= 0.f ? hit->ng : Vec3(-hit->ng);
                const auto on_side = [&](const Photon& photon, float) {
                    return photon.surface_normal().dot(side) > 0.f;
                };
                if (shown_->kind == PhotonMapKind::volume || !light_up(hit->p, on_side, sample))
                    sample[Component::emission] = Color::Constant(grey * std::abs(wo_local.z()));
                return sample;
            }
            Vec3 wi = traced.ray.d;  // straight on, if the surface scatters nothing
            if (hit->bsdf->traits_at(wo_local.z()).scatters()) {
                const VertexNumbers u = sampler.at_vertex(vertex);
                const auto next =
                    sample_scattering(*hit, wo_local, u.bsdf_lobe(), u.bsdf_direction(), Transport::radiance);
                if (!next) return sample;
                wi = next->wi;
            }
            traced.ray = hit->spawn_ray(wi);
            rays.trace(traced);
        }
        return sample;
    }

private:
    /// If a photon that `accept` takes lies near p, writes its colour into the sample and returns true.
    template <typename Accept>
    bool light_up(const Vec3& p, Accept&& accept, PixelSample& sample) {
        const auto nearest = find_nearest(shown_->map, p, shown_->size, accept);
        if (!nearest) return false;
        sample[component_of(shown_->kind)] = shown_->map[nearest->index].power() * shown_->per_mean_power;
        return true;
    }

    /// If a photon lies near the ray before `end`, writes the colour of the first into the sample and returns true.
    bool light_up_along(const Ray& ray, float end, PixelSample& sample) {
        if (shown_->map.size() == 0) return false;
        // All photons lie in the scene, so the part of the ray far from it is skipped, however far away the camera is.
        const auto size = static_cast<double>(shown_->size), first = static_cast<double>(ray.t_min);
        const auto middle = static_cast<double>((shown_->scene.bounds().center() - ray.o).dot(ray.d));
        const double reach = 0.5 * static_cast<double>(shown_->scene.diagonal()) + size;
        // With steps of one radius only the rim of a photon's ball can be missed, where the chord is shorter than a step.
        const double skipped = std::floor(std::max(middle - reach - first, 0.0) / size);
        for (double t = first + size * skipped; t < std::min(static_cast<double>(end), middle + reach); t += size)
            if (light_up(
                    ray.o + static_cast<float>(t) * ray.d, [](const Photon&, float) { return true; }, sample))
                return true;
        return false;
    }

    std::shared_ptr<const ShownPoints> shown_;
};

class PhotonView final : public Method {
public:
    explicit PhotonView(const PhotonViewSettings& settings) : settings_(settings) {}

    Plan plan(const Scene& scene) const override { return photon_view_plan(scene, settings_); }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        const Plan planned = plan(scene);
        auto points = std::make_shared<ShownPoints>(
            ShownPoints{scene, settings_.kind, static_cast<float>(settings_.size) * scene.diagonal()});
        EyeSampling sampling{.scene = scene, .points = PointSet::sobol, .seed = seed, .stages = stages};
        if (planned.runs("photon map")) trace_map(*points, sampling);
        return average_eye_samples(sampling, {{Component::emission, component_of(settings_.kind)}, {}},
                                   View(std::move(points)));
    }

private:
    /// Traces the photons (Jensen 2001, section 9.3) and builds their map.
    void trace_map(ShownPoints& points, EyeSampling& sampling) const {
        const auto timer = sampling.stages.time("photon tracing");
        StageProgress progress(sampling.stages, "photon tracing", settings_.photons);
        auto walk = trace_photons(sampling.scene, settings_.kind, settings_.photons, settings_.max_edges, sampling.seed,
                                  nullptr, &progress);
        sampling.photons = walk.emitted;
        sampling.rays = walk.rays;
        double sum = 0;
        for (const Photon& photon : walk.photons)
            sum += static_cast<double>(photon.power().mean());
        if (sum > 0) points.per_mean_power = static_cast<float>(static_cast<double>(walk.photons.size()) / sum);
        points.map = PhotonMap(std::move(walk.photons), walk.unit);
    }

    PhotonViewSettings settings_;
};

std::unique_ptr<Method> create_photon_view(const ParameterValues& values, const MethodDefaults& defaults) {
    const std::string map = values.choice("map");
    return std::make_unique<PhotonView>(
        PhotonViewSettings{.kind = map == "global"    ? PhotonMapKind::global
                                   : map == "caustic" ? PhotonMapKind::caustic
                                                      : PhotonMapKind::volume,
                           .photons = static_cast<std::uint64_t>(values.integer("photons")),
                           .size = values.number("size"),
                           .max_edges = max_edges_of(values, defaults)});
}

}  // namespace

MethodDescription describe_photon_view() {
    return {
        .name = "photon_view",
        .sentence = "the photons that photon_mapper stores, as points of light: no image of the scene's radiance",
        .parameters = {choice_parameter("map", {"global", "caustic", "volume"}, "the photons that are shown"),
                       count_parameter("photons", "1e4", "photons", "emitted for the map"),
                       number_parameter("size", "0.003", "scene diagonals", 1e-6, 1,
                                        "radius of the point of light that shows a photon")},
        .simulates = Effects::all(),
        .components = {},
        .unbiased = false,
        .create = create_photon_view,
        .estimates_radiance = false,
    };
}

}  // namespace gib
