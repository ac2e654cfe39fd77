#pragma once
// Answers in sentences, for table.md and the report: which method is cheapest, and what to know before.

#include "experiments/analysis/table_row.h"

#include <array>
#include <string>
#include <vector>

namespace gib {

/// Indices into target_errors of the errors for which the cheapest method is named: 5 % and 1 %.
inline constexpr std::array<std::size_t, 2> asked_targets = {1, 3};

/// The answer for a scene and each of asked_targets: which method is cheapest, which ones cannot be told from it, how much
/// longer the next one takes, and how far the others are then. Where the reference does not judge a component that holds
/// light, there is one answer: no method is the cheapest. Times that no run has measured are marked as extrapolated by
/// the fitted law.
std::vector<std::string> price_answers(const Analysis& analysis, const std::string& scene);

/// The same in a few words: the method that reaches an error first, or why none does.
struct ShortAnswer {
    std::string method;  ///< a label, "not reached", "not resolved" or "not judged"
    std::string detail;  ///< time and doubts, or the closest method; may be empty
};
ShortAnswer cheapest(const Analysis& analysis, const std::string& scene, std::size_t target);

/// "Warning: ...", with the command that helps.
std::string sentence_of(const Warning& warning);

}  // namespace gib
