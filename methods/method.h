#pragma once
// What every method is: a sequence of passes over one scene, whose image can be taken after each of them.

#include "common/core/components.h"
#include "common/images/film.h"
#include "common/images/image.h"
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

/// Wall-clock seconds by part of a method.
class StageTimes {
public:
    /// Adds the time until it is destroyed to its stage.
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
    /// In the order in which they first ran.
    std::vector<Stage> stages() const;

    /// Hears how far a stage has come, in [0, 1]: from any thread, never from two at once, ten times a second at most.
    using Listener = std::function<void(std::string_view stage, double fraction)>;
    void listen(Listener listener) { listener_ = std::move(listener); }
    void report(std::string_view stage, double fraction) const;

private:
    std::vector<std::unique_ptr<Stage>> stages_;  // a Timer holds a pointer into one
    Listener listener_;
    mutable std::mutex listening_;
    mutable std::chrono::steady_clock::time_point last_report_{};
};

/// How much of a stage's work is done, counted by the threads that do it.
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

/// What a method does for a scene: its passes, run or skipped, and what it leaves out.
struct Plan {
    struct Step {
        std::string pass;
        bool runs;
        std::string reason;  ///< why it is skipped
    };
    Effects called_for;
    Effects missing;  ///< called for, and not simulated by the method
    /// Components with paths that the method leaves out here; as a reference it cannot judge them.
    std::vector<Component> unresolved;
    std::vector<Step> steps;

    bool runs(std::string_view pass) const;
    /// Appends a step; `reason` is why it is skipped where it is.
    void add(std::string pass, bool is_run, std::string reason) {
        steps.push_back({std::move(pass), is_run, is_run ? std::string() : std::move(reason)});
    }
};

/// Counts that belong in tables beside the time.
struct RunCounts {
    std::uint64_t photons = 0;  ///< emitted
    std::uint64_t rays = 0;     ///< closest-hit and shadow rays
    NonFinite non_finite;
};

enum class Progress { more, converged };

/// One seed's computation; never reused.
class Run {
public:
    virtual ~Run() = default;
    /// The pass with this number (0, 1, 2, ... in order): the least work that leaves an image worth measuring.
    virtual Progress advance(std::uint32_t pass) = 0;
    /// Linear radiance after the passes so far; copies and normalises only, so that it need not be charged.
    virtual ComponentImages image() const = 0;
    virtual RunCounts counts() const = 0;
    /// What else a user should know of the result so far, by name: `residual`, `5.1e-05`. Names are single words.
    virtual std::vector<std::pair<std::string, std::string>> facts() const { return {}; }
};

class Method {
public:
    virtual ~Method() = default;
    virtual Plan plan(const Scene& scene) const = 0;
    /// Does the preparation (maps, caches, systems). The scene and `stages` outlive the run.
    virtual std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const = 0;
};

/// What the scene file or the experiment decides where a label does not.
struct MethodDefaults {
    int max_edges = std::numeric_limits<int>::max();  ///< edges of the longest path
};

/// A method as the registry has it.
struct MethodDescription {
    std::string name;
    std::string sentence;
    std::vector<Parameter> parameters;  ///< its own; every method takes `spp` and `max_depth` besides
    Effects simulates;
    std::vector<Component> components;  ///< that its images have
    bool unbiased;
    /// `values` were checked against the declarations.
    std::unique_ptr<Method> (*create)(const ParameterValues& values, const MethodDefaults& defaults);
    /// False: its images show something else, and it is left out wherever methods are compared.
    bool estimates_radiance = true;
};

/// The parameters that every method takes: spp and max_depth.
const std::vector<Parameter>& shared_parameters();
/// max_depth as edges: 0 in a label means unlimited, absent means the default.
int max_edges_of(const ParameterValues& values, const MethodDefaults& defaults);

/// The plan of a method before its steps: what the scene calls for, and what of it is missing.
Plan described_plan(const Scene& scene, const MethodDescription& method);
/// The passes that methods share, by their names in plans and stages.
inline constexpr std::string_view pass_eye_paths = "eye paths";
inline constexpr std::string_view pass_light_sampling = "light sampling";
/// Skipped where nothing emits light, or where no path is allowed.
void add_eye_paths(Plan& plan, const Scene& scene, int max_edges);
/// Skipped where no light can reach a diffuse surface, or where its two edges are too many.
void add_light_sampling(Plan& plan, int max_edges);

/// A film for the method's components: those that `effects` can show are accumulated, the rest stay black.
Film film_for(const Scene& scene, const Effects& effects, const MethodDescription& method);

/// All methods, in the order of the list in methods/CMakeLists.txt.
const std::vector<MethodDescription>& method_registry();
/// Those that estimate radiance.
std::vector<std::string> names_of_comparable_methods();
/// Throws InputError that lists the known methods.
const MethodDescription& find_method(std::string_view name, const SourceLocation& where = {});
/// The same for a method that is to be measured; throws InputError if it estimates no radiance.
const MethodDescription& find_comparable_method(std::string_view name, const SourceLocation& where = {});
/// The method's own and the shared parameters.
std::vector<Parameter> all_parameters(const MethodDescription& method);

}  // namespace gib
