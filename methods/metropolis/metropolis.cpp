// Metropolis light transport in primary sample space: Markov chains walk through the random numbers of bidirectional path
// tracing, and spend their time where these carry light. Sources: Veach and Guibas 1997, "Metropolis Light Transport"; Kelemen
// et al. 2002, "A Simple and Robust Mutation Strategy for the Metropolis Light Transport Algorithm".
//
// Computes: every component. A state of a chain is a path from the camera and one from a light, joined in all ways; its size f
// is the sum of all light that they carry to the image. Paths of one and two edges are sampled from the camera, with light
// sampling, since chains and light walks gain little there; in media and for pencils of light as bidirectional does.
// Parameters: large_steps is the probability of a step that forgets the state; spp and max_depth as for all methods.
// Bias: none, for paths that bidirectional can sample. Each pass has chains of its own. Independent samples give the mean b of
// f, and the chains start at some of these, chosen in proportion to f. Whatever the number of steps, b times the mean of h / f
// over a chain's states then has the expected value of h (Veach 1997, section 11.3.1): there is no start-up bias, and
// passes are independent.
// A pass: for every pixel one sample of up to two edges, one step of a chain and one independent sample.
// Noise: neighbouring pixels share the states of a chain, so noise has blobs, and the brightness of a feature that few
// chains find is uncertain as a whole.
// Fails: never; non-finite samples are counted and dropped.
#include "common/core/parallel.h"
#include "common/scene/scene.h"
#include "methods/metropolis/primary_sample.h"
#include "methods/parts/transport/delta_paths.h"
#include "methods/parts/vertices/joined_paths.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>

namespace gib {

namespace {

constexpr std::string_view step_chains = "chains";
constexpr std::uint32_t choices_of_step = 0x30000000;  // dimension of a step's size and acceptance; no vertex has it
constexpr int shortest = 3;                            // edges of the chains' shortest paths
// The steps of a chain in a pass, at most. 256 and 2,304 steps were equally good on cornell-glass, door-ajar and lamp-in-glass.
constexpr std::size_t steps_of_chain = 256;

struct Settings {
    double large_steps;
    int max_edges;
};

/// Paths of one and two edges: between surfaces, light sampling finds them as well without light walks, in half of the time.
/// Only light in media and of pencils needs the walks.
PathRules short_paths(const Scene& scene, const Effects& called_for, const Settings& settings) {
    const bool needs_walks =
        scene.has_media() || !components_of_pencils(scene, called_for, {Component::direct}).empty();
    return {.max_edges = std::min(settings.max_edges, shortest - 1), .follows_light = needs_walks};
}

/// The light that the paths of one state give to pixels: radiance [W/(sr m^2)] times the number of pixels.
struct State {
    std::vector<std::pair<std::size_t, PixelSample>> light;
    double size = 0;         ///< the sum over all pixels, components and channels, which chains sample
    double independent = 0;  ///< 1 if it counts as an independent sample
    double visits = 0;       ///< how often its chain has been in it, as an expected value
};

/// Makes the states of one thread at a time.
class StateMaker {
public:
    StateMaker(const Scene& scene, const JoinedPaths<NoMerging>& joined, const Pass& pass, SplatFilm& film)
        : rays_(scene),
          paths_(joined.paths),
          pass_(pass),
          film_(film),
          estimate_(joined, pass,
                    [this](std::size_t pixel, const PixelSample& light) { state_->light.emplace_back(pixel, light); }) {
    }

    std::uint64_t rays() const { return rays_.count(); }

    void make(const Sampler& sampler, State& state) {
        const Sensor& sensor = rays_.scene().sensor();
        const auto [film, lens, stratum] = sampler.at_start();
        const Vec2 place(film.x() * static_cast<float>(sensor.width()), film.y() * static_cast<float>(sensor.height()));
        const int x = std::min(static_cast<int>(place.x()), sensor.width() - 1);
        const int y = std::min(static_cast<int>(place.y()), sensor.height() - 1);
        const Vec2 in_pixel(place.x() - static_cast<float>(x), place.y() - static_cast<float>(y));
        std::array<Ray, 1> ray = {sensor.generate_ray(x, y, in_pixel, lens)};
        std::array<std::optional<Intersection>, 1> found;
        rays_.trace_from_camera(ray, found);
        const auto pixel = static_cast<std::size_t>(y * sensor.width() + x);

        state.light.clear();
        state_ = &state;
        PixelSample seen = estimate_(rays_, {ray[0], found[0], sensor.hides_emitters()}, sampler, pixel);
        for (Color& part : seen.parts)
            part *= static_cast<float>(paths_.count);
        state.light.emplace_back(pixel, seen);
        state.size = state.independent = state.visits = 0;
        PixelSample lost;
        for (const auto& [to, light] : state.light)
            for (std::size_t c = 0; c < light.parts.size(); ++c) {
                state.size += double{light.parts[c].sum()};
                if (!light.parts[c].isFinite().all()) lost.parts[c] = light.parts[c];
            }
        if (std::isfinite(state.size)) return;
        film_.add(pixel, pass_.number, lost);  // counts and drops what is not finite
        state = {};
    }

private:
    RayQueries rays_;
    const LightPaths& paths_;
    const Pass& pass_;
    SplatFilm& film_;
    State* state_ = nullptr;  ///< that is being made
    JoinedPathsEstimate<NoMerging> estimate_;
};

/// A thread makes its states with this. It keeps its memory, so that steps allocate none.
struct Worker {
    StateMaker maker;
    PrimarySample sample = {};
    State now = {}, next = {};
};

class MetropolisRun final : public Run {
public:
    MetropolisRun(const Scene& scene, const Settings& settings, const Plan& plan, std::unique_ptr<Run> short_paths,
                  const ShownComponents& shown, std::uint64_t seed, StageTimes& stages)
        : scene_(scene),
          large_steps_(settings.large_steps),
          seed_(seed),
          stages_(stages),
          runs_(plan.runs(step_chains)),
          short_paths_(std::move(short_paths)),
          light_paths_(scene, plan, stages),
          film_(scene.sensor().width(), scene.sensor().height(), shown.accumulated, light_paths_.sum_unit),
          joined_{light_paths_,
                  {.max_edges = settings.max_edges,
                   .light_sampling = plan.runs(step_light_sampling),
                   .min_edges = shortest},
                  film_,
                  no_merging_} {
        const auto pixels = static_cast<std::size_t>(light_paths_.count);
        chains_ = (pixels + steps_of_chain - 1) / steps_of_chain;
        steps_ = (pixels + chains_ - 1) / chains_;
        starts_ = pixels;
        if (runs_) expected_mean_ = mean_of(sample_starts(combine_keys(seed, 1), false));
    }

    Progress advance(std::uint32_t pass) override {
        passes_ = pass + 1;
        const Progress progress = short_paths_->advance(pass);
        if (!runs_) return progress;
        pass_.number = pass;
        const auto timer = stages_.time(step_chains);
        const std::uint64_t key = combine_keys(seed_, std::uint64_t{pass} + 2);
        const std::vector<double> sizes = sample_starts(key, true);
        const double mean = mean_of(sizes);
        follow_chains(key, sizes, mean);
        sum_of_means_ += mean;
        if (sum_of_means_ > 0) expected_mean_ = sum_of_means_ / passes_;
        return Progress::more;
    }

    ComponentImages image() const override {
        ComponentImages images = short_paths_->image();
        film_.add_mean(light_paths_.count * passes_, images);
        return images;
    }
    RunCounts counts() const override {
        RunCounts counts = short_paths_->counts();
        for (const auto& worker : idle_)
            counts.rays += worker->maker.rays();
        counts.non_finite = counts.non_finite + film_.non_finite();
        return counts;
    }

private:
    static double mean_of(const std::vector<double>& sizes) {
        return std::accumulate(sizes.begin(), sizes.end(), 0.) / static_cast<double>(sizes.size());
    }
    /// The numbers of independent sample i of a pass, or, for n > 0, fresh ones for a step of a chain that starts with them.
    static Sampler numbers(std::uint64_t pass_key, std::size_t i, std::size_t n = 0) {
        return Sampler(PointSet::independent, pass_key, i, static_cast<std::uint32_t>(n));
    }

    /// The sizes of independent states, among which the chains find their starts. Their light goes to the film, if it counts.
    std::vector<double> sample_starts(std::uint64_t key, bool counts) {
        std::vector<double> sizes(starts_);
        parallel_blocks(starts_, 256, [&](std::size_t begin, std::size_t end, std::size_t) {
            auto worker = take_worker();
            State& state = worker->now;
            for (std::size_t i = begin; i < end; ++i) {
                worker->maker.make(numbers(key, i), state);
                sizes[i] = state.size;
                state.independent = 1;
                if (counts) splat(state, 0);
            }
            give_back(std::move(worker));
        });
        return sizes;
    }

    std::unique_ptr<Worker> take_worker() {
        const std::lock_guard lock(idle_access_);
        if (idle_.empty()) return std::unique_ptr<Worker>(new Worker{{scene_, joined_, pass_, film_}});
        auto worker = std::move(idle_.back());
        idle_.pop_back();
        return worker;
    }
    void give_back(std::unique_ptr<Worker> worker) {
        const std::lock_guard lock(idle_access_);
        idle_.push_back(std::move(worker));
    }

    /// Chains of equal length start at places that divide the sum of all sizes, whose mean is `mean`, evenly.
    void follow_chains(std::uint64_t key, const std::vector<double>& sizes, double mean) {
        std::vector<double> cumulative(sizes.size());
        std::partial_sum(sizes.begin(), sizes.end(), cumulative.begin());
        const double offset = double{Sampler(PointSet::independent, key, 1, 0).get_1d(0)};
        StageProgress progress(stages_, step_chains, chains_);
        parallel_blocks(chains_, 1, [&](std::size_t chain, std::size_t, std::size_t) {
            const double at = (static_cast<double>(chain) + offset) / static_cast<double>(chains_) * cumulative.back();
            const auto start =
                std::min(std::upper_bound(cumulative.begin(), cumulative.end(), at), cumulative.end() - 1);
            auto worker = take_worker();
            follow_chain(*worker, key, static_cast<std::size_t>(start - cumulative.begin()), chain, mean);
            give_back(std::move(worker));
            progress.add(1);
        });
    }

    /// One chain: its states and its proposals, each weighed by the probability that the chain takes it (Veach 1997, section
    /// 11.3.2). `mean` is b of this pass. If it is 0, the states have no weight, but the large steps still count as independent
    /// samples, whose number must not depend on what the others found.
    void follow_chain(Worker& worker, std::uint64_t key, std::size_t first, std::size_t chain, double mean) {
        auto& [maker, sample, now, next] = worker;
        sample.restart();
        maker.make(Sampler(sample, numbers(key, first)), now);
        sample.accept();
        for (std::uint32_t step = 0; step < steps_; ++step) {
            const Sampler fresh = numbers(key, first, chain * steps_ + step + 1);
            const Vec2 u = fresh.get_2d(choices_of_step);
            const bool is_large = double{u.x()} < large_steps_;
            sample.propose(is_large);
            maker.make(Sampler(sample, fresh), next);
            const double acceptance = next.size < now.size ? next.size / now.size : 1;
            next.independent = is_large ? 1 : 0;
            next.visits = acceptance;
            now.visits += 1 - acceptance;
            if (double{u.y()} < acceptance) {
                std::swap(now, next);
                sample.accept();
            } else {
                sample.reject();
            }
            splat(next, mean);  // where the chain does not stay
        }
        splat(now, mean);
    }

    // Two kinds of samples make each state, N independent ones of density 1 and M states of chains of density f / b. The balance
    // heuristic weighs them (Kelemen et al. 2002, section 5), so that chains do not have to visit what is dim. Instead of b,
    // which belongs to the samples themselves, the weights have its estimate from earlier ones. The weights of a pass are constants
    // for its own samples, and their sum is 1 at every state, so that no estimate of b, however wrong, biases the image. While no
    // earlier sample has found light, the independent ones make all of it.
    double samples_at(double size) const {
        const auto states = static_cast<double>(chains_ * steps_);
        const double of_chains = expected_mean_ > 0 ? states * size / expected_mean_ : 0;
        return static_cast<double>(starts_) + large_steps_ * states + of_chains;
    }
    void splat(const State& state, double mean) {
        const double of_chain = expected_mean_ > 0 ? state.visits * mean / expected_mean_ : 0;
        const double factor = light_paths_.count / samples_at(state.size) * (state.independent + of_chain);
        if (!(factor > 0) || !(state.size > 0)) return;
        for (const auto& [pixel, light] : state.light) {
            PixelSample scaled;
            for (std::size_t c = 0; c < light.parts.size(); ++c)
                scaled.parts[c] = static_cast<float>(factor) * light.parts[c];
            film_.add(pixel, pass_.number, scaled);
        }
    }

    const Scene& scene_;
    double large_steps_;
    std::uint64_t seed_;
    StageTimes& stages_;
    bool runs_;
    std::unique_ptr<Run> short_paths_;
    LightPaths light_paths_;
    SplatFilm film_;
    NoMerging no_merging_;
    JoinedPaths<NoMerging> joined_;
    Pass pass_{};
    std::size_t chains_, steps_, starts_;          ///< of a pass; steps are those of one chain
    double expected_mean_ = 1, sum_of_means_ = 0;  ///< estimate of b, 0 if no light is known; its sum over passes
    std::vector<std::unique_ptr<Worker>> idle_;
    std::mutex idle_access_;
    std::uint32_t passes_ = 0;
};

class Metropolis final : public Method {
public:
    explicit Metropolis(const Settings& settings) : settings_(settings) {}

    Plan plan(const Scene& scene) const override {
        Plan plan = described_plan(scene, find_method("metropolis"));
        leave_out(plan, components_of_delta_paths(scene, plan.called_for));
        leave_out(plan, components_of_mirrored_pencils(scene, plan.called_for));
        add_joined_paths(plan, scene, {.max_edges = settings_.max_edges});
        const bool follows = plan.runs(step_light_paths);
        plan.add(step_chains, follows && settings_.max_edges >= shortest,
                 follows ? "chains make paths of three edges and more, which max_depth does not allow"
                         : "no light paths are followed");
        return plan;
    }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        const Plan planned = plan(scene);
        const ShownComponents shown = shown_components(scene, planned.called_for, find_method("metropolis"));
        Plan of_short_paths = described_plan(scene, find_method("metropolis"));
        const PathRules rules = short_paths(scene, planned.called_for, settings_);
        add_joined_paths(of_short_paths, scene, rules);
        auto short_run = start_joined_paths(scene, rules, {}, of_short_paths, shown, seed, stages);
        return std::make_unique<MetropolisRun>(scene, settings_, planned, std::move(short_run), shown, seed, stages);
    }

private:
    Settings settings_;
};

}  // namespace

MethodDescription describe_metropolis() {
    return {
        .name = "metropolis",
        .sentence = "Markov chains through bidirectional paths: unbiased, stays where it has found light",
        .parameters = {number_parameter("large_steps", "0.5", "", 0.01, 1,
                                        "probability of a step that draws all numbers anew")},
        .simulates = Effects::all(),
        .components = {all_components.begin(), all_components.end()},
        .unbiased = true,
        .create = [](const ParameterValues& values, const MethodDefaults& defaults) -> std::unique_ptr<Method> {
            return std::make_unique<Metropolis>(Settings{values.number("large_steps"), max_edges_of(values, defaults)});
        },
        .makes_references = false,
    };
}

}  // namespace gib
