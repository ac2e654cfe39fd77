#include "common/core/nearest_word.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace gib {

namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
    // The rows hold the distances of a's first i - 1, i and i + 1 letters to all beginnings of b.
    std::vector<std::size_t> before, row(b.size() + 1), next(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        next[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            next[j + 1] = std::min({row[j] + (a[i] == b[j] ? 0 : 1), next[j] + 1, row[j + 1] + 1});
            if (i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j])
                next[j + 1] = std::min(next[j + 1], before[j - 1] + 1);
        }
        before = std::exchange(row, next);
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
