#pragma once
// Which method is cheapest, and what to know before, for table.md, the report and the terminal.

#include "experiments/analysis/table_row.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// Indices into target_errors of the errors for which the cheapest method is named: 5 % and 1 %.
inline constexpr std::array<std::size_t, 2> asked_targets = {1, 3};

/// A method in the verdict about an error that is to be reached.
struct VerdictRow {
    std::optional<std::size_t> target = {};  ///< index into target_errors; empty: of all of them
    std::string method = "";                 ///< empty: no method is the cheapest, and `remark` says why
    Field seconds = {};                      ///< to the error: measured, or what is known
    Field factor = {};                       ///< the same as a multiple of the best one's
    Field error = {};         ///< relative RMSE after the best one's time; if none has reached it, of the final images
    std::string parts = "";   ///< components that hold the squared error: "90 % caustic, 10 % indirect"
    std::string kind = "";    ///< bias or noise: error_kind()
    std::string remark = "";  ///< how it stands beside the others, and what it leaves out
    bool is_best = false;
};

/// The verdict about a scene: for each of asked_targets the cheapest method, the next one, and the best label of each other
/// method; where none has reached the error, the closest ones. Where the reference does not judge a component that holds
/// light, there is one row: no method is the cheapest.
std::vector<VerdictRow> verdict(const Analysis& analysis, const std::string& scene);

/// The same in a few words: the method that reaches an error first, or why none does.
struct ShortAnswer {
    std::string method;  ///< a label, "not reached", "not resolved" or "not judged"
    std::string detail;  ///< time and doubts, or the closest method; may be empty
};
ShortAnswer cheapest(const Analysis& analysis, const std::string& scene, std::size_t target);

/// "Warning: ...", with the command that helps.
std::string sentence_of(const Warning& warning);

}  // namespace gib
