#pragma once
// The methods of the tests that every method has to pass. They come from the registry, so that a new method is tested
// without a change here. Only methods that need other settings than their defaults are named.

#include "methods/method.h"
#include "tests/support/scene_fixtures.h"

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

namespace gib::test {

/// The settings of a method under test: its defaults, those of the mean of an image without much blur, of small renders,
/// and of sweeps over many scenes.
enum class Work { defaults, fine, small, tiny };

/// A scene that calls for every pass: a lamp and a point light over a floor, a ball of glass, fog.
inline const LoadedScene& scene_of_every_effect() {
    static const LoadedScene scene =
        test::Scene(
            camera(40, box_film(4)), emitter("point"), shape("rectangle"), shape("sphere", glass()),
            shape("rectangle", to_world(translate(0, 0, 3)), area_light(1)),
            shape("cube", to_world(translate(5, 0, 0)), bsdf("null"), "<medium name='interior' type='homogeneous'/>"))
            .load();
    return scene;
}

struct MethodUnderTest {
    std::string name;   ///< method, or a variant of it
    std::string label;  ///< method with its settings
    const MethodDescription* description;
    std::vector<std::string> passes;  ///< passes that it runs in a scene with every effect

    Plan plan(const gib::Scene& scene) const {
        return ConfiguredMethod(MethodLabel::parse(label)).create({})->plan(scene);
    }
    bool runs(std::string_view pass) const { return std::find(passes.begin(), passes.end(), pass) != passes.end(); }
    /// Whether it takes samples of each pixel. Paths from the lights alone spread over the whole scene, so that a small
    /// part of it is noisy after as many passes.
    bool samples_pixels() const { return runs(step_eye_paths); }
    /// Whether its images carry an estimate of their bias.
    bool estimates_bias() const { return render(scene_of_every_effect(), label, 1).total_bias().has_value(); }
    bool simulates(Effect effect) const { return description->simulates.has(effect); }
    /// Whether it simulates every effect that the scene calls for.
    bool simulates_all_of(const gib::Scene& scene) const { return plan(scene).missing.empty(); }
    /// Whether it also makes every path.
    bool resolves(const gib::Scene& scene) const {
        const Plan planned = plan(scene);
        return planned.missing.empty() && planned.unresolved.empty();
    }
};
inline void PrintTo(const MethodUnderTest& method, std::ostream* out) { *out << method.label; }

inline MethodUnderTest method_under_test(std::string name, const std::string& label) {
    MethodUnderTest method{std::move(name), label, &find_method(MethodLabel::parse(label).name), {}};
    for (const Plan::Step& step : method.plan(*scene_of_every_effect().scene).steps)
        if (step.runs) method.passes.push_back(step.name);
    return method;
}

/// All methods that estimate radiance.
inline std::vector<MethodUnderTest> methods_under_test(Work work = Work::defaults) {
    struct Settings {
        std::string method, fine, small, tiny;
    };
    // With radii of their own, progressive methods need no pilot of 65,536 light paths for each image.
    const std::vector<Settings> others = {
        {"photon_mapper", "photons=1e5", "photons=8000", "photons=500"},
        {"progressive_photon_mapper", "photons=1000 radius=0.02 caustic_radius=0.02 volume_radius=0.02",
         "photons=500 radius=0.05 caustic_radius=0.02 volume_radius=0.05",
         "photons=250 radius=0.05 caustic_radius=0.03 volume_radius=0.05"},
        {"vcm", "", "radius=0.02 volume_radius=0.05", "radius=0.03 volume_radius=0.05"},
        {"radiosity", "", "patch=0.1", "patch=0.5"},
    };
    std::vector<MethodUnderTest> methods;
    for (const std::string& name : names_of_comparable_methods()) {
        std::string settings;
        for (const Settings& of : others)
            if (of.method == name && work != Work::defaults)
                settings = work == Work::fine ? of.fine : work == Work::small ? of.small : of.tiny;
        methods.push_back(method_under_test(name, name + (settings.empty() ? "" : " " + settings)));
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
        method_under_test("gather", map + " gather=" + rays),
        method_under_test("gather_paths", map + " gather=" + rays + " source=paths"),
        method_under_test("cache", map + " gather=" + rays_of_records + " cache=on"),
        method_under_test("shadows", map + " shadow_" + photons),
        method_under_test("ray", map + " volume=ray"),
        method_under_test("beams", map + " volume=beams volume_" + photons),
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

/// The methods that take samples of each pixel.
inline std::vector<MethodUnderTest> methods_that_sample_pixels(Work work = Work::defaults) {
    auto methods = methods_under_test(work);
    std::erase_if(methods, [](const MethodUnderTest& method) { return !method.samples_pixels(); });
    return methods;
}

/// A suite whose parameter is the method.
class OfAMethod : public testing::TestWithParam<MethodUnderTest> {
protected:
    const MethodUnderTest& method() const { return GetParam(); }
    ComponentImages rendered(const LoadedScene& scene, std::uint32_t passes, const std::string& settings = "") const {
        return render(scene, method().label + (settings.empty() ? "" : " " + settings), passes);
    }
};
/// Names tests by the method that is their parameter.
inline std::string name_of_method(const testing::TestParamInfo<MethodUnderTest>& info) { return info.param.name; }

}  // namespace gib::test
