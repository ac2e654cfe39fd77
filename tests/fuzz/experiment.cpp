// The fuzz target of experiment files. Their scenes must exist but are not read.

#include "experiments/plan/experiment_file.h"
#include "methods/method.h"
#include "tests/fuzz/harness.h"

#include <cmath>
#include <set>

namespace gib::fuzz {

namespace {

void check_experiment(const Experiment& experiment) {
    require(!experiment.scenes.empty() && !experiment.methods.empty(), "there is a scene and a method");
    require(experiment.seeds >= 1, "there is a seed");
    require(!experiment.epsilon || (std::isfinite(*experiment.epsilon) && *experiment.epsilon > 0),
            "epsilon is above 0");
    for (const auto& scene : experiment.scenes)
        require(scene.goal.target || scene.goal.seconds || !scene.reference_image.empty(),
                "every reference has a goal");
    std::set<std::string> labels;
    for (const MethodLabel& label : experiment.methods) {
        require(labels.insert(label.text()).second, "labels are different");
        // Cells and references are found by their label when an experiment is resumed.
        require(MethodLabel::parse(label.text()).values == label.values, "a label is read as it was written");
        if (const ExternalMethod* external = experiment.external(label)) {
            require(external->takes("scene") && external->takes("out"), "a command takes a scene and writes an image");
            continue;
        }
        const auto& method = find_comparable_method(label.name);
        method.create(ParameterValues(all_parameters(method), label), MethodDefaults{});
    }
}

}  // namespace

void run_input(std::string_view input) {
    static const ScratchFolder folder;
    static const bool written = [] {
        for (const char* name : {"a.xml", "b.xml", "c.xml"})
            folder.write(name, "<scene version='3.0.0'/>");
        return true;
    }();
    require(written, "there are scenes");
    unless_refused([&] {
        const std::string path = folder / "input.toml";
        if (const auto tuning = parse_tune_file(std::string(input), path))
            require(!tuning->head.scenes.empty() && tuning->minutes > 0, "there is a scene and time for it");
        else check_experiment(parse_experiment(std::string(input), path));
    });
}

}  // namespace gib::fuzz
