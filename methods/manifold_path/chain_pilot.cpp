#include "methods/manifold_path/chain_pilot.h"

#include "common/core/parallel.h"
#include "methods/manifold_path/chain_directions.h"
#include "methods/parts/emission/light_emission.h"
#include "methods/parts/transport/pixel_samples.h"

#include <numeric>
#include <span>

namespace gib {

namespace {

constexpr std::uint64_t pilot_seed = 0x6d616e69666f6c64;
constexpr std::size_t pixels = 128, pixels_of_block = 16;
/// Paths of one of these pixels: 16 of each pixel of the image together, up to a bound.
std::uint64_t paths_of(const Scene& scene) {
    const auto image =
        static_cast<std::uint64_t>(scene.sensor().width()) * static_cast<std::uint64_t>(scene.sensor().height());
    return std::clamp<std::uint64_t>(16 * image / pixels, 16, 128);
}
constexpr std::uint32_t photons = 1 << 12;
// Any of these numbers leaves the image unbiased. With fewer searches or a smaller share, kinds that the pilot has not met
// decide the error in scenes/bulb.xml; four times as many searches make the pool's variance times time a fifth larger.
/// Share of the choices that follows the first guess: kinds that the pilot has not met are possible.
constexpr double guessed_share = 0.4;
/// Bounds of the mean number of samples of a light at a point.
constexpr double fewest_samples = 0.1, most_samples = 1;
/// Least probability that a sample seeks other chains.
constexpr double fewest_searches = 0.3;

/// Light that chains have brought to a pixel.
struct Found {
    std::size_t light, number;  ///< number of the kind, given what lies ahead
    double chains;              ///< c^2
    double hits;                ///< an estimate of the square where paths hit the lamp
};
struct PilotPixel {
    std::vector<Found> found;
    double mean = 0, rest = 0;  ///< mean of all light; variance of all light but the chains', times the paths
};
struct PilotBlock {
    std::vector<PilotPixel> pixels;
    std::uint64_t rays = 0, chain_rays = 0;
    std::vector<double> times;  ///< ChainSampler::Spent
};

/// The paths of pixels [begin, end) of those that are spread over the image.
PilotBlock follow_paths(const Scene& scene, const ChainSampler& chains, int max_edges, std::size_t begin,
                        std::size_t end) {
    PilotBlock block{.pixels = std::vector<PilotPixel>(end - begin),
                     .times = std::vector<double>(scene.lights().size() + chains.tables())};
    ChainCounts counts;
    RayQueries rays(scene);
    const std::uint64_t paths = paths_of(scene);
    std::size_t pixel = 0;
    double by_chains = 0;
    const auto keep_sample = [&](const PathWalk& walk, const ChainSampler::Sample& sample, std::uint64_t took) {
        block.chain_rays += took;
        for (const ChainSampler::Spent& spent : sample.spent)
            block.times[spent.number] += spent.time;
        for (const auto& found : sample.found) {
            if (!found) continue;
            const double light = double{luminance(walk.at.beta * found->light.sum())};
            if (!(std::isfinite(light) && light > 0)) continue;
            by_chains += light;
            const double hits = found->hits * sqr(light / double{luminance(found->light.sum())});
            block.pixels[pixel].found.push_back({sample.spent[0].number, found->number, sqr(light) * found->q, hits});
        }
    };
    std::vector<double> sum(end - begin), squares(end - begin);
    for (std::uint64_t path = 0; path < paths; ++path) {
        pixel = 0;
        for_paths_over_image(rays, pilot_seed + path, begin, end, pixels, [&](const TracedRay& eye, const Sampler& u) {
            ChainDirections directions(chains, counts, keep_sample);
            by_chains = 0;
            const PixelSample sample = trace_path_in(directions, rays, eye, u, max_edges, true);
            double light = 0;
            for (const Color& part : sample.parts)
                light += double{luminance(part)};
            if (std::isfinite(light)) {
                block.pixels[pixel].mean += light / static_cast<double>(paths);
                sum[pixel] += light - by_chains;
                squares[pixel] += sqr(light - by_chains);
            }
            ++pixel;
        });
    }
    for (std::size_t i = 0; i < end - begin; ++i)
        block.pixels[i].rest = squares[i] - sqr(sum[i]) / static_cast<double>(paths);
    block.rays = rays.count();
    return block;
}

/// The sums of a pilot, of squares relative to those of the pixels' means as in the relative error of an image.
struct Moments {
    std::vector<double> chains;  ///< by number of the kind
    std::vector<double> hits;    ///< by light
    std::vector<double> times;   ///< ChainSampler::Spent
    double rest = 0, time = 0;   ///< of all other light
    std::uint64_t rays = 0;

    Moments(const ChainSampler& sampler, std::size_t lights, const std::vector<PilotBlock>& blocks)
        : chains(sampler.size() + lights), hits(lights), times(lights + sampler.tables()) {
        double mean = 0;
        for (const PilotBlock& block : blocks)
            for (const PilotPixel& pixel : block.pixels)
                mean += pixel.mean / static_cast<double>(pixels);
        for (const PilotBlock& block : blocks) {
            rays += block.rays;
            time += static_cast<double>(block.rays - block.chain_rays);
            for (std::size_t i = 0; i < times.size(); ++i)
                times[i] += block.times[i];
            for (const PilotPixel& pixel : block.pixels)
                if (mean > 0) add(pixel, 1 / (sqr(pixel.mean / mean) + sqr(0.1)));
        }
    }

private:
    void add(const PilotPixel& pixel, double weight) {
        rest += weight * pixel.rest;
        for (const Found& found : pixel.found) {
            chains[found.number] += weight * found.chains;
            hits[found.light] += weight * found.hits;
        }
    }
};

double sum_of_roots(std::span<const double> squares) {
    return std::accumulate(squares.begin(), squares.end(), 0.,
                           [](double sum, double square) { return sum + std::sqrt(square); });
}

/// The light of the chains of one lamp.
class LightOfChains {
public:
    LightOfChains(const ChainSampler& sampler, const Moments& all, std::size_t light)
        : all_(all), light_(light), straight_(all.chains[sampler.number_of_straight(light)]) {
        for (std::size_t place = 0; place < sampler.places(); ++place) {
            const std::size_t table = light * sampler.places() + place;
            const double root = sum_of_roots(std::span(all.chains).subspan(table * sampler.kinds(), sampler.kinds()));
            tables_.push_back({sqr(root), all.times[all.hits.size() + table], 1});
        }
        for (int i = 0; i < 10; ++i)
            balance();
    }

    /// Mean number of samples at a point.
    double samples() const { return samples_; }
    /// Probability of a search, by place.
    double searches(std::size_t place) const { return tables_[place].searches / samples_; }
    bool pays() const { return variance() * time() < (all_.rest + all_.hits[light_]) * all_.time; }

private:
    struct Table {
        double square, time;  ///< of one search at each point
        double searches;      ///< mean number at a point
    };
    double variance() const {
        double sum = all_.rest + straight_ / samples_;
        for (const Table& table : tables_)
            sum += table.square / table.searches;
        return sum;
    }
    double time() const {
        double sum = all_.time + samples_ * all_.times[light_];
        for (const Table& table : tables_)
            sum += table.searches * table.time;
        return sum;
    }
    /// Steps towards the least variance times time, where each part's share of the variance is its share of the time. A
    /// search needs a sample, so that tables that would be searched more often share the number of these.
    void balance() {
        const double ratio = time() / std::max(variance(), std::numeric_limits<double>::min());
        const auto best = [ratio](double square, double of_time) { return std::sqrt(square * ratio / of_time); };
        double square = straight_, of_time = all_.times[light_];
        for (const Table& table : tables_)
            if (table.square > 0 && best(table.square, table.time) > samples_) {
                square += table.square;
                of_time += table.time;
            }
        samples_ = square > 0 ? std::clamp(best(square, of_time), fewest_samples, most_samples) : fewest_samples;
        for (Table& table : tables_) {
            const double searches = table.square > 0 ? best(table.square, table.time) : 0;
            table.searches = std::clamp(searches, fewest_searches * samples_, samples_);
        }
    }

    const Moments& all_;
    std::size_t light_;
    double straight_, samples_ = 1;
    std::vector<Table> tables_;
};

/// Makes weights proportional to the roots of these squares, and, with the share guessed_share, to what they were.
void mix(std::span<double> weights, std::span<const double> squares) {
    const double roots = sum_of_roots(squares), guesses = std::accumulate(weights.begin(), weights.end(), 0.);
    for (std::size_t k = 0; roots > 0 && k < weights.size(); ++k)
        weights[k] = (1 - guessed_share) * std::sqrt(squares[k]) / roots + guessed_share * weights[k] / guesses;
}

/// Adds the power that a photon brings to a surface through a chain to its kind's.
void follow_photon(RayQueries& rays, const LightEmission& emission, std::uint32_t photon, const ChainSampler& chains,
                   std::vector<std::vector<double>>& powers) {
    const Sampler numbers(PointSet::independent, pilot_seed, photon, 0);
    const auto start = emission.sample(numbers);
    if (!start) return;
    NumberStream u(numbers);
    ChainEvents events{0, 0};  // counted from the last vertex
    std::optional<SurfaceHit> last;
    Ray ray = start->sample.ray;
    for (auto hit = rays.intersect(ray); hit; hit = rays.intersect(ray)) {
        if (!makes_chains(*hit)) {
            const std::size_t kind = last ? chains.find_kind(*last, events) : chains.kinds();
            if (kind < chains.kinds()) powers[start->sample.light][kind] += start->sample.power.sum();
            return;
        }
        if (events.length == chains.longest()) return;
        const Vec2 lobe(u.next(), u.next());
        const auto next = sample_scattering(*hit, hit->shading.to_local(-ray.d), lobe, Vec2::Zero(), Transport::power);
        if (!next || !next->delta) return;
        const bool transmits = next->wi.dot(hit->ng) * ray.d.dot(hit->ng) > 0.f;
        events = {events.length + 1, events.transmits << 1 | (transmits ? 1u : 0u)};
        ray = hit->spawn_ray(next->wi);
        last = hit;
    }
}

}  // namespace

std::uint64_t learn_kinds(const Scene& scene, ChainSampler& chains, int max_edges) {
    const auto& lights = scene.lights();
    std::vector<std::vector<double>> powers(lights.size(), std::vector<double>(chains.kinds()));
    const LightEmission emission(scene, LightEmission::towards_specular(scene));
    RayQueries rays(scene);
    for (std::uint32_t photon = 0; photon < photons; ++photon)
        follow_photon(rays, emission, photon, chains, powers);
    ChainSampler::Weights weights = chains.first_weights();
    const auto kinds_of = [n = chains.kinds()](std::size_t table, auto& values) {
        return std::span(values).subspan(table * n, n);
    };
    for (std::size_t table = 0; table < chains.tables(); ++table)
        mix(kinds_of(table, weights.kinds), powers[table / chains.places()]);
    chains.weigh(weights);
    std::vector<PilotBlock> blocks(pixels / pixels_of_block);
    parallel_blocks(pixels, pixels_of_block, [&](std::size_t begin, std::size_t end, std::size_t block) {
        blocks[block] = follow_paths(scene, chains, max_edges, begin, end);
    });
    const Moments all(chains, lights.size(), blocks);
    for (std::size_t light = 0; light < lights.size(); ++light) {
        const LightOfChains of(chains, all, light);
        weights.samples[light] *= is_delta(lights[light]) || of.pays() ? of.samples() : 0;
        for (std::size_t place = 0; place < chains.places(); ++place) {
            const std::size_t table = light * chains.places() + place;
            weights.searches[table] = of.searches(place);
            mix(kinds_of(table, weights.kinds), kinds_of(table, all.chains));
        }
    }
    const double samples = std::accumulate(weights.samples.begin(), weights.samples.end(), 0.);
    for (double& of_light : weights.samples)
        of_light *= std::min(1., most_samples / samples);
    chains.weigh(weights);
    return all.rays + rays.count();
}

}  // namespace gib
