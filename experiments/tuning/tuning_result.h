#pragma once
// The findings of a tuning, as text and as the file from which the report's section is made.

#include "experiments/results/layer.h"
#include "experiments/tuning/halving_search.h"
#include "experiments/tuning/time_estimate.h"

#include <string>
#include <vector>

namespace gib {

/// The search among the settings of one method.
struct TunedMethod {
    SearchSpace space;
    bool is_unbiased = false;        ///< and complete, so that it has no error floor
    LeftOut left_out = {};           ///< of the scene's effects and light
    std::vector<Trial> trials = {};  ///< all settings that were measured, the best first
};

/// A setting with its final runs, by seeds that have chosen nothing.
struct FinalSetting {
    std::size_t method;  ///< index of its TunedMethod
    Setting setting;
    bool is_best = false;  ///< the best one of its method; else its defaults
    double budget = 0;     ///< longest time of a run [s]
    Verdict verdict = {};
    bool is_fresh = true;  ///< false: no time was left for final runs, and the verdict is that of the search's run
};

struct TuningResult {
    std::string scene;        ///< name
    std::string target;       ///< relative RMSE, as asked for
    double minutes = 0;       ///< time that was asked for
    double used_seconds = 0;  ///< time that reference, search and final runs took
    std::vector<TunedMethod> methods = {};
    /// The best setting of each method first, in the order of the search's times.
    std::vector<FinalSetting> finals = {};
    std::vector<std::pair<double, Estimate>> along_the_way = {};  ///< seconds of the best setting to other errors
    std::vector<std::string> notes = {};                          ///< steps that were cut short for lack of time

    MethodLabel label(const FinalSetting& f) const { return methods[f.method].space.label(f.setting); }
    /// The first best setting of a method that has reached the target: of a complete method, or of any if none is
    /// complete. Null: none has reached it.
    const FinalSetting* best() const;
};

/// The label of the best setting, if one has reached the target, with its times; the defaults beside the best settings
/// of their method; what was cut; and at the end a line with the verdict of each method.
std::string tuning_text(const TuningResult& result);

/// tune.json, from which report/report_data.h makes the report's section: {"scene", "target", "used_seconds",
/// "minutes",
/// "methods": [{"base": label as asked for, "label", "paste", "state", "verdict", "seconds", "lo" and "hi": null if they
/// are not known, "parameters": [{"name", "unit", "sentence", "words": [...] or null}], "settings": [{"label",
/// "values": [number, word, or null without effect], "seconds": null if never, "measured": by the curve, not by its
/// law}]}],
/// "best": index of a method or null, "lines": of the text, "cuts": [...]}
std::string tuning_json(const TuningResult& result);

}  // namespace gib
