#include "methods/manifold_path/chain_pilot.h"

#include "common/core/parallel.h"
#include "methods/manifold_path/chain_directions.h"
#include "methods/parts/transport/pixel_samples.h"

namespace gib {

namespace {

constexpr std::uint64_t pilot_seed = 0x6d616e69666f6c64;
constexpr std::size_t pixels = 256, pixels_of_block = 16;
constexpr std::uint64_t paths = 16;  // of a pixel
/// Share of the choices that follows the first guess: kinds that the pilot has not met are possible.
constexpr double guessed_share = 0.05;
// More samples at a point leave the variance between points, which S holds too: on the pool, two gain nothing over one.
constexpr double fewest_samples = 0.1, most_samples = 1;

/// Light that chains have brought to a pixel.
struct Found {
    std::size_t kind;
    double chains;  ///< c^2
    double hits;    ///< an estimate of the square where paths hit the lamp
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
    const auto keep_sample = [&](const PathWalk& walk, const std::optional<ChainSampler::Sample>& sample,
                                 std::uint64_t took) {
        block.chain_rays += took;
        const double light = sample ? double{luminance(walk.at.beta * sample->light.sum())} : 0.;
        if (!sample || !std::isfinite(light)) return;
        by_chains += light;
        const double hits = sqr(light) * double{sample->hits_over_square};
        block.pixels[pixel].found.push_back({sample->kind, sqr(light) * double{sample->q}, hits});
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
    std::vector<double> chains, hits;  ///< by kind
    double rest = 0;
    std::uint64_t rays = 0, chain_rays = 0;

    Moments(std::size_t kinds, const std::vector<PilotBlock>& blocks) : chains(kinds), hits(kinds) {
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
                    chains[found.kind] += weight * found.chains;
                    hits[found.kind] += weight * found.hits;
                }
            }
        }
    }
    /// Time of one sample of the chains at each point over that of a path.
    double cost() const {
        return static_cast<double>(chain_rays) / static_cast<double>(std::max<std::uint64_t>(rays - chain_rays, 1));
    }
};

}  // namespace

std::uint64_t learn_kinds(const Scene& scene, ChainSampler& chains, int max_edges) {
    std::vector<PilotBlock> blocks(pixels / pixels_of_block);
    parallel_blocks(pixels, pixels_of_block, [&](std::size_t begin, std::size_t end, std::size_t block) {
        blocks[block] = follow_paths(scene, chains, max_edges, begin, end);
    });
    const Moments all(chains.kinds(), blocks);
    const double cost = all.cost();
    // By light, the second moments of both ways to make its chains.
    const auto& lights = scene.lights();
    std::vector<double> root(lights.size()), hits(lights.size());
    for (std::size_t k = 0; k < chains.kinds(); ++k) {
        root[chains.light_of(k)] += std::sqrt(all.chains[k]);
        hits[chains.light_of(k)] += all.hits[k];
    }
    const auto best_samples = [&](double S) {
        if (!(S > 0)) return 1.;
        return std::clamp(std::sqrt(S / (std::max(all.rest, 1e-6 * S) * cost)), fewest_samples, most_samples);
    };
    const bool has_delta = std::any_of(lights.begin(), lights.end(), is_delta);
    std::vector<bool> is_made(lights.size());
    double roots = 0;
    for (std::size_t l = 0; l < lights.size(); ++l) {
        const double S = sqr(root[l]), s = best_samples(S);
        // Beside delta lights, whose chains are sampled anyway, those of a lamp cost no more.
        is_made[l] =
            is_delta(lights[l]) || (S > 0 && (all.rest + S / s) * (has_delta ? 1 : 1 + s * cost) < all.rest + hits[l]);
        if (is_made[l]) roots += root[l];
    }
    double guesses = 0;
    std::vector<double> weights(chains.kinds());
    for (std::size_t k = 0; k < chains.kinds(); ++k)
        if (is_made[chains.light_of(k)]) guesses += chains.guess()[k];
    for (std::size_t k = 0; k < chains.kinds(); ++k) {
        if (!is_made[chains.light_of(k)]) continue;
        const double known = roots > 0 ? std::sqrt(all.chains[k]) / roots : 0.;
        weights[k] = (1 - guessed_share) * known + guessed_share * chains.guess()[k] / guesses;
    }
    chains.weigh(best_samples(sqr(roots)), weights);
    return all.rays;
}

}  // namespace gib
