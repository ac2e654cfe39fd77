// The time of a tuning is divided among reference, search, choice and final runs. What is left of a part goes to the next one.
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
#include <cmath>
#include <iostream>
#include <map>
#include <numeric>
#include <set>

namespace gib {

namespace {

/// When each part has to end, as shares of the whole time. A reference that does not resolve the target by then goes on; the other
/// parts then have the same shares of the rest.
constexpr double reference_end = 0.25, latest_reference_end = 0.5, search_end = 0.6, choice_end = 0.7;
/// With the fewest seeds, the final runs of the methods' best settings take at most this share of what is left then. Defaults and
/// neighbours run only where all seeds of all settings leave time for them.
constexpr double best_share = 0.7;

/// The search has one seed, the choice among its best settings others, because the best of many settings is partly the luckiest
/// with the seed that chose it. The final runs judge by the seeds 1 to final_seeds, which have chosen nothing. If time is
/// short, there are at least fewest_seeds.
constexpr std::uint64_t search_seed = 1001, first_choice_seed = 1002, choice_seeds = 3, final_seeds = 5,
                        fewest_seeds = 3;
/// A setting takes part in the choice if its time in the search is at most this many times that of the method's best.
constexpr double close_enough = 1.3;
/// Limit on the settings of a method that take part beside its best one.
constexpr std::size_t most_close = 3;
/// Runs may take this many times as long as the target is expected to take, because seeds and the load of the machine differ.
constexpr double ample = 2;
/// Other settings are given up after this many times the time of the best one: it is enough to know that they take longer.
constexpr double longest_factor = 3;

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
        const std::string words = runs_.make_reference(reference_end * seconds(), latest_reference_end * seconds());
        if (!words.empty()) {
            std::cerr << words << "\n";
            return exit_failed;
        }
        begin_ = std::max(reference_end, runs_.used() / seconds());
        for (std::size_t m = 0; m < result_.methods.size(); ++m)
            search_method(m);
        choose();
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
    /// When a part has to end [s] that ends after this share of the whole time if the reference takes no more than its part.
    double end_of(double share) const { return seconds() * (1 - (1 - share) * (1 - begin_) / (1 - reference_end)); }
    /// The longest time of a final run if only the best settings and the defaults of each method have one.
    double horizon() const {
        return (seconds() - end_of(choice_end)) / (2.0 * fewest_seeds * static_cast<double>(result_.methods.size()));
    }
    static double weight(const TunedMethod& method) {
        return static_cast<double>(1 + settings_per_axis * method.space.axes().size());
    }

    void search_method(std::size_t m) {
        TunedMethod& method = result_.methods[m];
        const double begin = runs_.used();
        const double all =
            std::accumulate(result_.methods.begin() + static_cast<std::ptrdiff_t>(m), result_.methods.end(), 0.0,
                            [](double sum, const TunedMethod& t) { return sum + weight(t); });
        const double share = std::max(0.0, end_of(search_end) - begin) * weight(method) / all;
        const SearchLimits limits{.seconds = share, .elapsed = [&] { return runs_.used() - begin; }};
        const SearchOutcome found = search(method.space, limits, [&](const auto& settings, double budget) {
            std::vector<TuningRuns::Wanted> wanted;
            for (const Setting& setting : settings)
                wanted.push_back({method.space.label(setting), search_seed, budget});
            std::vector<std::optional<TimeEstimate>> times;
            const auto runs = runs_.measured(wanted, begin + share);
            for (std::size_t i = 0; i < runs.size(); ++i) {
                const auto& [cell, is_left_out] = runs[i];
                if (cell) times.push_back(estimated_time(*cell, target_, horizon()));
                else times.push_back(is_left_out ? std::nullopt : std::optional(TimeEstimate{}));
                if (cell) searched_[wanted[i].label.text()] = *cell;
            }
            return times;
        });
        method.trials = found.trials;
        if (method.trials.empty()) method.trials.push_back({method.space.defaults(), {}});
        if (found.is_cut)
            result_.notes.push_back(
                fmt::format("the search among settings of {} ended early", method.space.base().text()));
    }

    /// Sets the budget to an ample one by the seeds of the choice; infinite unless all of its runs were done.
    void estimate(FinalSetting& candidate) {
        std::vector<TuningRuns::Wanted> wanted;
        for (std::uint64_t seed = first_choice_seed; seed < first_choice_seed + choice_seeds; ++seed)
            wanted.push_back({result_.label(candidate), seed, std::min(candidate.budget, horizon())});
        double log_cost = 0;
        for (const TuningRuns::Run& run : runs_.measured(wanted, end_of(choice_end)))
            log_cost += run.cell ? std::log(estimated_time(*run.cell, target_, horizon()).cost()) : INFINITY;
        candidate.budget = ample * std::exp(log_cost / choice_seeds);
    }

    /// Chooses the best setting of each method, and the order of the methods, by seeds that the search has not seen. What
    /// seems to take long comes last, so that time is short for it alone.
    void choose() {
        std::vector<FinalSetting> candidates;
        for (std::size_t m = 0; m < result_.methods.size(); ++m) {
            const auto& trials = result_.methods[m].trials;
            for (std::size_t i = 0; i <= std::min(most_close, trials.size() - 1); ++i)
                if (i == 0 || trials[i].time.cost() <= close_enough * trials.front().time.cost())
                    candidates.push_back(
                        {.method = m, .setting = trials[i].setting, .budget = ample * trials[i].time.cost()});
        }
        std::ranges::stable_sort(candidates, {}, &FinalSetting::budget);
        for (FinalSetting& candidate : candidates)
            if (candidates.size() > 1) estimate(candidate);
        std::ranges::stable_sort(candidates, {}, &FinalSetting::budget);
        for (const FinalSetting& candidate : candidates)
            if (std::ranges::count(result_.finals, candidate.method, &FinalSetting::method) == 0) {
                result_.finals.push_back(candidate);
                result_.finals.back().is_best = true;
            }
    }

    /// The defaults of each method, then the neighbours of the best setting.
    std::vector<FinalSetting> others() const {
        std::vector<FinalSetting> all;
        for (const FinalSetting& best : result_.finals) {
            const SearchSpace& space = result_.methods[best.method].space;
            if (space.defaults() != best.setting) all.push_back({.method = best.method, .setting = space.defaults()});
        }
        const FinalSetting& first = result_.finals.front();
        const SearchSpace& space = result_.methods[first.method].space;
        for (const Setting& setting : space.neighbours(first.setting))
            if (setting != space.defaults()) all.push_back({.method = first.method, .setting = setting});
        return all;
    }

    /// The budgets of all final runs. Other settings than the best are left out where their runs would not end in time.
    void plan_finals() {
        const double left = std::max(0.0, seconds() - runs_.used()), besides = runs_.besides();
        std::vector<double> wanted;
        for (const FinalSetting& f : result_.finals)
            wanted.push_back(f.budget);
        const auto budgets = shared_seconds(wanted, best_share * left / fewest_seeds, besides);
        double used = 0;
        for (std::size_t i = 0; i < budgets.size(); ++i) {
            result_.finals[i].budget = budgets[i];
            used += final_seeds * (budgets[i] + besides);
        }
        const double longest = longest_factor / ample * result_.finals.front().budget;
        const auto more = others();
        std::size_t kept = 0;
        for (const FinalSetting& other : more) {
            used += final_seeds * (longest + besides);
            if (used > left) break;
            result_.finals.push_back(other);
            result_.finals.back().budget = longest;
            ++kept;
        }
        if (kept < more.size())
            result_.notes.push_back(
                fmt::format("{} of {} other settings had no time for final runs, neighbours of the best "
                            "first",
                            more.size() - kept, more.size()));
    }

    void measure_finals() {
        const std::size_t bests = result_.finals.size();
        plan_finals();
        std::vector<MethodLabel> labels;
        std::vector<double> budgets;
        for (const FinalSetting& f : result_.finals) {
            labels.push_back(result_.label(f));
            budgets.push_back(f.budget);
        }
        runs_.begin_experiment(labels, budgets, final_seeds);
        std::vector<std::vector<Cell>> cells(labels.size());
        std::vector<std::pair<std::size_t, std::uint64_t>> order;  // setting, seed
        for (std::size_t i = 0; i < labels.size(); ++i)
            for (std::uint64_t seed = 1; seed <= final_seeds; ++seed)
                order.emplace_back(i, seed);
        // The fewest seeds of each method's best settings come first, the cheapest method before all others, because each one
        // is to have a verdict; then their other seeds, then the other settings.
        std::ranges::stable_sort(order, {}, [&](const auto& run) {
            return std::pair(run.first >= bests, run.first < bests && run.second > fewest_seeds);
        });
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
    double begin_ = reference_end;  ///< share of the time after which the search begins
    TuningRuns runs_;
    std::map<std::string, Cell> searched_;  ///< the latest run of each label by the seed of the search
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
