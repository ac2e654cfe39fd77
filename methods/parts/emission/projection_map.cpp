#include "methods/parts/emission/projection_map.h"

#include "common/core/parallel.h"
#include "common/scene/scene.h"

#include <algorithm>
#include <numeric>

namespace gib {

namespace {

/// A light whose kept bins have more than this volume, of 1 in all, is not worth aiming.
constexpr double all_but_kept = 0.98;
/// Such lights are looked for when 1 / trial_share of the bins have been made, so that the other lights get the rest.
constexpr std::size_t trial_share = 4;
/// Balls around the targets: a few for each bin, as coarse bins cannot resolve more of them, but not more than this.
constexpr std::size_t balls_per_bin = 8, most_balls = 1 << 15;
/// A tenth of the choices is spread evenly over the lights, as without projection maps (light_choice()).
constexpr double uniform_share = 0.1;

/// A light at infinity over the disc that covers these targets, if that is smaller than the scene's.
std::optional<Light> focused_on(const Light& light, const BoundingSphere& targets) {
    std::optional<Light> focused;
    std::visit(
        [&](const auto& of_kind) {
            if constexpr (requires { of_kind.scene; }) {
                if (!(targets.radius < of_kind.scene.radius)) return;
                auto narrower = of_kind;
                narrower.scene = targets;
                focused.emplace(std::move(narrower));
            }
        },
        light);
    return focused;
}

/// Maps u in [0, 1) to x in [lower, upper) of dimension i of the box.
float within(const EmissionBox& box, std::size_t i, float u) {
    const float x = box.lower[i] + u * box.width(i);
    return x < box.upper[i] ? x : std::nextafter(box.upper[i], 0.f);
}

}  // namespace

/// Builds the bins: halves the bins of most power and drops bins that cannot reach a target, until there are
/// `most_bins`.
class ProjectionMap::Refinement {
public:
    Refinement(const Scene& scene, const ProjectionMap& map, std::size_t most_bins)
        : scene_(scene), map_(map), targets_(map.targets_), lights_(map.lights_), most_bins_(most_bins) {
        double total = 0;
        for (const OfLight& light : lights_)
            total += light.power;
        for (std::size_t i = 0; i < lights_.size(); ++i) {
            Growing bin{{{}, static_cast<std::uint32_t>(i)}, lights_[i].power / total};
            if (lights_[i].power > 0 && look(bin)) bins_.push_back(bin);
        }
    }

    std::vector<Bin> run() {
        bool tried = false;
        for (double threshold = 0.5; !bins_.empty() && threshold > 1e-12;) {
            std::vector<std::size_t> heavy;
            for (std::size_t i = 0; i < bins_.size(); ++i)
                if (!bins_[i].finished && bins_[i].weight > threshold) heavy.push_back(i);
            if (heavy.empty()) {
                threshold *= 0.5;
                continue;
            }
            if (bins_.size() + heavy.size() > most_bins_) break;
            halve(heavy);
            if (!tried && bins_.size() > most_bins_ / trial_share) {
                give_up_idle_lights();
                tried = true;
            }
        }
        give_up_idle_lights();
        std::vector<Bin> result;
        for (const Growing& bin : bins_)
            result.push_back(bin.bin);
        return result;
    }

private:
    struct Growing {
        Bin bin;
        double weight;           ///< share of the power of all lights
        bool finished = false;   ///< halving the bin gains nothing
        std::uint32_t hint = 0;  ///< the target that it reached last, which is tested first
    };

    const Light& light_of(const Growing& bin) const { return map_.light_of(scene_, bin.bin.light); }

    /// Whether the bin's rays can reach a target. Also updates `finished` and `hint`.
    bool look(Growing& bin) const {
        const RayBundle bundle = emission_bundle(light_of(bin), scene_.shapes(), bin.bin.box);
        const auto reach = targets_.reach(bundle, lights_[bin.bin.light].own_shape, bin.hint);
        bin.finished = reach == ProjectionTargets::Reach::all_meet;
        return reach != ProjectionTargets::Reach::none;
    }

    struct Halves {
        std::array<Growing, 2> bins;
        std::array<bool, 2> kept = {false, false};
    };

    /// The two halves of the bin's box in a dimension; empty if the box cannot be cut there.
    std::optional<std::pair<EmissionBox, EmissionBox>> cut(const Growing& bin, std::size_t dimension) const {
        const EmissionBox& box = bin.bin.box;
        const float at = split_point(light_of(bin), scene_.shapes(), box, dimension);
        if (!(at > box.lower[dimension] && at < box.upper[dimension])) return std::nullopt;
        std::pair<EmissionBox, EmissionBox> halves{box, box};
        halves.first.upper[dimension] = at;
        halves.second.lower[dimension] = at;
        return halves;
    }

    /// Width of the bundle of the box's rays at the distance of the targets [scene units].
    double spread(const Growing& bin, const EmissionBox& box) const {
        const RayBundle bundle = emission_bundle(light_of(bin), scene_.shapes(), box);
        const double distance =
            std::max((targets_.center().cast<double>() - bundle.center).norm(), static_cast<double>(targets_.radius()));
        return bundle.radius + 2 * std::sin(0.5 * std::min(bundle.cone.half_angle, std::numbers::pi)) * distance;
    }

    /// Halves the bin in one dimension: the one whose extent adds most to the width of the bundle, that is, without
    /// whose extent the rays would be narrowest. Comparing the halves themselves would not do, as halving may narrow
    /// nothing yet, such as for a ring around an axis. Among equal dimensions the longest side of the box decides.
    Halves halves_of(const Growing& bin) const {
        const auto dimensions = emission_dimensions(light_of(bin));
        std::optional<std::pair<EmissionBox, EmissionBox>> best;
        double least = 0;
        float longest = 0.f;
        for (std::size_t i = 0; i < 4; ++i) {
            const float extent = bin.bin.box.width(i);
            if (!dimensions[i]) continue;
            const auto halves = cut(bin, i);
            if (!halves) continue;
            EmissionBox thin = bin.bin.box;  // a slice beside the middle, where a light's map may have an edge
            thin.lower[i] += 0.25f * extent;
            thin.upper[i] = thin.lower[i] + extent / 64;
            const double width = spread(bin, thin);
            const bool equal = best && std::abs(width - least) <= 1e-6 * least;
            if (best && (equal ? extent <= longest : width > least)) continue;
            best = halves;
            least = width;
            longest = extent;
        }
        Halves result{{bin, bin}};
        if (!best) {  // the box is as fine as float can resolve
            result.bins[0].finished = true;
            result.kept[0] = true;
            return result;
        }
        const double volume = bin.bin.box.volume();
        for (std::size_t side = 0; side < 2; ++side) {
            Growing& half = result.bins[side];
            half.bin.box = side == 0 ? best->first : best->second;
            half.weight = bin.weight * (half.bin.box.volume() / volume);
            result.kept[side] = look(half);
        }
        return result;
    }

    /// Halves the chosen bins and keeps the order of all bins, so that the map is the same for any number of threads.
    void halve(const std::vector<std::size_t>& chosen) {
        std::vector<Halves> halves(chosen.size());
        parallel_blocks(chosen.size(), 32, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t i = begin; i < end; ++i)
                halves[i] = halves_of(bins_[chosen[i]]);
        });
        std::vector<Growing> next;
        std::size_t n = 0;
        for (std::size_t i = 0; i < bins_.size(); ++i) {
            if (n == chosen.size() || chosen[n] != i) {
                next.push_back(bins_[i]);
                continue;
            }
            for (std::size_t side = 0; side < 2; ++side)
                if (halves[n].kept[side]) next.push_back(halves[n].bins[side]);
            ++n;
        }
        bins_ = std::move(next);
    }

    /// Gives each light that keeps nearly all of its emission one bin that holds all of it.
    void give_up_idle_lights() {
        std::vector<double> kept(lights_.size(), 0.0);
        for (const Growing& bin : bins_)
            kept[bin.bin.light] += bin.bin.box.volume();
        std::vector<Growing> next;
        std::vector<bool> seen(lights_.size(), false);
        for (Growing& bin : bins_) {
            const std::uint32_t light = bin.bin.light;
            if (kept[light] > all_but_kept) {
                if (seen[light]) continue;
                seen[light] = true;
                bin.bin.box = {};
                bin.finished = true;
            }
            next.push_back(bin);
        }
        bins_ = std::move(next);
    }

    const Scene& scene_;
    const ProjectionMap& map_;
    const ProjectionTargets& targets_;
    const std::vector<OfLight>& lights_;
    std::size_t most_bins_;
    std::vector<Growing> bins_;
};

std::unique_ptr<AimedEmission> AimedEmission::at_surfaces(const Scene& scene, TargetSurfaces surfaces,
                                                          std::size_t most_bins) {
    return std::make_unique<ProjectionMap>(scene, surfaces, most_bins);
}

ProjectionMap::ProjectionMap(const Scene& scene, TargetSurfaces surfaces, std::size_t most_bins)
    : ProjectionMap(scene, ProjectionTargets(scene, surfaces, std::min(balls_per_bin * most_bins, most_balls)),
                    most_bins) {}

ProjectionMap::ProjectionMap(const Scene& scene, ProjectionTargets targets, std::size_t most_bins)
    : targets_(std::move(targets)) {
    for (const Light& light : scene.lights()) {
        const auto* area = std::get_if<AreaLight>(&light);
        const bool blind = area && cannot_see_itself(*area, scene.shapes());
        auto focused = targets_.empty() ? std::nullopt : focused_on(light, {targets_.center(), targets_.radius()});
        lights_.push_back({.power = power_of(focused ? *focused : light).mean(),
                           .own_shape = blind ? area->shape : ProjectionTargets::no_shape,
                           .focused = std::move(focused)});
        all_power_ += power_of(light).mean();
    }
    bins_ = Refinement(scene, *this, most_bins).run();
    for (const Bin& bin : bins_)
        lights_[bin.light].kept += bin.box.volume();
    for (const OfLight& light : lights_)
        aims_ |= light.power > 0 && (light.kept < 1 || light.focused);
    if (!bins_.empty()) prepare_choice();
}

/// Computes the probabilities of lights and bins, V_l / P_l, and the table `guide_`.
void ProjectionMap::prepare_choice() {
    double power = 0, shining = 0;
    for (const OfLight& light : lights_) {
        power += light.power * light.kept;
        shining += light.kept > 0;
    }
    std::vector<double> choice;
    for (OfLight& light : lights_) {
        choice.push_back(
            light.kept > 0 ? (1 - uniform_share) * light.power * light.kept / power + uniform_share / shining : 0.0);
        if (light.kept > 0) light.scale = static_cast<float>(light.kept / choice.back());
    }
    double sum = 0;
    for (const Bin& bin : bins_) {
        begin_.push_back(sum);
        sum += choice[bin.light] * bin.box.volume() / lights_[bin.light].kept;
    }
    const std::size_t n = bins_.size();
    guide_.resize(n);
    for (std::size_t i = 0, bin = 0; i < n; ++i) {
        while (bin + 1 < n && begin_[bin + 1] * static_cast<double>(n) <= static_cast<double>(i))
            ++bin;
        guide_[i] = static_cast<std::uint32_t>(bin);
    }
}

const Light& ProjectionMap::light_of(const Scene& scene, std::size_t light) const {
    return lights_[light].focused ? *lights_[light].focused : scene.lights()[light];
}

double ProjectionMap::density(const Scene& scene, std::size_t light, const Vec3& w, float cos_light) const {
    return emission_pdf(light_of(scene, light), w, cos_light) / double{lights_[light].scale};
}

double ProjectionMap::kept_power() const {
    double kept = 0;
    for (const OfLight& light : lights_)
        kept += light.power * light.kept;
    return kept / all_power_;
}

bool ProjectionMap::meets_target(const Scene& scene, std::size_t light, const Vec3& p, const Vec3& w) const {
    const OfLight& from = lights_[light];
    if (!(from.kept > 0)) return false;
    const RayBundle ray{p.cast<double>(), 0, {w.cast<double>(), 0}, is_at_infinity(scene.lights()[light])};
    std::uint32_t hint = 0;
    return targets_.reach(ray, from.own_shape, hint) != ProjectionTargets::Reach::none;
}

std::uint32_t ProjectionMap::choose_bin(const Vec2& u_choice) const {
    // The two numbers make 48 bits, since a bin's share may be as small as a float's last digit.
    const double u = static_cast<double>(u_choice.x()) + 0x1p-24 * static_cast<double>(u_choice.y());
    std::uint32_t i = guide_[static_cast<std::size_t>(u * static_cast<double>(guide_.size()))];
    while (i + 1 < begin_.size() && begin_[i + 1] <= u)
        ++i;
    return i;
}

EmissionSample ProjectionMap::sample_emission(const Scene& scene, std::uint32_t bin, const Vec2& u_position,
                                              const Vec2& u_direction) const {
    const auto& [box, light] = bins_[bin];
    EmissionSample sample = gib::sample_emission(
        light_of(scene, light), scene.shapes(), Vec2(within(box, 0, u_position.x()), within(box, 1, u_position.y())),
        Vec2(within(box, 2, u_direction.x()), within(box, 3, u_direction.y())));
    sample.power *= double{lights_[light].scale};
    sample.light = light;
    // The disc over the targets may lie within the scene.
    if (lights_[light].focused)
        sample.ray.o -= BoundingSphere(scene.bounds()).distance_past(sample.ray.o) * sample.ray.d;
    return sample;
}

}  // namespace gib
