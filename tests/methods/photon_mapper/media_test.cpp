// The photon mapper in media and behind glass that splits light, against furnaces, closed forms and the path tracer.

#include "methods/parts/photons/photon_walk.h"
#include "tests/support/scene_text.h"
#include "tests/support/seed_means.h"

#include <fmt/format.h>
#include <limits>
#include <map>
#include <numbers>

namespace gib::test::media_test {
namespace {

constexpr double pi_d = std::numbers::pi;
constexpr double sigmas = 5;  ///< allowed errors, in standard errors of means over seeds
constexpr int unlimited = std::numeric_limits<int>::max();

const std::string constant_sky = constant_light(1);

std::string camera_before(int size, double fov) { return camera(fov, to_world(translate(0, 0, -4)), box_film(size)); }
std::string hg_phase(double g) { return element("phase", "hg", number("g", g)); }
std::string ball(const std::string& material, const std::string& sigma_s, double g = 0) {
    return shape("sphere", material, "<medium name='interior' type='homogeneous'>", rgb("sigma_s", sigma_s),
                 hg_phase(g), "</medium>");
}
const std::string no_surface = bsdf("null");
const std::string clear_glass = bsdf("dielectric", number("int_ior", 1.5), number("ext_ior", 1));

/// The integral of fluence over the unit ball with extinction sigma and albedo 1 under a sky of radiance 1. All light
/// together gives 4 pi V. For the light that comes straight from the sky, every line crosses a chord l = 2 mu with mu
/// cosine-distributed over the surface, and the integral of exp(-sigma t) along it is (1 - exp(-sigma l)) / sigma.
double fluence_of_ball(double sigma, bool straight_only) {
    if (!straight_only) return 4 * pi_d * 4 / 3 * pi_d;
    const double a = 2 * sigma;
    return pi_d * 4 * pi_d / sigma * (1 - 2 * (1 - (1 + a) * std::exp(-a)) / (a * a));
}

TEST(PhotonWalkInMedia, StoresTheFluenceOfAWhiteBall) {
    for (const auto& [sigma, g] : {std::pair{0.5, 0.0}, {3.0, 0.0}, {3.0, 0.8}}) {
        const auto scene = scene_of(
            scene_xml(camera_before(4, 40) + constant_sky + ball(no_surface, fmt::format("{0}, {0}, {0}", sigma), g)));
        Moments stored;
        for (std::uint64_t seed = 1; seed <= 32; ++seed) {
            double sum = 0;
            const auto walk = trace_photons(*scene.scene, PhotonMapKind::volume, 20000, unlimited, seed);
            for (const Photon& photon : walk.photons)
                sum += walk.unit * static_cast<double>(photon.power()[1]);
            stored.add(sum);
        }
        const double expected = fluence_of_ball(sigma, false) - fluence_of_ball(sigma, true);
        EXPECT_LT(stored.standard_error(), 0.01 * expected) << "the test would not see an error";
        EXPECT_NEAR(stored.mean(), expected, sigmas * stored.standard_error()) << sigma << ' ' << g;
    }
}

// The camera stands outside a ball of fog, the lamp in its middle. The medium
// around the lamp is found from the camera.
TEST(PhotonWalkInMedia, StartsInTheMediumOfTheLight) {
    const auto scene =
        scene_of(scene_xml(camera_before(4, 40) + point_light(0, 0, 0, 1) + ball(no_surface, "0.5, 0.5, 0.5")));
    EXPECT_FALSE(trace_photons(*scene.scene, PhotonMapKind::volume, 1000, unlimited, 1).photons.empty());
    // Paths have at most three edges, so a photon is scattered once and stored at its second event only.
    for (const Photon& photon : trace_photons(*scene.scene, PhotonMapKind::volume, 1000, 3, 1).photons)
        EXPECT_EQ(photon.edges, 2);
}

// A medium that absorbs nothing is invisible under a sky of radiance 1. Photons hold light that was scattered before,
// which is nearly the same everywhere in a thin ball. In a denser one it falls towards the surface, where a look-up takes photons
// from further inside: a bias that is proportional to its radius (0.5 % with 50 of 2e5 photons, 1.1 % with 50 of 2e4). Ten
// photons make it small.
TEST(PhotonMapperInMedia, WhiteMediaVanish) {
    const std::vector<std::pair<std::string, std::string>> bodies = {
        {"thin", ball(no_surface, "0.3, 0.3, 0.3")},    {"denser", ball(no_surface, "2, 2, 2")},
        {"forwards", ball(no_surface, "4, 4, 4", 0.7)}, {"coloured", ball(no_surface, "0.2, 1, 5")},
        {"in glass", ball(clear_glass, "2, 2, 2")},
    };
    for (const auto& [name, body] : bodies)
        for (const char* kernel : {"uniform", "gaussian"}) {
            const auto found = means_over_seeds(scene_of(scene_xml(camera_before(16, 25) + constant_sky + body)), 32,
                                                12, {}, std::string("photon_mapper photons=2e5 k=10 kernel=") + kernel);
            for (const Moments& m : found) {
                EXPECT_LT(m.standard_error(), 0.01) << name;
                EXPECT_NEAR(m.mean(), 1, sigmas * m.standard_error() + 0.002) << name << ' ' << kernel;
            }
        }
}

// In a dense ball, the fluence of scattered light falls by half towards the surface, which is all that the camera
// sees. Estimates there take photons from up to a radius further inside, so they are too bright by a share that is
// proportional to the radius.
TEST(PhotonMapperInMedia, DenseWhiteMediaVanishAsTheRadiusShrinks) {
    const auto scene = scene_of(scene_xml(camera_before(16, 25) + constant_sky + ball(no_surface, "8, 8, 8")));
    const auto excess = [&](const char* radius) {
        const Moments green = means_over_seeds(
            scene, 32, 12, {}, std::string("photon_mapper photons=2e5 k=all volume_radius=") + radius)[1];
        return std::pair(green.mean() - 1, green.standard_error());
    };
    const auto [wide, wide_error] = excess("0.03");
    const auto [narrow, narrow_error] = excess("0.0075");
    EXPECT_GT(wide, sigmas * wide_error);
    EXPECT_LT(narrow, 0.5 * wide);
    EXPECT_NEAR(narrow, 0.25 * wide, sigmas * std::hypot(narrow_error, 0.25 * wide_error));
}

// The mean free path is 1/300 of the ball's radius. All light that the sky sends into it stays in a layer that is thinner
// than the distance to the 50th photon; the look-ups are limited to a mean free path.
TEST(PhotonMapperInMedia, AThinLayerOfADenseMediumKeepsItsLight) {
    const auto scene = scene_of(
        scene_xml(camera_before(16, 25) + constant_sky + "<shape type='sphere'>" + no_surface +
                  "<medium name='interior' type='homogeneous'><float name='sigma_t' value='300'/><rgb name='albedo' "
                  "value='0.8'/></medium></shape>"));
    const Moments path = means_over_seeds(scene, 32, 6)[1];
    const Moments photons = means_over_seeds(scene, 32, 6, {}, "photon_mapper photons=2e5")[1];
    EXPECT_LT(std::hypot(path.standard_error(), photons.standard_error()), 0.01 * path.mean());
    EXPECT_NEAR(photons.mean(), path.mean(), 0.1 * path.mean());
}

using ComponentMoments = std::map<Component, std::array<Moments, 3>>;

ComponentMoments components_over_seeds(const LoadedScene& scene, const std::string& method, std::uint32_t passes,
                                       const std::vector<Component>& components) {
    ComponentMoments moments;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        const auto image = render(scene, method, passes, seed);
        for (Component c : components) {
            const Colord mean = mean_of(*image[c]);
            for (std::size_t i = 0; i < 3; ++i)
                moments[c][i].add(mean[static_cast<int>(i)]);
        }
    }
    return moments;
}

void expect_components(const LoadedScene& scene, std::uint32_t path_passes, const std::string& photon_mapper,
                       std::uint32_t photon_passes, const std::vector<Component>& components) {
    const auto path = components_over_seeds(scene, "path", path_passes, components);
    const auto photons = components_over_seeds(scene, photon_mapper, photon_passes, components);
    for (Component c : components)
        for (std::size_t i = 0; i < 3; ++i) {
            const Moments &expected = path.at(c)[i], &found = photons.at(c)[i];
            const double error = std::hypot(expected.standard_error(), found.standard_error());
            EXPECT_LT(error, 0.04 * expected.mean()) << name_of(c) << ' ' << i;
            EXPECT_NEAR(found.mean(), expected.mean(), 0.01 * expected.mean() + sigmas * error)
                << name_of(c) << ' ' << i;
        }
}

const std::string floor_and_wall =
    shape("rectangle", to_world(scale(4), rotate('x', -90), translate(0, -1, 0)), bsdf("diffuse")) +
    shape("rectangle", to_world(scale(4), rotate('y', 180), translate(0, 0, 3)), bsdf("diffuse"));

// A cube of fog stands over a floor, with a ball of glass in it and a lamp outside. All path
// classes occur, also those from a surface into the fog and from the fog to a surface. Emission is
// left out, because the lamp is not in view.
TEST(PhotonMapperInMedia, EveryComponentAgreesWithThePathTracerInFog) {
    const auto scene =
        Scene("<medium type='homogeneous' id='fog'>", rgb("sigma_t", "0.4, 0.6, 0.9"), rgb("albedo", "0.9, 0.8, 0.95"),
              hg_phase(0.4), "</medium>", camera_before(16, 40), floor_and_wall,
              shape("rectangle", to_world(scale(1.5), rotate('x', 90), translate(0, 3, 0)), area_light("10, 8, 6")),
              shape("cube", to_world(scale(1.5, 0.9, 1.5)), no_surface, "<ref name='interior' id='fog'/>"))
            .sphere(0.5, 0, 0, 0.5, clear_glass, "<ref name='exterior' id='fog'/>")
            .load();
    expect_components(scene, 512, "photon_mapper photons=2e5", 16,
                      {Component::direct, Component::caustic, Component::indirect, Component::volume});
}

// The floor is seen through the ball that splits the light on the floor, so
// eye paths and photons both have a stratum.
TEST(PhotonMapperWithDispersion, EveryComponentAgreesWithThePathTracer) {
    const auto scene = Scene(camera_before(16, 40), floor_and_wall)
                           .sphere(1, 3, 0, 1.2, area_light("20, 10, 5"))
                           .add(shape("sphere", bsdf("dielectric", number("int_ior", 1.5), number("ext_ior", 1),
                                                     number("cauchy_b", 0.03))))
                           .load();
    ASSERT_TRUE(scene.scene->has_dispersion());
    expect_components(scene, 1024, "photon_mapper photons=1e5", 16,
                      {Component::direct, Component::caustic, Component::indirect});
}

}  // namespace
}  // namespace gib::test::media_test
