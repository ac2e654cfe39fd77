#include "experiments/tuning/tune_experiment.h"

#include "common/core/reject.h"
#include "experiments/results/result_folder.h"
#include "experiments/run/run_experiment.h"
#include "experiments/system/interrupt.h"
#include "experiments/tuning/tune.h"

#include <algorithm>
#include <ostream>

namespace gib {

int tune_experiment(const TuneFile& file, const RunOptions& options, std::ostream& out) {
    if (options.seeds) reject({}, "--seeds is for experiments without [tune], which has one seed, and six at the end");
    if (options.fresh)
        reject({}, "--fresh is for experiments without [tune]; delete the folder of the results instead");
    TuneOptions tuning;
    tuning.target = file.target;
    tuning.methods = file.methods;
    for (const auto& variation : file.variations)
        tuning.variations.push_back(parse_variation(variation.text, variation.where));
    tuning.minutes = file.minutes;
    tuning.threads = options.threads;
    tuning.resolution = file.head.resolution;
    tuning.epsilon = file.head.epsilon;
    tuning.folders = file.head.paths;
    tuning.program = options.program;
    tuning.command_line = options.command_line;
    check_tuning(tuning);
    const std::string folder = options.out ? *options.out : result_folder_of(file.head.name);
    int code = 0;
    bool any = false;
    for (const ExperimentScene& scene : file.head.scenes) {
        if (scene.name.find(options.only) == std::string::npos) continue;
        out << (any ? "\n" : "") << scene.name << ":\n";
        any = true;
        tuning.scene = scene.path;
        tuning.out = folder + "/" + scene.name;
        code = std::max(code, tune(tuning, out));
    }
    if (!any) reject({}, "--only '{}' keeps no scene: it is in no scene's name", options.only);
    return code;
}

int run_or_tune(const RunOptions& options, std::ostream& out) {
    if (const auto file = load_tune_file(options.experiment)) return tune_experiment(*file, options, out);
    return run_experiment(options, out);
}

}  // namespace gib
