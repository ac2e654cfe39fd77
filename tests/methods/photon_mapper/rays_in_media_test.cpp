// Photons and beams around the eye's ray (volume=ray, volume=beams), against closed forms and the path tracer.

#include "tests/support/same_means.h"
#include "tests/support/scene_text.h"
#include "tests/support/seed_means.h"
#include "tests/support/volume_file.h"

#include <fmt/format.h>
#include <numbers>

namespace gib::test::rays_in_media_test {
namespace {

constexpr double sigmas = 5;  ///< allowed errors, in standard errors of means over seeds: false alarm below 1e-4 a test
const std::string no_surface = bsdf("null");

/// Looks along -z at the square [-size, size]^2 of the plane z = 0.
std::string camera_above(double size, int pixels) {
    return element("sensor", "orthographic", to_world(scale(size, size, 1), look_at("0, 0, 5", "0, 0, 0")),
                   box_film(pixels));
}

class VolumeLookUps : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, VolumeLookUps, testing::Values("ray", "beams"),
                         [](const auto& name) { return name.param; });

// A spotlight at x = -2 sends a cone of 1 degree through the cube [-1, 1]^3 of fog. Across the view each bit dx of the pencil
// has come through x + 1 of the fog, and its light goes through another 1 to the camera. The image's mean is
// Phi sigma_s p(90 degrees) exp(-sigma_t) times the integral of exp(-sigma_t (x + 1)) from -0.1 to 0.1, over the area of 0.04 in view.
TEST_P(VolumeLookUps, APencilOfLightHasItsClosedForm) {
    constexpr double sigma_t = 0.7, albedo = 0.8, g = 0.4, intensity = 100, degrees = 1;
    const auto scene = scene_of(
        scene_xml(element("integrator", "volpath", integer("max_depth", 2)) + camera_above(0.1, 16) +
                  emitter("spot", to_world(look_at("-2, 0, 0", "0, 0, 0")), number("cutoff_angle", degrees),
                          number("beam_width", degrees), rgb("intensity", intensity)) +
                  shape("cube", no_surface, "<medium name='interior' type='homogeneous'>", number("sigma_t", sigma_t),
                        number("albedo", albedo), element("phase", "hg", number("g", g)), "</medium>")));
    const double flux = intensity * 2 * std::numbers::pi * (1 - std::cos(degrees * std::numbers::pi / 180));
    const double phase = (1 - g * g) / (4 * std::numbers::pi * std::pow(1 + g * g, 1.5));
    const double along = (std::exp(-sigma_t * 0.9) - std::exp(-sigma_t * 1.1)) / sigma_t / 0.04;
    const double expected = flux * albedo * sigma_t * phase * std::exp(-sigma_t) * along;
    const std::string photons = GetParam() == "ray" ? "2e5" : "1e4";
    const std::string label =
        fmt::format("photon_mapper photons=0 caustic_photons=0 volume_photons={} volume_radius=0.01 volume={}", photons,
                    GetParam());
    const Moments m = means_over_seeds(scene, 16, 12, Component::volume, label)[1];
    EXPECT_LT(m.standard_error(), 0.003 * expected) << "the test would not see an error";
    EXPECT_NEAR(m.mean(), expected, 0.002 * expected + sigmas * m.standard_error());
}

/// Parallel light of irradiance 1 in a layer of fog from z = -1 to z = 0, below the camera: it travels along `along` z = 1 or -1
/// and turned from the view by an angle of this tangent.
LoadedScene layer_in_parallel_light(double tangent, int along) {
    return scene_of(scene_xml(element("integrator", "volpath", integer("max_depth", 2)) + camera_above(0.4, 8) +
                              emitter("directional", vector("direction", tangent, 0, along), rgb("irradiance", 1)) +
                              shape("cube", to_world(scale(2, 2, 0.5), translate(0, 0, -0.5)), no_surface,
                                    "<medium name='interior' type='homogeneous'>", number("sigma_t", 1),
                                    number("albedo", 0.8), "</medium>")));
}

/// The integral over the depth t from 0 to 1 of sigma_s / (4 pi) exp(-t) exp(-s / c), where the light has come through s = t of the
/// layer, or 1 - t from below, and c is the cosine of its angle to the view.
double scattered_by_layer(double tangent, int along) {
    constexpr int steps = 1000;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double t = (i + 0.5) / steps, s = along < 0 ? t : 1 - t;
        sum += std::exp(-t - s * std::hypot(1, tangent)) / steps;
    }
    return 0.8 / (4 * std::numbers::pi) * sum;
}

// The scatter of a pixel is that of the photons in a disc, about 16 of them. Were it that of ribbons, it would grow without bound as the tangent falls to 0.
TEST(PhotonBeams, ThatRunAlongTheViewScatterNoMoreThanPhotons) {
    for (const double tangent : {0., 1e-5, 1e-3, 1e-2, 0.3})
        for (const int along : {-1, 1})
            for (const std::string method : {"photon_mapper", "progressive_photon_mapper"}) {
                const auto scene = layer_in_parallel_light(tangent, along);
                const double expected = scattered_by_layer(tangent, along);
                const std::string label = method + " volume=beams volume_photons=1e4 volume_radius=0.02";
                Moments means, pixels;
                for (std::uint64_t seed = 1; seed <= 4; ++seed) {
                    const Image image = *render(scene, label, 2, seed)[Component::volume];
                    means.add(mean_of(image)[1]);
                    for (std::size_t i = 0; i < image.pixels(); ++i)
                        pixels.add(double{image.at(i)[1]});
                }
                const std::string what = fmt::format("{}, tangent {}, along {}", method, tangent, along);
                EXPECT_LT(means.standard_error(), 0.05 * expected) << what << ": the test would not see an error";
                EXPECT_NEAR(means.mean(), expected, sigmas * means.standard_error()) << what;
                EXPECT_LT(pixels.standard_error() * std::sqrt(4. * 64), 0.7 * expected) << what;
            }
}

/// A ball of fog lit by a lamp through a ball of glass, over a floor, and the fog's medium.
std::string volume_caustic(const std::string& medium) {
    return scene_xml(
        camera(35, to_world(look_at("0, 0.4, -5", "0, 0.2, 0")), box_film(12)) +
        shape("rectangle", to_world(scale(3), rotate('x', -90), translate(0, -1, 0)), diffuse(0.6)) +
        shape("rectangle", to_world(scale(0.5), rotate('x', 90), translate(0, 4, 0)), area_light("40, 30, 20")) +
        shape("sphere", center(0, 2, 0), radius(0.6), glass()) +
        shape("cube", to_world(scale(1, 0.9, 1)), no_surface, medium));
}

const std::string coloured_fog = "<medium name='interior' type='homogeneous'>" + rgb("sigma_t", "0.4, 0.7, 1.2") +
                                 rgb("albedo", "0.9, 0.8, 0.95") + element("phase", "hg", number("g", 0.3)) +
                                 "</medium>";

// Light straight from the lamp, focused by glass and scattered many times, in all channels and components.
TEST_P(VolumeLookUps, AgreeWithThePathTracerInColouredFog) {
    const auto scene = scene_of(volume_caustic(coloured_fog));
    SeedMeans path = seed_means(scene, "path", 2048);
    for (const std::string method : {"photon_mapper photons=2e4 volume_photons=1e4",
                                     "progressive_photon_mapper photons=2000 volume_photons=1000"}) {
        SeedMeans found = seed_means(scene, method + " volume_radius=0.004 volume=" + GetParam(), 8);
        expect_same_means(path, found, method, 0.01);
    }
}

/// A grid that is coloured and that varies, in the cube of the fog.
std::string cloud(const TemporaryFolder& folder, int channels) {
    std::vector<float> values;
    for (int i = 0; i < 27 * channels; ++i)
        values.push_back(static_cast<float>((i * 7) % 11) / 8.f);
    const std::string placing = to_world(translate(-0.5, -0.5, -0.5), scale(2, 1.8, 2));
    return "<medium name='interior' type='heterogeneous'><volume name='sigma_t' type='gridvolume'>" +
           text("filename", folder.write("cloud.vol", volume_bytes({3, 3, 3}, channels, values))) + placing +
           "</volume>" + rgb("albedo", "0.9, 0.8, 0.95") + element("phase", "hg", number("g", 0.3)) + "</medium>";
}

TEST_P(VolumeLookUps, AgreeWithThePathTracerOnGrids) {
    for (const int channels : {1, 3}) {
        const TemporaryFolder folder;
        const auto scene = scene_of(volume_caustic(cloud(folder, channels)));
        SeedMeans path = seed_means(scene, "path", 2048);
        SeedMeans found = seed_means(
            scene, "photon_mapper photons=2e4 volume_photons=1e4 volume_radius=0.004 volume=" + GetParam(), 16);
        expect_same_means(path, found, std::to_string(channels) + " channels", 0.01);
    }
}

// Both find the same light on surfaces as volume=points: their photons do not depend on how media are looked up.
TEST_P(VolumeLookUps, LeaveThePhotonsOnSurfacesAsTheyAre) {
    const auto scene = scene_of(volume_caustic(""));
    const std::string label = "photon_mapper photons=2e4";
    const Image points = render(scene, label, 2).total(),
                rays = render(scene, label + " volume=" + GetParam(), 2).total();
    for (std::size_t i = 0; i < points.pixels(); ++i)
        ASSERT_TRUE((points.at(i) == rays.at(i)).all()) << i;
}

}  // namespace
}  // namespace gib::test::rays_in_media_test
