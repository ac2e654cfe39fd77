// Whole scenes as people have them, in the words of Mitsuba 0.6 (found/): rooms under a sky, an environment or lamps of
// a temperature. Each loads with the warnings that it should have, and path tracing and photon mapping agree about its
// mean.

#include "tests/support/moments.h"
#include "tests/support/scene_fixtures.h"
#include "tests/support/scene_text.h"

#include <gmock/gmock.h>

#include <array>

namespace gib::test::found_scenes_test {
namespace {

using ::testing::HasSubstr;

/// Name of the file, and a part of each warning, in their order.
using FoundScene = std::pair<std::string, std::vector<std::string>>;

class FoundScenes : public ::testing::TestWithParam<FoundScene> {
protected:
    FoundScenes() {
        std::string pixels = "P6\n8 4\n255\n", normals = pixels;
        for (int i = 0; i < 96; ++i)
            pixels += static_cast<char>(30 + 2 * i);
        folder_.write("picture.ppm", pixels);
        for (int i = 0; i < 32; ++i) {
            normals += static_cast<char>(100 + 8 * (i % 8));
            normals += static_cast<char>(100 + 16 * (i / 8));
            normals += static_cast<char>(240);
        }
        folder_.write("normals.ppm", normals);
    }
    TemporaryFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(All, FoundScenes,
                         ::testing::Values(FoundScene{"room-under-sun-and-sky", {}},
                                           FoundScene{"table-under-the-sky-of-an-hour", {}},
                                           FoundScene{"room-with-lamps-of-two-temperatures", {}},
                                           FoundScene{"pictures-under-an-environment", {"'ewa'"}},
                                           FoundScene{"statue-in-the-evening-sun", {"nothing refers to this medium"}},
                                           FoundScene{"balls-of-copper-and-mixtures", {}},
                                           FoundScene{"tiles-with-a-normal-map", {}}));

// The mean of the image over 8 seeds each. The tolerance is 4 standard errors of the difference, and 3 % for the bias of
// the photon map. With errors from 8 seeds, alpha is 3 % for all 7 scenes and 3 channels together. The seeds are fixed.
TEST_P(FoundScenes, LoadAndLookAlikeToPathTracingAndPhotonMapping) {
    const auto& [name, warnings] = GetParam();
    const LoadedScene scene =
        load_scene(source_path("tests/scenes/found/" + name + ".xml"), {{}, std::nullopt, {folder_ / ""}});
    ASSERT_EQ(scene.warnings.size(), warnings.size()) << ::testing::PrintToString(scene.warnings);
    for (std::size_t i = 0; i < warnings.size(); ++i)
        EXPECT_THAT(scene.warnings[i], HasSubstr(warnings[i]));
    const auto means = [&](const std::string& label) {
        std::array<Moments, 3> channels;
        for (std::uint64_t seed = 1; seed <= 8; ++seed) {
            const Colord mean = mean_of(render(scene, label, 16, seed).total());
            for (std::size_t c = 0; c < 3; ++c)
                channels[c].add(mean[static_cast<Eigen::Index>(c)]);
        }
        return channels;
    };
    const auto path = means("path"), photons = means("photon_mapper photons=20000 k=40");
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_GT(path[c].mean(), 1e-3);
        const double error = std::hypot(path[c].standard_error(), photons[c].standard_error());
        EXPECT_NEAR(photons[c].mean(), path[c].mean(), 4 * error + 0.03 * path[c].mean());
    }
}

}  // namespace
}  // namespace gib::test::found_scenes_test
