#include "methods/radiosity/view.h"

#include "methods/parts/transport/pixel_samples.h"
#include "methods/parts/transport/scattered_ray.h"
#include "methods/parts/transport/specular_walk.h"
#include "methods/radiosity/light.h"

namespace gib {

namespace {

/// Random dimensions of a gather ray, as in methods/parts/gathering/final_gather.cpp.
constexpr std::uint32_t gather_direction = dimension::film, gather_lobe = dimension::lens;
constexpr std::uint64_t gather_tag = 0;

/// Sums the light that patches reflect along a final gather ray.
class GatherRayVisitor {
public:
    static constexpr bool wants_emission = false;
    static constexpr int splits = 0;

    explicit GatherRayVisitor(const RadiosityDisplay& display) : display_(display) {}

    const Color& radiance() const { return radiance_; }
    void diffuse(const SurfaceHit& hit, const Vec3& wo, const VertexNumbers&) {
        radiance_ += diffuse_reflectance(hit, wo) * display_.whole_irradiance(hit, wo) * inv_pi;
    }
    void emitted(const Color&) {}
    void scattered(const Vec3&, const Vec3&) {}

private:
    const RadiosityDisplay& display_;
    Color radiance_ = Color::Zero();
};

/// Samples a path from the eye up to the first surface; specular surfaces are left out.
class EyeVisitor {
public:
    static constexpr bool wants_emission = true;
    static constexpr int splits = 0;

    EyeVisitor(const RadiosityModel* model, const RadiosityViewSettings& settings, SpecularWalk& walk)
        : model_(model), settings_(settings), walk_(walk) {}

    const PixelSample& sample() const { return sample_; }

    void emitted(const Color& radiance) { sample_[Component::emission] += radiance; }
    void scattered(const Vec3&, const Vec3&) {}
    void diffuse(const SurfaceHit& hit, const Vec3& wo, const VertexNumbers& u) {
        if (settings_.samples_lights)
            sample_[Component::direct] += sample_direct_light(walk_.rays(), hit, hit.shading.to_local(wo), u,
                                                              LightTechniques::light_sampling_only, Lobes::diffuse)
                                              .diffuse;
        if (!model_) return;
        if (settings_.gather > 0) sample_[Component::indirect] += gathered(hit, wo);
        else
            sample_[Component::indirect] +=
                diffuse_reflectance(hit, wo) * model_->display().irradiance(hit, wo) * inv_pi;
    }

private:
    Color gathered(const SurfaceHit& hit, const Vec3& wo) {
        const auto n = static_cast<std::uint32_t>(settings_.gather);
        Colord sum = Colord::Zero();
        for (std::uint32_t i = 0; i < n; ++i) {
            const Sampler u = walk_.sampler().split(i, n, gather_tag);
            const auto next = sample_scattering(hit, hit.shading.to_local(wo), u.get_2d(gather_lobe),
                                                u.get_2d(gather_direction), Transport::radiance, Lobes::diffuse);
            if (!next) continue;
            const WalkSettings settings{2, false, false};
            SpecularWalk walk(walk_.rays(), u, settings, nullptr);
            TracedRay ray{hit.spawn_ray(next->wi)};
            walk_.rays().trace(ray);
            GatherRayVisitor visitor(model_->display());
            walk.follow(ray, visitor);
            sum += (next->weight * visitor.radiance()).cast<double>();
        }
        return (sum / n).cast<float>();
    }

    const RadiosityModel* model_;
    const RadiosityViewSettings& settings_;
    SpecularWalk& walk_;
    PixelSample sample_;
};

/// Sends each component to its film.
struct Films {
    Film& direct;
    Film* indirect;

    void add(std::size_t pixel, std::uint32_t pass, PixelSample sample) {
        if (indirect) {
            PixelSample other;
            std::swap(other[Component::indirect], sample[Component::indirect]);
            if (other[Component::indirect].isFinite().all()) indirect->add(pixel, pass, other);
            else sample[Component::emission] += other[Component::indirect];  // this film counts it
        }
        direct.add(pixel, pass, sample);
    }
};

}  // namespace

RadiosityView::RadiosityView(const Scene& scene, const Effects& effects, const RadiosityModel* model,
                             const RadiosityViewSettings& settings, std::uint64_t seed, StageTimes& stages)
    : scene_(scene),
      model_(model),
      settings_(settings),
      seed_(seed),
      stages_(stages),
      direct_([&] {
          std::vector<Component> shown, black;
          (scene.has_light() ? shown : black).push_back(Component::emission);
          (effects.has(Effect::direct_light) ? shown : black).push_back(Component::direct);
          return Film(scene.sensor().width(), scene.sensor().height(), shown, black);
      }()),
      shows_indirect_(model != nullptr) {}

void RadiosityView::sample(std::uint32_t pass, bool restart) {
    const int width = scene_.sensor().width(), height = scene_.sensor().height();
    if (restart || !indirect_) {
        first_pass_ = pass;
        indirect_.reset();
        if (shows_indirect_)
            indirect_.emplace(width, height, std::vector{Component::indirect}, std::vector<Component>{});
        else indirect_.emplace(width, height, std::vector<Component>{}, std::vector{Component::indirect});
    }
    passes_ = pass + 1;
    Films films{direct_, shows_indirect_ ? &*indirect_ : nullptr};
    const WalkSettings walks{settings_.max_edges, settings_.samples_lights, false};
    rays_ += sample_pixels(scene_, films, PointSet::sobol, seed_, pass, stages_, "view", [&] {
        return [&](RayQueries& rays, const TracedRay& eye, const Sampler& sampler) {
            SpecularWalk walk(rays, sampler, walks, nullptr);
            EyeVisitor visitor(model_, settings_, walk);
            walk.follow(eye, visitor);
            return visitor.sample();
        };
    });
}

ComponentImages RadiosityView::image() const {
    ComponentImages image = direct_.mean(passes_);
    if (indirect_) image[Component::indirect] = indirect_->mean(passes_ - first_pass_)[Component::indirect];
    return image;
}

}  // namespace gib
