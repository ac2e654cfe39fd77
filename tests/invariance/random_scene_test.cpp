// Random scenes with every method: images are finite and not negative, and no sample is dropped.

#include "tests/invariance/random_scenes.h"
#include "tests/support/hard_cases.h"

#include <map>

namespace gib::random_scene_test {
namespace {

using namespace test;

/// The scenes of the sweep; GIB_SWEEP_FIRST and GIB_SWEEP_SCENES in the environment may ask for others.
std::uint64_t first_scene() { return std::getenv("GIB_SWEEP_FIRST") ? std::stoull(std::getenv("GIB_SWEEP_FIRST")) : 0; }
std::uint64_t scene_count() {
    return std::getenv("GIB_SWEEP_SCENES") ? std::stoull(std::getenv("GIB_SWEEP_SCENES")) : 200;
}

/// Methods with options that are fast and noisy.
const std::vector<std::pair<std::string, std::string>>& swept_methods() {
    static const std::vector<std::pair<std::string, std::string>> methods = {
        {"path", "path"},
        {"photons", "photon_mapper photons=300"},
        {"photons_all", "photon_mapper photons=300 k=all radius=0.05 caustic_radius=0.02 kernel=cone"},
        {"gather", "photon_mapper photons=300 gather=4"},
        {"cache", "photon_mapper photons=300 gather=8 cache=on"},
        {"shadows", "photon_mapper photons=300 shadow_photons=300 shadows=guide"},
        {"radiosity", "radiosity patch=0.5"},
    };
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
        for (const auto& [name, label] : swept_methods()) {
            SCOPED_TRACE("scene " + std::to_string(seed) + ", " + label);
            if (!simulates(label, *scene.scene)) continue;
            ++judged[name];
            const Image image = render(scene, label, 2, seed + 1, 1).total();
            for (const float x : image.rgb)
                EXPECT_TRUE(std::isfinite(x) && x >= 0.f) << x;
        }
    }
    for (const auto& [name, label] : swept_methods())
        EXPECT_GT(judged[name], 0) << label;
}

INSTANTIATE_TEST_SUITE_P(Parts, RandomScenes, testing::Range<std::uint64_t>(0, 8));

}  // namespace
}  // namespace gib::random_scene_test
