// The time of a tuning is divided among reference, search and final runs. What is left of a part goes to the next one.
#include "experiments/tuning/tune.h"

#include "common/core/reject.h"
#include "experiments/metrics/epsilon.h"
#include "experiments/plan/experiment_file.h"
#include "experiments/system/interrupt.h"
#include "experiments/tuning/final_plan.h"
#include "experiments/tuning/time_estimate.h"
#include "experiments/tuning/tuning_page.h"
#include "experiments/tuning/tuning_rounds.h"
#include "experiments/tuning/tuning_text.h"
#include "methods/method.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>

namespace gib {

namespace {

constexpr double reference_share = 0.25, final_share = 0.3;  // shares of the time; the search has the rest
/// The search has seed 1 alone. The final runs have it, too, but their times are those of the others, which the search has
/// not seen: the best of many settings is partly the luckiest with the seed that chose it.
constexpr int fresh_seeds = 5;
/// Settings whose time in the search is this many times that of the method's best are measured again at the end.
constexpr double close_enough = 1.3;
constexpr std::size_t most_close = 3;

/// A label that is worth final runs; the lowest rank is the most important.
struct Wish {
    MethodLabel label;
    std::size_t method;
    enum Rank { best, defaults, close, neighbour } rank;
};

std::vector<MethodLabel> asked_methods(const TuneOptions& options) {
    std::vector<MethodLabel> methods;
    for (const auto& text : options.methods.empty() ? names_of_comparable_methods() : options.methods) {
        const ConfiguredMethod method(MethodLabel::parse(text));
        find_comparable_method(method.label.name);
        methods.push_back(method.label);
    }
    return methods;
}

void require_known(const Variation& variation, const std::vector<MethodLabel>& methods) {
    const auto has = [&](const MethodLabel& label) {
        const auto names = names_of(find_method(label.name).parameters);
        return std::find(names.begin(), names.end(), variation.parameter) != names.end();
    };
    if (std::none_of(methods.begin(), methods.end(), has))
        reject(variation.where, "{}: no method here has a parameter '{}'",
               variation.where.file.empty() ? "--vary" : "vary", variation.parameter);
}

class Tuning {
public:
    explicit Tuning(const TuneOptions& options)
        : options_(options),
          name_("tune-" + std::filesystem::path(options.scene).stem().string()),
          rounds_(options_, name_, options.out ? *options.out : result_folder_of(name_), parse_target(options.target),
                  reference_share * seconds()) {
        result_.scene = rounds_.scene();
        result_.target = options.target;
        result_.target_error = parse_target(options.target);
        result_.minutes = options.minutes;
        for (const auto& base : asked_methods(options))
            result_.methods.push_back({base, tuning_axes(base, options.variations), {}});
    }

    int run(std::ostream& out) {
        for (std::size_t m = 0; m < result_.methods.size(); ++m)
            search_method(m);
        measure_finals();
        result_.used_seconds = rounds_.used();
        const std::string page = write_tuning_page(result_, rounds_.folder());
        if (!result_.has_best()) {
            std::cerr << fmt::format("no method reached {} in the final runs{}; more --minutes give longer ones\n",
                                     options_.target, closest());
            return exit_failed;
        }
        out << tuning_text(result_)
            << fmt::format("Results: {}; page: {}; report: {}\n", rounds_.folder(), page,
                           rounds_.folder() + "/final/report.html");
        return 0;
    }

private:
    double seconds() const { return 60 * options_.minutes; }
    /// The longest time of a final run if only the best settings and the defaults of each method have one.
    double horizon() const { return longest_final(final_share * seconds(), 2 * result_.methods.size()); }
    /// When the search has to end, so that the final runs have their share.
    double search_end() const { return (1 - final_share) * seconds(); }

    void search_method(std::size_t m) {
        TunedMethod& method = result_.methods[m];
        // The reference is made in the first round; time that it or the methods before leave is used here.
        const double begin = std::max(rounds_.used(), reference_share * seconds());
        const auto left = std::count_if(result_.methods.begin() + static_cast<std::ptrdiff_t>(m), result_.methods.end(),
                                        [](const TunedMethod& t) { return !t.axes.empty(); });
        const double share = (search_end() - begin) / static_cast<double>(std::max(left, std::ptrdiff_t{1}));
        SearchSettings settings{.seconds = std::max(share, 0.0)};
        settings.elapsed = [&] { return std::max(rounds_.used() - begin, 0.0); };
        const auto outcome =
            search(method.base, method.axes, settings, [&](const auto& labels, double budget, int round) {
                const auto measured =
                    rounds_.measured({.name = fmt::format("{}-{}-{}", m + 1, method.base.name, round + 1),
                                      .labels = labels,
                                      .budget = budget,
                                      .deadline = begin + settings.seconds});
                return estimates(measured);
            });
        method.trials = outcome.trials;
        if (outcome.is_cut)
            result_.notes.push_back(fmt::format("the search among settings of {} ended early", method.base.text()));
    }

    std::vector<std::optional<TimeEstimate>> estimates(const TuningRounds::Round& round) const {
        std::vector<std::optional<TimeEstimate>> times;
        for (const auto& cells : round.cells) {
            if (!cells.empty()) times.push_back(estimated_time(cells.front(), result_.target_error, horizon()));
            else if (round.is_cut) times.push_back(std::nullopt);
            else times.push_back(TimeEstimate{});
        }
        return times;
    }

    /// Everything that is worth final runs, the most important first and without duplicates.
    std::vector<Wish> wishes() const {
        std::vector<Wish> all;
        for (std::size_t m = 0; m < result_.methods.size(); ++m) {
            const TunedMethod& method = result_.methods[m];
            const Trial& best = method.trials.front();
            all.push_back({best.label, m, Wish::best});
            if (!method.axes.empty()) all.push_back({method.base, m, Wish::defaults});
            for (std::size_t i = 1; i < method.trials.size() && i <= most_close; ++i)
                if (method.trials[i].time.cost() <= close_enough * best.time.cost())
                    all.push_back({method.trials[i].label, m, Wish::close});
            for (const auto& label : neighbours(best.label, method.axes))
                all.push_back({label, m, Wish::neighbour});
        }
        std::stable_sort(all.begin(), all.end(), [](const Wish& a, const Wish& b) { return a.rank < b.rank; });
        std::vector<Wish> unique;
        for (const Wish& wish : all)
            if (std::none_of(unique.begin(), unique.end(),
                             [&](const Wish& w) { return w.label.text() == wish.label.text(); }))
                unique.push_back(wish);
        return unique;
    }

    void measure_finals() {
        auto labels = wishes();
        double shortest = std::numeric_limits<double>::infinity();
        for (const TunedMethod& method : result_.methods)
            shortest = std::min(shortest, method.trials.front().time.seconds);
        const auto least =
            std::count_if(labels.begin(), labels.end(), [](const Wish& w) { return w.rank <= Wish::defaults; });
        const FinalPlan plan = plan_finals({.labels = labels.size(),
                                            .least = static_cast<std::size_t>(least),
                                            .seeds = 1 + fresh_seeds,
                                            .left = seconds() - rounds_.used(),
                                            .besides = rounds_.besides(),
                                            .shortest = shortest});
        if (plan.labels < labels.size())
            result_.notes.push_back(
                fmt::format("{} of {} settings worth final runs were left out, neighbours of the best first",
                            labels.size() - plan.labels, labels.size()));
        labels.erase(labels.begin() + static_cast<std::ptrdiff_t>(plan.labels), labels.end());
        TuningRounds::Request request{.name = "final",
                                      .budget = plan.budget,
                                      .seeds = 1 + fresh_seeds,
                                      .first_seed = 2,
                                      .deadline = seconds(),
                                      .has_report = true};
        for (const Wish& wish : labels)
            request.labels.push_back(wish.label);
        const auto round = rounds_.measured(request);
        if (round.is_cut) result_.notes.push_back("the final runs ended before all seeds were done");
        result_.final_budget = plan.budget;
        for (std::size_t i = 0; i < labels.size(); ++i)
            result_.finals.push_back(final_setting(labels[i], round.cells[i]));
        std::stable_sort(
            result_.finals.begin(), result_.finals.end(), [](const FinalSetting& a, const FinalSetting& b) {
                return std::pair(a.log_times.empty(), a.mean.value) < std::pair(b.log_times.empty(), b.mean.value);
            });
    }

    /// The settings whose final images came closest to the target, in brackets.
    std::string closest() const {
        const Cell* best = nullptr;
        const auto error2 = [](const Cell& cell) {
            return cell.checkpoints.back().errors.at(Layer::total).rel_mse_corrected;
        };
        for (const FinalSetting& setting : result_.finals)
            for (const Cell& cell : setting.cells)
                if (!best || error2(cell) < error2(*best)) best = &cell;
        if (!best) return "";
        return fmt::format(" (closest: {}, {:.3g} % after {:.3g} s)", best->method,
                           100 * std::sqrt(std::max(error2(*best), 0.0)), best->last().seconds);
    }

    FinalSetting final_setting(const Wish& wish, const std::vector<Cell>& cells) const {
        FinalSetting setting{.label = wish.label, .method = wish.method, .cells = cells};
        if (cells.size() > 1) setting.log_times = log_times(cells, result_.target_error);
        if (!setting.log_times.empty()) setting.mean = sample_mean(setting.log_times);
        return setting;
    }

    TuneOptions options_;
    std::string name_;
    TuningRounds rounds_;
    TuningResult result_;
};

}  // namespace

void check_tuning(const TuneOptions& options) {
    static_cast<void>(parse_target(options.target));
    if (options.epsilon) require_epsilon(*options.epsilon);
    const auto methods = asked_methods(options);
    for (const auto& variation : options.variations)
        require_known(variation, methods);
    for (const auto& base : methods)
        static_cast<void>(tuning_axes(base, options.variations));
}

int tune(const TuneOptions& options, std::ostream& out) {
    const InterruptGuard guard;
    check_tuning(options);
    return Tuning(options).run(out);
}

}  // namespace gib
