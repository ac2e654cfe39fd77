// LightPolicy::find(): a pilot decides whether light is guided.
#include "methods/parts/guiding/importons.h"
#include "methods/parts/guiding/light_guide.h"
#include "methods/parts/photons/photon_walk.h"

#include <algorithm>

namespace gib {

namespace {

constexpr std::uint64_t pilot_key = 0x9071;  // keeps the pilot's numbers apart from those of the image
constexpr std::uint64_t pilot_photons = 4096;
constexpr std::size_t pilot_eyes = 4096;
/// Importons and the pilot's photons go no further: among white walls they would not end.
constexpr int most_edges = 24;
/// `auto` guides if less of the light reaches places that are seen: in the library, where the eye sees a corner of the scene.
constexpr double most_used = 0.05;
constexpr double least_used = 1e-6;
/// ... and if guided photons have so many times the information of others for their rays, which take about twice the
/// time.
constexpr double least_gain = 3;

/// The worth of a pilot's photons where light is used.
struct PilotLight {
    double power = 0;        ///< over that which leaves the lights
    double information = 0;  ///< equivalent number of photons of equal power, (sum of P)^2 / sum of P^2, over rays
};

class Pilot {
public:
    Pilot(const Scene& scene, const LightUse& use, std::uint64_t seed)
        : scene_(scene), use_(use), seed_(combine_keys(seed, pilot_key)) {
        const ImportonPlaces eyes = follow_importons(scene, use.max_edges, pilot_eyes, seed_, nullptr);
        rays_ = eyes.rays;
        cells_.emplace(scene, eyes.used);
        seen_ = cells_->weights(eyes.used);
    }

    PilotLight light(PhotonMapKind kind, const LightGuide* guide) {
        const PhotonWalkResult pilot = trace_photons(scene_, kind, pilot_photons, use_.max_edges,
                                                     combine_keys(seed_, 1), nullptr, nullptr, nullptr, guide);
        rays_ += pilot.rays;
        double sum = 0, squares = 0;
        for (const Photon& photon : pilot.photons) {
            if (!seen_.contains(cells_->of(photon.p))) continue;
            const double power{photon.power().maxCoeff()};
            sum += power;
            squares += power * power;
        }
        const double photons = squares > 0 ? sum * sum / squares : 0;
        return {sum * pilot.unit / scene_.emitted_power().maxCoeff(),
                (photons + 1) / static_cast<double>(std::max<std::uint64_t>(pilot.rays, 1))};
    }
    std::uint64_t rays() const { return rays_; }

private:
    const Scene& scene_;
    const LightUse& use_;
    std::uint64_t seed_, rays_ = 0;
    std::optional<Cells> cells_;
    std::map<Cells::Index, double> seen_;
};

}  // namespace

std::shared_ptr<const LightPolicy> LightPolicy::find(const Scene& scene, Guiding guiding, const LightUse& of_method,
                                                     const Plan& plan, std::uint64_t seed, StageTimes& stages,
                                                     std::uint64_t& rays) {
    if (!plan.runs(step_importons)) return nullptr;
    LightUse use = of_method;
    use.max_edges = std::min(use.max_edges, most_edges);
    const auto timer = stages.time(step_importons);
    const PhotonMapKind kind = use.uses_direct ? PhotonMapKind::full : PhotonMapKind::global;
    Pilot pilot(scene, use, seed);
    std::shared_ptr<LightGuide> guide;
    const PilotLight all = pilot.light(PhotonMapKind::full, nullptr);
    if (guiding == Guiding::on || all.power < most_used) {
        guide = std::make_shared<LightGuide>(scene, use, seed);
        rays += guide->rays();
        const PilotLight without = kind == PhotonMapKind::full ? all : pilot.light(kind, nullptr);
        guide->want(std::max(without.power, least_used));
        guide->want(std::max(pilot.light(kind, guide.get()).power, least_used));
        if (guiding == Guiding::automatic &&
            pilot.light(kind, guide.get()).information < least_gain * without.information)
            guide.reset();
    }
    rays += pilot.rays();
    return guide;
}

}  // namespace gib
