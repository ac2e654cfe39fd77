#include "experiments/tuning/tuning_runs.h"

#include "common/core/files.h"
#include "common/core/number_text.h"
#include "experiments/metrics/reference_image.h"
#include "experiments/plan/label_checks.h"
#include "experiments/references/reference.h"
#include "experiments/tuning/search_space.h"
#include "methods/method.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <span>

namespace gib {

namespace {

namespace fs = std::filesystem;

/// The reference goes on while its error is above this share of the target. There is no tuning if it ends above the
/// larger one: its variance is subtracted from squared errors, but is itself known only to some per cent, and can be as
/// large as the remaining error.
constexpr double wanted_reference_error = 0.5, most_reference_error = 0.7;

/// Text as a TOML basic string.
std::string quoted_toml(const std::string& text) {
    std::string result = "\"";
    for (const char c : text)
        result += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    return result + "\"";
}

std::string method_table(const MethodLabel& label) {
    std::string text = fmt::format("[[method]]\nname = {}\n", quoted_toml(label.name));
    for (const auto& [name, value] : label.values)
        text += fmt::format("{} = {}\n", name, number_from<double>(value) ? value : quoted_toml(value));
    return text;
}

/// The label with more passes than any budget lets a cell make, and with its numbers as TOML has them: as typed, but
/// for those such as .5, 1. and 05.
MethodLabel endless(MethodLabel label) {
    static const std::regex toml_number("-?(0|[1-9][0-9]*)([.][0-9]+)?([eE][+-]?[0-9]+)?");
    for (auto& [name, value] : label.values)
        if (const auto number = number_from<double>(value); number && !std::regex_match(value, toml_number))
            value = fmt::format("{}", *number);
    return with_value(std::move(label), "spp", "1000000000");
}

/// The time of a budget with three digits, as its text has it.
double rounded_budget(double seconds) { return number_from<double>(fmt::format("{:.3g}", seconds)).value(); }

}  // namespace

TuningRuns::TuningRuns(const TuneFile& file, const ExperimentScene& scene, const RunOptions& options,
                       const std::vector<MethodLabel>& methods)
    : file_(file), scene_(scene), options_(options) {
    open(methods, 1);
}

std::string TuningRuns::experiment_text(const std::vector<MethodLabel>& labels, int seeds) const {
    const Experiment& head = file_.head;
    std::string text = fmt::format("title = {}\nscenes = [{}]\nseeds = {}\n",
                                   quoted_toml(fmt::format("{}: settings for {}", scene_.name, file_.target)),
                                   quoted_toml(fs::absolute(scene_.path).string()), seeds);
    if (head.resolution)
        text += fmt::format("resolution = [{}, {}]\n", head.resolution->first, head.resolution->second);
    if (head.epsilon) text += fmt::format("epsilon = {}\n", *head.epsilon);
    std::vector<std::string> folders;
    for (const auto& folder : head.paths)
        folders.push_back(quoted_toml(fs::absolute(folder).string()));
    if (!folders.empty()) text += fmt::format("paths = [{}]\n", fmt::join(folders, ", "));
    text += fmt::format("[reference]\ntarget = {:.3g}\n", parse_target(file_.target) / 4);
    for (const auto& label : labels)
        text += method_table(endless(label));
    return text;
}

void TuningRuns::open(const std::vector<MethodLabel>& labels, int seeds) {
    Experiment experiment = parse_experiment(experiment_text(labels, seeds), "tune-" + scene_.name + ".toml");
    session_.reset();  // the folder is locked by one at a time
    session_ = std::make_unique<RunSession>(checked_setup(std::move(experiment), options_), options_, FolderUse::alone);
}

double TuningRuns::used() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count() + stored_seconds_;
}

std::string TuningRuns::make_reference(double seconds, double most_seconds) {
    RunScene& scene = session_->setup.scenes.front();
    const double target = parse_target(file_.target), wanted_error = wanted_reference_error * target,
                 most_error = most_reference_error * target;
    std::optional<double> error;  // relative standard error; none: the reference samples no light
    for (const double limit : {seconds, most_seconds}) {
        scene.entry.goal.seconds = limit;
        session_->make_references();
        if (session_->references.has_failed(0)) throw RunError(session_->log.failures.back().text());
        const Reference reference = read_reference(session_->folder.reference_image(scene.entry.name));
        const Judgement judgement(reference);
        if (!judgement.is_empty())
            error = relative_standard_error(judgement.total(),
                                            judgement.denominators(judgement.epsilon(file_.head.epsilon)));
        if (!error || *error <= wanted_error) break;
        scene.entry.goal.target = wanted_error;  // what it goes on for
    }
    session_->write_index();  // with the notes on the reference
    if (!error) return "the reference samples no light of the scene";
    if (*error <= most_error) return "";
    const Experiment& head = file_.head;
    std::string command = fmt::format("gibench reference {} --target {:.3g}%", scene_.path, 25 * target);
    if (head.resolution) command += fmt::format(" --resolution {}x{}", head.resolution->first, head.resolution->second);
    if (head.epsilon) command += fmt::format(" --epsilon {}", *head.epsilon);
    for (const std::string& folder : head.paths)
        command += " -a " + folder;
    const std::string key = reference_key(scene.content_hash, session_->setup.experiment.reference_method);
    return fmt::format(
        "the reference's noise hides {}: its own error is {:.3g} %, and has to be {:.3g} % at most. This command "
        "improves "
        "it; repeat the tuning after it:\n{} -o {}",
        file_.target, 100 * *error, 100 * most_error, command, cached_reference_path(key));
}

WorkCell TuningRuns::cell_of(const Wanted& wanted) const {
    WorkCell cell = work_cell(session_->setup, 0, endless(wanted.label), wanted.seed);
    cell.identity.budget.seconds = rounded_budget(wanted.budget);
    cell.identity.reference = session_->references.identity(0);
    if (!is_experiment_) cell.name += fmt::format("-{:.3g}s", wanted.budget);
    return cell;
}

std::vector<TuningRuns::Run> TuningRuns::measured(const std::vector<Wanted>& wanted, double deadline) {
    const ResultFolder& folder = session_->folder;
    std::vector<WorkCell> cells;
    for (const Wanted& one : wanted)
        cells.push_back(cell_of(one));
    std::vector<const WorkCell*> missing;
    for (const WorkCell& cell : cells) {
        const auto stored = folder.read_cell(cell.name, cell.identity.key());
        if (stored) stored_seconds_ += stored->load_seconds + stored->last().seconds;
        else missing.push_back(&cell);
    }
    const std::size_t begun =
        run_cells(missing, session_->runner, session_->log.progress, [&] { return deadline - used(); });
    const std::span left_out = std::span(missing).subspan(begun);
    std::vector<Run> runs;
    for (const WorkCell& cell : cells)
        runs.push_back({folder.read_cell(cell.name, cell.identity.key()), std::ranges::count(left_out, &cell) > 0});
    return runs;
}

void TuningRuns::begin_experiment(const std::vector<MethodLabel>& labels, const std::vector<double>& budgets,
                                  int seeds) {
    open(labels, seeds);
    is_experiment_ = true;
    std::map<std::string, Budget> own;
    for (const WorkCell& cell : session_->list.all())
        for (std::size_t i = 0; i < labels.size(); ++i)
            if (endless(labels[i]).text() == cell.identity.method)
                own[cell.name] = {rounded_budget(budgets[i]), std::nullopt};
    session_->list.keep(own);
}

std::string TuningRuns::write_results(const std::string& tune_json) {
    write_file(session_->folder.file("tune.json"), tune_json);
    return session_->write_results();
}

bool TuningRuns::is_unbiased(const MethodLabel& label) const {
    return find_method(label.name).unbiased && filter_of(label).empty() && left_out(label).empty();
}

const LeftOut& TuningRuns::left_out(const MethodLabel& label) const {
    return session_->setup.left_out.at({scene_.name, endless(label).text()});
}

}  // namespace gib
