// Final gathering and the irradiance cache as the photon mapper uses them.

#include "methods/parts/gathering/gather_ray.h"
#include "tests/support/seed_means.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gib::test::final_gather_test {
namespace {

const std::vector<std::string> ways = {
    "gather=16 source=irradiance",
    "gather=4 source=photons",
    "gather=16 source=paths",
    "gather=128 cache=on source=irradiance accuracy=0.3",
    "gather=128 cache=on source=photons accuracy=0.3",
    "gather=128 cache=on source=paths accuracy=0.3",
};

/// Expects the image's mean of indirect light to be the path tracer's in every channel: within 1 %, which blurring
/// may cost, and 4 standard errors. The standard error must be less than the share `resolution` of the mean.
void expect_the_path_tracers_mean(const LoadedScene& scene, const std::string& depth, double resolution) {
    const auto truth = means_over_seeds(scene, 256, 8, Component::indirect, "path" + depth);
    for (const auto& way : ways) {
        const auto found = means_over_seeds(scene, 4, 8, Component::indirect,
                                            "photon_mapper photons=1e5 caustic_photons=1000 " + way + depth);
        for (std::size_t c = 0; c < 3; ++c) {
            const double error = std::hypot(truth[c].standard_error(), found[c].standard_error());
            EXPECT_LT(error, resolution * truth[c].mean()) << way << depth;
            EXPECT_NEAR(found[c].mean(), truth[c].mean(), 0.01 * truth[c].mean() + 4 * error) << way << depth;
        }
    }
}

TEST(FinalGather, IndirectLightIsThePathTracers) {
    expect_the_path_tracers_mean(shipped_scene("cornell-box.xml", {{}, std::pair{32, 32}}), "", 0.01);
}

// Paths are limited to 3, 4 and 6 edges, also where glass and a mirror lengthen the paths to and from a gather ray.
TEST(FinalGather, NoPathIsLongerThanAllowed) {
    const auto box = shipped_scene("cornell-box.xml", {{}, std::pair{24, 24}});
    const auto glass = shipped_scene("cornell-glass.xml", {{}, std::pair{24, 24}});
    expect_the_path_tracers_mean(box, " max_depth=3", 0.015);
    expect_the_path_tracers_mean(box, " max_depth=4", 0.015);
    expect_the_path_tracers_mean(glass, " max_depth=6", 0.02);
}

TEST(FinalGather, NeedsPathsOfThreeEdges) {
    const auto box = shipped_scene("cornell-box.xml", {{}, std::pair{8, 8}});
    for (const auto& way : ways)
        EXPECT_EQ(mean_of(*render(box, "photon_mapper photons=1000 max_depth=2 " + way, 1)[Component::indirect]).sum(),
                  0)
            << way;
}

/// Relative RMSE of the indirect light against an image that is taken as the truth.
double relative_error(const Image& image, const Image& truth) {
    double sum = 0;
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        const double r = double{truth.rgb[i]}, d = double{image.rgb[i]} - r;
        sum += d * d / (r * r + 0.01 * 0.01);
    }
    return std::sqrt(sum / static_cast<double>(image.rgb.size()));
}

// More rays, records and photons bring the image nearer to the truth at every
// step, until the truth's own noise is reached.
TEST(FinalGather, ErrorsShrinkAsPhotonsRaysAndAccuracyGrow) {
    const auto box = shipped_scene("cornell-box.xml", {{}, std::pair{48, 48}});
    const Image truth = *render(box, "photon_mapper source=paths gather=256 photons=0", 64, 99)[Component::indirect];
    for (const std::string source : {"irradiance", "paths"}) {
        double previous = infinity;
        for (const char* effort : {"photons=3000 gather=32 accuracy=0.6", "photons=3e4 gather=128 accuracy=0.3",
                                   "photons=3e5 gather=1024 accuracy=0.15"}) {
            const Image image =
                *render(box, std::string("photon_mapper k=auto cache=on ") + effort + " source=" + source,
                        8)[Component::indirect];
            const double error = relative_error(image, truth);
            EXPECT_LT(error, 0.7 * previous) << effort << ' ' << source;
            previous = error;
        }
        EXPECT_LT(previous, 0.05) << source;
    }
}

// The walls are thinner than the spacing of photons, places and records. The result of final
// gathering must be as near to the path tracer's image as the density estimate that ends where the
// surface does. A leak would make ten times the error.
TEST(FinalGather, LeaksNotThroughThinWalls) {
    const auto wall = shipped_scene("thin-wall.xml", {{}, std::pair{32, 24}});
    const Image truth = *render(wall, "path", 1024, 99)[Component::indirect];
    const std::string photons = "photon_mapper photons=5e5 caustic_photons=1000 ";
    const double estimate = relative_error(*render(wall, photons, 4)[Component::indirect], truth);
    for (const char* way : {"gather=32", "gather=256 cache=on"})
        EXPECT_LT(relative_error(*render(wall, photons + way, 4)[Component::indirect], truth), estimate) << way;
}

}  // namespace
}  // namespace gib::test::final_gather_test
