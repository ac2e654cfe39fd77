// Emission and direct light by eye paths of their own (direct_samples): the same light, with the noise of as many passes.

#include "tests/support/moments.h"
#include "tests/support/scene_fixtures.h"

namespace gib::direct_samples_test {
namespace {

using test::mean_of;
using test::render;

constexpr Component straight[] = {Component::emission, Component::direct};

/// The mean over pixels and channels of the variance over seeds.
double variance_over_seeds(const LoadedScene& scene, const std::string& label, std::uint32_t passes, Component c) {
    constexpr std::uint64_t seeds = 12;
    std::vector<test::Moments> values;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        const Image image = *render(scene, label, passes, seed)[c];
        values.resize(image.rgb.size());
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i].add(image.rgb[i]);
    }
    double sum = 0;
    for (const test::Moments& value : values)
        sum += static_cast<double>(seeds) * value.standard_error() * value.standard_error();
    return sum / static_cast<double>(values.size());
}

// The path that looks up photons takes the same random numbers with and without them.
TEST(DirectSamples, LeaveTheLightOfPhotonsAsItIs) {
    const auto scene = test::shipped_scene("cornell-glass.xml", {{}, std::pair{20, 20}});
    for (const std::string label : {"photon_mapper photons=5000", "photon_mapper photons=5000 gather=16 cache=on"}) {
        const auto one = render(scene, label, 2), many = render(scene, label + " direct_samples=11", 2);
        for (Component c : {Component::caustic, Component::indirect})
            EXPECT_EQ(one[c]->rgb, many[c]->rgb) << label << ' ' << name_of(c);
        for (Component c : straight)
            EXPECT_NE(one[c]->rgb, many[c]->rgb) << label << ' ' << name_of(c);
    }
}

// Both estimate emission and direct light without bias: glass and a mirror, a medium, glossy plates. Four standard errors,
// each below 3 % of the light.
TEST(DirectSamples, EmissionAndDirectLightAreThoseOfThePathTracer) {
    for (const char* file : {"cornell-glass.xml", "fog.xml", "veach-mis.xml"}) {
        const auto scene = test::shipped_scene(file, {{}, std::pair{24, 24}});
        for (Component c : straight) {
            test::Moments path, photons;
            for (std::uint64_t seed = 1; seed <= 12; ++seed) {
                path.add(mean_of(*render(scene, "path", 64, seed)[c]).mean());
                photons.add(mean_of(*render(scene, "photon_mapper photons=1000 direct_samples=16", 4, seed)[c]).mean());
            }
            const double error = std::hypot(path.standard_error(), photons.standard_error());
            EXPECT_LT(error, 0.03 * path.mean()) << file << ' ' << name_of(c);
            EXPECT_NEAR(photons.mean(), path.mean(), 4 * error) << file << ' ' << name_of(c);
        }
    }
}

// Sixteen paths a pixel are sixteen points of one Owen-scrambled sequence, however passes divide them, so that the
// variance is the same. Were the paths of a pass repeated in the next one, it would be four times as large. The ratio of two
// such estimates scatters by about a tenth.
TEST(DirectSamples, HaveTheNoiseOfAsManyPasses) {
    const auto scene = test::shipped_scene("cornell-glass.xml", {{}, std::pair{24, 24}});
    const std::string label = "photon_mapper photons=0 caustic_photons=0";
    for (Component c : straight) {
        const double of_passes = variance_over_seeds(scene, label, 16, c);
        for (const auto& [passes, count] : {std::pair{1u, 16}, std::pair{4u, 4}}) {
            const std::string many = label + " direct_samples=" + std::to_string(count);
            EXPECT_NEAR(variance_over_seeds(scene, many, passes, c) / of_passes, 1, 0.35) << name_of(c) << ' ' << count;
        }
    }
}

}  // namespace
}  // namespace gib::direct_samples_test
