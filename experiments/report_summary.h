#pragma once
// The report's answer in words: which method is cheapest, and why.

#include "experiments/analysis.h"

#include <string>
#include <vector>

namespace gib {

/// One method's price of an error.
struct Offer {
    std::string method;
    Estimate seconds;
};
/// Those that reach target_errors[target] in a scene's whole image, cheapest first.
std::vector<Offer> offers(const Analysis& analysis, const std::string& scene, std::size_t target);

/// Which method is cheapest at an error, by how much, and what the next one spends its time on. Plain text.
std::string cheapest_sentence(const Analysis& analysis, const std::string& scene, std::size_t target);
/// One for each target that a method reaches, and one for all that none does.
std::vector<std::string> cheapest_sentences(const Analysis& analysis, const std::string& scene,
                                            const std::vector<std::size_t>& targets);

}  // namespace gib
