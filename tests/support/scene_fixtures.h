#pragma once
// Small scenes and renders shared by the tests.

#include "common/core/parallel.h"
#include "common/reader/scene_file.h"
#include "common/scene/scene.h"
#include "methods/method.h"
#include "tests/support/scene_builder.h"
#include "tests/support/source_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <functional>
#include <string>

namespace gib::test {

inline LoadedScene scene_of(const std::string& xml) { return parse_scene(xml, source_path("tests/inline.xml")); }

inline LoadedScene shipped_scene(const std::string& name, const SceneLoadOptions& options = {}) {
    return load_scene(source_path("scenes/" + name), options);
}

struct Rendered {
    ComponentImages image;
    RunCounts counts;
};

/// The image and the counts of a method after `passes` passes, or earlier if it converges or if its image after 16, 32, 64, ...
/// passes is `enough`.
inline Rendered render_and_count(const LoadedScene& scene, const std::string& label, std::uint32_t passes,
                                 std::uint64_t seed = 1, int threads = 0,
                                 const std::function<bool(const ComponentImages&)>& enough = {}) {
    Rendered result;
    with_threads(threads, [&] {
        const MethodLabel parsed = MethodLabel::parse(label);
        const MethodDescription& description = find_method(parsed.name);
        const auto method =
            description.create(ParameterValues(all_parameters(description), parsed), MethodDefaults{scene.max_edges});
        StageTimes stages;
        const auto run = method->start(*scene.scene, seed, stages);
        for (std::uint32_t pass = 0; pass < passes; ++pass) {
            if (run->advance(pass) == Progress::converged) break;
            if (enough && pass >= 15 && std::has_single_bit(pass + 1) && enough(run->image())) break;
        }
        EXPECT_EQ(run->counts().non_finite.count, 0u) << label;
        result = {run->image(), run->counts()};
    });
    return result;
}

inline ComponentImages render(const LoadedScene& scene, const std::string& label, std::uint32_t passes,
                              std::uint64_t seed = 1, int threads = 0) {
    return render_and_count(scene, label, passes, seed, threads).image;
}

/// Whether the method takes samples of each pixel. Paths from the lights alone spread over the whole scene, so that a
/// small part of it is noisy after as many passes; their means are compared with those of other methods, by their own
/// standard errors, in bidirectional_test.cpp.
inline bool samples_pixels(const MethodDescription& method, const LoadedScene& scene) {
    const Plan plan = ConfiguredMethod(MethodLabel{method.name, {}}).create({})->plan(*scene.scene);
    return std::any_of(plan.steps.begin(), plan.steps.end(),
                       [](const Plan::Step& step) { return step.name == step_eye_paths; });
}
inline bool samples_pixels(const MethodDescription& method) {
    return samples_pixels(method, shipped_scene("furnace.xml"));
}

/// Mean over pixels of each channel.
inline Colord mean_of(const Image& image) {
    Colord sum = Colord::Zero();
    for (std::size_t i = 0; i < image.pixels(); ++i)
        sum += image.at(i).cast<double>();
    return sum / static_cast<double>(image.pixels());
}

}  // namespace gib::test
