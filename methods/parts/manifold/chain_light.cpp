#include "methods/parts/manifold/chain_light.h"

#include <algorithm>
#include <bit>

namespace gib {

namespace {

/// Where a chain ends on a light. `y` is a point of its surface, if it has one.
ChainEnd end_on(const Light& light, const SurfaceGeometry& y) {
    if (const auto* point = std::get_if<PointLight>(&light)) return {point->position, false};
    if (const auto* spot = std::get_if<SpotLight>(&light)) return {spot->position(), false};
    if (const auto* projector = std::get_if<ProjectorLight>(&light)) return {projector->position(), false};
    if (const auto* sun = std::get_if<DirectionalLight>(&light)) return {-sun->direction, true};
    return {y.p, false};
}

/// The unit direction from x to the end.
Vec3 direction_to(const ChainEnd& end, const Vec3& x) { return end.at_infinity ? end.p : Vec3(end.p - x).normalized(); }

/// Whether light from w may reach the hit from the side of wo, or from any side of one that transmits.
bool may_receive(const SurfaceHit& hit, const Vec3& wo_local, const Vec3& w) {
    if (!(w.squaredNorm() > 0.5f)) return false;
    return hit.bsdf->traits().transmission ||
           w.dot(hit.shading.n) * hit.shading.n.dot(hit.shading.to_world(wo_local)) >= 0.f;
}

/// f |cos| of the hit for light from w.
LobeValues scattered(const SurfaceHit& hit, const Vec3& wo_local, const Vec3& w) {
    if (hit.delta_only || !hit.normals_agree_about(w)) return {};
    const Vec3 wi_local = hit.shading.to_local(w);
    LobeValues f = hit.bsdf->f_local(wo_local, wi_local);
    f.diffuse *= std::abs(wi_local.z());
    f.specular *= std::abs(wi_local.z());
    return f;
}

/// Whether Newton's method has found the same chain twice. Directions may differ by four times the errors of both, and by
/// 1e-5 for the rounding of p in single precision, which chains magnify. Next to the edge of a caustic two chains are
/// nearer to each other than that, and are taken for one.
bool is_same(const Chain& a, const Chain& b) {
    return a.shape == b.shape && a.instance == b.instance && a.events == b.events &&
           double{(a.w - b.w).norm()} <= 1e-5 + 4 * (a.error + b.error);
}

/// Points below the horizon of x that are drawn again before a seed fails. Any number leaves the estimate unbiased, since
/// all trials draw alike. With a tenth of the surface above the horizon, 3 % of the seeds fail.
constexpr int most_redraws = 32;

bool may_make_chains(const Scene& scene, std::size_t shape) {
    const Material& material = scene.material_of_shape(shape);
    return material.traits().delta && !material.is_bumped();
}

}  // namespace

ChainSampler::ChainSampler(const Scene& scene, int longest)
    : scene_(scene), longest_(longest), area_(scene.shapes().size()) {
    const InstancedGroups& groups = scene.groups();
    const auto outside = static_cast<std::uint32_t>(groups.begin.empty() ? scene.shapes().size() : groups.begin[0]);
    const auto add = [&](std::uint32_t shape, std::uint32_t instance) {
        if (!may_make_chains(scene, shape) || !(area_of(scene.shapes()[shape]) > 0)) return;
        if (!area_[shape]) area_[shape].emplace(scene.shapes()[shape]);
        surfaces_.push_back({shape, instance});
    };
    for (std::uint32_t i = 0; i < outside; ++i)
        add(i, no_instance);
    for (std::uint32_t n = 0; n < groups.instances.size(); ++n) {
        const std::uint32_t group = groups.instances[n].group;
        for (std::uint32_t i = groups.begin[group]; i < groups.begin[group + 1]; ++i)
            add(i, n);
    }
    if (surfaces_.empty() || kinds() * scene.lights().size() > most_kinds) return;
    weigh(first_weights());
}

/// The events of length l with the bits b have the number 2^l + b among those of a surface.
std::size_t ChainSampler::number_of(const Kind& kind) const {
    return kind.surface * kinds_per_surface() + ((std::size_t{1} << kind.events.length) | kind.events.transmits);
}

ChainSampler::Kind ChainSampler::kind_of(std::size_t number) const {
    const auto events = static_cast<std::uint32_t>(number % kinds_per_surface());
    const int length = std::max(static_cast<int>(std::bit_width(events)) - 1, 0);
    return {number / kinds_per_surface(), {length, events & ((1u << length) - 1)}};
}

ChainSampler::Weights ChainSampler::first_weights() const {
    const auto transmits = [&](const Surface& s) { return scene_.material_of_shape(s.shape).traits().transmission; };
    const bool any_transmits = std::any_of(surfaces_.begin(), surfaces_.end(), transmits);
    Weights weights{{}, std::vector<double>(tables(), 1.), std::vector<double>(size())};
    for (const Light& light : scene_.lights())
        weights.samples.push_back(!is_environment(light) && power_of(light).maxCoeff() > 0);
    for (std::size_t i = 0; i < size(); ++i) {
        const Kind kind = kind_of(i % kinds());
        const bool is_possible = kind.events.length > 0 && (kind.events.transmits == 0 || any_transmits) &&
                                 (!kind.events.transmits_at(0) || transmits(surfaces_[kind.surface]));
        if (is_possible) weights.kinds[i] = std::exp2(-kind.events.length);
    }
    return weights;
}

void ChainSampler::weigh(const Weights& weights) {
    lights_ = DiscreteDistribution(weights.samples);
    searches_ = weights.searches;
    kinds_.clear();
    const auto step = static_cast<std::ptrdiff_t>(kinds());
    for (auto begin = weights.kinds.begin(); begin != weights.kinds.end(); begin += step)
        kinds_.emplace_back(std::vector<double>(begin, begin + step));
}

std::size_t ChainSampler::find_surface(std::uint32_t shape, std::uint32_t instance) const {
    const auto is_it = [&](const Surface& s) { return s.shape == shape && s.instance == instance; };
    return static_cast<std::size_t>(std::find_if(surfaces_.begin(), surfaces_.end(), is_it) - surfaces_.begin());
}

std::optional<ChainSampler::Kind> ChainSampler::straight_kind(RayQueries& rays, const SurfaceHit& x,
                                                              const ChainEnd& end) const {
    const Vec3 d = direction_to(end, x.p);
    if (!(d.squaredNorm() > 0.5f)) return std::nullopt;
    const float length = end.at_infinity ? std::numeric_limits<float>::infinity() : (end.p - x.p).norm();
    std::size_t first = surfaces_.size();
    int vertices = 0;
    for (Ray ray = x.spawn_ray(d);;) {
        const auto hit = rays.intersect(ray);
        if (!hit || (hit->p - x.p).norm() >= length * (1 - 1e-4f)) break;
        if (makes_chains(*hit)) {
            if (!hit->bsdf->traits().transmission || ++vertices > longest_) return std::nullopt;
            if (vertices == 1) first = find_surface(hit->shape, hit->instance);
        } else if (is_black(hit->straight_on(d))) {
            return std::nullopt;
        }
        ray = hit->spawn_ray(d);
    }
    if (first == surfaces_.size()) return std::nullopt;
    return Kind{first, {vertices, (1u << vertices) - 1}};
}

std::size_t ChainSampler::table_of(std::size_t light, const std::optional<Kind>& straight, bool leads_to_chain) const {
    if (!straight) return light * places();
    return light * places() + 1 + 2 * std::min(straight->surface, places() / 2 - 1) + (leads_to_chain ? 1 : 0);
}

std::optional<Chain> ChainSampler::find(RayQueries& rays, const ChainStart& start, std::size_t surface,
                                        const std::optional<Chain>& seed, const ChainEnd& end) const {
    auto chain = find_chain(rays, start, seed, end);
    const Surface& first = surfaces_[surface];
    if (chain && (chain->shape != first.shape || chain->instance != first.instance)) return std::nullopt;
    return chain;
}

std::optional<Chain> ChainSampler::find_straight(RayQueries& rays, const ChainStart& start, const Vec3& wo_local,
                                                 const Kind& kind, const ChainEnd& end) const {
    const Vec3 w = direction_to(end, start.hit.p);
    if (!may_receive(start.hit, wo_local, w)) return std::nullopt;
    return find(rays, start, kind.surface, trace_chain(rays, start, w, kind.events), end);
}

Vec3 ChainSampler::seed_point(const Surface& surface, NumberStream& u) const {
    const float first = u.next(), second = u.next();
    const Vec3 p = area_[surface.shape]->sample(scene_.shapes()[surface.shape], {first, second}).p;
    if (surface.instance == no_instance) return p;
    const Instance& instance = scene_.instances()[surface.instance];
    return (instance.linear * p.cast<double>() + instance.translation).cast<float>();
}

/// The light as seen from the chain's last vertex, with the density of y [1/sr] in its pdf_w.
std::optional<LightSample> ChainSampler::light_at(const Chain& chain, std::uint32_t light,
                                                  const SurfaceGeometry& y) const {
    const auto* lamp = std::get_if<AreaLight>(&scene_.lights()[light]);
    if (!lamp) return gib::sample_light(scene_.lights()[light], scene_.shapes(), chain.last->p, Vec2::Zero());
    const Vec3 way = y.p - chain.last->p;
    const float d2 = way.squaredNorm(), d = std::sqrt(d2), cosine = -way.dot(y.ng) / d;
    if (!(cosine > 0.f)) return std::nullopt;
    return LightSample{.wi = way / d,
                       .distance = d,
                       .Le = lamp->radiance_at(y.texture_point()),
                       .pdf_w = d2 / (cosine * lamp->surface.area()),
                       .delta = false,
                       .cos_light = cosine,
                       .light = light,
                       .target = shadow_ray_target(y, chain.last->p)};
}

namespace {

/// A number of trials that does not vary: about two are usual, and the variance of the number doubles that of the light.
/// Any number leaves the image unbiased.
constexpr double typical_trials = 4;

/// Densities over directions at x [1/sr] with which chains of q = 1 and one trial, and hits, make a path; for delta lights
/// over lights.
struct Densities {
    double chains, hits;

    Densities(const ChainStart& start, const Vec3& wo_local, const Chain& chain, const ChainEnd& end,
              const LightSample& light)
        : chains(double{light.pdf_w} * determinant_of(chain, end)),
          hits(light.delta ? 0.
                           : double{start.hit.bsdf->pdf_w_local(wo_local, start.hit.shading.to_local(chain.w)) *
                                    chain.probability}) {}
    bool prefer_chains(double q) const { return q * chains > hits; }
};

}  // namespace

bool ChainSampler::makes(PathWalk& walk, ChainStart start, const Vec3& wo_local, const Vec3& w,
                         const ChainEvents& events, const SurfaceHit& y) const {
    if (!(lights_.probability(y.light) > 0.f) || events.length < 1 || events.length > longest_) return false;
    // The chain of the straight line may depend on the wavelength, although this path does not.
    if (scene_.has_dispersion() && !start.stratum)
        start.stratum = static_cast<int>(wavelength_strata * walk.flights.next());
    RayQueries& rays = walk.rays;
    const auto chain = trace_chain(rays, start, w, events);
    if (!chain) return false;
    const auto light = light_at(*chain, y.light, y);
    const std::size_t surface = find_surface(chain->shape, chain->instance);
    if (!light || surface == surfaces_.size()) return false;
    const ChainEnd end{y.p, false};
    const auto straight = straight_kind(rays, start.hit, end);
    const auto first = straight ? find_straight(rays, start, wo_local, *straight, end) : std::nullopt;
    double q = samples_of(y.light);
    if (!(first && is_same(*first, *chain))) {
        const std::size_t table = table_of(y.light, straight, first.has_value());
        q *= searches_[table] * double{kinds_[table].probability(number_of({surface, events}))} / typical_trials;
    }
    return Densities(start, wo_local, *chain, end, *light).prefer_chains(q);
}

/// The chains from a hit to a point of a light.
class ChainSampler::Search {
public:
    Search(const ChainSampler& chains, PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local, std::size_t light)
        : chains_(chains),
          walk_(walk),
          wo_local_(wo_local),
          light_(static_cast<std::uint32_t>(light)),
          start_{hit, walk.at.medium, walk.at.stratum} {
        const Scene& scene = chains.scene_;
        NumberStream& u = walk.flights;
        if (const auto* lamp = std::get_if<AreaLight>(&scene.lights()[light])) {
            const float first = u.next(), second = u.next();
            y_ = lamp->surface.sample_geometry(scene.shapes()[lamp->shape], {first, second});
        }
        end_ = end_on(scene.lights()[light], y_);
        splits_ = scene.has_dispersion() && !start_.stratum;
        if (splits_) start_.stratum = static_cast<int>(wavelength_strata * u.next());
        straight_ = chains.straight_kind(walk.rays, hit, end_);
    }

    const std::optional<Kind>& straight() const { return straight_; }
    std::uint64_t trials() const { return trials_; }

    /// The chain that the straight line leads to.
    std::optional<Chain> find_straight() {
        ++trials_;
        return chains_.find_straight(walk_.rays, start_, wo_local_, *straight_, end_);
    }
    /// The chain that a seed leads to. Half of the seeds are the straight line, if its own chain is of another kind.
    std::optional<Chain> find_by_seed(const Kind& kind) {
        ++trials_;
        const bool along_line = straight_ && straight_ != kind && walk_.flights.next() < 0.5f;
        const Vec3 w = along_line ? direction_to(end_, start_.hit.p) : seed(kind.surface);
        if (!may_receive(start_.hit, wo_local_, w)) return std::nullopt;
        return chains_.find(walk_.rays, start_, kind.surface, trace_chain(walk_.rays, start_, w, kind.events), end_);
    }

    /// Number of seeds until one leads to this chain; not a number if most_trials do not.
    double number_of_trials(const Kind& kind, const Chain& chain, ChainCounts& counts) {
        for (std::uint32_t n = 1; n <= most_trials; ++n) {
            const auto again = find_by_seed(kind);
            if (again && is_same(*again, chain)) return n;
        }
        counts.lost.fetch_add(1, std::memory_order_relaxed);
        return std::numeric_limits<double>::quiet_NaN();
    }

    /// The light of a chain that is found with the probability q / n, where `n_of` is called if it brings light, and
    /// `typical` is an n that depends on the chain alone.
    template <typename NumberOf>
    std::optional<Found> light_of(const Chain& chain, std::size_t number, double q, double typical, NumberOf&& n_of) {
        const auto seen = chains_.light_at(chain, light_, y_);
        LobeValues f = scattered(start_.hit, wo_local_, chain.w);
        if (!seen || is_black(seen->Le) || is_black(f.sum())) return std::nullopt;
        const Densities densities(start_, wo_local_, chain, end_, *seen);
        if (!densities.prefer_chains(q / typical)) return std::nullopt;
        const Color arriving = seen->Le * transmitted(chain, *seen);
        if (is_black(arriving)) return std::nullopt;
        const double n = n_of(), density = q * densities.chains / n;
        f.diffuse *= arriving / static_cast<float>(density);
        f.specular *= arriving / static_cast<float>(density);
        const double hits = densities.hits > 0 ? sqr(double{luminance(f.sum())}) * density / densities.hits : 0.;
        return Found{f, number, q, hits};
    }

private:
    /// The direction of a point of the surface. Points below the horizon of x are drawn again.
    Vec3 seed(std::size_t surface) {
        Vec3 w = Vec3::Zero();
        for (int i = 0; i == 0 || (i < most_redraws && !may_receive(start_.hit, wo_local_, w)); ++i)
            w = (chains_.seed_point(chains_.surfaces_[surface], walk_.flights) - start_.hit.p).normalized();
        return w;
    }

    /// Weight of the whole chain, from the light to x.
    Color transmitted(const Chain& chain, const LightSample& seen) {
        Color weight = Color::Ones();
        if (chains_.scene_.has_media()) {
            const auto whole = trace_chain(walk_.rays, start_, chain.w, chain.events, &walk_.flights);
            if (!whole) return Color::Zero();
            const Vec3 from = offset_origin(*chain.last, seen.wi);
            weight = whole->weight * walk_.rays.transmittance(from, whole->medium, seen, walk_.flights);
        } else {
            weight = chain.weight * walk_.rays.visibility(*chain.last, seen);
        }
        return splits_ && chain.is_split ? Color(weight * stratum_weight(*start_.stratum)) : weight;
    }

    const ChainSampler& chains_;
    PathWalk& walk_;
    Vec3 wo_local_;
    std::uint32_t light_;
    ChainStart start_;
    SurfaceGeometry y_ = {};
    ChainEnd end_ = {};
    bool splits_;
    std::optional<Kind> straight_;
    std::uint64_t trials_ = 0;
};

ChainSampler::Sample ChainSampler::sample(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local, int longest,
                                          ChainCounts& counts) const {
    if (longest < 1) return {};
    NumberStream& u = walk.flights;
    const auto light = lights_.sample(u.next());
    const double q = samples_of(light.index);
    const auto rays_of = [&walk](const auto& work) {
        const std::uint64_t before = walk.rays.count();
        work();
        return static_cast<double>(walk.rays.count() - before);
    };
    std::optional<Search> search;
    const double straight_rays = rays_of([&] { search.emplace(*this, walk, hit, wo_local, light.index); });
    const std::optional<Kind>& straight = search->straight();
    Sample sample;
    std::optional<Chain> first;
    const double chain_rays = rays_of([&] {
        if (straight) first = search->find_straight();
        if (first && straight->events.length <= longest)
            sample.found[0] = search->light_of(*first, number_of_straight(light.index), q, 1., [] { return 1.; });
    });
    sample.spent[0] = {light.index, (straight_rays + time_of_chain_ray * chain_rays) / q};
    const std::size_t table = table_of(light.index, straight, first.has_value());
    const double searches = q * searches_[table];
    const auto seek_other = [&] {
        const auto choice = kinds_[table].sample(u.next());
        const Kind kind = kind_of(choice.index);
        const auto other = kind.events.length <= longest ? search->find_by_seed(kind) : std::nullopt;
        if (!other || (first && is_same(*other, *first))) return;
        sample.found[1] =
            search->light_of(*other, table * kinds() + choice.index, searches * double{choice.probability},
                             typical_trials, [&] { return search->number_of_trials(kind, *other, counts); });
    };
    if (double{u.next()} < searches_[table] && kinds_[table].total() > 0)
        sample.spent[1] = {scene_.lights().size() + table, time_of_chain_ray * rays_of(seek_other) / searches};
    counts.trials.fetch_add(search->trials(), std::memory_order_relaxed);
    counts.chains.fetch_add((sample.found[0] ? 1u : 0u) + (sample.found[1] ? 1u : 0u), std::memory_order_relaxed);
    return sample;
}

}  // namespace gib
