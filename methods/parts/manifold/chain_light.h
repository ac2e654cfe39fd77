#pragma once
// Light that reaches a surface through chains of delta vertices, by specular manifold sampling without bias. Source:
// Zeltner, Georgiev and Jakob 2020, "Specular Manifold Sampling for Rendering High-Frequency Caustics and Glints",
// section 4.
//
// A sample at x draws the kind of a chain: a light, the shape of x_1, and the events (reflection, transmission) of 1 to
// `longest` vertices, with the probability q (times the mean number of samples, where there are more or fewer than one); then a point
// y of the light. A seed is a uniform point of the shape:
// Newton's method starts from the direction of the ray from x to there, or often from that to y, if the shape lies
// there. A set of seeds of unknown probability p leads to the same chain. New seeds are drawn until one does; their
// number n has the mean 1 / p (Zeltner 2020, section 4.3), and
//     f(wo, w) |cos| T Le n / (q pdf_w(y) |det M|)
// is an unbiased estimate of the light of all chains, where T is the chain's weight, and Le / pdf_w(y) is what a sample
// of y would bring to x_k: Le cos_y / (pdf_a r^2).
//
// Samples of the bsdf hit lamps too. Their density over directions at x is pdf_w(w) P, with the probability P of the
// chain's lobes; that of chains is q pdf_w(y) |det M| / n. The larger of the two, with a constant for n, makes the path
// (Veach 1997, section 9.2, the maximum heuristic): it depends on the path alone, so that each path is made once.
// Without it the light of a chain near a focus, where det M is 0, had no bound. The number n has no bound but
// `most_trials`, where the sample is set to a value that is not finite, so that it is dropped and counted.

#include "methods/parts/manifold/specular_chain.h"
#include "methods/parts/transport/path_walk.h"

#include <atomic>

namespace gib {

/// Counts of a run, over all threads.
struct ChainCounts {
    std::atomic<std::uint64_t> chains = 0;  ///< found
    std::atomic<std::uint64_t> trials = 0;  ///< seeds, the first ones included
    std::atomic<std::uint64_t> lost = 0;    ///< chains that most_trials did not find again
};

class ChainSampler {
public:
    static constexpr int longest_possible = 8;
    static constexpr std::uint32_t most_trials = 1u << 20;
    /// Where lamps can be hit, chains make a path only if they are denser by this factor. The number of trials is
    /// larger than 1 and varies.
    static constexpr double least_advantage = 4;
    /// No scene with more kinds is sampled: the kinds that matter would be found too seldom.
    static constexpr std::size_t most_kinds = 1u << 16;

    /// All kinds of chains of at most `longest` vertices are equally likely at each length. The scene must outlive
    /// this.
    ChainSampler(const Scene& scene, int longest);

    /// Kinds are numbered from 0. Kinds without a chain are never drawn.
    std::size_t kinds() const { return guess_.size(); }
    std::uint32_t light_of(std::size_t kind) const { return static_cast<std::uint32_t>(kind / kinds_per_light()); }
    /// The probabilities of kinds at the start, up to a factor.
    const std::vector<double>& guess() const { return guess_; }
    /// Sets the mean number of samples at a point, and the probabilities of kinds in proportion to `weights`. Lights
    /// without any weight are left to other samples.
    void weigh(double samples, const std::vector<double>& weights);
    double samples() const { return samples_; }
    /// Whether any kind can be drawn.
    bool empty() const { return !(choice_.size() > 0 && choice_.total() > 0); }

    struct Sample {
        LobeValues light;  ///< radiance [W/(sr m^2)] that the hit scatters
        std::size_t kind;
        float q;           ///< mean number of samples of the kind at a point
        float hit_moment;  ///< light^2 / hit_moment has the mean that light^2 has if samples of the bsdf hit the light
    };
    /// One sample of the light that reaches the hit, where the walk is, through chains of at most `longest` vertices
    /// that this makes, divided by samples(). Empty if it found none.
    std::optional<Sample> sample(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local, int longest,
                                 ChainCounts& counts) const;

    /// Whether this makes the chain from the start, which scatters light from w to wo, to the emitter at y.
    bool makes(RayQueries& rays, const ChainStart& start, const Vec3& wo_local, const Vec3& w,
               const ChainEvents& events, const SurfaceHit& y) const;

private:
    struct Surface {
        std::uint32_t shape, instance;
    };
    struct Kind {
        std::uint32_t light;
        std::size_t surface;
        ChainEvents events;
    };
    std::size_t kinds_per_surface() const { return std::size_t{1} << (longest_ + 1); }
    std::size_t kinds_per_light() const { return surfaces_.size() * kinds_per_surface(); }
    std::size_t number_of(const Kind& kind) const;
    Kind kind_of(std::size_t number) const;
    Vec3 seed_point(const Surface& surface, NumberStream& u) const;
    std::optional<LightSample> light_at(const Chain& chain, std::uint32_t light, const SurfaceGeometry& y) const;
    struct Densities {
        double chains, hits;
        bool prefer_chains() const { return chains > least_advantage * hits; }
    };
    Densities densities(const ChainStart& start, const Vec3& wo_local, const Chain& chain, const ChainEnd& end,
                        const LightSample& light, std::size_t kind) const;

    const Scene& scene_;
    int longest_;
    std::vector<Surface> surfaces_;
    std::vector<std::optional<AreaSampler>> area_;  ///< by shape
    std::vector<double> guess_;
    double samples_ = 1;
    DiscreteDistribution choice_;
    std::vector<bool> is_made_;  ///< by light
};

}  // namespace gib
