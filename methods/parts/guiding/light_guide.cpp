#include "methods/parts/guiding/light_guide.h"

#include "common/scene/scene.h"
#include "methods/parts/emission/projection_map.h"

#include <algorithm>

namespace gib {

namespace {

constexpr std::uint64_t importon_key = 0x1390;  // keeps their numbers apart from those of the image

// The numbers below were chosen by the halls and yards of experiments/learning.toml and its kind; any are unbiased.
constexpr double field_memory = 16 * 0x1p20;  // [bytes]
constexpr std::uint64_t fewest_visits = 32;
constexpr double crowd = 1024;  // visits of a leaf, see RadianceField::learn()
/// Importons of the first and of the last round. Each round has twice as many as the one before; the field learns after
/// each.
constexpr std::size_t first_round = 1 << 12, last_round = 1 << 15;
/// The probability of following the field: a direction that it leaves out weighs 1 / (1 - a).
constexpr float by_field = 0.75f;
constexpr std::size_t most_bins = 1 << 12;
/// Aimed starts do not pay where this share of all light reaches their cells anyway.
constexpr double most_kept = 0.35;

/// Balls around the cells that hold a share of the weight of these places, the heaviest first.
std::vector<ProjectionTargets::Ball> balls_around(const Cells& cells, const std::map<Cells::Index, double>& weights,
                                                  double share) {
    std::vector<std::pair<double, Cells::Index>> heaviest;
    double all = 0;
    for (const auto& [cell, weight] : weights) {
        heaviest.emplace_back(weight, cell);
        all += weight;
    }
    std::sort(heaviest.rbegin(), heaviest.rend());
    std::vector<ProjectionTargets::Ball> balls;
    for (double held = 0; const auto& [weight, cell] : heaviest) {
        if (held > share * all) break;
        held += weight;
        balls.push_back({.center = cells.center(cell),
                         .radius = cells.radius(),
                         .shape = ProjectionTargets::no_shape,
                         .whole_sphere = false});
    }
    return balls;
}

/// Starts towards the places that need light most, and towards ever more of them, by maps that keep at most the share `most` of the
/// emission and differ from each other; none without such a map. The others follow.
std::optional<LightEmission> emission_towards(const Scene& scene, const std::vector<ImportonVertex>& places,
                                              double most, const LightEmission::Maps& others) {
    const Cells cells(scene, places);
    const auto weights = cells.weights(places);
    LightEmission::Maps maps;
    for (const double share : {0.98, 0.9, 0.7, 0.4}) {
        auto map =
            std::make_shared<ProjectionMap>(scene, ProjectionTargets(balls_around(cells, weights, share)), most_bins);
        if (map->empty() || map->kept_power() > most) continue;
        most = 0.5 * map->kept_power();
        maps.insert(maps.begin(), std::move(map));
    }
    if (maps.empty()) return std::nullopt;
    maps.insert(maps.end(), others.begin(), others.end());
    return LightEmission(scene, std::move(maps));
}

}  // namespace

LightGuide::LightGuide(const Scene& scene, const LightUse& use, std::uint64_t seed)
    : field_(scene.bounds(), 1, field_memory, fewest_visits) {
    ImportonPlaces last;
    for (std::size_t count = first_round; count <= last_round; count *= 2) {
        last = follow_importons(scene, use.max_edges, count, combine_keys(combine_keys(seed, importon_key), count),
                                &field_);
        field_.learn(crowd);
        rays_ += last.rays;
    }
    if (use.uses_direct) last.needed.insert(last.needed.end(), last.used.begin(), last.used.end());
    const LightEmission::Maps specular = LightEmission::towards_specular(scene);
    emission_ = emission_towards(scene, last.needed, most_kept, use.uses_direct ? specular : LightEmission::Maps());
    // Where nearly all that is specular is seen, its own map does as well.
    const double most = specular.empty() ? most_kept : 0.2 * specular.front()->kept_power();
    caustic_emission_ = emission_towards(scene, last.specular, most, specular);
}

std::optional<RadianceField::Distribution> LightGuide::known_at(const Vec3& p, const Vec3& normal) const {
    const auto known = field_.at(field_.place(p, normal));
    return known.selection() > 0.f ? std::optional(known) : std::nullopt;
}

/// The probability of following the field. A path that has become more powerful than most starts, by going where the field does
/// not lead, follows the bsdf alone, since such weights must not multiply.
float LightGuide::selection(const PathWalk& walk, float first_power) const {
    const float ordinary = emission_ ? emission_->ordinary_power() : 1.f;
    return walk.at.beta.maxCoeff() > 1.5f * ordinary * first_power ? 0.f : by_field;
}

bool LightGuide::survives(PathWalk& walk, float first_power, float most, float u) const {
    Color& beta = walk.at.beta;
    return gib::survives(beta, std::min(beta.maxCoeff() / (wanted_power_ * first_power), most), u);
}

std::optional<ScatteredRay> LightGuide::scatter(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo,
                                                const Vec3& wo_local, const VertexNumbers& u, float first_power,
                                                bool sees_lights) const {
    const auto known =
        has_guidable_lobe(hit, wo_local, Transport::power) ? known_at(hit.p, normal_towards(hit, wo)) : std::nullopt;
    if (!known) return scatter_plainly(walk, hit, wo_local, u, sees_lights);
    const auto next = scatter_by_mixture(*known, selection(walk, first_power), hit, wo_local, u, Transport::power);
    if (!next) return std::nullopt;
    walk.take(*next, sees_lights);
    if (!survives(walk, first_power, most_survival(walk.at.vertex), u.roulette())) return std::nullopt;
    return *next;
}

std::optional<Vec3> LightGuide::scatter(PathWalk& walk, const Vec3& p, float before, const VertexNumbers& u,
                                        float first_power) const {
    const auto known = known_at(p, Vec3::Zero());
    if (!known) return scatter_plainly(walk, before, u);
    const auto [wi, by_phase, pdf_w] =
        scatter_by_mixture(*known, selection(walk, first_power), walk.at.medium->phase(), walk.wo(), u);
    walk.at.beta *= by_phase / pdf_w;
    walk.at.pdf_w = infinity;
    if (!survives(walk, first_power, most_survival(walk.at.vertex), u.roulette())) return std::nullopt;
    return wi;
}

}  // namespace gib
