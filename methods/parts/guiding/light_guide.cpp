#include "methods/parts/guiding/light_guide.h"

#include "common/core/parallel.h"
#include "methods/parts/photons/photon_walk.h"
#include "methods/parts/transport/path_tracer.h"
#include "methods/parts/transport/pixel_samples.h"

#include <algorithm>
#include <map>

namespace gib {

namespace {

constexpr std::array<std::string_view, 3> guiding_names = {"auto", "on", "off"};

constexpr std::uint64_t pilot_key = 0x9071, importon_key = 0x1390;  // keep their numbers apart from those of the image
constexpr std::uint64_t blur_tag = 0x626c7572;

constexpr double field_memory = 16 * 0x1p20;  // [bytes]
constexpr std::uint64_t fewest_visits = 32;
constexpr double crowd = 1024;  // visits of a leaf, see RadianceField::learn()
/// Importons of the first and of the last round, after each of which the field learns; each round has twice as many as the one
/// before.
constexpr std::size_t first_round = 1 << 12, last_round = 1 << 15;
/// The probability of following the field: a direction that it leaves out weighs 1 / (1 - a).
constexpr float by_field = 0.75f;
/// `auto` guides if less of the light is used.
constexpr double most_used = 0.15;
constexpr double least_used = 1e-6;
constexpr std::uint64_t pilot_photons = 8192;
constexpr std::size_t pilot_eyes = 8192;
constexpr std::size_t most_bins = 1 << 12;
/// Aimed starts do not pay where this share of all light reaches their cells anyway.
constexpr double most_kept = 0.35;

struct WeighedPlace {
    Vec3 p;
    double weight;
};

/// What importons find: places where light is used, those from where it is sent there, and of these the specular ones.
struct Finds {
    std::vector<WeighedPlace> used = {}, needed = {}, specular = {};

    void append(const Finds& more) {
        used.insert(used.end(), more.used.begin(), more.used.end());
        needed.insert(needed.end(), more.needed.begin(), more.needed.end());
        specular.insert(specular.end(), more.specular.begin(), more.specular.end());
        rays += more.rays;
    }
    std::uint64_t rays = 0;
};

/// A class of directions for trace_path_in(), which chooses them as path tracing does.
class ImportonDirections : public BsdfDirections {
public:
    ImportonDirections(bool gathers, RadianceField* field, Finds& finds)
        : depth_(gathers ? 1 : 0), field_(field), finds_(finds) {}

    void start(const Sampler& sampler) {
        blur_.emplace(sampler.split(0, 1, blur_tag));
        scattered_ = 0;
    }
    void arrive(const Vec3& p, const Vec3& normal) {
        p_ = p;
        normal_ = normal;
    }
    std::optional<ScatteredRay> scatter(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local,
                                        const VertexNumbers& u, bool sees_lights) {
        const LobeTraits& lobes = hit.bsdf->traits_at(wo_local.z());
        come(walk, !hit.delta_only && lobes.diffuse, lobes.specular());
        const auto next = BsdfDirections::scatter(walk, hit, wo_local, u, sees_lights);
        if (next && next->lobe == LobeKind::diffuse) ++scattered_;
        return ends() ? std::nullopt : next;
    }
    std::optional<Vec3> scatter_in_medium(PathWalk& walk, const VertexNumbers& u, bool sees_lights) {
        come(walk, true, false);
        ++scattered_;
        if (ends()) return std::nullopt;
        return BsdfDirections::scatter_in_medium(walk, u, sees_lights);
    }

private:
    bool ends() const { return !field_ && scattered_ > depth_; }
    void come(const PathWalk& walk, bool uses, bool focuses) {
        const double weight{luminance(walk.at.beta)};
        if (!std::isfinite(weight) || !(weight > 0)) return;
        if (scattered_ == depth_ && uses) finds_.used.push_back({p_, weight});
        if (scattered_ <= depth_ || !field_) return;
        finds_.needed.push_back({p_, weight});
        if (focuses) finds_.specular.push_back({p_, weight});
        const RadianceField::Place place = field_->place(p_, normal_);
        field_->visit(place, 0, 0);
        field_->record(place, walk.wo(), weight, blur_->at_vertex(walk.at.vertex));
    }

    int depth_;
    RadianceField* field_;  ///< null: importons end where light is used
    Finds& finds_;
    std::optional<Sampler> blur_;
    Vec3 p_ = Vec3::Zero(), normal_ = Vec3::Zero();
    int scattered_ = 0;  ///< by diffuse lobes and media
};

/// Importons spread evenly over the image.
Finds follow_importons(const Scene& scene, const GuideSettings& settings, std::size_t count, std::uint64_t key,
                       RadianceField* field) {
    const Sensor& sensor = scene.sensor();
    const std::size_t pixels = static_cast<std::size_t>(sensor.width()) * static_cast<std::size_t>(sensor.height());
    constexpr std::size_t per_block = 1024;
    std::vector<Finds> blocks((count + per_block - 1) / per_block);
    parallel_blocks(count, per_block, [&](std::size_t begin, std::size_t end, std::size_t block) {
        Finds& finds = blocks[block];
        RayQueries rays(scene);
        ImportonDirections directions(settings.gathers, field, finds);
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t pixel = i * pixels / count;
            for_each_pixel(rays, PointSet::independent, key, static_cast<std::uint32_t>(i), pixel, pixel + 1,
                           [&](std::size_t, const TracedRay& eye, const Sampler& sampler) {
                               directions.start(sampler);
                               trace_path_in(directions, rays, eye, sampler, settings.max_edges, false);
                           });
        }
        finds.rays = rays.count();
    });
    Finds all;
    for (const Finds& block : blocks)
        all.append(block);
    return all;
}

/// Cubes of space, whose size follows the extent of most of the places that they are made for.
class Cells {
public:
    using Index = std::array<int, 3>;

    Cells(const Scene& scene, const std::vector<WeighedPlace>& places) : size_(scene.diagonal() / across) {
        if (places.empty()) return;
        Bounds most;
        for (const double quantile : {0.05, 0.95}) {
            Vec3 at;
            for (int i = 0; i < 3; ++i) {
                std::vector<float> x;
                for (const WeighedPlace& place : places)
                    x.push_back(place.p[i]);
                const auto nth = x.begin() + static_cast<std::ptrdiff_t>(quantile * static_cast<double>(x.size() - 1));
                std::nth_element(x.begin(), nth, x.end());
                at[i] = *nth;
            }
            most.add(at);
        }
        size_ = std::max(most.diagonal() / across, size_ / across);
    }

    Index of(const Vec3& p) const {
        const Vec3 x = p / size_;
        return {static_cast<int>(std::floor(x[0])), static_cast<int>(std::floor(x[1])),
                static_cast<int>(std::floor(x[2]))};
    }
    ProjectionTargets::Ball ball_around(const Index& cell) const {
        const Vec3 corner(static_cast<float>(cell[0]), static_cast<float>(cell[1]), static_cast<float>(cell[2]));
        return {.center = (corner + Vec3::Constant(0.5f)) * size_,
                .radius = 0.5f * std::sqrt(3.f) * size_,
                .shape = ProjectionTargets::no_shape,
                .whole_sphere = false};
    }
    std::map<Index, double> weights(const std::vector<WeighedPlace>& places) const {
        std::map<Index, double> weights;
        for (const WeighedPlace& place : places)
            weights[of(place.p)] += place.weight;
        return weights;
    }

private:
    static constexpr float across = 64;  // cells
    float size_;
};

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
        balls.push_back(cells.ball_around(cell));
    }
    return balls;
}

/// Starts towards the places that need light most, and towards ever more of them, by maps that drop most of the emission and
/// differ from each other; none without such a map.
std::optional<LightEmission> emission_towards(const Scene& scene, const std::vector<WeighedPlace>& places) {
    const Cells cells(scene, places);
    const auto weights = cells.weights(places);
    LightEmission::Maps maps;
    for (const double share : {0.98, 0.9, 0.7, 0.4}) {
        auto map =
            std::make_shared<ProjectionMap>(scene, ProjectionTargets(balls_around(cells, weights, share)), most_bins);
        const double most = maps.empty() ? most_kept : 0.5 * maps.front()->kept_power();
        if (!map->empty() && map->kept_power() <= most) maps.insert(maps.begin(), std::move(map));
    }
    return maps.empty() ? std::nullopt : std::optional(LightEmission(scene, std::move(maps)));
}

/// Photons' power that is stored where light is used, over that which leaves the lights, as a pilot finds it.
class UsedLight {
public:
    UsedLight(const Scene& scene, const GuideSettings& settings, std::uint64_t seed)
        : scene_(scene), settings_(settings), seed_(combine_keys(seed, pilot_key)) {
        const Finds eyes = follow_importons(scene, settings, pilot_eyes, seed_, nullptr);
        rays_ = eyes.rays;
        cells_.emplace(scene, eyes.used);
        seen_ = cells_->weights(eyes.used);
    }

    double share(const LightGuide* guide) {
        const PhotonMapKind kind = settings_.uses_direct ? PhotonMapKind::full : PhotonMapKind::global;
        const PhotonWalkResult pilot = trace_photons(scene_, kind, pilot_photons, settings_.max_edges,
                                                     combine_keys(seed_, 1), nullptr, nullptr, nullptr, guide);
        rays_ += pilot.rays;
        double used = 0;
        for (const Photon& photon : pilot.photons)
            if (seen_.contains(cells_->of(photon.p))) used += double{photon.power().maxCoeff()};
        return used * pilot.unit / scene_.emitted_power().maxCoeff();
    }
    std::uint64_t rays() const { return rays_; }

private:
    const Scene& scene_;
    const GuideSettings& settings_;
    std::uint64_t seed_, rays_ = 0;
    std::optional<Cells> cells_;
    std::map<Cells::Index, double> seen_;
};

}  // namespace

Parameter guide_parameter() {
    return choice_parameter(
        "guide", strings(guiding_names),
        "light's paths follow the importance that walks from the camera find; auto: where most light "
        "would never be used");
}

Guiding guiding_of(const ParameterValues& values) { return chosen<Guiding>(guiding_names, values.choice("guide")); }

void add_importons(Plan& plan, Guiding guiding, std::string why_not) {
    plan.add(step_importons, guiding == Guiding::off ? "guide=off" : std::move(why_not));
}

LightGuide::LightGuide(const Scene& scene, const GuideSettings& settings, std::uint64_t seed)
    : field_(scene.bounds(), 1, field_memory, fewest_visits) {
    Finds last;
    for (std::size_t count = first_round; count <= last_round; count *= 2) {
        last = follow_importons(scene, settings, count, combine_keys(combine_keys(seed, importon_key), count), &field_);
        field_.learn(crowd);
        rays_ += last.rays;
    }
    if (settings.uses_direct) last.needed.insert(last.needed.end(), last.used.begin(), last.used.end());
    emission_ = emission_towards(scene, last.needed);
    caustic_emission_ = emission_towards(scene, last.specular);
}

std::optional<RadianceField::Distribution> LightGuide::at_surface(const SurfaceHit& hit, const Vec3& wo,
                                                                  const Vec3& wo_local) const {
    if (!has_guidable_lobe(hit, wo_local, Transport::power)) return std::nullopt;
    const auto known = field_.at(field_.place(hit.p, normal_towards(hit, wo)));
    return known.selection() > 0.f ? std::optional(known) : std::nullopt;
}

std::optional<RadianceField::Distribution> LightGuide::in_medium(const Vec3& p) const {
    const auto known = field_.at(field_.place(p, Vec3::Zero()));
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
    if (!beta.isFinite().all()) return false;
    return gib::survives(beta, std::min(beta.maxCoeff() / (wanted_power_ * first_power), most), u);
}

std::optional<ScatteredRay> LightGuide::scatter(const RadianceField::Distribution& known, PathWalk& walk,
                                                const SurfaceHit& hit, const Vec3& wo_local, const VertexNumbers& u,
                                                float first_power, bool sees_lights) const {
    const auto next = scatter_by_mixture(known, selection(walk, first_power), hit, wo_local, u, Transport::power);
    if (!next) return std::nullopt;
    walk.take(*next, sees_lights);
    if (!survives(walk, first_power, most_survival(walk.at.vertex), u.roulette())) return std::nullopt;
    return *next;
}

std::optional<Vec3> LightGuide::scatter_in_medium(const RadianceField::Distribution& known, PathWalk& walk,
                                                  const VertexNumbers& u, float first_power, bool sees_lights) const {
    const auto [wi, by_phase, pdf_w] =
        scatter_by_mixture(known, selection(walk, first_power), walk.at.medium->phase(), walk.wo(), u);
    walk.at.beta *= by_phase / pdf_w;
    walk.at.pdf_w = sees_lights ? by_phase : infinity;
    if (!survives(walk, first_power, most_survival(walk.at.vertex), u.roulette())) return std::nullopt;
    return wi;
}

std::shared_ptr<const LightGuide> find_guide(const Scene& scene, const GuideSettings& settings, const Plan& plan,
                                             std::uint64_t seed, StageTimes& stages, std::uint64_t& rays) {
    if (!plan.runs(step_importons)) return nullptr;
    const auto timer = stages.time(step_importons);
    UsedLight used(scene, settings, seed);
    std::shared_ptr<LightGuide> guide;
    const double unguided = used.share(nullptr);
    if (settings.guiding == Guiding::on || unguided < most_used) {
        guide = std::make_shared<LightGuide>(scene, settings, seed);
        guide->want(std::max(unguided, least_used));
        guide->want(std::max(used.share(guide.get()), least_used));
        rays += guide->rays();
    }
    rays += used.rays();
    return guide;
}

}  // namespace gib
