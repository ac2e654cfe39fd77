#include "experiments/tuning/tuning_rounds.h"

#include "common/core/files.h"
#include "common/core/number_text.h"
#include "common/reader/scene_file.h"
#include "experiments/run/cell_queue.h"
#include "experiments/system/interrupt.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <iostream>
#include <thread>

namespace gib {

namespace {

namespace fs = std::filesystem;

/// More passes than any budget lets a cell make.
constexpr const char* endless_spp = "1000000000";

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

std::vector<std::vector<Cell>> stored(const ResultFolder& folder, const TuningRounds::Request& request) {
    const ResultIndex index = folder.read_index();
    std::vector<std::vector<Cell>> result;
    for (const auto& label : request.labels) {
        result.emplace_back();
        for (int seed = request.first_seed; seed <= request.seeds; ++seed) {
            const auto name = cell_folder_name(index.scenes.front().name, with_value(label, "spp", endless_spp).text(),
                                               static_cast<std::uint64_t>(seed));
            const auto key = index.cell_keys.find(name);
            auto cell = key == index.cell_keys.end() ? std::nullopt : folder.read_cell(name, key->second);
            if (cell) result.back().push_back(*std::move(cell));
        }
    }
    return result;
}

/// A round of the clock, which is stored as not done if it is left by an exception.
class ClockedRound {
public:
    explicit ClockedRound(TuningClock& clock) : clock_(clock) {}
    ~ClockedRound() {
        try {
            clock_.end(is_done, is_cut);
        } catch (const std::exception& error) {
            std::cerr << fmt::format("warning: the time of a round is lost: {}\n", error.what());
        }
    }
    ClockedRound(const ClockedRound&) = delete;
    ClockedRound& operator=(const ClockedRound&) = delete;

    bool is_done = false, is_cut = false;

private:
    TuningClock& clock_;
};

}  // namespace

TuningRounds::TuningRounds(const TuneOptions& options, std::string name, std::string folder, double target,
                           double reference_seconds)
    : options_(options),
      name_(std::move(name)),
      folder_(std::move(folder)),
      target_(target),
      reference_seconds_(reference_seconds),
      clock_(folder_ + "/clock.json") {
    const LoadedScene loaded = load_scene(options.scene, {{}, options.resolution, options.folders});
    scene_ = loaded.name;
    const unsigned threads =
        options.threads > 0 ? static_cast<unsigned>(options.threads) : std::thread::hardware_concurrency();
    setup_ = fmt::format("{} {}", loaded.content_hash, threads);
    ResultFolder::make(folder_);
}

std::string TuningRounds::experiment_text(const Request& request) const {
    std::string text = fmt::format("title = {}\nscenes = [{}]\nseeds = {}\nbudget = {{ seconds = {:.3g} }}\n",
                                   quoted(fmt::format("{}: {}", name_, request.name)),
                                   quoted(fs::absolute(options_.scene).string()), request.seeds, request.budget);
    if (options_.resolution)
        text += fmt::format("resolution = [{}, {}]\n", options_.resolution->first, options_.resolution->second);
    if (options_.epsilon) text += fmt::format("epsilon = {}\n", *options_.epsilon);
    if (!options_.folders.empty()) {
        std::vector<std::string> paths;
        for (const auto& folder : options_.folders)
            paths.push_back(quoted(fs::absolute(folder).string()));
        text += fmt::format("paths = [{}]\n", fmt::join(paths, ", "));
    }
    text += fmt::format("[reference]\ntarget = {:.3g}\nseconds = {:.3g}\n", target_ / 4, reference_seconds_);
    for (const auto& label : request.labels)
        text += method_table(with_value(label, "spp", endless_spp));
    return text;
}

TuningRounds::Round TuningRounds::measured(const Request& request) {
    const std::string text = experiment_text(request);
    write_file(folder_ + "/" + request.name + ".toml", text);
    const double before = clock_.used();
    const bool is_stored = fs::exists(folder_ + "/" + request.name + "/index.json");
    clock_.begin(request.name, setup_ + "\n" + text, is_stored);
    Round round;
    {
        ClockedRound timed(clock_);
        round = run(request);
        timed.is_done = true;
        timed.is_cut = round.is_cut;
    }
    double charged = 0, runs = 0;
    for (const auto& cells : round.cells)
        for (const Cell& cell : cells) {
            charged += cell.last().seconds;
            ++runs;
        }
    // The first round makes the reference, too.
    if (before > 0 && runs > 0) besides_ = std::max(0.0, (clock_.used() - before - charged) / runs);
    return round;
}

TuningRounds::Round TuningRounds::run(const Request& request) {
    RunOptions run_options;
    run_options.experiment = folder_ + "/" + request.name + ".toml";
    run_options.out = folder_ + "/" + request.name;
    run_options.threads = options_.threads;
    run_options.program = options_.program;
    run_options.command_line = options_.command_line;
    bool is_cut = clock_.was_done() && clock_.was_cut();
    run_options.may_start = [&] {
        if (!clock_.was_done() && clock_.used() < request.deadline) return true;
        is_cut = is_cut || !clock_.was_done();
        return false;
    };
    ExperimentRun experiment(run_options);
    if (!experiment.measure()) throw Interrupted();
    if (request.has_report) experiment.write_results();
    return {stored(experiment.folder(), request), is_cut};
}

}  // namespace gib
