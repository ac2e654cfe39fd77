// The scenes of scenes/ load and are lit as their comments say; where a closed
// form is known, the path tracer finds it.
#include "common/core/files.h"
#include "tests/support/moments.h"
#include "tests/support/polygon_light.h"
#include "tests/support/scene_fixtures.h"

#include <gmock/gmock.h>
#include <algorithm>
#include <filesystem>
#include <functional>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <vector>

namespace gib::test::scene_library_test {
namespace {

constexpr double pi = std::numbers::pi;

std::string scene_path(const std::string& name) { return source_path("scenes/" + name) + ".xml"; }

/// The names of the scenes that need no mesh of scripts/meshes.
std::vector<std::string> scene_names() {
    std::vector<std::string> names;
    for (const auto& file : std::filesystem::directory_iterator(source_path("scenes")))
        if (file.path().extension() == ".xml" &&
            read_file(file.path().string()).find("meshes/generated/") == std::string::npos)
            names.push_back(file.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

class EveryScene : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Library, EveryScene, testing::ValuesIn(scene_names()), [](const auto& name) {
    std::string identifier = name.param;
    std::replace(identifier.begin(), identifier.end(), '-', '_');
    return identifier;
});

/// The scene at about 32 pixels a side, with its own aspect ratio.
LoadedScene small_scene(const std::string& name) {
    const LoadedScene whole = shipped_scene(name + ".xml");
    const Sensor& sensor = whole.scene->sensor();
    return shipped_scene(name + ".xml", {{}, std::pair{32, 32 * sensor.height() / sensor.width()}});
}

TEST(SceneLibraryFiles, OpenWithACommentAndHaveALineInTheTable) {
    for (const std::string& name : scene_names()) {
        EXPECT_THAT(read_file(scene_path(name)),
                    testing::StartsWith("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<!--\n"));
        EXPECT_THAT(read_file(source_path("scenes/README.md")), testing::HasSubstr("\n| `" + name + ".xml` |"));
    }
}

TEST_P(EveryScene, IsExposedForAMeanNearOne) {
    const LoadedScene scene = small_scene(GetParam());
    EXPECT_TRUE((scene.scene->emitted_power() > 0).all());
    // The Cornell boxes keep the lamp that everybody gives them.
    if (GetParam().starts_with("cornell-")) GTEST_SKIP();
    // Only specular manifold sampling finds points of light behind glass.
    const bool behind_glass =
        !ConfiguredMethod(MethodLabel::parse("path")).create({})->plan(*scene.scene).unresolved.empty();
    const double mean =
        mean_of(render(scene, behind_glass ? "manifold_path" : "path", behind_glass ? 16 : 256).total()).mean();
    EXPECT_GT(mean, 0.5);
    EXPECT_LT(mean, 2.0);
}

/// The scene with another camera: an orthographic one of 8 x 8 pixels that sees a square 0.002 wide around `target`.
LoadedScene scene_seen_at(const std::string& name, const Vec3d& eye, const Vec3d& target) {
    const auto text = [](const Vec3d& p) {
        return std::to_string(p.x()) + ',' + std::to_string(p.y()) + ',' + std::to_string(p.z());
    };
    std::string xml = read_file(scene_path(name));
    const std::size_t begin = xml.find("<sensor"), end = xml.find("</sensor>");
    if (begin == std::string::npos || end == std::string::npos) throw std::logic_error(name + " has no sensor");
    xml.replace(
        begin, end + std::string("</sensor>").size() - begin,
        element("sensor", "orthographic", to_world(scale(0.001), look_at(text(eye), text(target))), box_film(8)));
    return parse_scene(xml, scene_path(name));
}

/// The green radiance of a component at `target`, over 16 seeds of 64 pixels x `passes` samples.
Moments radiance_at(const LoadedScene& scene, Component component, const std::string& label, std::uint32_t passes) {
    Moments radiance;
    for (std::uint64_t seed = 1; seed <= 16; ++seed) {
        const ComponentImages image = render(scene, label, passes, seed);
        const auto& part = image[component];
        if (!part) throw std::logic_error("the component is absent");
        radiance.add(mean_of(*part)[1]);
    }
    return radiance;
}

/// Expects the mean within 5 standard errors: by Student's t of 15 degrees of freedom, chance exceeds that once in
/// 6000 times, and there are 16 such comparisons. The error must be small enough to show a mistake of 2 %.
void expect_radiance(const Moments& found, double expected) {
    EXPECT_NEAR(found.mean(), expected, 5 * found.standard_error() + 2e-4 * expected);
    EXPECT_LT(found.standard_error(), 0.004 * expected);
}

/// The rectangle with this middle and these half edges.
std::vector<Vec3d> rectangle(const Vec3d& middle, const Vec3d& s, const Vec3d& t) {
    return {middle - s - t, middle + s - t, middle + s + t, middle - s + t};
}

/// The integral over 0..1 by the midpoint rule.
double integral(int steps, const std::function<double(double)>& f) {
    double sum = 0;
    for (int i = 0; i < steps; ++i)
        sum += f((i + 0.5) / steps);
    return sum / steps;
}

/// The Fresnel reflectance of glass of index 1.5 for unpolarised light; `sine` is that of the angle in air.
double glass_reflectance(double sine) {
    const double ci = std::sqrt(1 - sine * sine), ct = std::sqrt(1 - sine * sine / 2.25);
    const double rs = (ci - 1.5 * ct) / (ci + 1.5 * ct), rp = (1.5 * ci - ct) / (1.5 * ci + ct);
    return (rs * rs + rp * rp) / 2;
}

void expect_floor_by_lambert(const std::string& name, double Le, const std::vector<std::vector<Vec3d>>& lamps,
                             const Vec3d& p) {
    SCOPED_TRACE(name + " at " + std::to_string(p.x()) + ", " + std::to_string(p.z()));
    double E = 0;
    for (const auto& lamp : lamps)
        E += lambert_irradiance(p, Vec3d::UnitY(), lamp) * Le;
    const LoadedScene scene = scene_seen_at(name, p + Vec3d(0, 0.2, -0.2), p);
    expect_radiance(radiance_at(scene, Component::direct, "path max_depth=2", 1024), 0.5 / pi * E);
}

TEST(SceneLibrary, OneLampAndOneOfManyPiecesShineByLambertsFormula) {
    const Vec3d x = Vec3d(0.6, 0, 0), z = Vec3d(0, 0, 0.4);
    const std::vector<std::vector<Vec3d>> lamps = {rectangle(Vec3d(-1, 0.5, 0), x, z),
                                                   rectangle(Vec3d(1, 0.5, 0), x, z)};
    for (const Vec3d& p : {Vec3d(0, 0, 0), Vec3d(-1, 0, -0.7), Vec3d(1, 0, -0.7), Vec3d(1.7, 0, 0.9)})
        expect_floor_by_lambert("smits-jensen-emission", 28, lamps, p);
}

TEST(SceneLibrary, UncoveredFloorFollowsLambertsFormula) {
    const double tilt = pi / 9;  // 20 degrees
    expect_floor_by_lambert(
        "smits-jensen-shadows", 150,
        {rectangle(Vec3d(-0.8, 3.4, 0), 0.5 * Vec3d(std::cos(tilt), std::sin(tilt), 0), Vec3d(0, 0, 0.5))},
        Vec3d(0.4, 0, -3.5));
    expect_floor_by_lambert("smits-jensen-forms", 88,
                            {rectangle(Vec3d(-0.4, 3.2, -0.4), Vec3d(0.6, 0, 0), Vec3d(0, 0, 0.6))},
                            Vec3d(-2.2, 0, -1.5));
}

/// The part of a coffer's lamp that p on the floor sees through the coffer's mouth. The mouth is a square 1 wide at
/// height 2.5; its projection from p into the lamp's plane is 3.98 / 2.5 times as large.
std::optional<std::vector<Vec3d>> lamp_through_coffer(const Vec3d& p, double x, double z) {
    constexpr double height = 3.98, scale = height / 2.5;
    const auto seen = [&](double from, double middle) {
        const double lower = std::max(middle - 0.2, from + scale * (middle - 0.5 - from));
        const double upper = std::min(middle + 0.2, from + scale * (middle + 0.5 - from));
        return std::pair{(lower + upper) / 2, (upper - lower) / 2};
    };
    const auto [mx, sx] = seen(p.x(), x);
    const auto [mz, sz] = seen(p.z(), z);
    if (sx <= 0 || sz <= 0) return std::nullopt;
    return rectangle(Vec3d(mx, height, mz), Vec3d(sx, 0, 0), Vec3d(0, 0, sz));
}

// Light sampling is guided: one in ten lamps is visible, so the path tracer
// would need a hundred times as many samples.
TEST(SceneLibrary, TheFloorUnderManyLampsSeesThemThroughTheirCoffers) {
    for (const Vec3d& p : {Vec3d(-4.1, 0, 2.7), Vec3d(-3.5, 0, 3.5), Vec3d(4, 0, -4.3)}) {
        SCOPED_TRACE(std::to_string(p.x()) + ", " + std::to_string(p.z()));
        double E = 0;
        for (int i = 0; i < 12; ++i)
            for (int j = 0; j < 12; ++j)
                if (const auto lamp = lamp_through_coffer(p, i - 5.5, j - 5.5))
                    E += lambert_irradiance(p, Vec3d::UnitY(), *lamp) * ((i + j) % 2 == 0 ? 68 : 65);
        const LoadedScene scene = scene_seen_at("many-lights", p + Vec3d(0, 0.2, -0.2), p);
        const char* const label = "photon_mapper photons=0 max_depth=2 shadow_photons=2e4";
        expect_radiance(radiance_at(scene, Component::direct, label, 512), 0.58 / pi * E);
    }
}

TEST(SceneLibrary, SecondaryLightIsTheIntegralOverTheCard) {
    const std::vector<Vec3d> lamp = rectangle(Vec3d(-1.45, -0.6, 0), Vec3d(0, 0.4, 0), Vec3d(0, 0, 0.4));
    for (const Vec3d& p : {Vec3d(-0.8, 0, 0), Vec3d(-0.5, 0, -1), Vec3d(0.5, 0, 1.2)}) {
        SCOPED_TRACE(std::to_string(p.x()) + ", " + std::to_string(p.z()));
        // Only the half of the card above the table counts, 1.5 x 3; both surfaces reflect 0.5.
        const double E = 1.5 * 3 * integral(100, [&](double v) {
                             return integral(200, [&](double w) {
                                 const Vec3d card(-2.6, 1.5 * v, 3 * w - 1.5), to_card = card - p;
                                 const double B = 0.5 / pi * 5400 * lambert_irradiance(card, Vec3d::UnitX(), lamp);
                                 return B * -to_card.x() * to_card.y() / std::pow(to_card.squaredNorm(), 2);
                             });
                         });
        const LoadedScene scene = scene_seen_at("smits-jensen-secondary", p + Vec3d(0, 0.2, -0.2), p);
        expect_radiance(radiance_at(scene, Component::indirect, "path max_depth=3", 2048), 0.5 / pi * E);
    }
}

TEST(SceneLibrary, ScenesOfIndirectLightShowNoOther) {
    for (const char* name : {"smits-jensen-secondary", "smits-jensen-mirror", "door-ajar"}) {
        const ComponentImages image = render(small_scene(name), "path", 64);
        for (Component c : {Component::emission, Component::direct, Component::caustic}) {
            ASSERT_TRUE(image[c]);
            EXPECT_EQ(mean_of(*image[c]).sum(), 0.0) << name << ' ' << name_of(c);
        }
        EXPECT_GT(mean_of(*image[Component::indirect]).minCoeff(), 0.0) << name;
    }
}

// The lamp is a disc of radius r at height h under the ceiling, and the point right above it sees all of it: its irradiance is
// pi Le r^2 / (r^2 + h^2).
TEST(SceneLibrary, TheShadeHidesNothingOfTheLampFromTheSpotAboveIt) {
    const Vec3d p(1.1, 2.6, 0.9);
    const LoadedScene scene = scene_seen_at("lamp-in-shade", p + Vec3d(-0.3, -0.4, -0.3), p);
    const double h = 2.6 - 1.2, r = 0.12;
    expect_radiance(radiance_at(scene, Component::direct, "path max_depth=2", 256),
                    0.69 * 19700 * r * r / (r * r + h * h));
}

TEST(SceneLibrary, LosslessObjectsInTheFurnaceAreInvisible) {
    const LoadedScene scene =
        shipped_scene("furnace-objects.xml", {{{"rho", "0.8"}, {"emission", "0.3"}}, std::pair{16, 16}});
    Moments mean;
    for (std::uint64_t seed = 1; seed <= 16; ++seed)
        mean.add(mean_of(render(scene, "path", 64, seed).total()).mean());
    expect_radiance(mean, 0.3 / (1 - 0.8));
}

TEST(SceneLibrary, AHollowSphereIsLitEvenly) {
    for (const double rho : {0.5, 0.8}) {
        SCOPED_TRACE(rho);
        const LoadedScene scene = shipped_scene("sphere-checkerboard.xml",
                                                {{{"rho", std::to_string(rho)}, {"emission", "1"}}, std::pair{16, 16}});
        expect_radiance(radiance_at(scene, Component::direct, "path", 128), rho / 2);
        expect_radiance(radiance_at(scene, Component::indirect, "path", 128), rho * rho / (1 - rho) / 2);
    }
}

// A ray leaves the axis at the angle t, 1.8 below the centre of a glass sphere of radius 1. Before and
// after the sphere, it passes the centre at the distance p = 1.8 sin t, and it is turned by 2 (i - r) with
// sin i = p = 1.5 sin r. It meets the lamp, a sphere of radius 0.4 whose centre lies 4.5 above, if it
// passes the lamp's centre at less than 0.4.
TEST(SceneLibrary, TheGlassSpheresCausticOnItsAxisIsAnIntegral) {
    const double below = 1.8, above = 4.5, widest = std::asin(1 / below);
    const double E = 2 * pi * 700 * widest * integral(100000, [&](double u) {
                         const double t = widest * u, p = below * std::sin(t);
                         const double angle = t - 2 * (std::asin(p) - std::asin(p / 1.5));
                         if (std::abs(p + above * std::sin(angle)) > 0.4) return 0.0;
                         return std::pow(1 - glass_reflectance(p), 2) * std::cos(t) * std::sin(t);
                     });
    const LoadedScene scene = scene_seen_at("glass-sphere", Vec3d(0, 0.3, -0.3), Vec3d::Zero());
    EXPECT_NEAR(0.5 / pi * E, 63.1, 0.05);  // the value in the scene's comment
    // Light that glass reflects twice inside adds less than 0.1 %.
    const Moments found = radiance_at(scene, Component::caustic, "path max_depth=8", 2048);
    EXPECT_NEAR(found.mean(), 0.5 / pi * E, 5 * found.standard_error() + 1e-3 * 0.5 / pi * E);
    EXPECT_LT(found.standard_error(), 0.004 * 0.5 / pi * E);
}

TEST(SceneLibrary, TheBulbTakesItsShareOfTheLampsLight) {
    const double r = 0.2, a = 0.36, b = 0.4;
    const double transmitted = r * integral(1000, [&](double u) {
                                   const double p = r * u, F1 = glass_reflectance(p / a), F2 = glass_reflectance(p / b);
                                   return (1 - F1) * (1 - F2) / (1 - F1 * F2) * 2 * p;
                               });
    EXPECT_NEAR(transmitted / (r * r), 0.922, 0.001);
    const Vec3d p(-0.8, 0, -0.5), to_lamp = Vec3d(0, 1.1, 0) - p;
    const double E = pi * 44 * transmitted * to_lamp.normalized().y() / to_lamp.squaredNorm();
    const LoadedScene scene = scene_seen_at("lamp-in-glass", p + Vec3d(-0.2, 0.3, -0.3), p);
    // `white` reflects 0.7.
    expect_radiance(radiance_at(scene, Component::caustic, "path max_depth=8", 2048), 0.7 / pi * E);
    EXPECT_EQ(mean_of(*render(small_scene("lamp-in-glass"), "path", 64)[Component::direct]).sum(), 0.0);
}

// The cusp lies a third of the radius from the centre; the lamp's width blurs it towards the wall.
TEST(SceneLibrary, TheRingsCuspIsBrightest) {
    const auto caustic = [](double x) {
        const Vec3d p(x, 0, 0);
        return radiance_at(scene_seen_at("metal-ring", p + Vec3d(0, 0.2, -0.2), p), Component::caustic, "path", 128)
            .mean();
    };
    const double cusp = caustic(0.36);
    EXPECT_GT(cusp, 2 * caustic(0.22));
    EXPECT_GT(cusp, 2 * caustic(0.5));
    EXPECT_GT(cusp, 4 * caustic(0.7));
}

}  // namespace
}  // namespace gib::test::scene_library_test
