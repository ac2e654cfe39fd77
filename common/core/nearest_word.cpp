#include "common/core/nearest_word.h"

#include <algorithm>
#include <numeric>

namespace gib {

namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
    // The row holds the distances of a's first i letters to all beginnings of b.
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
}

}  // namespace

std::string nearest_word(std::string_view word, const std::vector<std::string>& known) {
    std::string nearest;
    std::size_t least = 0;
    for (const std::string& candidate : known) {
        const std::size_t distance = edit_distance(word, candidate);
        if (3 * distance > candidate.size() || (!nearest.empty() && distance >= least)) continue;
        nearest = candidate;
        least = distance;
    }
    return nearest;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& known) {
    const std::string nearest = nearest_word(word, known);
    return nearest.empty() ? "" : "; did you mean '" + nearest + "'?";
}

std::string did_you_mean_or_stop(std::string_view word, const std::vector<std::string>& known) {
    const std::string question = did_you_mean(word, known);
    return question.empty() ? "." : question;
}

}  // namespace gib
