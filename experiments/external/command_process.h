#pragma once
// Runs the command of another renderer under the clock. `gibench run` starts the program with the internal subcommand
// `measure-command request.json`; that process forks a shell with the command, waits, and leaves seconds and memory in
// result.json. It stands between the two because the peak memory of a process that a large one starts includes that of
// its parent (ru_maxrss is kept across exec), while this one is small.

#include <string>

namespace gib {

struct CommandRequest {
    std::string command;      ///< text for /bin/sh
    std::string folder;       ///< folder in which it runs
    double timeout = 0;       ///< wall-clock time after which it is killed [s]
    std::string cell_folder;  ///< receives its standard output and error: stdout.txt and stderr.txt
    std::string work_folder;  ///< folder for request.json and result.json
};

struct CommandResult {
    double seconds = 0;       ///< wall-clock time from the start of the shell to its end [s]
    double peak_rss_mib = 0;  ///< largest resident set among the shell and the processes that it waited for [MiB]
    bool timed_out = false;
    int exit_code = 0;
    int signal = 0;  ///< signal that ended it; 0: none
};

/// Runs in the process of `measure-command`. When the command has ended, all processes that it has started are killed, also
/// those in sessions of their own.
void measure_command(const std::string& request_file);

/// Starts `program` as that process and returns what it measured. Throws RunError if it cannot be started, and
/// Interrupted on Ctrl-C, after the command has been killed.
CommandResult run_command(const std::string& program, const CommandRequest& request);

}  // namespace gib
