// Random scenes with every method: images are finite and not negative, and no sample is dropped.

#include "tests/invariance/random_scenes.h"
#include "tests/support/methods_under_test.h"

#include <map>

namespace gib::random_scene_test {
namespace {

using namespace test;

/// The scenes of the sweep; GIB_SWEEP_FIRST and GIB_SWEEP_SCENES in the environment may ask for others.
std::uint64_t first_scene() { return std::getenv("GIB_SWEEP_FIRST") ? std::stoull(std::getenv("GIB_SWEEP_FIRST")) : 0; }
std::uint64_t scene_count() {
    return std::getenv("GIB_SWEEP_SCENES") ? std::stoull(std::getenv("GIB_SWEEP_SCENES")) : 200;
}

/// All methods, and other ways to look stored light up.
const std::vector<MethodUnderTest>& swept_methods() {
    static const std::vector<MethodUnderTest> methods = [] {
        auto all = methods_under_test(Work::tiny);
        for (MethodUnderTest& variant : look_up_variants(Work::tiny))
            all.push_back(std::move(variant));
        return all;
    }();
    return methods;
}
/// These take longer, so they see one scene in 16.
const std::vector<MethodUnderTest>& slow_methods() {
    static const std::vector<MethodUnderTest> methods = pilot_variants();
    return methods;
}

SceneMood mood_of(std::uint64_t scene) {
    if (scene % 16 == 0) return SceneMood::matt;  // few: curved shapes have many patches
    return scene % 4 == 0 ? SceneMood::polygons : SceneMood::any;
}

/// The sweep in parts, so that they can run in parallel.
class RandomScenes : public testing::TestWithParam<std::uint64_t> {};

TEST_P(RandomScenes, AreFiniteAndNotNegative) {
    constexpr std::uint64_t parts = 8;
    const TemporaryFolder folder;
    std::map<std::string, int> judged;
    for (std::uint64_t seed = first_scene() + GetParam(); seed < first_scene() + scene_count(); seed += parts) {
        RandomScene description = random_scene(seed, mood_of(seed / parts));
        description.camera.size = 4;
        const LoadedScene scene = scene_of(scene_file(description, folder));
        const auto sweep = [&](const std::vector<MethodUnderTest>& methods) {
            for (const MethodUnderTest& method : methods) {
                SCOPED_TRACE("scene " + std::to_string(seed) + ", " + method.label);
                if (!method.simulates_all_of(*scene.scene)) continue;
                ++judged[method.name];
                const Image image = render(scene, method.label, 2, seed + 1, 1).total();
                for (const float x : image.rgb)
                    EXPECT_TRUE(std::isfinite(x) && x >= 0.f) << x;
            }
        };
        sweep(swept_methods());
        if (seed / parts % 16 == 1) sweep(slow_methods());
    }
    for (const MethodUnderTest& method : swept_methods())
        EXPECT_GT(judged[method.name], 0) << method.label;
}

INSTANTIATE_TEST_SUITE_P(Parts, RandomScenes, testing::Range<std::uint64_t>(0, 8));

}  // namespace
}  // namespace gib::random_scene_test
