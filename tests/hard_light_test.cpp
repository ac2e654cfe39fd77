// Hard cases of light transport: lights, albedos, interfaces, roughness and media at the ends of their ranges. Every
// method that simulates the scene.

#include "tests/hard_cases.h"

namespace gib {
namespace {

using namespace test;

const std::string in_the_furnace = "what loses no light is invisible where the radiance is 1 everywhere";
const std::string black_bsdf = diffuse_bsdf(0);

std::string perfect_mirror() { return "<bsdf type='conductor'><string name='material' value='none'/></bsdf>"; }

std::string rectangle(const std::string& operations, const std::string& inside) {
    return shape("rectangle", "<transform name='to_world'>" + operations + "</transform>", inside);
}
std::string scaled(double x, double y, double z = 1) {
    return "<scale x='" + exact(x) + "' y='" + exact(y) + "' z='" + exact(z) + "'/>";
}
std::string moved(double x, double y, double z) {
    return "<translate x='" + exact(x) + "' y='" + exact(y) + "' z='" + exact(z) + "'/>";
}
const std::string face_down = "<rotate x='1' angle='180'/>";

/// Of things in the furnace, seen by a camera at `from`.
HardCase seen_in_furnace(const std::string& name, const std::string& things, double radiance = 1,
                         const Vec3d& from = {0, 0, -3}, std::uint32_t passes = 8) {
    HardCase hard{
        name,
        [=](const TemporaryFolder&) {
            return scene_xml(camera(Place{}.view(from, from + Vec3d(0.05, 0.1, 1)), 40, 8) + furnace() + things);
        },
        Relation::equal,
        radiance,
        in_the_furnace,
        passes};
    return hard;
}

std::string nested_shells(int count) {
    std::string shells;
    for (int i = 0; i < count; ++i)
        shells += sphere_at(Vec3d::Zero(), 1.2 - i / 100.0, glass(i % 2 ? 1 : 1.5, i % 2 ? 1.5 : 1));
    return shells;
}

/// The floor under what `lights` describes, seen straight from above at (x, y) from height 0.01 in a square of side 2
/// `half`.
std::string floor_under(const std::string& lights, double x, double y, double half, double albedo = 0.5,
                        double size = 10) {
    return scene_xml("<integrator type='direct'/><sensor type='orthographic'><transform name='to_world'>" +
                     scaled(half, half) + lookat({x, y, 0.005}, {x, y, 0}) + "</transform>" + box_film(8) +
                     "</sensor>" + rectangle(scaled(size, size), diffuse_bsdf(albedo)) + lights);
}

void add_lights(std::vector<HardCase>& cases) {
    // A lamp of area A and radiance L at height 1 straight above: E = L A for A much below 1 (relative error A).
    for (const auto& [name, side] : {std::pair("1e_3", 1e-3), std::pair("1e_6", 1e-6), std::pair("1e_9", 1e-9)})
        cases.push_back({"LampOfSide" + std::string(name),
                         [=](const TemporaryFolder&) {
                             return floor_under(rectangle(scaled(side / 2, side / 2) + face_down + moved(0, 0, 1),
                                                          black_bsdf + area_emitter(1 / (side * side))),
                                                0, 0, 1e-3);
                         },
                         Relation::equal, 0.5 / std::numbers::pi, "E = L A / h^2", 16});
    // The same as a disk and a sphere: E = pi L r^2 / h^2.
    cases.push_back({"SmallSphereLamp",
                     [](const TemporaryFolder&) {
                         return floor_under(sphere_at({0, 0, 1}, 1e-6, black_bsdf + area_emitter(1e12)), 0, 0, 1e-3);
                     },
                     Relation::equal, 0.5, "E = pi L (r / h)^2", 16});
    // A square lamp of side 2 a at height 1 over its middle (Howell, B-4): E = pi L F. Beyond that, uniform points of
    // the lamp have such weights that methods which follow no samples of the bsdf converge too slowly to be judged.
    const auto square_above = [](double half) {
        const double b = half / std::sqrt(1 + half * half);
        return 4 / std::numbers::pi * b * std::atan(b);
    };
    for (const auto& [name, half, only] : {std::tuple("", 10.0, ""), std::tuple("Vast", 1e4, "path")}) {
        cases.push_back({"LampOfTheScenesSize" + std::string(name),
                         [half = half](const TemporaryFolder&) {
                             return floor_under(rectangle(scaled(half, half) + face_down + moved(0, 0, 1),
                                                          black_bsdf + area_emitter(1)),
                                                0, 0, 1e-3, 0.5, half);
                         },
                         Relation::equal, 0.5 * square_above(half), "form factor of a square overhead", 64});
        cases.back().only = only;
    }
    // Perpendicular unit squares with a common edge: F = 0.20004378 (Howell, C-14), E = pi L F in the mean over the
    // floor's square; the lamp stands on it, and the integrand has the singularity of the corner.
    cases.push_back({"LampTouchesTheFloor",
                     [](const TemporaryFolder&) {
                         return floor_under(
                             rectangle(scaled(0.5, 0.5) + "<rotate y='1' angle='90'/>" + moved(0, 0, 0.5),
                                       black_bsdf + area_emitter(1)),
                             0.5, 0, 0.5);
                     },
                     Relation::equal, 0.5 * 0.20004378, "form factor of squares at right angles", 256});
    // A lamp that lies on the floor, 1e-6 above it, and shines up: nothing arrives there.
    cases.push_back({"LampLiesOnTheFloor",
                     [](const TemporaryFolder&) {
                         return floor_under(rectangle(scaled(1, 1) + moved(0, 0, 1e-6), black_bsdf + area_emitter(1)),
                                            2, 0, 0.5);
                     },
                     Relation::black, 0, "the lamp faces away from the floor", 16});
    // A point lamp at height d over the middle of a square of side 2 a: E dA = I dw, so that the square's mean is I /
    // (4 a^2) times its solid angle.
    const double d = 0.1, a = 0.5;
    const double solid_angle = 4 * std::asin(a * a / (a * a + d * d));
    cases.push_back({"PointLampCloseToTheFloor",
                     [=](const TemporaryFolder&) {
                         return floor_under("<emitter type='point'><point name='position' x='0' y='0' z='" + exact(d) +
                                                "'/>" + rgb_xml("intensity", 1) + "</emitter>",
                                            0, 0, a);
                     },
                     Relation::equal, 0.5 / std::numbers::pi * solid_angle / (4 * a * a), "E dA = I dw", 64});
    for (const auto& [name, radiance] :
         {std::pair("1e_20", 1e-20), std::pair("1e20", 1e20), std::pair("1e_30", 1e-30), std::pair("1e30", 1e30)})
        cases.push_back({"FurnaceOfRadiance" + std::string(name),
                         [=](const TemporaryFolder&) {
                             return scene_xml(camera(Place{}.view({0, 0, -3}, Vec3d::Zero()), 40, 8) +
                                              sphere_at(Vec3d::Zero(), 4,
                                                        "<boolean name='flip_normals' value='true'/>" +
                                                            diffuse_bsdf(0.5) + area_emitter(0.5 * radiance)) +
                                              sphere_at(Vec3d::Zero(), 0.5, glass(1.5)));
                         },
                         Relation::equal, radiance, "radiance is linear in the lights", 16});
    // 1e4 lamps of equal power of which 9999 face away from the floor below them; the share of samples that finds the
    // one that matters is 1e-4, so the others are dimmer by 1e4.
    cases.push_back({"TenThousandLampsOfWhichOneMatters",
                     [](const TemporaryFolder&) {
                         std::string lamps;
                         for (int i = 0; i < 9999; ++i)
                             lamps +=
                                 rectangle(scaled(0.01, 0.01) + moved(i % 100 * 0.05 - 2.5, i / 100 * 0.05 - 2.5, 2),
                                           black_bsdf + area_emitter(1e-4));
                         return floor_under(lamps + rectangle(scaled(5e-3, 5e-3) + face_down + moved(0, 0, 1),
                                                              black_bsdf + area_emitter(1e4)),
                                            0, 0, 1e-3);
                     },
                     Relation::equal, 0.5 / std::numbers::pi, "E = L A / h^2 of the lamp that faces the floor", 16});
}

void add_albedos(std::vector<HardCase>& cases) {
    const auto furnace_of = [](double rho, const std::string& integrator, double emission) {
        return [=](const TemporaryFolder&) {
            return scene_xml(
                integrator + camera(Place{}.view({0, 0, -0.5}, {0.1, 0.2, 1}), 60, 8) +
                sphere_at(Vec3d::Zero(), 1,
                          "<boolean name='flip_normals' value='true'/>" + diffuse_bsdf(rho) + area_emitter(emission)));
        };
    };
    cases.push_back({"Albedo0", furnace_of(0, "", 1), Relation::equal, 1, "only the lamp itself", 2, true});
    // Unlimited walks of albedo 1 have no finite answer; n edges have the sum of n terms.
    cases.push_back({"Albedo1EightEdges",
                     furnace_of(1, "<integrator type='path'><integer name='max_depth' value='8'/></integrator>", 0.125),
                     Relation::equal, 1, "L = sum of max_depth equal terms", 8});
    cases.back().without = "radiosity";  // its solvers cut the series of a system off only where that converges
    cases.push_back(
        {"Albedo0_9999HundredEdges",
         furnace_of(0.9999, "<integrator type='path'><integer name='max_depth' value='100'/></integrator>", 1e-4),
         Relation::equal, 1 - std::pow(0.9999, 100), "a geometric series, cut off", 2});
    cases.push_back({"WhiteSphereUnderTheSky",
                     [](const TemporaryFolder&) {
                         return scene_xml(camera(Place{}.view({0, 0, -3}, Vec3d::Zero()), 20, 8) +
                                          sphere_at(Vec3d::Zero(), 1, diffuse_bsdf(1)) + "<emitter type='constant'>" +
                                          rgb_xml("radiance", 1) + "</emitter>");
                     },
                     Relation::equal, 1, "a convex surface reflects its albedo of an even sky", 16});
    cases.push_back({"ClosedBoxWithoutLight",
                     [](const TemporaryFolder&) {
                         return scene_xml(
                             camera(Place{}.view({0, 0, -0.5}, {0.1, 0.2, 1}), 60, 8) +
                             shape("cube", "", "<boolean name='flip_normals' value='true'/>" + diffuse_bsdf(1)));
                     },
                     Relation::black, 0, "no light", 4});
}

void add_interfaces(std::vector<HardCase>& cases) {
    const Vec3d o = Vec3d::Zero();
    for (const auto& [name, eta] : {std::pair("1", 1.0), std::pair("1_1e_7", 1 + 1e-7), std::pair("1_1e_5", 1 + 1e-5),
                                    std::pair("3", 3.0), std::pair("1_third", 1 / 3.0)})
        cases.push_back(seen_in_furnace("GlassOfEta" + std::string(name), sphere_at(o, 1.2, glass(eta))));
    cases.push_back(seen_in_furnace("HundredShells", nested_shells(100)));
    // Without the late cap of roulette on specular paths (methods/roulette.h) this one is 0.78.
    cases.push_back(seen_in_furnace("HundredShellsManySamples", nested_shells(100), 1, {0, 0, -3}, 64));
    cases.back().only = "path";
    // Water in a glass: the walls coincide, leave a gap of air of 1e-5, or overlap by as much.
    for (const auto& [name, gap] : {std::pair("Touching", 0.0), std::pair("Gap", 1e-5), std::pair("Overlap", -1e-5)})
        cases.push_back(seen_in_furnace(
            "WaterInGlass" + std::string(name),
            sphere_at(o, 1.2, glass(1.5)) + sphere_at(o, 1, glass(1, 1.5)) + sphere_at(o, 1 - gap, glass(1.33))));
    cases.push_back(seen_in_furnace("TheSamePaneTwice", rectangle(scaled(2, 2), "<bsdf type='thindielectric'/>") +
                                                            rectangle(scaled(2, 2), "<bsdf type='thindielectric'/>")));
    cases.push_back(
        seen_in_furnace("CoincidentGlassCubes", shape("cube", "", glass(1.5)) + shape("cube", "", glass(1.5))));
    // Radiance over eta^2 is what refraction keeps.
    cases.push_back(seen_in_furnace("CameraInGlass", sphere_at({0, 0, -3}, 0.5, glass(1.5)), 2.25));
    // On the wall, looking along and away from it.
    cases.push_back(seen_in_furnace("CameraOnALight", "", 1, {0, 0, -4}));
    const std::string two_sided_mirror = "<bsdf type='twosided'>" + perfect_mirror() + "</bsdf>";
    cases.push_back(
        seen_in_furnace("MirrorCorridor", rectangle(scaled(2, 2) + moved(0, 0, 1), two_sided_mirror) +
                                              rectangle(scaled(1, 1) + moved(0, 0, -3.5), two_sided_mirror)));
    // A black lamp in a box of perfect mirrors: every path ends on it.
    cases.push_back({"ClosedMirrorBox",
                     [=](const TemporaryFolder&) {
                         return scene_xml(
                             camera(Place{}.view({0.3, 0.2, -0.9}, {0.1, 0.2, 1}), 60, 8) +
                             shape("cube", "", "<boolean name='flip_normals' value='true'/>" + perfect_mirror()) +
                             sphere_at(o, 0.5, black_bsdf + area_emitter(1)));
                     },
                     Relation::equal, 1, "every path ends on the lamp", 64});
    cases.push_back({"ClosedMirrorBoxWithoutLight",
                     [=](const TemporaryFolder&) {
                         return scene_xml(
                             camera(Place{}.view({0.3, 0.2, -0.9}, {0.1, 0.2, 1}), 60, 8) +
                             shape("cube", "", "<boolean name='flip_normals' value='true'/>" + perfect_mirror()) +
                             "<emitter type='point'><point name='position' x='9' y='0' z='0'/></emitter>" +
                             sphere_at({0.5, 0.5, 0.5}, 0.1, diffuse_bsdf(0.5)));
                     },
                     Relation::black, 0, "no light comes into a closed box", 2});
    for (const auto& [name, alpha] :
         {std::pair("1e_4", 1e-4), std::pair("1e_2", 1e-2), std::pair("0_1", 0.1), std::pair("1", 1.0)}) {
        const std::string rough = number_xml("alpha", alpha);
        HardCase metal = seen_in_furnace(
            "RoughMirror" + std::string(name),
            sphere_at(o, 1.2,
                      "<bsdf type='roughconductor'><string name='material' value='none'/>" + rough + "</bsdf>"));
        HardCase frosted = seen_in_furnace("RoughGlass" + std::string(name),
                                           sphere_at(o, 1.2, "<bsdf type='roughdielectric'>" + rough + "</bsdf>"));
        // Light that is scattered more than once between microfacets is not modelled: rough surfaces are darker than 1,
        // smooth ones by O(alpha^2).
        if (alpha > 0.01) metal.relation = frosted.relation = Relation::at_most;
        cases.push_back(metal);
        cases.push_back(frosted);
    }
    cases.push_back({"LensOfRadius0",
                     [=](const TemporaryFolder&) {
                         return scene_xml(
                             "<sensor type='thinlens'><float name='fov' value='40'/><float name='aperture_radius' "
                             "value='0'/><float name='focus_distance' value='2'/>" +
                             box_film(8) + "</sensor>" + furnace());
                     },
                     Relation::equal, 1, in_the_furnace, 16});
}

void add_media(std::vector<HardCase>& cases) {
    const auto ball = [](double optical_depth, double albedo) {
        return sphere_at(Vec3d::Zero(), 1,
                         "<bsdf type='null'/><medium name='interior' type='homogeneous'>" +
                             rgb_xml("sigma_t", optical_depth / 2) + rgb_xml("albedo", albedo) + "</medium>");
    };
    for (const auto& [name, depth] : {std::pair("1e_6", 1e-6), std::pair("1e_2", 1e-2), std::pair("1", 1.0)})
        cases.push_back(seen_in_furnace("WhiteMedium" + std::string(name), ball(depth, 1), 1, {0, 0, -3}, 32));
    // A look-up's ball that is wider than a mean free path blurs the light in the medium: known bias.
    cases.push_back(seen_in_furnace("WhiteMedium10", ball(10, 1), 1, {0, 0, -3}, 32));
    cases.back().only = "path";

    const auto absorber = [=](double depth) {
        return [=](const TemporaryFolder&) {
            return scene_xml(camera(Place{}.view({0, 0, -3}, Vec3d::Zero()), 0.01, 8) + furnace(4, 0) + ball(depth, 0));
        };
    };
    for (const auto& [name, depth] :
         {std::pair("1e_6", 1e-6), std::pair("1e_2", 1e-2), std::pair("1", 1.0), std::pair("10", 10.0)})
        cases.push_back({"AbsorbingMedium" + std::string(name), absorber(depth), Relation::equal, std::exp(-depth),
                         "Beer's law", 16});
    cases.push_back({"AbsorbingMedium1e4", absorber(1e4), Relation::at_most, 0,
                     "Beer's law: exp(-1e4) is below float's range", 16});
    cases.push_back(
        {"CameraInAThickMedium",
         [=](const TemporaryFolder&) {
             return scene_xml(
                 "<medium id='m' type='homogeneous'>" + rgb_xml("sigma_t", 1e4) + rgb_xml("albedo", 0.5) + "</medium>" +
                 camera(Place{}.view(Vec3d::Zero(), Vec3d::UnitZ()), 40, 8, "<ref name='medium' id='m'/>") + furnace() +
                 sphere_at(Vec3d::Zero(), 1, "<bsdf type='null'/><ref name='interior' id='m'/>"));
         },
         Relation::at_most, 0, "nothing comes through an optical depth of 1e4", 16});
}

const std::vector<HardCase>& table() {
    static const std::vector<HardCase> cases = [] {
        std::vector<HardCase> all;
        add_lights(all);
        add_albedos(all);
        add_interfaces(all);
        add_media(all);
        return all;
    }();
    return cases;
}

class HardLight : public testing::TestWithParam<CaseAndMethod> {};
INSTANTIATE_TEST_SUITE_P(Table, HardLight, testing::ValuesIn(combined(table())), test::name_of);
TEST_P(HardLight, HasItsAnswer) { expect_answer(GetParam()); }

}  // namespace
}  // namespace gib
