// Path guiding: path tracing that learns where light comes from, and sends its paths there. Sources: Mueller, Gross and Novak
// 2017, "Practical Path Guiding for Efficient Light-Transport Simulation"; Mueller 2019, "Practical Path Guiding in Production".
//
// Computes: every component, by the paths of `path`. At surfaces and in media a field of incident radiance, which earlier passes
// have learned, proposes directions beside the bsdf or phase function. Where it knows of little concentrated light, and in the
// first iterations, most passes are path tracing.
// Parameters: memory of the field [MiB]; sampler, spp and max_depth as for all methods.
// Bias: none, for paths that `path` can sample: the samples of a pass are drawn by what earlier passes have learned, and the
// weights of passes are constants.
// A pass: one sample of every pixel. Iteration k has 2^k passes; the field changes between iterations only.
// Noise: that of `path` in the first passes; where light comes from few directions it becomes far less.
// Fails: never; non-finite samples are counted and dropped. Light that no path has found yet, such as that of a tiny gap, is as
// noisy as that of `path`.
#include "common/scene/scene.h"
#include "methods/guided_path/guided_directions.h"
#include "methods/parts/transport/delta_paths.h"
#include "methods/parts/transport/pixel_samples.h"
#include "methods/parts/transport/trace_path.h"

#include <bit>
#include <cmath>

namespace gib {

namespace {

// A leaf of the tree over space is cut if more than this number of paths, times the square root of the passes that the field
// learns from, have visited it (Mueller 2017, section 3.3, has 12,000 and larger images).
constexpr double crowd = 400;
// Paths from which an iteration learns, at most about: if it follows the field, and if they only see whether that would pay.
constexpr double enough_paths = 0x1p19, enough_looks = 0x1p13;
// Images of more pixels do not follow the field in the iterations before the ninth: it does not pay for its time yet. These
// iterations learn from this share of their paths, or from `enough_looks`.
constexpr std::size_t many_pixels = 0x1p13;
constexpr double first_share = 1. / 64;
constexpr std::uint32_t lesson = 0x30000000;  // dimension of the choice to learn from a path; no vertex has it
// The field pays if at least this share of the paths comes to concentrated light.
constexpr double share_that_pays = 0.1;

constexpr std::string_view step_learning = "learning";

struct Settings {
    PointSet points;
    double memory;  ///< [MiB]
    int max_edges;
};

/// A power of two near the radiance [W/(sr m^2)] of a diffuse ball around the scene that gives off the light of its lights.
double typical_radiance(const Scene& scene) {
    const double power = scene.emitted_power().maxCoeff();
    const double radiance = power / (4 * std::numbers::pi * BoundingSphere(scene.bounds()).area());
    return std::isfinite(radiance) && radiance > 0 ? std::exp2(std::round(std::log2(radiance))) : 1;
}

class GuidedPathRun final : public Run {
public:
    GuidedPathRun(const Scene& scene, const Settings& settings, const Plan& plan, const ShownComponents& shown,
                  std::uint64_t seed, StageTimes& stages)
        : scene_(scene),
          points_(settings.points),
          max_edges_(settings.max_edges),
          light_sampling_(plan.runs(step_light_sampling)),
          seed_(seed),
          stages_(stages),
          runs_(plan.runs(step_eye_paths)),
          learns_(plan.runs(step_learning)),
          pixels_(static_cast<std::size_t>(scene.sensor().width()) * static_cast<std::size_t>(scene.sensor().height())),
          first_guided_(pixels_ > many_pixels ? 9 : 0),
          film_(scene.sensor().width(), scene.sensor().height(), shown.accumulated, shown.black),
          field_(scene.bounds(), typical_radiance(scene), settings.memory * 0x1p20) {}

    Progress advance(std::uint32_t pass) override {
        passes_ = pass + 1;
        const std::uint32_t iteration = std::bit_width(passes_) - 1, weight = weight_of(iteration);
        weights_ += weight;
        if (!runs_) return Progress::converged;
        if (learns_ && pass > 0 && std::has_single_bit(passes_)) {
            const auto timer = stages_.time(step_learning);
            field_.learn(crowd * std::sqrt(std::exp2(iteration - 1) * double{share_of_lessons(iteration - 1)}));
        }
        const float lessons = learns_ ? share_of_lessons(iteration) : 0;
        const bool guided = is_guided(iteration);
        rays_ += sample_pixels(scene_, film_, points_, seed_, pass, stages_, step_eye_paths, [=, this] {
            return [=, this, directions = GuidedDirections(field_)](RayQueries& rays, const TracedRay& eye,
                                                                    const Sampler& sampler) mutable {
                const bool tells = sampler.get_1d(lesson) < lessons;
                directions.start();
                PixelSample sample = tells || guided
                                         ? trace_path_in(directions, rays, eye, sampler, max_edges_, light_sampling_)
                                         : trace_path(rays, eye, sampler, {max_edges_, light_sampling_});
                if (tells) directions.tell(field_, sampler);
                if (weight == 1) return sample;
                for (Color& part : sample.parts)
                    part *= static_cast<float>(weight);
                return sample;
            };
        });
        return Progress::more;
    }

    ComponentImages image() const override { return film_.mean(weights_); }
    RunCounts counts() const override { return {0, rays_, film_.non_finite()}; }
    std::vector<std::pair<std::string, std::string>> facts() const override {
        return {{"cells", std::to_string(field_.leaf_count())},
                {"quadtree_nodes", std::to_string(field_.node_count())},
                {"guided", pays() ? "yes" : "no (few paths come to concentrated light, so passes are path tracing)"}};
    }

private:
    bool pays() const { return field_.concentrated_share() >= share_that_pays; }
    bool is_guided(std::uint32_t iteration) const { return iteration >= first_guided_ && pays(); }
    /// The share of the paths of an iteration from which the field learns: more paths add little to what it knows, and take time.
    float share_of_lessons(std::uint32_t iteration) const {
        const double paths = std::exp2(iteration) * static_cast<double>(pixels_);
        const double share = (is_guided(iteration) ? enough_paths : enough_looks) / paths;
        return static_cast<float>(std::min(iteration < first_guided_ ? std::max(share, first_share) : share, 1.));
    }
    /// The weight of a pass, a power of two near 2^(k / 2) for iteration k of those that may follow the field. Later passes have
    /// learned more. Weights by the variances that the passes show, as of Mueller 2019, depend on the samples that they weigh, and
    /// bias the image.
    std::uint32_t weight_of(std::uint32_t iteration) const {
        return 1u << std::min((std::max(iteration, first_guided_) - first_guided_) / 2, 10u);
    }

    const Scene& scene_;
    PointSet points_;
    int max_edges_;
    bool light_sampling_;
    std::uint64_t seed_;
    StageTimes& stages_;
    bool runs_, learns_;
    std::size_t pixels_;
    std::uint32_t first_guided_;  ///< iteration
    Film film_;
    RadianceField field_;
    std::uint64_t rays_ = 0;
    std::uint32_t passes_ = 0;
    std::uint64_t weights_ = 0;  ///< sum of the weights of all passes
};

class GuidedPath final : public Method {
public:
    explicit GuidedPath(const Settings& settings) : settings_(settings) {}

    Plan plan(const Scene& scene) const override {
        Plan plan = described_plan(scene, find_method("guided_path"));
        leave_out_of_camera_paths(plan, scene);
        add_eye_paths(plan, scene, settings_.max_edges);
        add_light_sampling(plan, settings_.max_edges);
        plan.add(step_learning, plan.runs(step_eye_paths) && settings_.max_edges >= 2,
                 plan.runs(step_eye_paths)
                     ? "directions are chosen by paths of two edges, which max_depth does not allow"
                     : "no eye paths are followed");
        return plan;
    }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        const Plan planned = plan(scene);
        return std::make_unique<GuidedPathRun>(scene, settings_, planned,
                                               shown_components(scene, planned.called_for, find_method("guided_path")),
                                               seed, stages);
    }

private:
    Settings settings_;
};

}  // namespace

MethodDescription describe_guided_path() {
    return {
        .name = "guided_path",
        .sentence = "path tracing that learns where light comes from: unbiased, finds light behind doors",
        .parameters = {number_parameter("memory", "64", "MiB", 1, 65536, "memory of the radiance field, at most"),
                       point_set_parameter()},
        .simulates = Effects::all(),
        .components = {all_components.begin(), all_components.end()},
        .unbiased = true,
        .create = [](const ParameterValues& values, const MethodDefaults& defaults) -> std::unique_ptr<Method> {
            if (values.text("filter") != "none")
                throw InputError(
                    "a filter takes two halves of the passes: those of guided_path have weights and make no halves");
            return std::make_unique<GuidedPath>(
                Settings{point_set_of(values), values.number("memory"), max_edges_of(values, defaults)});
        },
        // A short pilot shows the variance before the field has learned, and batches with seeds of their own forget it: tried, it
        // made references no sooner, and made the pilots of all makers shorter (experiments/STUDIES.md).
        .makes_references = false,
        .ray_cost = 2,
        .samples_pixels_alone = true,
    };
}

}  // namespace gib
