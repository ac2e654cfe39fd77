#include "methods/manifold_path/chain_pilot.h"

#include "common/core/parallel.h"
#include "methods/manifold_path/chain_directions.h"
#include "methods/parts/transport/pixel_samples.h"

namespace gib {

namespace {

constexpr std::uint64_t pilot_seed = 0x6d616e69666f6c64;
constexpr std::size_t paths = 4096, paths_per_block = 256;
/// Share of the choices that follows the first guess: kinds that the pilot has not met are possible.
constexpr double guessed_share = 0.1;
/// Time of a path with chains over that of one without: tried scenes have 1.5 to 4.
constexpr double cost_of_chains = 3;

/// What the pilot finds of each kind.
struct Moments {
    std::vector<double> chains;  ///< sum of c^2
    std::vector<double> hits;    ///< estimate of that sum where paths hit the lamp
    std::uint64_t rays = 0;
};

Moments follow_paths(const Scene& scene, const ChainSampler& chains, int max_edges, std::size_t begin,
                     std::size_t end) {
    const std::size_t kinds = chains.kinds().size();
    Moments found{std::vector<double>(kinds), std::vector<double>(kinds)};
    ChainCounts counts;
    RayQueries rays(scene);
    const auto tell = [&](const PathWalk& walk, const ChainSampler::Sample& sample) {
        const double light = double{luminance(walk.at.beta * sample.light.sum())};
        if (!std::isfinite(light)) return;
        found.chains[sample.kind] += sqr(light) * double{sample.q};
        found.hits[sample.kind] += sqr(light) / double{sample.hit_moment};
    };
    for_paths_over_image(rays, pilot_seed, begin, end, paths, [&](const TracedRay& eye, const Sampler& sampler) {
        ChainDirections directions(chains, counts, tell);
        trace_path_in(directions, rays, eye, sampler, max_edges, true);
    });
    found.rays = rays.count();
    return found;
}

}  // namespace

std::uint64_t learn_kinds(const Scene& scene, ChainSampler& chains, int max_edges) {
    const std::size_t kinds = chains.kinds().size();
    std::vector<Moments> blocks(paths / paths_per_block);
    parallel_blocks(paths, paths_per_block, [&](std::size_t begin, std::size_t end, std::size_t block) {
        blocks[block] = follow_paths(scene, chains, max_edges, begin, end);
    });
    Moments all{std::vector<double>(kinds), std::vector<double>(kinds)};
    for (const Moments& block : blocks) {
        all.rays += block.rays;
        for (std::size_t k = 0; k < kinds; ++k) {
            all.chains[k] += block.chains[k];
            all.hits[k] += block.hits[k];
        }
    }
    // By light, the second moments of both ways to make its chains.
    const std::size_t lights = scene.lights().size();
    std::vector<double> root(lights), hits(lights);
    for (std::size_t k = 0; k < kinds; ++k) {
        root[chains.kinds()[k].light] += std::sqrt(all.chains[k]);
        hits[chains.kinds()[k].light] += all.hits[k];
    }
    const auto is_made = [&](std::size_t light) {
        return is_delta(scene.lights()[light]) || sqr(root[light]) * cost_of_chains < hits[light];
    };
    double sum = 0, guesses = 0;
    std::vector<double> weights(kinds), guess(kinds);
    for (std::size_t k = 0; k < kinds; ++k) {
        const ChainSampler::Kind& kind = chains.kinds()[k];
        if (!is_made(kind.light)) continue;
        weights[k] = std::sqrt(all.chains[k]);
        guess[k] = std::exp2(-kind.events.length);
        sum += weights[k];
        guesses += guess[k];
    }
    for (std::size_t k = 0; k < kinds; ++k)
        weights[k] = sum > 0 ? (1 - guessed_share) * weights[k] / sum + guessed_share * guess[k] / guesses : guess[k];
    chains.weigh(weights);
    return all.rays;
}

}  // namespace gib
