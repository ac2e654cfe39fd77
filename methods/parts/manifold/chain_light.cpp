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
/// 1e-4 for the rounding of p in single precision, which chains magnify. Different chains are hundredths apart and more.
bool is_same(const Chain& a, const Chain& b) { return double{(a.w - b.w).norm()} <= 1e-4 + 4 * (a.error + b.error); }

/// Probability of a search for other chains where the direction of the light has led to one.
constexpr double further_searches = 0.25;

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
    const std::size_t lights = scene.lights().size();
    if (surfaces_.empty() || kinds() * lights > most_kinds) return;
    std::vector<double> of_lights(lights), of_kinds;
    for (std::size_t light = 0; light < lights; ++light) {
        const std::vector<double> guessed = guess(light);
        of_lights[light] = std::any_of(guessed.begin(), guessed.end(), [](double w) { return w > 0; });
        for (std::size_t place = 0; place < places(); ++place)
            of_kinds.insert(of_kinds.end(), guessed.begin(), guessed.end());
    }
    weigh(1, of_lights, of_kinds);
}

std::vector<double> ChainSampler::guess(std::size_t light) const {
    const auto transmits = [&](const Surface& s) { return scene_.material_of_shape(s.shape).traits().transmission; };
    const bool any_transmits = std::any_of(surfaces_.begin(), surfaces_.end(), transmits);
    const Light& of = scene_.lights()[light];
    std::vector<double> weights(kinds(), 0.);
    if (is_environment(of) || !(power_of(of).maxCoeff() > 0)) return weights;
    for (std::size_t k = 0; k < weights.size(); ++k) {
        const Kind kind = kind_of(k);
        const std::uint32_t bits = kind.events.transmits;
        const bool is_possible = kind.events.length > 0 && (bits == 0 || any_transmits) &&
                                 ((bits & 1) == 0 || transmits(surfaces_[kind.surface]));
        if (is_possible) weights[k] = std::exp2(-kind.events.length);
    }
    return weights;
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

void ChainSampler::weigh(double samples, const std::vector<double>& lights, const std::vector<double>& kinds) {
    samples_ = samples;
    lights_ = DiscreteDistribution(lights);
    kinds_.clear();
    for (auto begin = kinds.begin(); begin != kinds.end(); begin += static_cast<std::ptrdiff_t>(this->kinds()))
        kinds_.emplace_back(std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(this->kinds())));
}

std::size_t ChainSampler::find_surface(std::uint32_t shape, std::uint32_t instance) const {
    const auto is_it = [&](const Surface& s) { return s.shape == shape && s.instance == instance; };
    return static_cast<std::size_t>(std::find_if(surfaces_.begin(), surfaces_.end(), is_it) - surfaces_.begin());
}

std::size_t ChainSampler::surface_ahead(RayQueries& rays, const SurfaceHit& x, const ChainEnd& end) const {
    const Vec3 straight = direction_to(end, x.p);
    const auto ahead = straight.squaredNorm() > 0.5f ? rays.intersect(x.spawn_ray(straight)) : std::nullopt;
    return ahead ? find_surface(ahead->shape, ahead->instance) : surfaces_.size();
}

/// Surfaces from most_places - 2 on share a table; places() - 1 is nothing ahead.
std::size_t ChainSampler::table_of(std::size_t light, std::size_t ahead) const {
    const std::size_t place = ahead == surfaces_.size() ? places() - 1 : std::min(ahead, places() - 2);
    return light * places() + place;
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

/// The densities over directions at x [1/sr], without the number of trials, with which chains and hits make the path;
/// for delta lights those over lights.
ChainSampler::Densities ChainSampler::densities(const ChainStart& start, const Vec3& wo_local, const Chain& chain,
                                                const ChainEnd& end, const LightSample& light, double q) const {
    const Vec3 wi_local = start.hit.shading.to_local(chain.w);
    return {q * double{light.pdf_w} * determinant_of(chain, end),
            light.delta ? 0. : double{start.hit.bsdf->pdf_w_local(wo_local, wi_local) * chain.probability}};
}

bool ChainSampler::makes(RayQueries& rays, const ChainStart& start, const Vec3& wo_local, const Vec3& w,
                         const ChainEvents& events, const SurfaceHit& y) const {
    const double of_light = double{lights_.probability(y.light)};
    if (!(of_light > 0) || events.length < 1 || events.length > longest_) return false;
    const auto chain = trace_chain(rays, start, w, events);
    if (!chain) return false;
    const auto light = light_at(*chain, y.light, y);
    const std::size_t surface = find_surface(chain->shape, chain->instance);
    if (!light || surface == surfaces_.size()) return false;
    const ChainEnd end{y.p, false};
    const DiscreteDistribution& kinds = kinds_[table_of(y.light, surface_ahead(rays, start.hit, end))];
    const double q = samples_ * of_light * double{kinds.probability(number_of({surface, events}))};
    return densities(start, wo_local, *chain, end, *light, q).prefer_chains();
}

std::optional<ChainSampler::Sample> ChainSampler::sample(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local,
                                                         int longest, ChainCounts& counts) const {
    NumberStream& u = walk.flights;
    const auto choice = lights_.sample(u.next());
    const std::size_t of = choice.index;
    SurfaceGeometry y{};
    if (const auto* lamp = std::get_if<AreaLight>(&scene_.lights()[of])) {
        const float first = u.next(), second = u.next();
        y = lamp->surface.sample_geometry(scene_.shapes()[lamp->shape], {first, second});
    }
    const ChainEnd end = end_on(scene_.lights()[of], y);
    const std::size_t ahead = surface_ahead(walk.rays, hit, end), table = table_of(of, ahead);
    if (!(kinds_[table].total() > 0)) return std::nullopt;
    const auto kind_choice = kinds_[table].sample(choice.u);
    const Kind kind = kind_of(kind_choice.index);
    const Surface& surface = surfaces_[kind.surface];
    if (kind.events.length > longest) return std::nullopt;
    Sample sample{.number = table * kinds() + kind_choice.index,
                  .q = static_cast<float>(samples_) * choice.probability * kind_choice.probability};
    ChainStart start{hit, walk.at.medium, walk.at.stratum};
    const bool splits = scene_.has_dispersion() && !start.stratum;
    if (splits) start.stratum = static_cast<int>(wavelength_strata * u.next());
    const float side = hit.bsdf->traits().transmission ? 0.f : hit.shading.n.dot(hit.shading.to_world(wo_local));
    const auto is_seen = [&](const Vec3& w) { return w.squaredNorm() > 0.5f && w.dot(hit.shading.n) * side >= 0.f; };
    std::uint64_t trials = 0;
    const auto find_from = [&](const Vec3& w) -> std::optional<Chain> {
        ++trials;
        auto chain = find_chain(walk.rays, start, w, kind.events, end);
        if (chain && (chain->shape != surface.shape || chain->instance != surface.instance)) return std::nullopt;
        return chain;
    };
    const auto find_by_seed = [&]() -> std::optional<Chain> {
        Vec3 w = Vec3::Zero();
        // Points below the horizon of x are drawn again.
        for (int i = 0; i == 0 || (i < most_redraws && !is_seen(w)); ++i)
            w = (seed_point(surface, u) - hit.p).normalized();
        return is_seen(w) ? find_from(w) : std::nullopt;
    };

    float light = 0.f, hits = 0.f;  // luminance that has been added, and its square if hits made it
    // Adds a chain that is found with the probability 1 / n. `n_of` is called if it brings light.
    const auto add = [&](const Chain& chain, auto&& n_of) {
        const auto seen = light_at(chain, static_cast<std::uint32_t>(of), y);
        LobeValues f = scattered(hit, wo_local, chain.w);
        if (!seen || is_black(seen->Le) || is_black(f.sum())) return;
        const Densities by = densities(start, wo_local, chain, end, *seen, double{sample.q});
        if (!by.prefer_chains()) return;
        Color arriving = seen->Le / static_cast<float>(by.chains);
        if (scene_.has_media()) {
            const auto whole = trace_chain(walk.rays, start, chain.w, kind.events, &u);
            if (!whole) return;
            const Vec3 from = offset_origin(*chain.last, seen->wi);
            arriving *= whole->weight * walk.rays.transmittance(from, whole->medium, *seen, u);
        } else {
            arriving *= chain.weight * walk.rays.visibility(*chain.last, *seen);
        }
        if (splits && chain.is_split) arriving *= stratum_weight(*start.stratum);
        if (is_black(arriving)) return;
        counts.chains.fetch_add(1, std::memory_order_relaxed);
        const auto n = static_cast<float>(n_of());
        f.diffuse *= arriving * n;
        f.specular *= arriving * n;
        sample.light.diffuse += f.diffuse;
        sample.light.specular += f.specular;
        light += luminance(f.sum());
        hits += by.hits > 0 ? sqr(luminance(f.sum())) / (n * static_cast<float>(by.hits / by.chains)) : 0.f;
    };

    const Vec3 straight = direction_to(end, hit.p);
    const bool is_ahead = kind.surface == ahead && kind.events.transmits_at(0) && is_seen(straight);
    const auto first = is_ahead ? find_from(straight) : std::nullopt;
    if (first) add(*first, [] { return 1; });
    const double searches = first ? further_searches : 1;
    if (double{u.next()} < searches) {
        const auto other = find_by_seed();
        if (other && !(first && is_same(*other, *first)))
            add(*other, [&] {
                for (std::uint32_t n = 1; n <= most_trials; ++n) {
                    const auto again = find_by_seed();
                    if (again && is_same(*again, *other)) return n / searches;
                }
                counts.lost.fetch_add(1, std::memory_order_relaxed);
                return std::numeric_limits<double>::quiet_NaN();
            });
    }
    counts.trials.fetch_add(trials, std::memory_order_relaxed);
    if (light == 0.f) return std::nullopt;
    sample.hits_over_square = hits / sqr(light);
    return sample;
}

}  // namespace gib
