#pragma once
// Finds the word that was probably meant, for messages about a wrong one.

#include <string>
#include <string_view>
#include <vector>

namespace gib {

/// The known word with the smallest edit distance (Damerau 1964, restricted: one letter inserted, deleted or replaced, or two
/// neighbours swapped), the first of equals. Empty if even that one differs in more than a third of its letters.
std::string nearest_word(std::string_view word, const std::vector<std::string>& known);

/// "; did you mean 'render'?", or nothing if no known word is near.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& known);
/// The same before another sentence: a full stop if no known word is near.
std::string did_you_mean_or_stop(std::string_view word, const std::vector<std::string>& known);

}  // namespace gib
