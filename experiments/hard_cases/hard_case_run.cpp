#include "experiments/hard_cases/hard_case_run.h"

#include "common/core/files.h"
#include "common/reader/scene_file.h"
#include "experiments/hard_cases/hard_case_table.h"
#include "experiments/results/manifest.h"
#include "experiments/results/result_folder.h"
#include "experiments/system/child_process.h"
#include "experiments/system/file_lock.h"
#include "experiments/system/interrupt.h"
#include "experiments/system/progress.h"
#include "experiments/text/json_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <iostream>
#include <mutex>
#include <system_error>
#include <thread>

namespace gib {

namespace {

constexpr int exit_interrupted = 130;

class HardCaseRun {
public:
    explicit HardCaseRun(const RunOptions& options)
        : options_(options),
          file_(load_hard_cases(options.experiment)),
          folder_(options.out ? *options.out : result_folder_of(file_.name)),
          threads_(options.threads > 0 ? options.threads
                                       : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))) {
        if (options.seeds) {
            file_.seeds = *options.seeds;
            for (HardCase& hard : file_.cases)
                hard.seeds = *options.seeds;
        }
        if (file_.seeds < 2) throw InputError("hard cases need at least 2 seeds: their scatter is what is judged by");
        for (const HardCase& hard : file_.cases) {
            if (hard.relation == Relation::refused) {
                add(hard, "");
                continue;
            }
            for (const MethodLabel& method : file_.methods)
                add(hard, method.text());
        }
        if (rows_.empty()) throw InputError(fmt::format("--only '{}' keeps no pair of case and method", options.only));
        ResultFolder::make(folder_.path());
        require_writable(folder_.path());
        lock_.emplace(lock_result_folder(folder_.path()));
        remove_leftovers_in(folder_.path());
    }

    /// Judges the pairs in parallel, each on one thread, because their images are too small for several.
    void judge_all() {
        std::atomic<std::size_t> next = 0;
        std::vector<std::exception_ptr> errors(std::min(static_cast<std::size_t>(threads_), rows_.size()));
        const auto work = [&](std::exception_ptr& error) {
            try {
                for (std::size_t i; (i = next++) < rows_.size();)
                    judge_row(i);
            } catch (...) {
                error = std::current_exception();
                next = rows_.size();
            }
        };
        {
            std::vector<std::jthread> workers;  // joined at the end of this block, on an exception too
            workers.reserve(errors.size());
            try {
                for (auto& error : errors)
                    workers.emplace_back([&work, &error] { work(error); });
            } catch (const std::system_error& error) {
                next = rows_.size();
                throw RunError(fmt::format("cannot start {} threads: {}", errors.size(), error.what()));
            }
        }
        // Ctrl-C also reaches the children, possibly before this process. The way in which they ended
        // is no verdict then.
        InterruptGuard::check();
        for (const auto& error : errors)
            if (error) std::rethrow_exception(error);
    }

    /// Writes the results, table.md also to `out` and the pairs that do not hold to stderr. Returns whether all hold.
    bool write_results(std::ostream& out) {
        write_file(folder_.file("hard_cases.csv"), hard_case_csv(rows_).text());
        write_file(folder_.file("manifest.json"), manifest_text(index(), {.command_line = options_.command_line,
                                                                          .experiment_file = file_.path,
                                                                          .resolution = {},
                                                                          .cells = {}}));
        const std::string report = rebuild_hard_case_report(folder_.path());
        out << read_file(folder_.file("table.md")) << "\nReport: " << report << "\n";
        bool all_hold = true;
        for (const auto& row : rows_) {
            const Verdict verdict = row.verdict.verdict;
            if (verdict != Verdict::fails && verdict != Verdict::unresolved) continue;
            all_hold = false;
            std::cerr << fmt::format("{}: {}, {}: {}\n", name_of(verdict), row.hard.name,
                                     row.method.empty() ? "any method" : row.method, row.verdict.why);
        }
        return all_hold;
    }

private:
    void add(const HardCase& hard, const std::string& method) {
        const bool selected =
            hard.name.find(options_.only) != std::string::npos || method.find(options_.only) != std::string::npos;
        if (selected) rows_.push_back({.hard = hard, .method = method, .images = {}, .verdict = {}});
    }

    void judge_row(std::size_t number) {
        InterruptGuard::check();
        HardCaseRow& row = rows_[number];
        if (!row.method.empty())
            if (const auto why = exclusion(row.hard, MethodLabel::parse(row.method))) {
                row.verdict = {.verdict = Verdict::not_judged, .got = std::nullopt, .why = *why};
                finished();
                return;
            }
        std::string said;
        try {
            run_child(
                {options_.program, "judge-case", file_.path, row.hard.name, row.method, std::to_string(row.hard.seeds)},
                [&](const std::string& line) { said += line; });
            row.images = images_from_json(nlohmann::json::parse(said));
            row.verdict = judge(row.hard, row.images, file_.tail(), file_.resolve,
                                row.method.empty() ? Effects() : file_.may_leave_out(MethodLabel::parse(row.method)));
        } catch (const Interrupted&) {
            throw;
        } catch (const ChildNotStarted&) {
            throw;
        } catch (const std::exception& error) {
            row.verdict = {.verdict = Verdict::fails, .got = std::nullopt, .why = error.what()};
        }
        finished();
    }

    void finished() {
        const std::lock_guard lock(showing_);
        ++done_;
        const double share = static_cast<double>(done_) / static_cast<double>(rows_.size());
        const std::chrono::duration<double> so_far = std::chrono::steady_clock::now() - start_;
        progress_.update(share, so_far.count() * (1 / share - 1),
                         fmt::format("{} of {} pairs of case and method", done_, rows_.size()));
    }

    ResultIndex index() const {
        ResultIndex index;
        index.title = file_.title;
        index.experiment_text = file_.text;
        index.seeds = file_.seeds;
        index.threads = threads_;
        for (const auto& method : file_.methods)
            index.methods.push_back(method.text());
        return index;
    }

    RunOptions options_;
    HardCases file_;
    ResultFolder folder_;
    std::optional<FileLock> lock_;  ///< of the folder
    int threads_;
    std::vector<HardCaseRow> rows_;
    ProgressLine progress_;
    std::mutex showing_;
    std::size_t done_ = 0;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

int run_hard_cases(const RunOptions& options, std::ostream& out) {
    const InterruptGuard guard;
    HardCaseRun run(options);
    try {
        run.judge_all();
    } catch (const Interrupted&) {
        std::cerr << "interrupted: nothing is written\n";
        return exit_interrupted;
    }
    return run.write_results(out) ? 0 : 1;
}

void judge_case(const std::string& file, const std::string& name, const std::string& label, int seeds,
                std::ostream& out) {
    die_with_parent();
    for (const HardCase& hard : load_hard_cases(file).cases) {
        if (hard.name != name) continue;
        const std::string method = label.empty() ? "path" : label;
        out << to_json(render_hard_case(hard, MethodLabel::parse(method), seeds, 1)).dump() << std::endl;
        return;
    }
    throw InputError({file}, fmt::format("there is no case '{}'", name));
}

bool holds_hard_case_results(const std::string& folder) {
    return std::filesystem::exists(ResultFolder(folder).file("hard_cases.csv"));
}

std::string rebuild_hard_case_report(const std::string& folder_path) {
    const ResultFolder folder(folder_path);
    const std::string csv = folder.file("hard_cases.csv"), manifest = folder.file("manifest.json");
    std::string title;
    try {
        title = read_json(manifest).at("title");
    } catch (const nlohmann::json::exception& error) {
        throw InputError({manifest}, fmt::format("not a manifest: {}", error.what()));
    }
    const HardCaseTable table = hard_case_table(read_file(csv), csv, title);
    write_file(folder.file("table.md"), hard_case_markdown(table));
    write_file(folder.file("report.html"), hard_case_html(table));
    return folder.file("report.html");
}

}  // namespace gib
