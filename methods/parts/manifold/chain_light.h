#pragma once
// Light that reaches a surface through chains of delta vertices, by specular manifold sampling without bias. Source: Zeltner,
// Georgiev and Jakob 2020, "Specular Manifold Sampling for Rendering High-Frequency Caustics and Glints", section 4.
//
// A sample at x draws the kind of a chain: a light, the shape of x_1, and the events (reflection, transmission) of 1 to
// `longest` vertices, with the probability q; then a point y of the light. A seed is a uniform point of the shape: Newton's
// method starts from the direction of the ray from x to there. A set of seeds of unknown probability p leads to the same chain. New seeds are drawn
// until one does; their number n has the mean 1 / p (Zeltner 2020, section 4.3, equation 11), and
//     f(wo, w) |cos| T Le n / (q pdf_w(y) |det M|)
// is an unbiased estimate of the light of all chains, where T is the chain's weight, and Le / pdf_w(y) is what a sample of y would
// bring to x_k: Le cos_y / (pdf_a r^2). The number n has no bound but `most_trials`, where the sample counts as lost and is not
// finite, so that it is dropped and told.

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
    /// No scene with more kinds is sampled: the kinds that matter would be found too seldom.
    static constexpr std::size_t most_kinds = 1u << 16;

    struct Kind {
        std::uint32_t light;    ///< index among the scene's lights
        std::uint32_t surface;  ///< index among the surfaces that make chains
        ChainEvents events;
    };
    /// All kinds of chains of at most `longest` vertices are equally likely at each length. The scene must outlive this.
    ChainSampler(const Scene& scene, int longest);

    bool empty() const { return kinds_.empty(); }
    const std::vector<Kind>& kinds() const { return kinds_; }
    int longest() const { return longest_; }
    /// Sets the probabilities of kinds, in proportion to `weights`. Lights without any weight are left to other samples.
    void weigh(const std::vector<double>& weights);
    /// Whether this makes the chains of this length that end on the light.
    bool makes(std::uint32_t light, int length) const {
        return length >= 1 && length <= longest_ && is_made_[light];
    }

    struct Sample {
        LobeValues light;   ///< radiance [W/(sr m^2)] that the hit scatters
        std::size_t kind;
        float q;            ///< probability of the kind
        float hit_moment;   ///< estimate of the mean of light^2 where the bsdf's samples hit the light: light^2 / hit_moment
    };
    /// One sample of the light that reaches the hit, where the walk is, through chains of at most `longest` vertices. Empty if it
    /// found none.
    std::optional<Sample> sample(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local, int longest,
                                 ChainCounts& counts) const;

private:
    struct Surface {
        std::uint32_t shape, instance;
    };
    Vec3 seed_point(const Surface& surface, NumberStream& u) const;
    std::optional<LightSample> light_at(const Chain& chain, std::uint32_t light, const SurfaceGeometry& y) const;

    const Scene& scene_;
    int longest_;
    std::vector<Surface> surfaces_;
    std::vector<std::optional<AreaSampler>> area_;  ///< by shape
    std::vector<Kind> kinds_;
    DiscreteDistribution choice_;
    std::vector<bool> is_made_;  ///< by light
};

}  // namespace gib
