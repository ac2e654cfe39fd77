#pragma once
// Work that the program hands to a process of its own: an internal subcommand reads request.json in a work folder, and
// leaves result.json there, which is written whole or not at all.

#include "common/core/error.h"
#include "common/core/files.h"
#include "experiments/system/child_process.h"
#include "experiments/text/json_record.h"

#include <fmt/format.h>

#include <unistd.h>
#include <functional>
#include <string>

namespace gib {

/// The file of the running program.
inline constexpr const char* own_program = "/proc/self/exe";

/// Runs in the parent: starts this program, waits for it and returns its result. Each line of its standard output is
/// passed to
/// `on_line`. Throws RunError with the child's message if it fails; on Ctrl-C it stops the child and throws Interrupted.
template <typename Result, typename Request>
Result result_of_child(const char* subcommand, const Request& request,
                       const std::function<void(const std::string& line)>& on_line) {
    const std::string file = request.work_folder + "/request.json";
    nlohmann::json j = request;
    j["parent"] = getpid();
    write_file(file, j.dump(1) + "\n");
    run_child({own_program, subcommand, file}, on_line);
    try {
        const nlohmann::json result = read_json(request.work_folder + "/result.json");
        return result.get<Result>();
    } catch (const std::exception& error) {
        throw RunError(fmt::format("the process left no record that can be read: {}", error.what()));
    }
}

/// Runs in the child, which ends when its parent dies.
template <typename Request>
Request request_of_parent(const std::string& file) {
    const nlohmann::json j = read_json(file);
    die_with_parent(j.at("parent"));
    return j.get<Request>();
}

template <typename Request, typename Result>
void leave_result(const Request& request, const Result& result) {
    write_file(request.work_folder + "/result.json", nlohmann::json(result).dump(1) + "\n");
}

}  // namespace gib
