// Radiosity as a method: what its images show, which scenes and settings it refuses, and which light it leaves out.
#include "methods/radiosity/view.h"
#include "tests/methods/radiosity/fixtures.h"
#include "tests/support/scene_text.h"

#include <gmock/gmock.h>

#include <map>
#include <numbers>

namespace gib::test::radiosity_test {
namespace {

constexpr double pi = std::numbers::pi;

/// Runs the method of a label on a scene for `passes` passes or until it has
/// converged; returns what `use` makes of the run.
template <typename Use>
auto after(const LoadedScene& scene, const std::string& label, std::uint32_t passes, Use&& use) {
    StageTimes stages;
    const auto run =
        ConfiguredMethod(MethodLabel::parse(label)).create({scene.max_edges})->start(*scene.scene, 1, stages);
    for (std::uint32_t pass = 0; pass < passes; ++pass)
        if (run->advance(pass) == Progress::converged) break;
    return use(*run);
}

std::map<std::string, std::string> facts_of(const LoadedScene& scene, const std::string& label, std::uint32_t passes) {
    return after(scene, label, passes, [](const gib::Run& run) {
        const auto facts = run.facts();
        return std::map<std::string, std::string>(facts.begin(), facts.end());
    });
}

/// A model of a scene and its stages' times.
struct Model {
    StageTimes stages;
    RadiosityModel model;
    Model(const LoadedScene& scene, const RadiositySettings& settings) : model(*scene.scene, settings, 1, stages) {}
    void converge() {
        while (!model.has_converged())
            model.advance();
    }
    /// The irradiance where a ray hits, on the side with the normal +z.
    double irradiance(const LoadedScene& scene, const Vec3& origin) const {
        const auto hit = scene.scene->intersect({origin, Vec3(0, 0, -1)});
        EXPECT_TRUE(hit);
        return hit ? static_cast<double>(model.irradiance(*hit, Vec3::UnitZ())[0]) : 0;
    }
};

const std::string room = hollow_cube(one_sided("0.7 0.5 0.3")) + point_light(0.3, 0.2, 0.6, 1);

double mean_difference(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i)
        sum += static_cast<double>(std::abs(a.rgb[i] - b.rgb[i]));
    return sum / static_cast<double>(a.rgb.size());
}

TEST(Radiosity, ShowsWhatPathTracingDoes) {
    const auto scene =
        seen_from_inside(room + shape("cube", to_world(scale(0.3), translate(-0.3, 0.1, -0.6)), one_sided("0.6")));
    const ComponentImages truth = render(scene, "path", 1024);
    const double level = mean_of(*truth[Component::indirect]).mean();
    for (const char* label : {"radiosity patch=0.04 links=0.005", "radiosity patch=0.1 links=0.005 gather=16"}) {
        const ComponentImages found = render(scene, label, 32);
        // The path-traced image has 16 x 16 pixels of 1024 paths: noise of 2 % a pixel.
        EXPECT_LT(mean_difference(*found[Component::indirect], *truth[Component::indirect]), 0.035 * level) << label;
        EXPECT_NEAR(mean_of(*found[Component::indirect]).mean() / level, 1, 0.01) << label;
    }
}

/// Irradiance at `p` on the floor z = 0 due to light that goes from a point light to a wall in x = 0 and from there
/// straight to `p`: a sum over n x n parts of the wall.
double light_by_way_of_a_wall(const Vec3d& p, const Vec3d& light, double intensity, double rho) {
    constexpr int n = 400;
    double E = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const Vec3d w(0, -1 + 2 * (i + 0.5) / n, (j + 0.5) / n * 2);
            const Vec3d to_light = light - w, to_p = p - w;
            const double B = rho * intensity * to_light.x() / std::pow(to_light.norm(), 3);
            E += B / pi * to_p.x() * w.z() / sqr(to_p.squaredNorm()) * (4.0 / (n * n));
        }
    return E;
}

// Away from the edges of shadows, the error falls with the size of patches, at first order or better.
TEST(Radiosity, ErrorOfSmoothLightShrinksWithThePatches) {
    const Vec3d light(0.8, 0.2, 1.3);
    const auto scene =
        seen_from_inside(shape("rectangle", to_world(translate(1, 0, 0)), one_sided("0.5")) +
                         shape("rectangle", to_world(rotate('y', 90), translate(0, 0, 1)), one_sided("0.8")) +
                         point_light(0.8, 0.2, 1.3, 1));
    std::vector<double> errors;
    for (const double patch : {0.3, 0.15, 0.075}) {
        Model model(scene, {patch, RadiositySolver::hierarchical, 0.002, 0, 3});
        model.converge();
        double error = 0, level = 0;
        for (int i = 0; i < 64; ++i) {
            const Vec3d p(0.2 + 1.6 * (i % 8 + 0.3) / 8, -0.8 + 1.6 * (i / 8 + 0.6) / 8, 0);
            const Vec3d center(1, 0, 1);  // the scene's centre, which is the origin of its coordinates
            const double truth = light_by_way_of_a_wall(p, light, 1, 0.8);
            error += sqr(model.irradiance(scene, Vec3((p - center).cast<float>() + Vec3(0, 0, 0.1f))) - truth);
            level += sqr(truth);
        }
        errors.push_back(std::sqrt(error / level));
    }
    EXPECT_LT(errors[2], 0.02);
    EXPECT_GT(std::log2(errors[0] / errors[2]) / 2, 1) << errors[0] << ' ' << errors[1] << ' ' << errors[2];
}

std::string two_sided(double albedo) { return bsdf("twosided", one_sided(std::to_string(albedo))); }

/// A room without a front wall, lit from within, and what stands in it. The floor is z = -1.
std::string open_room(double albedo, const std::string& bodies) {
    const std::string wall = two_sided(albedo);
    return shape("rectangle", to_world(translate(0, 0, -1)), wall) +
           shape("rectangle", to_world(rotate('x', 180), translate(0, 0, 1)), wall) +
           shape("rectangle", to_world(rotate('y', 90), translate(-1, 0, 0)), wall) +
           shape("rectangle", to_world(rotate('y', -90), translate(1, 0, 0)), wall) +
           shape("rectangle", to_world(rotate('x', 90), translate(0, 1, 0)), wall) + bodies +
           point_light(0.1, -0.1, 0.8, 1);
}

/// A mesh of triangles, nine numbers each.
std::string triangles(const TemporaryFolder& folder, const std::vector<std::array<double, 9>>& corners, double albedo) {
    std::string obj;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        for (std::size_t k = 0; k < 9; k += 3)
            obj += fmt::format("v {} {} {}\n", corners[i][k], corners[i][k + 1], corners[i][k + 2]);
        obj += fmt::format("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
    }
    return shape("obj", text("filename", folder.write("triangles.obj", obj)), flag("face_normals"), two_sided(albedo));
}

void expect_indirect_light_of_path_tracing(const std::string& body) {
    const auto scene =
        Scene(camera(50, to_world(look_at("0.2 -3 0.2", "0 0 -0.1", "0 0 1")), box_film(16)), body).load();
    const double truth = mean_of(*render(scene, "path", 1024)[Component::indirect]).mean();
    for (const char* label : {"radiosity patch=0.08", "radiosity patch=0.04 links=0.005"})
        EXPECT_NEAR(mean_of(*render(scene, label, 32)[Component::indirect]).mean() / truth, 1, 0.02) << label;
}

// A block that stands on the floor covers it, with or without a bottom. No light gets in, and it is not taken for light that is
// shut in.
TEST(Radiosity, ABlockStandsOnTheFloor) {
    expect_indirect_light_of_path_tracing(open_room(
        0.95, shape("cube", to_world(scale(0.35), rotate('z', 20), translate(0.4, 0.3, -0.65)), two_sided(0.95))));
    const auto side = [](double angle) {
        return shape(
            "rectangle",
            to_world(rotate('x', 90), translate(0, -1, 0), scale(0.35), rotate('z', angle), translate(0.4, 0.3, -0.65)),
            two_sided(0.7));
    };
    expect_indirect_light_of_path_tracing(open_room(
        0.7,
        side(20) + side(110) + side(200) + side(290) +
            shape("rectangle", to_world(translate(0, 0, 1), scale(0.35), rotate('z', 20), translate(0.4, 0.3, -0.65)),
                  two_sided(0.7))));
}

// Surfaces in one plane share the light there: none of it counts twice.
TEST(Radiosity, SurfacesLieInOnePlane) {
    const TemporaryFolder folder;
    for (const bool turned : {false, true}) {
        SCOPED_TRACE(turned);
        const double y = turned ? -0.6 : 0.6;
        expect_indirect_light_of_path_tracing(open_room(
            0.7, triangles(folder, {{-0.6, -y, -1, 0.6, -y, -1, 0.6, y, -1}, {-0.8, -y, -1, 0.5, y, -1, -0.7, y, -1}},
                           0.7)));
    }
    std::vector<std::array<double, 9>> slivers;
    for (int i = 0; i < 10; ++i)
        slivers.push_back({-0.8, 0.5, 0.2, 0.8, 0.5, 0.2 + 1e-7 * i, 0.8, 0.5 - 4e-3 * (i + 1), 0.2 + 1e-7 * (i + 1)});
    expect_indirect_light_of_path_tracing(open_room(0.7, triangles(folder, slivers, 0.7)));
}

// A carpet that lies close above the floor has all the light there. The room's diagonal is 3.5.
TEST(Radiosity, ACarpetHidesTheFloorUnderIt) {
    for (const auto& [floor, carpet] : {std::pair(0.3, 0.95), std::pair(0.8, 0.2)})
        for (const double lift : {8e-6, 3e-5, 1e-4}) {
            SCOPED_TRACE(testing::Message() << carpet << " on " << floor << ", " << lift);
            expect_indirect_light_of_path_tracing(open_room(
                floor, shape("rectangle", to_world(scale(0.6), translate(0.1, 0, -1 + lift)), two_sided(carpet))));
        }
}

// A cube of 10 m, reflectance 2/3, with a point light of 50000 cd in the middle: published luminances of a wall at its
// centre, 2.5 m from it, and 2.5 m from it in both directions.
TEST(Radiosity, LosesNoLightInAClosedCube) {
    const auto scene =
        seen_from_inside(shape("cube", flag("flip_normals"), to_world(scale(5)), one_sided("0.6666666667")) +
                         point_light(0, 0, 0, 50000));
    for (const RadiositySettings& settings : {RadiositySettings{0.06, RadiositySolver::hierarchical, 0.002, 0, 1000},
                                              RadiositySettings{0.03, RadiositySolver::hierarchical, 0.002, 0, 1000}}) {
        Model model(scene, settings);
        model.converge();
        for (const auto& [x, y, luminance] : {std::tuple{0.f, 0.f, 892.8}, {2.5f, 0.f, 768.7}, {2.5f, 2.5f, 686.6}}) {
            const double direct = 50000 * 5 / std::pow(25 + static_cast<double>(x * x + y * y), 1.5);
            const double E = direct + model.irradiance(scene, Vec3(x, y, 0.f));
            EXPECT_NEAR(2.0 / 3 * E / pi / luminance, 1, 0.003) << settings.patch << ' ' << settings.links;
        }
    }
}

// While the solution changes, images show the latest solution only. The first solution, of 8 reflections in a bright room, has less
// than half of the light: with its sample the image of the pass that ends the changes would be too dark. Samples of pixels differ
// by less than 1 %.
TEST(Radiosity, SamplesOfAnOlderSolutionDoNotCount) {
    const auto scene = seen_from_inside(hollow_cube(one_sided("0.95")) + point_light(0.3, 0.2, 0.6, 1));
    const std::string label = "radiosity patch=0.2 links=0.02 max_depth=1000";
    const auto mean_after = [&](std::uint32_t passes) {
        return after(scene, label, passes,
                     [](const gib::Run& run) { return double{mean_of(*run.image()[Component::indirect]).mean()}; });
    };
    std::uint32_t passes = 1;
    while (facts_of(scene, label, passes)["converged"] != "yes")
        ++passes;
    const double first = mean_after(1), last = mean_after(passes), later = mean_after(passes + 16);
    EXPECT_GT(passes, 1u);
    EXPECT_LT(first, 0.5 * later);
    EXPECT_NEAR(last, later, 0.01 * later);
}

// A floor lies under a plate that is lit from above and reflects on its upper side only.
TEST(Radiosity, TheBackOfAOneSidedSurfaceIsBlack) {
    const std::string plate = one_sided("0.8");
    const auto scene = Scene(camera(40, to_world(look_at("0 -3 0.4", "0 0 0", "0 0 1")), box_film(16)),
                             shape("rectangle", plate), shape("rectangle", to_world(translate(0, 0, 1)), plate),
                             point_light(0, 0, 2, 5), point_light(0, -2, 0.3, 5))
                           .load();
    for (const char* label : {"radiosity patch=0.1", "radiosity patch=0.1 gather=4"}) {
        const ComponentImages image = render(scene, label, 4);
        EXPECT_GT(mean_of(*image[Component::direct]).sum(), 0.01) << label;
        EXPECT_EQ(mean_of(*image[Component::indirect]).sum(), 0) << label;
    }
}

TEST(Radiosity, SaysHowFarItCame) {
    const auto scene = seen_from_inside(hollow_cube(one_sided("0.999")) + point_light(0.5, 0, 0, 1));
    auto facts = facts_of(scene, "radiosity patch=0.2 max_depth=1000", 3);
    EXPECT_EQ(facts["converged"], "no");
    EXPECT_EQ(facts["sweeps"], "3");
    EXPECT_GT(std::stod(facts["residual"]), 0.1);
    EXPECT_EQ(facts["closed"], "yes");
    EXPECT_LT(std::stod(facts["closure_mean"]), 0.01);
    facts = facts_of(scene, "radiosity patch=0.2", 30);
    EXPECT_EQ(facts["converged"], "yes");
    EXPECT_LT(std::stod(facts["residual"]), 1e-4);
}

TEST(Radiosity, RefusesWhatDoesNotFitBeforeItIsMade) {
    const auto scene = seen_from_inside(room);
    for (const char* label : {"radiosity patch=1e-5", "radiosity patch=0.001 solver=direct"})
        try {
            facts_of(scene, label, 1);
            ADD_FAILURE() << label;
        } catch (const InputError& error) {
            EXPECT_THAT(error.what(), testing::ContainsRegex("needs [0-9]+ bytes")) << label;
            EXPECT_THAT(error.what(), testing::HasSubstr("patches")) << label;
        }
}

}  // namespace
}  // namespace gib::test::radiosity_test
