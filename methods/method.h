#pragma once
// The interface of a method: it computes an image of one scene in a sequence of passes, and the image can be taken
// after each pass.

#include "common/core/components.h"
#include "common/images/image.h"
#include "common/images/non_finite.h"
#include "common/scene/effects.h"
#include "methods/parameters.h"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace gib {

/// Wall-clock seconds that a run has spent in each stage of its method ("photon tracing", "eye paths").
class StageTimes {
public:
    /// Adds the time between its construction and its destruction to one stage.
    class Timer {
    public:
        Timer(double& seconds) : seconds_(seconds), start_(std::chrono::steady_clock::now()) {}
        ~Timer() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
        Timer(const Timer&) = delete;
        Timer& operator=(const Timer&) = delete;

    private:
        double& seconds_;
        std::chrono::steady_clock::time_point start_;
    };
    struct Stage {
        std::string name;
        double seconds;
    };

    [[nodiscard]] Timer time(std::string_view stage);
    /// All stages, in the order in which they first ran.
    std::vector<Stage> stages() const;

    /// Is told which fraction of a stage, in [0, 1], is done. It is called from any thread, but never from two at
    /// once, and at most ten times a second.
    using Listener = std::function<void(std::string_view stage, double fraction)>;
    void listen(Listener listener) { listener_ = std::move(listener); }
    void report(std::string_view stage, double fraction) const;

private:
    std::vector<std::unique_ptr<Stage>> stages_;  // by pointer: a Timer refers to the seconds of one
    Listener listener_;
    mutable std::mutex listening_;
    mutable std::chrono::steady_clock::time_point last_report_{};
};

/// Counts the finished part of a stage's work, over all threads, and reports it to the listener.
class StageProgress {
public:
    StageProgress(const StageTimes& stages, std::string_view stage, std::uint64_t total)
        : stages_(stages), stage_(stage), total_(total) {}
    void add(std::uint64_t done) {
        stages_.report(stage_, static_cast<double>(done_ += done) / static_cast<double>(total_));
    }

private:
    const StageTimes& stages_;
    std::string_view stage_;
    std::uint64_t total_;
    std::atomic<std::uint64_t> done_ = 0;
};

/// The steps of a method that run or are skipped for a scene, and the effects of the scene that it does not simulate.
struct Plan {
    struct Step {
        std::string name;
        bool runs;
        std::string reason;  ///< why it is skipped; empty if it runs
    };
    Effects called_for;    ///< the effects that the scene shows
    Effects missing = {};  ///< those of them that the method does not simulate
    /// Components some paths of which the method leaves out in this scene. As a reference it cannot judge them.
    std::vector<Component> unresolved = {};
    std::vector<Step> steps = {};
    /// The method that does the same in this scene; empty: none. A reference then needs only one of the two.
    std::string same_as = {};

    bool runs(std::string_view name) const;
    /// Appends a step, which runs unless there is a reason to skip it.
    void add(std::string_view name, std::string reason) {
        steps.push_back({std::string(name), reason.empty(), std::move(reason)});
    }
    /// Appends a step; `reason` says why it is skipped and is dropped if the step runs.
    void add(std::string_view name, bool is_run, std::string reason) { add(name, is_run ? "" : std::move(reason)); }
};

/// Counts that tables print beside the time.
struct RunCounts {
    std::uint64_t photons = 0;  ///< emitted
    std::uint64_t rays = 0;     ///< closest-hit and shadow rays
    NonFinite non_finite;
};

enum class Progress { more, converged };

enum class PointSet;
struct StoredLight;

/// The computation of one method for one scene and one seed; it is never reused.
class Run {
public:
    virtual ~Run() = default;
    /// Runs one pass; passes are numbered 0, 1, 2, ... in order. A pass is the least work after which
    /// the image is worth measuring.
    virtual Progress advance(std::uint32_t pass) = 0;
    /// The image after the passes so far, as linear radiance [W/(sr m^2)]. It only copies and normalises, so its time
    /// need not be charged to the method.
    virtual ComponentImages image() const = 0;
    virtual RunCounts counts() const = 0;
    /// Further facts about the result so far, as pairs of a name (one word) and a value,
    /// such as `residual` and `5.1e-05`.
    virtual std::vector<std::pair<std::string, std::string>> facts() const { return {}; }
    /// The light that is kept in the scene and not in the image (parts/stored_light/stored_light.h); by default none.
    virtual StoredLight stored_light() const;
};

class Method {
public:
    virtual ~Method() = default;
    virtual Plan plan(const Scene& scene) const = 0;
    /// Makes the preparation (maps, caches, systems of equations) and returns a run. The scene and `stages` must
    /// outlive the run.
    virtual std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const = 0;
};

/// Settings of a method that its label does not give.
struct MethodDefaults {
    int max_edges = std::numeric_limits<int>::max();  ///< edges of the longest path, unless the label gives them
    /// Passes that other runs, of other seeds, have made before: methods whose radius shrinks go on from there.
    std::uint64_t first_pass = 0;
};

/// A method's entry in the registry.
struct MethodDescription {
    std::string name;
    std::string sentence;
    std::vector<Parameter> parameters;  ///< its own, without `spp` and `max_depth`, which every method takes
    Effects simulates;
    std::vector<Component> components;  ///< the components that its images have
    bool unbiased;
    /// Makes the method. `values` have been checked against the declarations.
    std::unique_ptr<Method> (*create)(const ParameterValues& values, const MethodDefaults& defaults);
    /// Values, as in a label, with which a method makes only the paths that an unbiased one cannot sample, so that both
    /// together make all. Empty: there are none.
    struct Remainder {
        std::string values, of_method;
    };
    Remainder remainder = {};
    /// False if its images show something else than radiance; such a method is left
    /// out wherever methods are compared.
    bool estimates_radiance = true;
    /// False if references made of all unbiased methods leave it out. Their shares of the work follow from the variance
    /// that a short pilot shows, which says little where rare starts decide.
    bool makes_references = true;
    /// Time of a ray or camera sample, with all that belongs to it, over that of `path`: the median of five scenes, rounded.
    /// References share their work by it.
    double ray_cost = 1;
    /// Whether each of its samples lights its own pixel alone, by no more than a lamp that the camera sees: pixels are then
    /// independent and samples bounded (energy_test.h). Chains to lights at a point have no bound.
    bool samples_pixels_alone = false;
    bool stores_light = false;  ///< its runs have a stored_light() of their own
};

/// The parameters that every method takes: spp and max_depth.
const std::vector<Parameter>& shared_parameters();
/// The largest number of edges of a path by `max_depth`: 0 in a label means unlimited, and the default holds if the
/// label does not give it.
int max_edges_of(const ParameterValues& values, const MethodDefaults& defaults);
/// The parameter `sampler`: the random numbers of a method's paths.
Parameter point_set_parameter();
PointSet point_set_of(const ParameterValues& values);

/// A plan without steps yet: the effects that the scene calls for, those that are
/// missing, and the unresolved components.
Plan described_plan(const Scene& scene, const MethodDescription& method);
/// A sentence that names the components of which the method leaves out paths; empty if there are none.
std::string incomplete_components(const Plan& plan, const MethodLabel& label);
/// The names, in plans and stages, of the steps that several methods share.
inline constexpr std::string_view step_eye_paths = "eye paths";
inline constexpr std::string_view step_light_sampling = "light sampling";
/// Adds the step of the eye paths, skipped where nothing emits light or no path is allowed.
void add_eye_paths(Plan& plan, const Scene& scene, int max_edges);
/// Adds the step of light sampling, skipped where no light can reach a diffuse or glossy surface or a medium, or
/// where its paths of two edges are longer than allowed.
void add_light_sampling(Plan& plan, int max_edges);

/// Components of a method's images, by whether anything can be seen in them.
struct ShownComponents {
    std::vector<Component> accumulated, black;
};
/// The method's components: those that `effects` can make visible are accumulated, the others stay black.
ShownComponents shown_components(const Scene& scene, const Effects& effects, const MethodDescription& method);

/// All methods, in the order of the list in methods/CMakeLists.txt.
const std::vector<MethodDescription>& method_registry();
/// The names of the methods that estimate radiance.
std::vector<std::string> names_of_comparable_methods();
/// The names of the methods whose runs store light.
std::vector<std::string> names_of_methods_that_store_light();
/// The method of this name. Throws InputError, with a list of the methods, if there is none.
const MethodDescription& find_method(std::string_view name, const SourceLocation& where = {});
/// The method of this name for a measurement. Throws InputError if there is none or if it estimates no radiance.
const MethodDescription& find_comparable_method(std::string_view name, const SourceLocation& where = {});
/// The method's own parameters and the shared ones.
std::vector<Parameter> all_parameters(const MethodDescription& method);

/// A method with the values that its label gives.
struct ConfiguredMethod {
    MethodLabel label;
    const MethodDescription& description;
    ParameterValues values;

    /// Throws InputError at `where` for an unknown method and for parameters that do not fit its declarations.
    explicit ConfiguredMethod(MethodLabel the_label, const SourceLocation& where = {});
    /// Throws InputError for values that do not go together.
    std::unique_ptr<Method> create(const MethodDefaults& defaults) const;
};

}  // namespace gib
