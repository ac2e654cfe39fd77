#pragma once
// The methods of the tests that every method has to pass. They come from the registry, so that a new method is tested
// without being told. Names stand here alone, and only where a method needs other settings than its defaults.

#include "methods/method.h"
#include "tests/support/scene_fixtures.h"

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

namespace gib::test {

/// The settings of a method under test: its defaults, those of small renders, or those of sweeps over many scenes.
enum class Work { defaults, small, tiny };

struct MethodUnderTest {
    std::string name;   ///< of the method, or of a variant of it
    std::string label;  ///< with its settings
    const MethodDescription* description;
    std::vector<std::string> passes;  ///< that it runs in a scene with every effect

    Plan plan(const Scene& scene) const { return ConfiguredMethod(MethodLabel::parse(label)).create({})->plan(scene); }
    bool runs(std::string_view pass) const { return std::find(passes.begin(), passes.end(), pass) != passes.end(); }
    /// Whether it takes samples of each pixel. Paths from the lights alone spread over the whole scene, so that a small
    /// part of it is noisy after as many passes.
    bool samples_pixels() const { return runs(pass_eye_paths); }
    bool simulates(Effect effect) const { return description->simulates.has(effect); }
    /// Whether it simulates every effect that the scene calls for.
    bool simulates_all_of(const Scene& scene) const { return plan(scene).missing.empty(); }
    /// Whether it also makes every path.
    bool resolves(const Scene& scene) const {
        const Plan planned = plan(scene);
        return planned.missing.empty() && planned.unresolved.empty();
    }
};
inline void PrintTo(const MethodUnderTest& method, std::ostream* out) { *out << method.label; }

/// A scene that calls for every pass: a lamp and a point light over a floor, a ball of glass, fog.
inline const LoadedScene& scene_of_every_effect() {
    static const LoadedScene scene = scene_of(scene_xml(
        "<sensor type='perspective'>" + box_film(4) +
        "</sensor><shape type='rectangle'/><shape type='sphere'><bsdf type='dielectric'/></shape><shape "
        "type='rectangle'><transform name='to_world'><translate z='3'/></transform><emitter type='area'/></shape>"
        "<emitter type='point'/><shape type='cube'><transform name='to_world'><translate x='5'/></transform><bsdf "
        "type='null'/><medium name='interior' type='homogeneous'/></shape>"));
    return scene;
}

inline MethodUnderTest method_under_test(std::string name, const std::string& label) {
    MethodUnderTest method{std::move(name), label, &find_method(MethodLabel::parse(label).name), {}};
    for (const Plan::Step& step : method.plan(*scene_of_every_effect().scene).steps)
        if (step.runs) method.passes.push_back(step.pass);
    return method;
}

/// All methods that estimate radiance.
inline std::vector<MethodUnderTest> methods_under_test(Work work = Work::defaults) {
    struct Settings {
        std::string method, small, tiny;
    };
    // With radii of their own, progressive methods need no pilot of 65,536 light paths for each image.
    const std::vector<Settings> others = {
        {"photon_mapper", "photons=8000", "photons=500"},
        {"progressive_photon_mapper", "photons=500 radius=0.05 caustic_radius=0.02 volume_radius=0.05",
         "photons=250 radius=0.05 caustic_radius=0.03 volume_radius=0.05"},
        {"vcm", "radius=0.02 volume_radius=0.05", "radius=0.03 volume_radius=0.05"},
        {"radiosity", "patch=0.1", "patch=0.5"},
    };
    std::vector<MethodUnderTest> methods;
    for (const std::string& name : names_of_comparable_methods()) {
        const auto found = std::find_if(others.begin(), others.end(), [&](const auto& s) { return s.method == name; });
        const bool has_others = found != others.end() && work != Work::defaults;
        methods.push_back(method_under_test(
            name, has_others ? name + " " + (work == Work::small ? found->small : found->tiny) : name));
    }
    return methods;
}

/// Other ways to look up stored light, for cases that concern them.
inline std::vector<MethodUnderTest> look_up_variants(Work work) {
    const std::string photons = work == Work::small ? "photons=8000" : "photons=500",
                      rays = work == Work::small ? "8" : "4", rays_of_records = work == Work::small ? "32" : "8";
    const std::string map = "photon_mapper " + photons;
    return {
        method_under_test("photons_all", map + " k=all radius=0.05 caustic_radius=0.02 kernel=cone"),
        method_under_test("compensation", map + " k=30 compensation=on"),
        method_under_test("gather", map + " gather=" + rays),
        method_under_test("gather_paths", map + " gather=" + rays + " source=paths"),
        method_under_test("cache", map + " gather=" + rays_of_records + " cache=on"),
        method_under_test("shadows", map + " shadow_" + photons + " shadows=guide"),
    };
}
/// The progressive methods, that is, those whose radius may be found from a pilot, with the radius left to it.
inline std::vector<MethodUnderTest> pilot_variants() {
    std::vector<MethodUnderTest> variants;
    for (const std::string& name : names_of_comparable_methods()) {
        const auto& parameters = find_method(name).parameters;
        if (std::any_of(parameters.begin(), parameters.end(),
                        [](const Parameter& p) { return p.name == "radius" && p.default_value == "auto"; }))
            variants.push_back(method_under_test(name + "_pilot", name));
    }
    return variants;
}

/// Names tests by the method that is their parameter.
inline std::string name_of_method(const testing::TestParamInfo<MethodUnderTest>& info) { return info.param.name; }

}  // namespace gib::test
