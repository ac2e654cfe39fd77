#include "experiments/tuning/tuning_text.h"

#include "experiments/text/numbers.h"

#include <fmt/format.h>

namespace gib {

std::string standing_text(const TuningResult& result, const FinalSetting& other) {
    if (other.cells.empty()) return "not measured with fresh seeds";
    if (other.log_times.empty()) return "not reached in the final runs";
    const Estimate factor = factor_between(other, result.best());
    return fmt::format("{} times as long{}", with_interval(factor),
                       holds_one(factor) ? ", cannot be told from the best" : "");
}

std::string tuning_text(const TuningResult& result) {
    const FinalSetting& best = result.best();
    std::string text = label_to_paste(result) + "\n";
    text += fmt::format("seconds to {}: {}, {} fresh seeds, 95 % interval\n", result.target,
                        with_interval(seconds_of(best)), best.log_times.size());
    for (const auto& [error, seconds] : times_along_the_way(result))
        text += fmt::format("seconds to {:g} %: {}\n", 100 * error, with_interval(seconds));
    for (const Speedup& speedup : speedups(result))
        text += sentence_of(result, speedup) + "\n";
    text += "other settings, each a method of the final runs:\n";
    for (const FinalSetting& other : result.finals) {
        if (&other == &best) continue;
        const std::string change = change_of(result, other);
        text += fmt::format("  {}: {}{}\n", standing_text(result, other), other.label.text(),
                            change.empty() ? "" : " (" + change + ")");
    }
    for (const auto& note : result.notes)
        text += "cut: " + note + "\n";
    return text;
}

}  // namespace gib
