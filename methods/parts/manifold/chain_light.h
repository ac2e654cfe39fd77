#pragma once
// Light that reaches a surface through chains of delta vertices, by specular manifold sampling without bias. Source:
// Zeltner, Georgiev and Jakob 2020, "Specular Manifold Sampling for Rendering High-Frequency Caustics and Glints",
// section 4.
//
// A sample at x draws a light and a point y of it, with the probability q (times the mean number of samples, where there
// are more or fewer than one). Newton's method starts from a direction at x, and leads to one chain or to none.
// 1. If the straight line from x to y crosses smooth surfaces that transmit, and else only what lets light straight on, a
//    chain of as many transmissions is sought from the direction of y (Hanika 2015). Nothing is random in this: the
//    probability is 1.
// 2. With the probability r, others are sought. The kind of the chain is drawn with a probability q_k: the shape of x_1,
//    and the events (reflection, transmission) of 1 to `longest` vertices. r and q_k depend on what lies ahead: the
//    first surface of the straight line, and whether the line has led to a chain. The start is a seed, the ray from x to
//    a uniform point of the shape, or, for half of them, to y, if the line is of another kind. A set of seeds of unknown
//    probability p leads to the same chain. New seeds are drawn until one does; their number n has the mean 1 / p
//    (Zeltner 2020, section 4.3). A chain that the straight line leads to counts only there.
// With n = 1 for the first chain and n / (r q_k) for another,
//     f(wo, w) |cos| T Le n / (q pdf_w(y) |det M|)
// sums to an unbiased estimate of the light of all chains, where T is the chain's weight, and Le / pdf_w(y) is what a
// sample of y would bring to x_k: Le cos_y / (pdf_a r^2).
//
// Samples of the bsdf hit lamps too. Their density over directions at x is pdf_w(w) P, with the probability P of the
// chain's lobes; that of chains is q pdf_w(y) |det M| / n, with r q_k for all chains but the first. The larger of the
// two, with a constant for n, makes the path (Veach 1997, section 9.2, the maximum heuristic): it depends on the path
// alone, so that each path is made once. Without this rule the light of a chain near a focus, where det M is 0, would
// have no bound. The number n has no bound but `most_trials`, where the sample counts as lost and is not finite, so that
// it is dropped and counted.

#include "methods/parts/manifold/specular_chain.h"
#include "methods/parts/transport/path_walk.h"

#include <array>
#include <atomic>

namespace gib {

/// Counts of a run, over all threads.
struct ChainCounts {
    std::atomic<std::uint64_t> chains = 0;  ///< that brought light
    std::atomic<std::uint64_t> trials = 0;  ///< starts of Newton's method
    std::atomic<std::uint64_t> lost = 0;    ///< chains that most_trials did not find again
};

class ChainSampler {
public:
    static constexpr int longest_possible = 8;
    static constexpr std::uint32_t most_trials = 1u << 20;
    /// Time of a ray of Newton's method, with the derivatives at its end, over that of another ray: the mean of six
    /// scenes.
    static constexpr double time_of_chain_ray = 2.5;
    /// No scene with more kinds is sampled: the kinds that matter would be found too seldom.
    static constexpr std::size_t most_kinds = 1u << 16;

    /// All lengths of at most `longest` vertices are equally likely. The scene must outlive this.
    ChainSampler(const Scene& scene, int longest);

    /// Kinds given what lies ahead are numbered from 0, those of one light and one place after each other.
    std::size_t size() const { return scene_.lights().size() * places() * kinds(); }
    /// Kinds of one light.
    std::size_t kinds() const { return surfaces_.size() * kinds_per_surface(); }
    /// The number, among the kinds of a light, of chains that leave this surface towards x; kinds() if it makes none.
    std::size_t find_kind(const SurfaceHit& x_1, const ChainEvents& events) const {
        const std::size_t surface = find_surface(x_1.shape, x_1.instance);
        return surface < surfaces_.size() ? number_of({surface, events}) : kinds();
    }
    /// Number of cases of what lies ahead: nothing, or one of the first surfaces or any other one, where the straight
    /// line leads to a chain or to none.
    std::size_t places() const { return 1 + 2 * std::min(surfaces_.size(), most_surfaces); }
    /// Distributions of kinds, `places()` of each light after each other.
    std::size_t tables() const { return scene_.lights().size() * places(); }
    struct Weights {
        std::vector<double> samples;   ///< mean number at a point, by light; 0: left to other samples
        std::vector<double> searches;  ///< probability that a sample seeks other chains, by table
        std::vector<double> kinds;     ///< by number, in proportion to the probabilities in a table
    };
    /// One sample of each light that chains may bring, and all lengths alike.
    Weights first_weights() const;
    void weigh(const Weights& weights);
    int longest() const { return longest_; }
    double samples() const { return lights_.total(); }
    /// Whether any kind can be drawn.
    bool empty() const { return !(lights_.size() > 0 && lights_.total() > 0); }

    /// The number, among those of the kinds, of the chains that straight lines lead to.
    std::size_t number_of_straight(std::size_t light) const { return size() + light; }

    struct Found {
        LobeValues light;    ///< radiance [W/(sr m^2)] that the hit scatters
        std::size_t number;  ///< of the kind, given what lies ahead
        double q;            ///< mean number of samples of the light and the kind at a point
        double
            hits;  ///< has the mean that luminance^2 of `light` has if samples of the bsdf hit the lamp; 0: they cannot
    };
    struct Spent {
        std::size_t number;  ///< of the light, or behind the lights of the table
        double time;         ///< [rays], divided by the mean number of samples or searches at a point
    };
    struct Sample {
        std::array<std::optional<Found>, 2> found = {};  ///< by the straight line, and by a seed
        std::array<Spent, 2> spent = {};                 ///< on the light's straight lines, and on the table's searches
    };
    /// One sample of the light that reaches the hit, where the walk is, through chains of at most `longest` vertices
    /// that this makes, divided by samples().
    Sample sample(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local, int longest, ChainCounts& counts) const;

    /// Whether this makes the chain from the start, which scatters light from w to wo, to the emitter at y.
    bool makes(PathWalk& walk, ChainStart start, const Vec3& wo_local, const Vec3& w, const ChainEvents& events,
               const SurfaceHit& y) const;

private:
    struct Surface {
        std::uint32_t shape, instance;
    };
    struct Kind {
        std::size_t surface;  ///< of x_1
        ChainEvents events;

        bool operator==(const Kind&) const = default;
    };
    static constexpr std::size_t most_surfaces = 7;  ///< with tables of their own, which bounds their memory
    std::size_t kinds_per_surface() const { return std::size_t{1} << (longest_ + 1); }
    std::size_t number_of(const Kind& kind) const;
    Kind kind_of(std::size_t number) const;
    /// The number of a surface, or of surfaces if it is none.
    std::size_t find_surface(std::uint32_t shape, std::uint32_t instance) const;
    /// The transmissions along the straight line to the end; none if something else lies there, or too many do.
    std::optional<Kind> straight_kind(RayQueries& rays, const SurfaceHit& x, const ChainEnd& end) const;
    /// The kinds' distribution of a light, given the straight kind.
    std::size_t table_of(std::size_t light, const std::optional<Kind>& straight, bool leads_to_chain) const;
    double samples_of(std::size_t light) const { return samples() * double{lights_.probability(light)}; }
    Vec3 seed_point(const Surface& surface, NumberStream& u) const;
    std::optional<LightSample> light_at(const Chain& chain, std::uint32_t light, const SurfaceGeometry& y) const;
    /// The chain with this first surface that Newton's method finds from the seed.
    std::optional<Chain> find(RayQueries& rays, const ChainStart& start, std::size_t surface,
                              const std::optional<Chain>& seed, const ChainEnd& end) const;
    /// The chain that the straight line leads to, if x may receive light from there.
    std::optional<Chain> find_straight(RayQueries& rays, const ChainStart& start, const Vec3& wo_local,
                                       const Kind& kind, const ChainEnd& end) const;
    class Search;

    const Scene& scene_;
    int longest_;
    std::vector<Surface> surfaces_;
    std::vector<std::optional<AreaSampler>> area_;  ///< by shape
    DiscreteDistribution lights_;
    std::vector<double> searches_;             ///< by table
    std::vector<DiscreteDistribution> kinds_;  ///< by table
};

}  // namespace gib
