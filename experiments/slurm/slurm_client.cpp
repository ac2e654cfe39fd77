#include "experiments/slurm/slurm_client.h"

#include "common/core/number_text.h"
#include "common/core/reject.h"
#include "experiments/system/child_process.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <sstream>

namespace gib {

namespace {

namespace fs = std::filesystem;

bool is_on_path(const std::string& program) {
    const char* path = std::getenv("PATH");
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');)
        if (::access((folder + "/" + program).c_str(), X_OK) == 0) return true;
    return false;
}

/// The lines that a command prints.
std::vector<std::string> lines_of(const std::vector<std::string>& command) {
    std::vector<std::string> lines;
    run_child(command, [&](const std::string& line) { lines.push_back(line); });
    return lines;
}

/// A word for the shell that runs a job's script.
std::string quoted(const std::string& word) {
    if (word.starts_with(task_index)) return word;
    std::string text = "'";
    for (const char c : word)
        text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

/// Ascending numbers as Slurm writes them, "0-2,5".
std::string ranges_of(const std::vector<std::size_t>& numbers) {
    std::string text;
    for (std::size_t i = 0, end; i < numbers.size(); i = end) {
        for (end = i + 1; end < numbers.size() && numbers[end] == numbers[end - 1] + 1;)
            ++end;
        text += fmt::format("{}{}", i > 0 ? "," : "", numbers[i]);
        if (end > i + 1) text += fmt::format("-{}", numbers[end - 1]);
    }
    return text;
}

}  // namespace

void require_slurm() {
    for (const char* program : {"sbatch", "srun", "squeue", "scontrol"})
        if (!is_on_path(program))
            reject(
                {},
                "--on slurm needs Slurm's command '{}', which is not on the PATH; run this on a machine that submits "
                "jobs, or leave out --on slurm",
                program);
}

std::size_t largest_array() {
    for (const std::string& line : lines_of({"scontrol", "show", "config"})) {
        std::istringstream words(line);
        std::string key, equals;
        std::size_t value = 0;
        if (!(words >> key >> equals >> value) || key != "MaxArraySize") continue;
        if (value == 0) throw RunError("this Slurm takes no array jobs: its MaxArraySize is 0");
        return value;
    }
    throw RunError("'scontrol show config' does not say MaxArraySize");
}

std::vector<SlurmTask> active_tasks() {
    std::vector<SlurmTask> tasks;
    for (const std::string& line : lines_of({"squeue", "--me", "--array", "--noheader", "--format=%F %K"})) {
        std::istringstream words(line);
        SlurmTask task;
        std::string index;
        if (!(words >> task.job >> index)) continue;
        task.index = number_from<std::size_t>(index).value_or(0);  // "N/A" without an array
        tasks.push_back(task);
    }
    return tasks;
}

std::uint64_t submit_job(const SlurmJob& job) {
    std::string command = fmt::format("exec srun --ntasks=1 --cpus-per-task={} --cpu-bind=cores", job.cpus);
    for (const std::string& word : job.command)
        command += " " + quoted(word);
    std::vector<std::string> arguments = {
        "sbatch",
        "--parsable",
        "--requeue",
        "--open-mode=append",
        "--ntasks=1",
        "--job-name=" + job.name,
        fmt::format("--cpus-per-task={}", job.cpus),
        "--chdir=" + fs::current_path().string(),
        fmt::format("--output={}/%x-%{}.txt", log_pattern(fs::absolute(job.log_folder).string()),
                    job.tasks.empty() ? "j" : "A_%a")};
    arguments.insert(arguments.end(), job.user_options.begin(), job.user_options.end());
    if (!job.tasks.empty()) arguments.push_back("--array=" + ranges_of(job.tasks));
    if (!job.after.empty()) arguments.push_back(fmt::format("--dependency=afterany:{}", fmt::join(job.after, ":")));
    arguments.push_back("--wrap=" + command);
    const auto lines = lines_of(arguments);
    // sbatch --parsable prints JOB or JOB;CLUSTER.
    const std::string answer = lines.empty() ? "" : lines.back();
    const auto number = number_from<std::uint64_t>(answer.substr(0, answer.find(';')));
    if (!number) throw RunError(fmt::format("sbatch has answered '{}' instead of a job's number", answer));
    return *number;
}

std::uint64_t own_job() {
    const char* number = std::getenv("SLURM_JOB_ID");
    return number ? number_from<std::uint64_t>(number).value_or(0) : 0;
}

void forget_own_job() {
    std::vector<std::string> names;
    for (char** entry = environ; *entry; ++entry) {
        const std::string name = std::string(*entry).substr(0, std::string(*entry).find('='));
        if (name != "SLURM_CONF" && (name.starts_with("SLURM") || name.starts_with("SRUN_"))) names.push_back(name);
    }
    for (const std::string& name : names)
        ::unsetenv(name.c_str());
}

std::string log_pattern(const std::string& path) {
    std::string pattern;
    for (const char c : path) {
        if (c == '\\') reject({path, 0, 0}, "Slurm writes no logs to a path with a backslash");
        if (c == '%') pattern += '%';
        pattern += c;
    }
    return pattern;
}

}  // namespace gib
