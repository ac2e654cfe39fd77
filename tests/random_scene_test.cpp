// Random scenes with every method: images are finite and not negative, and no sample was dropped.

#include "tests/hard_cases.h"
#include "tests/random_scenes.h"

namespace gib {
namespace {

using namespace test;

/// Scenes of the sweep; the environment may ask for more.
std::uint64_t first_scene() { return std::getenv("GIB_SWEEP_FIRST") ? std::stoull(std::getenv("GIB_SWEEP_FIRST")) : 0; }
std::uint64_t scene_count() {
    return std::getenv("GIB_SWEEP_SCENES") ? std::stoull(std::getenv("GIB_SWEEP_SCENES")) : 200;
}

/// Options that find little light quickly.
const std::vector<std::pair<std::string, std::string>>& swept_methods() {
    static const std::vector<std::pair<std::string, std::string>> methods = {
        {"path", "path"},
        {"photons", "photon_mapper photons=300"},
        {"photons_all", "photon_mapper photons=300 k=all radius=0.05 caustic_radius=0.02 kernel=cone"},
        {"gather", "photon_mapper photons=300 gather=4"},
        {"cache", "photon_mapper photons=300 gather=8 cache=on"},
        {"shadows", "photon_mapper photons=300 shadow_photons=300 shadows=guide"},
        {"radiosity", "radiosity patch=0.3"},
    };
    return methods;
}

class RandomScenes : public testing::TestWithParam<std::pair<std::string, std::string>> {};

TEST_P(RandomScenes, AreFiniteAndNotNegative) {
    const auto& [name, label] = GetParam();
    const TemporaryFolder folder;
    std::uint64_t judged = 0;
    for (std::uint64_t seed = first_scene(); seed < first_scene() + scene_count(); ++seed) {
        SCOPED_TRACE("scene " + std::to_string(seed));
        RandomScene description = random_scene(seed, seed % 4 == 0 ? SceneMood::matt : SceneMood::any);
        description.camera.size = 4;
        const LoadedScene scene = scene_of(scene_file(description, folder));
        if (!simulates(label, *scene.scene)) continue;
        ++judged;
        const Image image = render(scene, label, 2, seed + 1, 1).total();
        for (const float x : image.rgb)
            ASSERT_TRUE(std::isfinite(x) && x >= 0.f) << x;
    }
    EXPECT_GT(judged, scene_count() / 8);
}

INSTANTIATE_TEST_SUITE_P(Methods, RandomScenes, testing::ValuesIn(swept_methods()),
                         [](const auto& method) { return method.param.first; });

}  // namespace
}  // namespace gib
