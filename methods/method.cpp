#include "methods/method.h"

#include "common/core/nearest_word.h"
#include "common/core/reject.h"
#include "common/sampling/sampler.h"
#include "common/scene/scene.h"

#include <fmt/ranges.h>

#include <algorithm>

namespace gib {

StageTimes::Timer StageTimes::time(std::string_view stage) {
    for (auto& s : stages_)
        if (s->name == stage) return Timer(s->seconds);
    stages_.push_back(std::make_unique<Stage>(Stage{std::string(stage), 0.0}));
    return Timer(stages_.back()->seconds);
}

std::vector<StageTimes::Stage> StageTimes::stages() const {
    std::vector<Stage> copy;
    for (const auto& s : stages_)
        copy.push_back(*s);
    return copy;
}

void StageTimes::report(std::string_view stage, double fraction) const {
    if (!listener_) return;
    const std::unique_lock lock(listening_, std::try_to_lock);
    const auto now = std::chrono::steady_clock::now();
    if (!lock || now - last_report_ < std::chrono::milliseconds(100)) return;
    last_report_ = now;
    listener_(stage, fraction);
}

bool Plan::runs(std::string_view name) const {
    return std::any_of(steps.begin(), steps.end(), [&](const Step& step) { return step.name == name && step.runs; });
}

const std::vector<Parameter>& shared_parameters() {
    static const std::vector<Parameter> parameters = {
        integer_parameter("spp", "", "samples a pixel", 1, 0x1p31,
                          "largest number of passes; default: the scene's sample_count, else 16"),
        integer_parameter("max_depth", "", "edges", 0, 0x1p30,
                          "largest number of edges of a path, 0 = unlimited; default: the scene's max_depth, else "
                          "unlimited"),
        {.name = "filter",
         .kind = Parameter::Kind::text,
         .default_value = "none",
         .unit = "",
         .sentence = "what takes noise out of the image, and makes it biased: none; nlm (non-local means with two half "
                     "buffers, guided by albedo, normal and depth); in an experiment file also a command"},
    };
    return parameters;
}

int max_edges_of(const ParameterValues& values, const MethodDefaults& defaults) {
    if (!values.given("max_depth")) return defaults.max_edges;
    const auto depth = static_cast<int>(values.integer("max_depth"));
    return depth == 0 ? std::numeric_limits<int>::max() : depth;
}

Parameter point_set_parameter() {
    return choice_parameter("sampler", {"sobol", "independent"},
                            "random numbers of a pixel's samples: Owen-scrambled Sobol' points, or independent ones");
}
PointSet point_set_of(const ParameterValues& values) {
    return values.choice("sampler") == "sobol" ? PointSet::sobol : PointSet::independent;
}

Plan described_plan(const Scene& scene, const MethodDescription& method) {
    Plan plan;
    plan.called_for = effects_of(scene);
    plan.missing = plan.called_for - method.simulates;
    // Light of the environment is part of every component, and missing media or dispersion change each of them, since
    // any component can be seen through them.
    const bool media = plan.missing.has(Effect::participating_media);
    const bool all = media || plan.missing.has(Effect::dispersion) || plan.missing.has(Effect::environment_light);
    if (all) plan.unresolved.push_back(Component::emission);
    if (all || plan.missing.has(Effect::direct_light)) plan.unresolved.push_back(Component::direct);
    if (all || plan.missing.has(Effect::caustics)) plan.unresolved.push_back(Component::caustic);
    if (all || plan.missing.has(Effect::diffuse_interreflection)) plan.unresolved.push_back(Component::indirect);
    if (media) plan.unresolved.push_back(Component::volume);
    return plan;
}

void add_eye_paths(Plan& plan, const Scene& scene, int max_edges) {
    plan.add(step_eye_paths, scene.has_light() && max_edges >= 1,
             scene.has_light() ? "a path of no edges carries no light" : "nothing emits light");
}

std::string incomplete_components(const Plan& plan, const MethodLabel& label) {
    std::string names;
    for (Component c : plan.unresolved)
        names += (names.empty() ? "" : ", ") + std::string(name_of(c));
    return names.empty() ? "" : fmt::format("'{}' leaves out light of the components: {}", label.text(), names);
}

void add_light_sampling(Plan& plan, int max_edges) {
    const bool lit = plan.called_for.has(Effect::direct_light) || plan.called_for.has(Effect::glossy_lobes) ||
                     plan.called_for.has(Effect::participating_media);
    plan.add(step_light_sampling, lit && max_edges >= 2,
             lit ? "a path of direct light has two edges, more than max_depth allows"
                 : "no light can reach a diffuse or glossy surface");
}

ShownComponents shown_components(const Scene& scene, const Effects& effects, const MethodDescription& method) {
    const std::array<bool, component_count> shown = {
        scene.has_light(), effects.has(Effect::direct_light), effects.has(Effect::caustics),
        effects.has(Effect::diffuse_interreflection), scene.has_light() && effects.has(Effect::participating_media)};
    ShownComponents components;
    for (Component c : method.components)
        (shown[static_cast<std::size_t>(index_of(c))] ? components.accumulated : components.black).push_back(c);
    return components;
}

namespace {

std::vector<std::string> names_of_methods_with(bool MethodDescription::*property) {
    std::vector<std::string> names;
    for (const auto& method : method_registry())
        if (method.*property) names.push_back(method.name);
    return names;
}

}  // namespace

std::vector<std::string> names_of_comparable_methods() {
    return names_of_methods_with(&MethodDescription::estimates_radiance);
}
std::vector<std::string> names_of_methods_that_store_light() {
    return names_of_methods_with(&MethodDescription::stores_light);
}

const MethodDescription& find_method(std::string_view name, const SourceLocation& where) {
    std::vector<std::string> names;
    for (const auto& method : method_registry()) {
        if (method.name == name) return method;
        names.push_back(method.name);
    }
    reject(where, "unknown method '{}'{} There are: {}", name, did_you_mean_or_stop(name, names),
           fmt::join(names, ", "));
}

const MethodDescription& find_comparable_method(std::string_view name, const SourceLocation& where) {
    const MethodDescription& method = find_method(name, where);
    if (!method.estimates_radiance)
        reject(where, "'{}' estimates no radiance, so its images cannot be compared; there are: {}", name,
               fmt::join(names_of_comparable_methods(), ", "));
    return method;
}

std::vector<Parameter> all_parameters(const MethodDescription& method) {
    std::vector<Parameter> parameters = method.parameters;
    parameters.insert(parameters.end(), shared_parameters().begin(), shared_parameters().end());
    return parameters;
}

ConfiguredMethod::ConfiguredMethod(MethodLabel the_label, const SourceLocation& where)
    : label(std::move(the_label)),
      description(find_method(label.name, where)),
      values(all_parameters(description), label, where) {}

std::unique_ptr<Method> ConfiguredMethod::create(const MethodDefaults& defaults) const {
    return description.create(values, defaults);
}

}  // namespace gib
