// Photons and irradiance records made visible: a point lights up where a stored photon, or a record, is near.
//
// Computes: no radiance. Each sample follows the eye path through specular surfaces to the first surface that stores
// photons; where the nearest photon of the map lies within `size`, it shows that photon's power over the map's mean
// power, in the component that the map serves. For the volume map the same is done all along the way. Surfaces
// themselves are seen in dim grey, as `emission`, so that photons have a place. Records show their irradiance over the
// mean of all of them; they are those of an irradiance cache that gathers by path tracing, before the first pass.
// Parameters: map = global | caustic | volume | records, photons [emitted], size [fraction of the scene's diagonal]; of
// records gather, accuracy, spacing, min_spacing and max_spacing as for photon_mapper; spp and max_depth as for all
// methods.
// A pass: one sample of every pixel. The map is filled at the start, with the photons that photon_mapper has by the
// same seed and projection=off.
// Fails: never; an empty map shows no photon.
#include "methods/method.h"
#include "methods/parts/gathering/cached_gather.h"
#include "methods/parts/photons/photon_map.h"
#include "methods/parts/photons/photon_walk.h"
#include "methods/parts/transport/pixel_samples.h"
#include "methods/parts/transport/scattered_ray.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace gib {

namespace {

/// Radiance of a surface that is seen face on.
constexpr float grey = 0.05f;
/// Of specular surfaces that are looked through.
constexpr int max_specular_vertices = 16;

struct PhotonViewSettings {
    PhotonMapKind kind;
    std::uint64_t photons;  ///< emitted
    double size;            ///< of the scene's diagonal
    int max_edges;
    bool records;  ///< of an irradiance cache, instead of photons
    int gather;    ///< rays of a record
    CacheSettings spacing;
};

/// An irradiance cache as it is before the first pass.
struct Records {
    GatheredLight light;
    FinalGather gather;
    CachedGather cache;

    Records(const Scene& scene, const PhotonViewSettings& settings)
        : light{GatherSource::paths, settings.max_edges, true, true, features_of(scene), {}, {}, {}, {}},
          gather(light, settings.gather),
          cache(scene, gather, settings.spacing) {}
};

Component component_of(PhotonMapKind kind) {
    switch (kind) {
        case PhotonMapKind::global:
        case PhotonMapKind::full:
            return Component::indirect;
        case PhotonMapKind::caustic:
            return Component::caustic;
        case PhotonMapKind::volume:
            return Component::volume;
    }
    return Component::indirect;
}

Plan photon_view_plan(const Scene& scene, const PhotonViewSettings& settings) {
    Plan plan;
    plan.called_for = effects_of(scene);
    plan.unresolved.assign(all_components.begin(), all_components.end());
    const bool has_scattering = settings.kind != PhotonMapKind::volume || scene.has_scattering_media();
    if (settings.records) {
        const bool split = scene.has_media() || scene.has_dispersion();
        plan.add("irradiance cache", scene.has_light() && !split,
                 split ? "in media and dispersed light nothing is gathered" : "nothing emits light");
        plan.add(std::string(pass_eye_paths), true, "");
        return plan;
    }
    plan.add("photon map", scene.has_light() && has_scattering,
             scene.has_light() ? "no medium scatters light" : "nothing emits light");
    plan.add(std::string(pass_eye_paths), true, "");
    return plan;
}

class PhotonViewRun final : public Run {
public:
    PhotonViewRun(const Scene& scene, const PhotonViewSettings& settings, std::uint64_t seed, StageTimes& stages)
        : scene_(scene),
          seed_(seed),
          stages_(stages),
          kind_(settings.kind),
          size_(static_cast<float>(settings.size) * scene.diagonal()),
          film_(scene.sensor().width(), scene.sensor().height(), {Component::emission, component_of(settings.kind)},
                {}) {
        if (photon_view_plan(scene, settings).runs("irradiance cache")) make_records(settings);
        if (!photon_view_plan(scene, settings).runs("photon map")) return;
        const auto timer = stages_.time("photon tracing");
        StageProgress progress(stages, "photon tracing", settings.photons);
        auto walk = trace_photons(scene, settings.kind, settings.photons, settings.max_edges, seed, nullptr, &progress);
        photons_ = walk.emitted;
        rays_ = walk.rays;
        double sum = 0;
        for (const Photon& photon : walk.photons)
            sum += static_cast<double>(photon.power().mean());
        if (sum > 0) per_mean_power_ = static_cast<float>(static_cast<double>(walk.photons.size()) / sum);
        map_ = PhotonMap(std::move(walk.photons), walk.unit);
    }

    Progress advance(std::uint32_t pass) override {
        passes_ = pass + 1;
        rays_ += sample_pixels(scene_, film_, PointSet::sobol, seed_, pass, stages_, pass_eye_paths, [this] {
            return [this, neighbours = std::vector<PhotonMap::Neighbour>()](RayQueries& rays, const TracedRay& eye,
                                                                            const Sampler& sampler) mutable {
                return look(rays, eye, sampler, neighbours);
            };
        });
        return Progress::more;
    }

    ComponentImages image() const override { return film_.mean(passes_); }
    RunCounts counts() const override { return {photons_, rays_, film_.non_finite()}; }

private:
    void make_records(const PhotonViewSettings& settings) {
        const auto timer = stages_.time("irradiance cache");
        StageProgress progress(stages_, "irradiance cache",
                               static_cast<std::uint64_t>(scene_.sensor().width() * scene_.sensor().height()));
        records_ = std::make_unique<Records>(scene_, settings);
        rays_ = records_->cache.overture({settings.max_edges, true, true}, seed_, &progress);
        double sum = 0;
        for (const IrradianceRecord& record : records_->cache.cache().records())
            sum += static_cast<double>(record.irradiance.mean());
        if (sum > 0) per_mean_power_ = static_cast<float>(static_cast<double>(records_->cache.cache().size()) / sum);
    }

    PixelSample look(RayQueries& rays, TracedRay traced, const Sampler& sampler,
                     std::vector<PhotonMap::Neighbour>& neighbours) const {
        PixelSample sample;
        for (int vertex = 0; vertex < max_specular_vertices; ++vertex) {
            const auto hit = rays.surface_hit(traced);
            if (kind_ == PhotonMapKind::volume) {
                const float end = hit ? traced.found->t : std::min(traced.ray.t_max, 2.f * scene_.diagonal());
                if (light_up_along(traced.ray, end, neighbours, sample)) return sample;
            }
            if (!hit) return sample;
            const Vec3 wo = -traced.ray.d, wo_local = hit->shading.to_local(wo);
            if (hit->bsdf->traits_at(wo_local.z()).diffuse) {
                const Vec3 side = wo.dot(hit->ng) >= 0.f ? hit->ng : Vec3(-hit->ng);
                const auto on_side = [&](const Photon& photon, float) {
                    return photon.surface_normal().dot(side) > 0.f;
                };
                const bool lit = records_
                                     ? light_up_record(*hit, side, sample)
                                     : kind_ != PhotonMapKind::volume && light_up(hit->p, on_side, neighbours, sample);
                if (!lit) sample[Component::emission] = Color::Constant(grey * std::abs(wo_local.z()));
                return sample;
            }
            Vec3 wi = traced.ray.d;  // through a surface that is not there
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

    /// Whether a photon that `accept` takes is near p; then it is in the sample.
    template <typename Accept>
    bool light_up(const Vec3& p, Accept&& accept, std::vector<PhotonMap::Neighbour>& neighbours,
                  PixelSample& sample) const {
        map_.nearest(p, 1, size_, accept, neighbours);
        if (neighbours.empty()) return false;
        sample[component_of(kind_)] = map_[neighbours.front().photon].power() * per_mean_power_;
        return true;
    }

    bool light_up_record(const SurfaceHit& hit, const Vec3& side, PixelSample& sample) const {
        const IrradianceRecord* record = records_->cache.cache().nearest(hit.p, side, size_);
        if (record) sample[Component::indirect] = record->irradiance * per_mean_power_;
        return record != nullptr;
    }

    bool light_up_along(const Ray& ray, float end, std::vector<PhotonMap::Neighbour>& neighbours,
                        PixelSample& sample) const {
        if (map_.size() == 0) return false;
        // All photons lie in the scene, however far away the camera is.
        const auto size = static_cast<double>(size_), first = static_cast<double>(ray.t_min);
        const auto middle = static_cast<double>((scene_.bounds().center() - ray.o).dot(ray.d));
        const double reach = 0.5 * static_cast<double>(scene_.diagonal()) + size;
        // Steps of one radius miss no more than the rim of a ball: chords shorter than it.
        const double skipped = std::floor(std::max(middle - reach - first, 0.0) / size);
        for (double t = first + size * skipped; t < std::min(static_cast<double>(end), middle + reach); t += size)
            if (light_up(
                    ray.o + static_cast<float>(t) * ray.d, [](const Photon&, float) { return true; }, neighbours,
                    sample))
                return true;
        return false;
    }

    const Scene& scene_;
    std::uint64_t seed_;
    StageTimes& stages_;
    PhotonMapKind kind_;
    float size_;  ///< [scene units]
    Film film_;
    PhotonMap map_;
    std::unique_ptr<Records> records_;  ///< null: photons are shown
    float per_mean_power_ = 0.f;        ///< 1 / the mean over photons (records) and channels [1/unit (m^2/W)]
    std::uint64_t photons_ = 0;
    std::uint64_t rays_ = 0;
    std::uint32_t passes_ = 0;
};

class PhotonView final : public Method {
public:
    explicit PhotonView(const PhotonViewSettings& settings) : settings_(settings) {}

    Plan plan(const Scene& scene) const override { return photon_view_plan(scene, settings_); }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        return std::make_unique<PhotonViewRun>(scene, settings_, seed, stages);
    }

private:
    PhotonViewSettings settings_;
};

std::unique_ptr<Method> create_photon_view(const ParameterValues& values, const MethodDefaults& defaults) {
    const std::string map = values.choice("map");
    const PhotonMapKind kind = map == "global"    ? PhotonMapKind::global
                               : map == "caustic" ? PhotonMapKind::caustic
                                                  : PhotonMapKind::volume;
    const bool records = map == "records";
    return std::make_unique<PhotonView>(PhotonViewSettings{
        records ? PhotonMapKind::global : kind, static_cast<std::uint64_t>(values.integer("photons")),
        values.number("size"), max_edges_of(values, defaults), records, static_cast<int>(values.integer("gather")),
        cache_settings_of(values)});
}

}  // namespace

MethodDescription describe_photon_view() {
    std::vector<Parameter> parameters = {
        choice_parameter("map", {"global", "caustic", "volume", "records"},
                         "which photons are shown; or the records of an irradiance cache"),
        count_parameter("photons", "1e4", "photons", "emitted for the map"),
        {"size",
         Parameter::Kind::number,
         "0.003",
         "scene diagonals",
         1e-6,
         1,
         {},
         "radius of the point that shows a photon or a record"},
        {"gather", Parameter::Kind::integer, "256", "rays", 1, 1e6, {}, "of a record"},
    };
    for (Parameter& parameter : cache_parameters())
        parameters.push_back(std::move(parameter));
    return {
        "photon_view",
        "the photons that photon_mapper stores, as points of light: no image of the scene's radiance",
        std::move(parameters),
        Effects::all(),
        {},
        false,
        create_photon_view,
        false,
    };
}

}  // namespace gib
