#include "methods/manifold_path/chain_pilot.h"

#include "common/core/parallel.h"
#include "methods/manifold_path/chain_directions.h"
#include "methods/parts/transport/pixel_samples.h"

#include <numeric>

namespace gib {

namespace {

constexpr std::uint64_t pilot_seed = 0x6d616e69666f6c64;
constexpr std::size_t pixels = 256, pixels_of_block = 16;
constexpr std::uint64_t paths = 16;  // of a pixel
/// Share of the choices that follows the first guess: kinds that the pilot has not met are possible.
constexpr double guessed_share = 0.2;
// More samples at a point leave the variance between points, which S holds too: on the pool, two gain nothing over one.
constexpr double fewest_samples = 0.1, most_samples = 1;

/// Time of a ray of Newton's method, with the derivatives at its end, over that of another ray: the mean of six scenes.
constexpr double time_of_chain_ray = 2.5;

/// Light that chains have brought to a pixel.
struct Found {
    std::size_t number;  ///< of the kind, given what lies ahead
    double chains;       ///< c^2
    double hits;         ///< an estimate of the square where paths hit the lamp
};
struct PilotPixel {
    std::vector<Found> found;
    double mean = 0, rest = 0;  ///< mean of all light; variance of all light but the chains', times the paths
};
struct PilotBlock {
    std::vector<PilotPixel> pixels;
    std::uint64_t rays = 0, chain_rays = 0;
};

/// The paths of pixels [begin, end) of those that are spread over the image.
PilotBlock follow_paths(const Scene& scene, const ChainSampler& chains, int max_edges, std::size_t begin,
                        std::size_t end) {
    PilotBlock block{std::vector<PilotPixel>(end - begin)};
    ChainCounts counts;
    RayQueries rays(scene);
    std::size_t pixel = 0;
    double by_chains = 0;
    const auto keep_sample = [&](const PathWalk& walk, const ChainSampler::Sample& sample, std::uint64_t took) {
        block.chain_rays += took;
        for (const auto& found : sample) {
            if (!found) continue;
            const double light = double{luminance(walk.at.beta * found->light.sum())};
            if (!(std::isfinite(light) && light > 0)) continue;
            by_chains += light;
            const double hits = found->hits * sqr(light / double{luminance(found->light.sum())});
            block.pixels[pixel].found.push_back({found->number, sqr(light) * found->q, hits});
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
                block.pixels[pixel].mean += light / paths;
                sum[pixel] += light - by_chains;
                squares[pixel] += sqr(light - by_chains);
            }
            ++pixel;
        });
    }
    for (std::size_t i = 0; i < end - begin; ++i)
        block.pixels[i].rest = squares[i] - sqr(sum[i]) / paths;
    block.rays = rays.count();
    return block;
}

/// The sums of a pilot, of squares relative to those of the pixels' means as in the relative error of an image.
struct Moments {
    std::vector<double> chains, hits;  ///< by number of the kind
    std::vector<double> largest_hit;   ///< largest term of `hits`
    double rest = 0;
    std::uint64_t rays = 0, chain_rays = 0;

    Moments(std::size_t size, const std::vector<PilotBlock>& blocks) : chains(size), hits(size), largest_hit(size) {
        double mean = 0;
        for (const PilotBlock& block : blocks)
            for (const PilotPixel& pixel : block.pixels)
                mean += pixel.mean / pixels;
        for (const PilotBlock& block : blocks) {
            rays += block.rays;
            chain_rays += block.chain_rays;
            for (const PilotPixel& pixel : block.pixels) {
                const double weight = mean > 0 ? 1 / (sqr(pixel.mean / mean) + sqr(0.1)) : 0;
                rest += weight * pixel.rest;
                for (const Found& found : pixel.found) {
                    chains[found.number] += weight * found.chains;
                    hits[found.number] += weight * found.hits;
                    largest_hit[found.number] = std::max(largest_hit[found.number], weight * found.hits);
                }
            }
        }
    }
    /// Time of one sample of the chains at each point over that of a path.
    double cost() const {
        return time_of_chain_ray * static_cast<double>(chain_rays) /
               static_cast<double>(std::max<std::uint64_t>(rays - chain_rays, 1));
    }
};

}  // namespace

std::uint64_t learn_kinds(const Scene& scene, ChainSampler& chains, int max_edges) {
    std::vector<PilotBlock> blocks(pixels / pixels_of_block);
    parallel_blocks(pixels, pixels_of_block, [&](std::size_t begin, std::size_t end, std::size_t block) {
        blocks[block] = follow_paths(scene, chains, max_edges, begin, end);
    });
    const Moments all(chains.size() + scene.lights().size(), blocks);
    const double cost = all.cost();
    // The second moments of both ways to make the chains of each light: of chains, if kinds are drawn in proportion to
    // the roots of theirs at each place; of hits, without the largest term. One rare hit is no reason to sample chains.
    const auto& lights = scene.lights();
    std::vector<double> moment(lights.size()), hits(lights.size()), root(lights.size() * chains.places());
    std::vector<double> largest(lights.size());
    const auto add_hits = [&](std::size_t light, std::size_t number) {
        hits[light] += all.hits[number];
        largest[light] = std::max(largest[light], all.largest_hit[number]);
    };
    for (std::size_t i = 0; i < chains.size(); ++i) {
        root[i / chains.kinds()] += std::sqrt(all.chains[i]);
        add_hits(i / chains.kinds() / chains.places(), i);
    }
    for (std::size_t table = 0; table < root.size(); ++table) {
        const bool is_straight = table % chains.places() + 1 < chains.places();
        moment[table / chains.places()] += sqr(root[table]) / (is_straight ? ChainSampler::further_searches : 1);
    }
    for (std::size_t l = 0; l < lights.size(); ++l) {
        moment[l] += all.chains[chains.number_of_straight(l)];
        add_hits(l, chains.number_of_straight(l));
        hits[l] -= largest[l];
    }
    const auto best_samples = [&](double S) {
        if (!(S > 0)) return 1.;
        return std::clamp(std::sqrt(S / (std::max(all.rest, 1e-6 * S) * cost)), fewest_samples, most_samples);
    };
    const bool has_delta = std::any_of(lights.begin(), lights.end(), is_delta);
    std::vector<double> of_lights(lights.size()), of_kinds(chains.size());
    std::vector<bool> is_made(lights.size());
    for (std::size_t l = 0; l < lights.size(); ++l) {
        const std::vector<double> guess = chains.guess(l);
        const double S = moment[l], s = best_samples(S), guesses = std::accumulate(guess.begin(), guess.end(), 0.);
        // Beside delta lights, whose chains are sampled anyway, those of a lamp cost no more.
        const double per_path = has_delta ? 1 : 1 + s * cost;
        is_made[l] =
            guesses > 0 && (is_delta(lights[l]) || (S > 0 && (all.rest + S / s) * per_path < all.rest + hits[l]));
        if (!is_made[l]) continue;
        of_lights[l] = std::sqrt(S);
        for (std::size_t table = l * chains.places(); table < (l + 1) * chains.places(); ++table)
            for (std::size_t k = 0; k < chains.kinds(); ++k) {
                const std::size_t i = table * chains.kinds() + k;
                const double known = root[table] > 0 ? std::sqrt(all.chains[i]) / root[table] : 0.;
                of_kinds[i] = (1 - guessed_share) * known + guessed_share * guess[k] / guesses;
            }
    }
    const double roots = std::accumulate(of_lights.begin(), of_lights.end(), 0.);
    const auto made = static_cast<double>(std::count(is_made.begin(), is_made.end(), true));
    for (std::size_t l = 0; l < lights.size(); ++l)
        if (is_made[l])
            of_lights[l] = (roots > 0 ? (1 - guessed_share) * of_lights[l] / roots : 0.) + guessed_share / made;
    chains.weigh(best_samples(sqr(roots)), of_lights, of_kinds);
    return all.rays;
}

}  // namespace gib
