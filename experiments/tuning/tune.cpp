// The time of a tuning is divided beforehand, so that the rounds do not depend on how long earlier ones took: a
// continued search asks for the same cells and finds them stored.
#include "experiments/tuning/tune.h"

#include "common/core/error.h"
#include "common/core/files.h"
#include "common/core/number_text.h"
#include "common/core/reject.h"
#include "experiments/metrics/student_t.h"
#include "experiments/plan/experiment_file.h"
#include "experiments/run/cell_queue.h"
#include "experiments/system/interrupt.h"
#include "experiments/tuning/time_estimate.h"
#include "methods/method.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>

namespace gib {

namespace {

namespace fs = std::filesystem;

constexpr double reference_share = 0.25, search_share = 0.45, final_share = 0.3;  // of the time
/// The search has seed 1 alone. The final runs have it, too, but their times are those of the others, which the search has
/// not seen: the best of many settings is partly the luckiest with the seed that chose it.
constexpr int fresh_seeds = 5;
/// More passes than any budget lets a cell make.
constexpr const char* endless_spp = "1000000000";
/// Settings whose time in the search is this many times that of the method's best are measured again at the end.
constexpr double close_enough = 1.3;
constexpr std::array along_the_way = {0.10, 0.05, 0.02, 0.01};

/// Text as a TOML basic string.
std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text)
        result += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    return result + "\"";
}

std::string method_table(const MethodLabel& label) {
    std::string text = fmt::format("[[method]]\nname = {}\n", quoted(label.name));
    for (const auto& [name, value] : label.values)
        text += fmt::format("{} = {}\n", name, number_from<double>(value) ? value : quoted(value));
    return text;
}

struct Final {
    MethodLabel label;
    std::vector<Cell> cells;
    std::vector<double> log_times = {};  ///< empty: not reached
    SampleMean mean{0, {0, 1}};          ///< of log_times
};

class Tuning {
public:
    explicit Tuning(const TuneOptions& options)
        : options_(options),
          target_(parse_target(options.target)),
          name_("tune-" + fs::path(options.scene).stem().string()),
          folder_(options.out ? *options.out : result_folder_of(name_)) {
        for (const auto& text : options.variations)
            variations_.push_back(parse_variation(text));
        auto labels = options.methods.empty() ? names_of_comparable_methods() : options.methods;
        for (const auto& text : labels)
            methods_.push_back(ConfiguredMethod(MethodLabel::parse(text)).label);
        for (const auto& variation : variations_)
            require_known(variation);
    }

    int run(std::ostream& out) {
        std::vector<MethodLabel> finals;
        double shortest = std::numeric_limits<double>::infinity();
        for (const auto& base : methods_)
            for (const Trial& trial : chosen(base)) {
                finals.push_back(trial.label);
                shortest = std::min(shortest, trial.time.seconds);
            }
        return print(measure_finals(finals, shortest), out);
    }

private:
    void require_known(const Variation& variation) const {
        const auto has = [&](const MethodLabel& label) {
            const auto names = names_of(find_method(label.name).parameters);
            return std::find(names.begin(), names.end(), variation.parameter) != names.end();
        };
        if (std::none_of(methods_.begin(), methods_.end(), has))
            reject({}, "--vary: no method here has a parameter '{}'", variation.parameter);
    }

    double seconds() const { return 60 * options_.minutes; }

    /// The best settings of a method and those that are close to them or one step away.
    std::vector<Trial> chosen(const MethodLabel& base) {
        const auto axes = tuning_axes(base, variations_);
        const SearchSettings settings{.seconds = search_share * seconds() / static_cast<double>(methods_.size())};
        const auto trials = search(base, axes, settings, [&](const auto& labels, double budget, int round) {
            const std::string name = fmt::format("{}-{}", base.name, round + 1);
            std::vector<TimeEstimate> times;
            for (const auto& cells : measured(name, labels, budget, 1, 1))
                times.push_back(cells.empty() ? TimeEstimate{} : estimated_time(cells.front(), target_));
            return times;
        });
        std::vector<Trial> result = {trials.front()};
        const double best = trials.front().time.seconds;
        const auto add = [&](const Trial& trial) {
            const auto same = [&](const Trial& t) { return t.label.text() == trial.label.text(); };
            if (std::none_of(result.begin(), result.end(), same)) result.push_back(trial);
        };
        for (const Trial& trial : trials)
            if (trial.time.seconds <= close_enough * best && result.size() < 3) add(trial);
        for (const auto& label : neighbours(trials.front().label, axes))
            add({label, {}});
        if (!axes.empty()) add({base, {}});
        return result;
    }

    /// The text of the experiment that measures these labels for `budget` seconds.
    std::string experiment_text(const std::string& name, const std::vector<MethodLabel>& labels, double budget,
                                int seeds) const {
        std::string text = fmt::format("title = {}\nscenes = [{}]\nseeds = {}\nbudget = {{ seconds = {:.3g} }}\n",
                                       quoted(fmt::format("{}: {}", name_, name)),
                                       quoted(fs::absolute(options_.scene).string()), seeds, budget);
        if (options_.resolution)
            text += fmt::format("resolution = [{}, {}]\n", options_.resolution->first, options_.resolution->second);
        if (!options_.folders.empty()) {
            std::vector<std::string> paths;
            for (const auto& folder : options_.folders)
                paths.push_back(quoted(fs::absolute(folder).string()));
            text += fmt::format("paths = [{}]\n", fmt::join(paths, ", "));
        }
        text +=
            fmt::format("[reference]\ntarget = {:.3g}\nseconds = {:.3g}\n", target_ / 4, reference_share * seconds());
        for (const auto& label : labels)
            text += method_table(with_value(label, "spp", endless_spp));
        return text;
    }

    /// Measures seeds 1 to `seeds` and returns the cells of those from `first` on, by label; none for a label that failed.
    std::vector<std::vector<Cell>> measured(const std::string& name, const std::vector<MethodLabel>& labels,
                                            double budget, int seeds, int first) const {
        const std::string file = folder_ + "/" + name + ".toml";
        ResultFolder::make(folder_);
        write_file(file, experiment_text(name, labels, budget, seeds));
        RunOptions run_options;
        run_options.experiment = file;
        run_options.out = folder_ + "/" + name;
        run_options.threads = options_.threads;
        run_options.program = options_.program;
        run_options.command_line = options_.command_line;
        ExperimentRun run(run_options);
        if (!run.measure()) throw Interrupted();
        if (seeds > 1) run.write_results();
        return stored(run.folder(), labels, seeds, first);
    }

    static std::vector<std::vector<Cell>> stored(const ResultFolder& folder, const std::vector<MethodLabel>& labels,
                                                 int seeds, int first) {
        const ResultIndex index = folder.read_index();
        std::vector<std::vector<Cell>> result;
        for (const auto& label : labels) {
            result.emplace_back();
            for (int seed = first; seed <= seeds; ++seed) {
                const auto name =
                    cell_folder_name(index.scenes.front().name, with_value(label, "spp", endless_spp).text(),
                                     static_cast<std::uint64_t>(seed));
                const auto key = index.cell_keys.find(name);
                auto cell = key == index.cell_keys.end() ? std::nullopt : folder.read_cell(name, key->second);
                if (cell) result.back().push_back(*std::move(cell));
            }
        }
        return result;
    }

    std::vector<Final> measure_finals(const std::vector<MethodLabel>& labels, double shortest) {
        const double fair = final_share * seconds() / ((1 + fresh_seeds) * static_cast<double>(labels.size()));
        // The best settings have to reach the target, and it is enough to know that others take three times as long.
        const double budget = std::isfinite(shortest) ? std::clamp(fair, 1.5 * shortest, 3 * shortest) : fair;
        const auto cells = measured("final", labels, budget, 1 + fresh_seeds, 2);
        std::vector<Final> finals;
        for (std::size_t i = 0; i < labels.size(); ++i) {
            Final result{.label = labels[i], .cells = cells[i], .log_times = {}};
            if (cells[i].size() == fresh_seeds) result.log_times = log_times(cells[i], target_);
            if (!result.log_times.empty()) result.mean = sample_mean(result.log_times);
            finals.push_back(std::move(result));
        }
        std::stable_sort(finals.begin(), finals.end(), [](const Final& a, const Final& b) {
            return std::pair(a.log_times.empty(), a.mean.value) < std::pair(b.log_times.empty(), b.mean.value);
        });
        return finals;
    }

    std::string label_to_paste(const Final& f) const {
        const auto passes = passes_to(f.cells, target_);
        return passes ? with_value(f.label, "spp", std::to_string(*passes)).text() : f.label.text();
    }

    int print(const std::vector<Final>& finals, std::ostream& out) const;
    void print_ratios(const Final& best, const std::vector<Final>& finals, std::ostream& out) const;

    TuneOptions options_;
    double target_;
    std::string name_, folder_;
    std::vector<Variation> variations_;
    std::vector<MethodLabel> methods_;
};

/// exp(mean +- half) as "1.2 (1.1 to 1.3)".
std::string factor_text(double mean, double half) {
    return fmt::format("{:.3g} ({:.3g} to {:.3g})", std::exp(mean), std::exp(mean - half), std::exp(mean + half));
}

/// The other labels of the method, as factors of time; those whose interval holds 1 cannot be told from the best.
void Tuning::print_ratios(const Final& best, const std::vector<Final>& finals, std::ostream& out) const {
    for (const Final& other : finals) {
        if (&other == &best) continue;
        const std::string text = other.label.text();
        if (other.log_times.empty()) {
            out << fmt::format("  not reached in the final runs: {}\n", text);
            continue;
        }
        const double ratio = other.mean.value - best.mean.value;
        const double half = half_width({other.mean.variance, best.mean.variance}, 0.05);
        out << fmt::format("  {} times as long{}: {}\n", factor_text(ratio, half),
                           ratio <= half ? ", cannot be told from the best" : "", text);
    }
}

int Tuning::print(const std::vector<Final>& finals, std::ostream& out) const {
    const Final& best = finals.front();
    if (best.log_times.empty()) {
        std::cerr << fmt::format("no method reached {} in the final runs; more --minutes give longer ones\n",
                                 options_.target);
        return exit_failed;
    }
    out << label_to_paste(best) << "\n";
    const double half = half_width({best.mean.variance}, 0.05);
    out << fmt::format("seconds to {}: {}, {} fresh seeds, 95 % interval\n", options_.target,
                       factor_text(best.mean.value, half), fresh_seeds);
    for (const double error : along_the_way)
        if (const auto times = log_times(best.cells, error); !times.empty()) {
            const SampleMean mean = sample_mean(times);
            out << fmt::format("seconds to {:g} %: {}\n", 100 * error,
                               factor_text(mean.value, half_width({mean.variance}, 0.05)));
        }
    out << "other settings, each a method of the final runs:\n";
    print_ratios(best, finals, out);
    out << fmt::format("Results: {}; report: {}\n", folder_, folder_ + "/final/report.html");
    return 0;
}

}  // namespace

int tune(const TuneOptions& options, std::ostream& out) {
    const InterruptGuard guard;
    return Tuning(options).run(out);
}

}  // namespace gib
