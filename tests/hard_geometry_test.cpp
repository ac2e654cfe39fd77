// Hard cases of geometry and floating point: far, small, needle-shaped, coincident. Every method that simulates the
// scene.

#include "tests/hard_cases.h"

namespace gib {
namespace {

using namespace test;

/// What loses no light, in every kind of shape: glass, a mirror, a pane.
std::string invisible_things(const Place& place) {
    const std::string mirror = "<bsdf type='conductor'><string name='material' value='none'/></bsdf>";
    const auto at = [&](const std::string& operations) { return place.transform(operations); };
    return shape("sphere", at("<scale value='0.3'/><translate x='-0.2' y='-0.3' z='0.1'/>"), glass(1.5)) +
           shape("cube", at("<scale value='0.2'/><rotate y='1' angle='30'/><translate x='0.5' y='-0.4' z='-0.3'/>"),
                 glass(1.5)) +
           shape("cylinder", at("<scale value='0.2'/><rotate x='1' angle='40'/><translate y='0.6'/>"), mirror) +
           shape("disk", at("<scale value='0.2'/><rotate y='1' angle='150'/><translate x='0.7' y='0.3' z='0.5'/>"),
                 mirror) +
           shape("rectangle",
                 at("<scale value='0.3'/><rotate y='1' angle='160'/><translate x='-0.4' y='0.5' z='0.3'/>"),
                 "<bsdf type='thindielectric'>" + number_xml("int_ior", 1.5) + number_xml("ext_ior", 1) + "</bsdf>");
}

/// The furnace as a box, with all of them in it, put elsewhere.
std::string placed_furnace(const Place& place) {
    return scene_xml(camera(place.view({-0.9, 0.1, -0.85}, {0.3, -0.1, 0.4}), 75, 8) +
                     shape("cube", place.transform(),
                           "<boolean name='flip_normals' value='true'/>" + diffuse_bsdf(0.5) + area_emitter(0.5)) +
                     invisible_things(place));
}

/// A closed mesh of 2 n^2 triangles, those at the poles without area: a sphere of unit radius by longitude and
/// latitude.
std::string sphere_ply(int n, const Vec3d& centre, bool degenerate) {
    std::string vertices, faces;
    int count = 0, face_count = 0;
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j < n; ++j, ++count) {
            const double theta = std::numbers::pi * i / n, phi = 2 * std::numbers::pi * j / n;
            vertices += exact(centre.x() + std::sin(theta) * std::cos(phi)) + " " +
                        exact(centre.y() + std::cos(theta)) + " " +
                        exact(centre.z() + std::sin(theta) * std::sin(phi)) + "\n";
        }
    const auto face = [&](int a, int b, int c) {
        faces += "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
        ++face_count;
    };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const int a = i * n + j, b = i * n + (j + 1) % n, c = a + n, d = b + n;
            face(a, b, c);
            face(b, d, c);
            if (!degenerate) continue;
            face(a, a, b);  // no area
            face(a, b, c);  // twice the same
        }
    return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) +
           "\nproperty double x\nproperty double y\nproperty double z\nelement face " + std::to_string(face_count) +
           "\nproperty list uchar int vertex_indices\nend_header\n" + vertices + faces;
}

std::string ply_shape(const TemporaryFolder& folder, const std::string& content, const std::string& inside,
                      const std::string& transform = "") {
    static int files = 0;
    const std::string path = folder.write("mesh" + std::to_string(files++) + ".ply", content);
    return "<shape type='ply'><string name='filename' value='" + path +
           "'/><boolean name='face_normals' value='true'/>" + transform + inside + "</shape>";
}

const std::string sky = "<emitter type='constant'>" + rgb_xml("radiance", 1) + "</emitter>";
const std::string two_sided_half = "<bsdf type='twosided'>" + diffuse_bsdf(0.5) + "</bsdf>";

/// A camera inside a closed mesh in a bright sky.
HardCase dark_inside(const std::string& name, std::function<std::string(const TemporaryFolder&)> mesh,
                     const Vec3d& at) {
    return {
        name,
        [=](const TemporaryFolder& folder) {
            return scene_xml(camera(Place{1, at}.view({0.1, 0.05, -0.2}, {0.3, 1, 0.2}), 120, 16) + mesh(folder) + sky);
        },
        Relation::black,
        0,
        "no light comes through a closed surface",
        16};
}

void add_scales_and_places(std::vector<HardCase>& cases) {
    const std::string unity = "radiance 1 everywhere, whatever the units and the place";
    for (const auto& [name, scale] : {std::pair("1e_6", 1e-6), std::pair("1e_3", 1e-3), std::pair("1e3", 1e3),
                                      std::pair("1e6", 1e6), std::pair("1e12", 1e12), std::pair("1e_12", 1e-12)})
        cases.push_back({"FurnaceScaled" + std::string(name),
                         [scale](const TemporaryFolder&) { return placed_furnace({scale}); }, Relation::equal, 1,
                         unity});
    for (const auto& [name, times] : {std::pair("1e4", 1e4), std::pair("1e6", 1e6)})
        for (const double scale : {1.0, 1e-6, 1e6})
            cases.push_back({"FurnaceMoved" + std::string(name) +
                                 (scale == 1  ? ""
                                  : scale < 1 ? "Small"
                                              : "Large"),
                             [=](const TemporaryFolder&) {
                                 return placed_furnace({scale, scale * times * Vec3d(1.1, -2.3, 1.7)});
                             },
                             Relation::equal, 1, unity});
}

void add_closed_meshes(std::vector<HardCase>& cases) {
    cases.push_back(dark_inside(
        "DarkInside",
        [](const TemporaryFolder& folder) {
            return ply_shape(folder, sphere_ply(12, Vec3d::Zero(), false), two_sided_half);
        },
        Vec3d::Zero()));
    cases.push_back(dark_inside(
        "DarkInsideDegenerate",
        [](const TemporaryFolder& folder) {
            return ply_shape(folder, sphere_ply(12, Vec3d::Zero(), true), two_sided_half);
        },
        Vec3d::Zero()));
    const Vec3d far(3e5, -2e5, 1e6);
    cases.push_back(dark_inside(
        "DarkInsideFarOff",
        [far](const TemporaryFolder& folder) { return ply_shape(folder, sphere_ply(12, far, false), two_sided_half); },
        far));
    cases.push_back(dark_inside(
        "DarkInsideBesideAVastPlate",
        [](const TemporaryFolder& folder) {
            return ply_shape(folder, sphere_ply(12, Vec3d::Zero(), false), two_sided_half) +
                   shape("rectangle",
                         "<transform name='to_world'><scale value='1e4'/><translate z='1e3' x='7e3'/></transform>",
                         two_sided_half);
        },
        Vec3d::Zero()));
    // Form factors between its triangles and the plate are too many to be waited for.
    cases.back().without = "radiosity";
    cases.push_back(dark_inside(
        "DarkInsideACube",
        [](const TemporaryFolder&) {
            return shape("cube", "<transform name='to_world'><rotate x='1' y='2' z='-1' angle='33'/></transform>",
                         two_sided_half);
        },
        Vec3d::Zero()));
}

/// A thing at the origin under an even sky, from above.
std::string under_the_sky(const std::string& thing, double half_width, double half_height) {
    return scene_xml("<sensor type='orthographic'><transform name='to_world'><scale x='" + exact(half_width) + "' y='" +
                     exact(half_height) + "'/><lookat origin='0,0,1' target='0,0,0' up='0,1,0'/></transform>" +
                     box_film(8) + "</sensor>" + thing + sky);
}

/// Needles, and normals and angles at which the geometry is hardly there.
void add_slender_and_grazing(std::vector<HardCase>& cases) {
    const std::string reflects = "a convex surface reflects its albedo of an even sky";
    for (const auto& [name, aspect] : {std::pair("1e3", 1e3), std::pair("1e6", 1e6), std::pair("1e9", 1e9)})
        cases.push_back({"NeedleUnderTheSky" + std::string(name),
                         [=](const TemporaryFolder&) {
                             return under_the_sky(
                                 shape("rectangle",
                                       "<transform name='to_world'><scale y='" + exact(1 / aspect) + "'/></transform>",
                                       two_sided_half),
                                 0.9, 0.9 / aspect);
                         },
                         Relation::equal, 0.5, reflects, 16});
    // Two triangles whose vertex normals lean by 120 degrees to below the surface: energy is not made.
    cases.push_back({"NormalsBelowTheSurface",
                     [=](const TemporaryFolder& folder) {
                         const std::string path = folder.write(
                             "leaning.obj",
                             "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvn 0.86602540378 0 -0.5\nvn 0 0.86602540378 "
                             "-0.5\nvn -0.86602540378 0 -0.5\nvn 0 0 1\nf 1//1 2//2 3//3\nf 1//1 3//3 4//4\n");
                         return under_the_sky("<shape type='obj'><string name='filename' value='" + path +
                                                  "'/><bsdf type='twosided'>" + diffuse_bsdf(1) + "</bsdf></shape>",
                                              0.9, 0.9);
                     },
                     Relation::at_most, 1, "a white surface reflects no more than an even sky", 64});
    for (const auto& [name, degrees] : {std::pair("89_9", 89.9), std::pair("89_999", 89.999)}) {
        const double angle = degrees * std::numbers::pi / 180;
        cases.push_back({"GrazingView" + std::string(name),
                         [=](const TemporaryFolder&) {
                             return scene_xml(
                                 "<sensor type='orthographic'><transform name='to_world'><scale x='0.5' y='" +
                                 exact(0.5 * std::cos(angle)) + "'/>" +
                                 lookat(Vec3d(0, std::cos(angle), std::sin(angle)) * 3, Vec3d::Zero()) +
                                 "</transform>" + box_film(8) + "</sensor>" +
                                 shape("rectangle",
                                       "<transform name='to_world'><rotate x='1' angle='-90'/></transform>",
                                       two_sided_half) +
                                 sky);
                         },
                         Relation::equal, 0.5, reflects, 16});
        cases.push_back(
            {"GrazingLight" + std::string(name),
             [=](const TemporaryFolder&) {
                 return scene_xml("<sensor type='orthographic'><transform name='to_world'><scale value='0.5'/>" +
                                  lookat(Vec3d(0, 0, 3), Vec3d::Zero()) + "</transform>" + box_film(8) + "</sensor>" +
                                  shape("rectangle", "", diffuse_bsdf(0.5)) +
                                  "<emitter type='directional'><vector name='direction' x='" + exact(std::sin(angle)) +
                                  "' y='0' z='" + exact(-std::cos(angle)) + "'/>" + rgb_xml("irradiance", 1) +
                                  "</emitter>");
             },
             Relation::equal, 0.5 / std::numbers::pi * std::cos(angle), "E = E_0 cos(theta), L = rho E / pi", 4});
    }
}

const std::vector<HardCase>& table() {
    static const std::vector<HardCase> cases = [] {
        std::vector<HardCase> all;
        add_scales_and_places(all);
        add_closed_meshes(all);
        add_slender_and_grazing(all);
        return all;
    }();
    return cases;
}

class HardGeometry : public testing::TestWithParam<CaseAndMethod> {};
INSTANTIATE_TEST_SUITE_P(Table, HardGeometry, testing::ValuesIn(combined(table())), test::name_of);
TEST_P(HardGeometry, HasItsAnswer) { expect_answer(GetParam()); }

// The image of a scene in other units and at another place is the same image: no path but those that pass an edge
// within rounding takes another way.
TEST(HardGeometryOfEveryMethod, ImagesDependNeitherOnUnitsNorOnThePlace) {
    const Vec3d aside(1.1, -2.3, 1.7);
    for (const HardMethod& method : hard_methods()) {
        const LoadedScene scene = scene_of(placed_furnace({}));
        if (!simulates(method.label, *scene.scene)) continue;
        const double expected = mean_of(render(scene, method.label, 4, 1, 1).total()).mean();
        for (const Place& place : {Place{1e-12}, Place{1e-6}, Place{1e-3}, Place{1e3}, Place{1e6}, Place{1e12},
                                   Place{1, 1e4 * aside}, Place{1, 1e6 * aside}, Place{1e-6, aside}}) {
            const Image image = render(scene_of(placed_furnace(place)), method.label, 4, 1, 1).total();
            EXPECT_NEAR(mean_of(image).mean() / expected, 1, 1e-3) << method.name << ' ' << place.transform();
        }
    }
}

// Rays from within a closed mesh to its vertices, the middles of its edges and points on them.
TEST(HardGeometryRays, EdgesAndVerticesOfAClosedMeshAreHit) {
    const TemporaryFolder folder;
    for (const double scale : {1e-9, 1.0, 1e9}) {
        const std::string resize = "<transform name='to_world'><scale value='" + exact(scale) + "'/></transform>";
        const LoadedScene loaded =
            scene_of(scene_xml(camera(Place{}.view(Vec3d::Zero(), Vec3d::UnitZ()), 40, 4) +
                               ply_shape(folder, sphere_ply(12, Vec3d::Zero(), false), two_sided_half, resize)));
        const auto& mesh = std::get<Mesh>(loaded.scene->shapes().front());
        int rays = 0;
        for (const Vec3& from : {Vec3(0, 0, 0), Vec3(0.31f, 0.22f, -0.17f), Vec3(0, 0.5f, 0)})
            for (const auto& triangle : mesh.triangles)
                for (int corner = 0; corner < 3; ++corner)
                    for (const float along : {0.f, 0.25f, 0.5f}) {
                        const Vec3 a = mesh.vertex(triangle[static_cast<std::size_t>(corner)]),
                                   b = mesh.vertex(triangle[static_cast<std::size_t>((corner + 1) % 3)]);
                        const Vec3 o = static_cast<float>(scale) * from, to = a + along * (b - a) - o;
                        ++rays;
                        EXPECT_TRUE(loaded.scene->intersect({o, to.stableNormalized()}))
                            << scale << ' ' << to.transpose();
                        EXPECT_TRUE(loaded.scene->occluded({o, 2.f * to, 0.f, 1.f})) << scale << ' ' << to.transpose();
                    }
        EXPECT_GT(rays, 5000);
    }
}

}  // namespace
}  // namespace gib
