#include "methods/parts/vertices/joined_paths.h"

#include "common/scene/scene.h"

namespace gib {

Parameter shared_paths_parameter() {
    return choice_parameter(
        std::string(shared_paths_name), {"16", "1", "4", "64", "256"},
        "light paths of pixels nearby that a path from the camera is connected with where it first can be");
}
std::size_t shared_paths_of(const ParameterValues& values) { return std::stoul(values.choice(shared_paths_name)); }

void add_joined_paths(Plan& plan, const Scene& scene, const PathRules& rules) {
    add_light_paths(plan, scene, rules.max_edges);
    add_eye_paths(plan, scene, rules.max_edges);
    add_light_sampling(plan, rules.max_edges);
    plan.add(std::string(step_connections), rules.connects && rules.max_edges >= 3,
             rules.connects ? "a path with two inner vertices has three edges, more than max_depth allows"
                            : "connections are turned off");
}

std::unique_ptr<Run> start_joined_paths(const Scene& scene, const PathRules& rules,
                                        const MakeTechniqueImages& make_techniques, const Plan& plan,
                                        const ShownComponents& shown, std::uint64_t seed, StageTimes& stages) {
    return std::make_unique<JoinedPathsRun<NoMerging>>(scene, rules, make_techniques, plan, shown, seed, stages,
                                                       [](const LightPaths&) { return NoMerging(); });
}

}  // namespace gib
