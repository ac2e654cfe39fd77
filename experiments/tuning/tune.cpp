// The time of a tuning is divided among reference, search and final runs. What one part leaves goes to the next one.
#include "experiments/tuning/tune.h"

#include "common/core/nearest_word.h"
#include "common/core/reject.h"
#include "experiments/metrics/epsilon.h"
#include "experiments/run/run_experiment.h"
#include "experiments/system/interrupt.h"
#include "experiments/tuning/tuning_result.h"
#include "experiments/tuning/tuning_runs.h"
#include "methods/method.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <set>

namespace gib {

namespace {

/// Shares of the whole time: of the reference, and of a reference whose noise still hides the target. The search has
/// its share of what the reference leaves, or would leave if it took all of its time.
constexpr double reference_share = 0.25, latest_reference_share = 0.5, search_share = 0.6;

/// Each round of the search has the next seed from the first one on, because the best of many settings is partly the
/// luckiest with the seed that chose it. The final runs have fresh seeds, 1 to final_seeds. Their budgets leave time
/// for at least fewest_seeds.
constexpr std::uint64_t first_search_seed = 1001, final_seeds = 5, fewest_seeds = 3;
/// Share of the search's time for the charged seconds of its runs; the rest is for processes, loading and comparison.
/// The settings of the first round are the cover.
constexpr double charged_share = 0.6, first_round_end = 0.7;
/// Final runs may take this many times the expected time to the target, because seeds and the load of the machine
/// differ.
constexpr double ample = 2;
/// The shortest budget of a final run [s]: a machine that halts a process for some milliseconds must not end it before
/// the target.
constexpr double shortest_final = 0.1;

/// The methods that are searched. Throws InputError if a label or a variation is wrong.
std::vector<SearchSpace> asked_spaces(const TuneFile& file) {
    std::vector<Variation> variations;
    for (const auto& [text, where] : file.variations)
        variations.push_back(parse_variation(text, where));
    std::vector<SearchSpace> spaces;
    std::set<std::string> parameters;
    for (const auto& text : file.methods.empty() ? names_of_comparable_methods() : file.methods) {
        const ConfiguredMethod method(MethodLabel::parse(text));
        for (const auto& name : names_of(find_comparable_method(method.label.name).parameters))
            parameters.insert(name);
        spaces.emplace_back(method.label, tuning_axes(method.label, variations));
    }
    for (const Variation& variation : variations)
        if (parameters.count(variation.parameter) == 0)
            reject(variation.where, "{}: no method here has a parameter '{}'{} There are: {}", variation.source(),
                   variation.parameter,
                   did_you_mean_or_stop(variation.parameter, {parameters.begin(), parameters.end()}),
                   fmt::join(parameters, ", "));
    return spaces;
}

std::vector<MethodLabel> bases_of(const std::vector<SearchSpace>& spaces) {
    std::vector<MethodLabel> bases;
    for (const SearchSpace& space : spaces)
        bases.push_back(space.base());
    return bases;
}

class Tuning {
public:
    Tuning(const std::vector<SearchSpace>& spaces, const TuneFile& file, const ExperimentScene& scene,
           const RunOptions& options)
        : target_(parse_target(file.target)), runs_(file, scene, options, bases_of(spaces)) {
        result_ = {.scene = scene.name, .target = file.target, .minutes = file.minutes};
        for (const SearchSpace& space : spaces)
            result_.methods.push_back({space, runs_.is_unbiased(space.base()), runs_.left_out(space.base())});
    }

    int run(std::ostream& out) {
        const std::string words = runs_.make_reference(reference_share * seconds(), latest_reference_share * seconds());
        if (!words.empty()) {
            std::cerr << words << "\n";
            return exit_failed;
        }
        const double left = std::min(1 - reference_share, 1 - runs_.used() / seconds());
        for (std::size_t m = 0; m < result_.methods.size(); ++m)
            search_method(m, search_share * left * seconds());
        std::ranges::stable_sort(result_.finals, {}, &FinalSetting::budget);
        measure_finals();
        result_.used_seconds = runs_.used();
        const std::string report = runs_.write_results(tuning_json(result_));
        if (!result_.best()) std::cerr << fmt::format("no method is known to have reached {}\n", result_.target);
        std::cerr << fmt::format("Report: {}\n", report);
        out << tuning_text(result_);
        return result_.best() ? 0 : exit_failed;
    }

private:
    double seconds() const { return 60 * result_.minutes; }
    /// Time that each method can have for a final run if two methods share what the search leaves [s].
    double horizon() const { return (1 - reference_share) * (1 - search_share) * seconds() / (2 * fewest_seeds); }
    static double weight(const TunedMethod& method) {
        return static_cast<double>(1 + settings_per_axis * method.space.axes().size());
    }

    void search_method(std::size_t m, double seconds_of_all) {
        TunedMethod& method = result_.methods[m];
        double all = 0;
        for (const TunedMethod& other : result_.methods)
            all += weight(other);
        const double share = seconds_of_all * weight(method) / all, begin = runs_.used();
        const auto measure = [&](const auto& settings, std::uint64_t round, double budget) {
            std::vector<TuningRuns::Wanted> wanted;
            for (const Setting& setting : settings)
                wanted.push_back({method.space.label(setting), first_search_seed + round, budget});
            std::vector<std::optional<TimeEstimate>> times;
            const auto runs = runs_.measured(wanted, begin + (round == 0 ? first_round_end : 1) * share);
            for (std::size_t i = 0; i < runs.size(); ++i) {
                const auto& [cell, is_left_out] = runs[i];
                if (cell) times.push_back(estimated_time(*cell, target_, horizon()));
                else times.push_back(is_left_out ? std::nullopt : std::optional(TimeEstimate{}));
                if (cell) searched_[wanted[i].label.text()] = *cell;
            }
            return times;
        };
        const SearchOutcome found = search(method.space, charged_share * share, measure);
        method.trials = found.trials;
        if (method.trials.empty()) method.trials.push_back({method.space.defaults(), {}});
        const Trial& best = method.trials.front();
        result_.finals.push_back(
            {.method = m, .setting = best.setting, .is_best = true, .budget = ample * best.time.cost()});
        if (found.is_cut)
            result_.notes.push_back(
                fmt::format("the search among settings of {} ended early", method.space.base().text()));
    }

    /// The budgets of the final runs: each method, the most promising first, has what it needs, but at most half of
    /// what is left; the last one may have all. The defaults of a method have the budget of its best settings, and come
    /// last.
    void plan_finals() {
        double left = std::max(0.0, seconds() - runs_.used()) / fewest_seeds;
        const std::size_t bests = result_.finals.size();
        for (std::size_t i = 0; i < bests; ++i) {
            FinalSetting& f = result_.finals[i];
            f.budget = std::min(f.budget, i + 1 < bests ? left / 2 : left);
            left -= f.budget;
            const Setting defaults = result_.methods[f.method].space.defaults();
            if (defaults != f.setting)
                result_.finals.push_back({.method = f.method, .setting = defaults, .budget = f.budget});
        }
    }

    void measure_finals() {
        const std::size_t bests = result_.finals.size();
        plan_finals();
        std::vector<MethodLabel> labels;
        std::vector<double> budgets;
        for (const FinalSetting& f : result_.finals) {
            labels.push_back(result_.label(f));
            budgets.push_back(std::max(f.budget, shortest_final));
        }
        runs_.begin_experiment(labels, budgets, final_seeds);
        std::vector<std::vector<Cell>> cells(labels.size());
        std::vector<std::pair<std::size_t, std::uint64_t>> order;  // setting, seed
        for (std::uint64_t seed = 1; seed <= final_seeds; ++seed)
            for (std::size_t i = 0; i < labels.size(); ++i)
                order.emplace_back(i, seed);
        std::ranges::stable_sort(order, {}, [&](const auto& run) { return run.first >= bests; });
        std::vector<TuningRuns::Wanted> wanted;
        for (const auto& [i, seed] : order)
            wanted.push_back({labels[i], seed, budgets[i]});
        bool is_cut = false;
        const auto runs = runs_.measured(wanted, seconds());
        for (std::size_t n = 0; n < runs.size(); ++n) {
            if (runs[n].cell) cells[order[n].first].push_back(*runs[n].cell);
            is_cut = is_cut || runs[n].is_left_out;
        }
        const bool any = std::ranges::any_of(cells, [](const auto& runs_of_label) { return !runs_of_label.empty(); });
        if (is_cut)
            result_.notes.push_back(any ? "some final runs ended before all seeds were done"
                                        : "no time was left for final runs");
        for (std::size_t i = 0; i < labels.size(); ++i) {
            FinalSetting& f = result_.finals[i];
            const auto searched = searched_.find(labels[i].text());
            f.is_fresh = !f.is_best || !cells[i].empty() || searched == searched_.end();
            if (!f.is_fresh) cells[i] = {searched->second};
            f.verdict = verdict_of(cells[i], target_, result_.methods[f.method].is_unbiased);
        }
        if (const FinalSetting* best = result_.best())
            for (const double error : {0.10, 0.05, 0.02, 0.01})
                if (const Verdict v =
                        verdict_of(cells[static_cast<std::size_t>(best - result_.finals.data())], error, false);
                    v.state == Verdict::measured && error != target_)
                    result_.along_the_way.emplace_back(error, v.seconds);
    }

    double target_;
    TuningRuns runs_;
    std::map<std::string, Cell> searched_;  ///< the latest run of each label in the search
    TuningResult result_;
};

}  // namespace

int tune(const TuneFile& file, const ExperimentScene& scene, const RunOptions& options, std::ostream& out) {
    const InterruptGuard guard;
    if (file.head.epsilon) require_epsilon(*file.head.epsilon);
    return Tuning(asked_spaces(file), file, scene, options).run(out);
}

int run_or_tune(const RunOptions& options, std::ostream& out) {
    const auto file = load_tune_file(options.experiment);
    if (!file) return run_experiment(options, out);
    if (options.seeds) reject({}, "--seeds is for experiments without [tune], whose seeds have their own parts");
    if (options.fresh)
        reject({}, "--fresh is for experiments without [tune]; delete the folder of the results instead");
    if (options.share) reject({}, "--share is for experiments without [tune], whose runs follow from each other");
    check_out(options);
    static_cast<void>(asked_spaces(*file));
    const std::string folder = result_folder_of(options.out, file->head.name);
    int code = 0;
    bool any = false;
    for (const ExperimentScene& scene : file->head.scenes) {
        if (scene.name.find(options.only) == std::string::npos) continue;
        out << (any ? "\n" : "") << scene.name << ":\n";
        any = true;
        RunOptions own = options;
        own.out = folder + "/" + scene.name;
        own.only.clear();
        code = std::max(code, tune(*file, scene, own, out));
    }
    if (!any) reject({}, "--only '{}' keeps no scene: it is in no scene's name", options.only);
    return code;
}

}  // namespace gib
