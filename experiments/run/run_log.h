#pragma once
// What a run says while it works: its line of progress, and what has failed.

#include "experiments/system/progress.h"

#include <string>
#include <vector>

namespace gib {

struct RunLog {
    struct Failure {
        std::string of;  ///< cell or reference
        std::string message;

        std::string text() const { return of + ": " + message; }
    };

    ProgressLine progress;
    std::vector<Failure> failures;

    void fail(const std::string& of, const std::string& message) {
        failures.push_back({of, message});
        progress.message("failed: " + failures.back().text());
    }
    /// Says all failures again at the end of a run, and returns its exit code.
    int exit_code() const;
};

}  // namespace gib
