// Radiosity with a system that is singular or nearly so, and with degenerate patches.

#include "tests/methods/radiosity/fixtures.h"
#include "tests/support/hard_cases.h"
#include "tests/support/scene_text.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace gib::test::degenerate_patches_test {
namespace {

/// Rows of a closed system sum up to 1 within this (methods/radiosity/system.cpp).
constexpr double row_rounding = 1e-7;
/// A solution has converged if the missing power is at most this share of the power that is reflected first.
constexpr double converged = 1e-4;

double power_of(const PatchedScene& scene, const PatchColors& values) { return scene.system.power(values)[0]; }

double first_power(const PatchedScene& scene) {
    double power = 0;
    for (const std::uint32_t leaf : scene.system.leaves())
        power += scene.system.area(leaf) * scene.system.first_reflection(leaf)[0];
    return power;
}

std::string lamp_aside() { return point_light(0.5, 0.2, 0.1, 1); }
std::string closed_room(const std::string& shape, double rho) {
    const std::string material = diffuse_bsdf(rho);
    return (shape == "cube" ? hollow_cube(material) : hollow_sphere(material)) + lamp_aside();
}

struct SolverCase {
    RadiositySolver solver;
    std::string shape;
};
std::vector<SolverCase> solver_cases() {
    std::vector<SolverCase> cases;
    for (std::size_t i = 0; i < radiosity_solver_names.size(); ++i)
        for (const char* shape : {"cube", "sphere"})
            cases.push_back({static_cast<RadiositySolver>(i), shape});
    return cases;
}
std::string name_of_solver(const testing::TestParamInfo<SolverCase>& test) {
    return std::string(radiosity_solver_names[static_cast<std::size_t>(test.param.solver)]) + "_" + test.param.shape;
}

class EverySolver : public testing::TestWithParam<SolverCase> {};
INSTANTIATE_TEST_SUITE_P(Table, EverySolver, testing::ValuesIn(solver_cases()), name_of_solver);

// All light that the walls of a closed room send arrives, so the power of all reflections is that of the first over
// 1 - rho. A converged solution lacks at most 1e-4 (1 + rho + rho^2 + ...) of the first, and rows that are off by
// 1e-7 change the share that is lost by as much. The number of sweeps is bounded: after n sweeps, 2^(n + 2) reflections
// are summed, and each leaves rho of the light; Cholesky's factors take one sweep.
TEST_P(EverySolver, FindsTheGeometricSeriesUpToAnAlbedoOf0_9999) {
    for (const double rho : {0.0, 0.5, 0.99, 0.9999}) {
        const PatchedScene scene(closed_room(GetParam().shape, rho), GetParam().shape == "cube" ? 2.1 : 1.3);
        const double albedo = static_cast<double>(static_cast<float>(rho));
        const double reflections = 1 + std::ceil(std::log(converged) / std::log(std::max(albedo, 1e-9)));
        const int most = GetParam().solver == RadiositySolver::direct
                             ? 1
                             : 1 + std::max(0, static_cast<int>(std::ceil(std::log2(reflections / 8))));
        RadiositySolution solution(scene.system, GetParam().solver);
        while (solution.residual() > converged && solution.sweeps() <= most)
            solution.sweep();
        EXPECT_LE(solution.residual(), converged);
        EXPECT_LE(solution.sweeps(), most) << rho;
        const double lost = 1 - albedo;
        EXPECT_NEAR(power_of(scene, solution.radiosity()) * lost, first_power(scene),
                    (converged + row_rounding / lost) * first_power(scene) + 1e-300)
            << rho;
    }
}

// Light that is shut in and absorbed by nothing has no finite power.
TEST_P(EverySolver, RefusesAClosedRoomThatAbsorbsNothing) {
    const PatchedScene white(closed_room(GetParam().shape, 1.0), 1.3);
    try {
        RadiositySolution(white.system, GetParam().solver);
        ADD_FAILURE() << "no refusal";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("absorb"), testing::HasSubstr("max_depth")));
    }
    const PatchedScene nearly(closed_room(GetParam().shape, 1 - 1e-5), 1.3);
    EXPECT_NO_THROW(RadiositySolution(nearly.system, GetParam().solver));
}

// The room is not known to be closed, and its rows sum up to more than 1.
TEST_P(EverySolver, RefusesASystemThatGainsLight) {
    PatchedScene scene(closed_room(GetParam().shape, 0.5), 1.3, 0, false);
    for (Colord& rho : scene.light.reflectance)
        rho = Colord::Constant(1.2);
    RadiositySolution solution(scene.system, GetParam().solver);
    const auto solve = [&] {
        for (int i = 0; i < 10; ++i)
            solution.sweep();
    };
    EXPECT_THROW(solve(), InputError);
}

// n reflections in a closed room of albedo 1 have n times the power of the first;
// each may be off by the error of the rows.
TEST_P(EverySolver, SumsWhiteWallsReflectionsUpToALimit) {
    const PatchedScene scene(closed_room(GetParam().shape, 1.0), 1.3);
    for (const int n : {0, 1, 2, 3, 6, 31, 1000}) {
        RadiositySolution solution(scene.system, GetParam().solver, n);
        while (solution.residual() > 0)
            solution.sweep();
        EXPECT_LE(solution.sweeps(), n < 2 ? 0 : std::max(1, static_cast<int>(std::ceil(std::log2(n))) - 2)) << n;
        EXPECT_NEAR(power_of(scene, solution.radiosity()), n * first_power(scene),
                    n * n * row_rounding * first_power(scene))
            << n;
    }
}

std::string furnace_sphere(double rho, double emission, int max_depth) {
    return scene_xml(element("integrator", "path", integer("max_depth", max_depth)) +
                     camera(60, to_world(look_at("0, 0, -0.5", "0.1, 0.2, 1")), box_film(8)) +
                     sphere_at(Vec3d::Zero(), 1, flag("flip_normals") + diffuse_bsdf(rho) + area_light(emission)));
}

// L is the sum of max_depth terms of emission rho^i. The light of the lamp on patches is sampled: 16 samples
// a patch, with a relative deviation below 1, on at least 96 patches of the sphere. Pixels have as many
// samples. The bound is five standard errors.
TEST(RadiosityLabel, HasTheFurnaceOfEveryDepthByEverySolver) {
    const double noise = 5 / std::sqrt(16.0 * 96);
    for (const std::string_view solver : radiosity_solver_names) {
        const std::string label = "radiosity patch=0.2 solver=" + std::string(solver);
        for (const int depth : {1, 2, 3, 8, 33}) {
            const LoadedScene scene = scene_of(furnace_sphere(1, 1.0 / depth, depth));
            EXPECT_NEAR(mean_of(render(scene, label, 16).total()).mean(), 1, depth < 2 ? 1e-6 : noise)
                << label << ' ' << depth;
        }
        const LoadedScene scene = scene_of(furnace_sphere(0.9999, 1e-4, -1));
        EXPECT_NEAR(mean_of(render(scene, label, 16).total()).mean(), 1, noise) << label;
    }
}

/// A floor of albedo 0.5 and side 2 below `ceiling`, with a point light at z = 0.5.
std::string floor_and(const std::string& ceiling) {
    return shape("rectangle", diffuse_bsdf(0.5)) + ceiling + point_light(0.1, 0.2, 0.5, 1);
}
std::string plate(double z, const std::string& material) {
    return shape("rectangle", to_world(rotate('x', 180), translate(0, 0, z)), material);
}

Colord indirect_power(const PatchedScene& scene) {
    RadiositySolution solution(scene.system, RadiositySolver::direct);
    solution.sweep();
    return scene.system.power(solution.radiosity());
}

// A ray meets only the first of several surfaces in the same place, so the others neither reflect nor send light.
TEST(DegeneratePatches, DuplicatesAddNoLight) {
    const std::string one = plate(1, diffuse_bsdf(0.8)), ball = sphere_at({0, 0, 0.8}, 0.1, diffuse_bsdf(0.7));
    for (const std::string& thing : {one, ball}) {
        const PatchedScene alone(floor_and(thing), 0.71, 0, false);
        for (const std::string& again : {thing, thing + thing}) {
            const PatchedScene both(floor_and(thing + again), 0.71, 0, false);
            EXPECT_EQ(both.mesh.leaves().size(), alone.mesh.leaves().size());
            EXPECT_EQ(indirect_power(both)[0], indirect_power(alone)[0]);
        }
    }
    // If the copy faces the other way, it is seen from its back, which reflects nothing.
    std::string back = one;
    back.insert(back.find('>') + 1, "<boolean name='flip_normals' value='true'/>");
    const PatchedScene turned(floor_and(one + back), 0.71, 0, false);
    EXPECT_EQ(turned.mesh.leaves().size(), PatchedScene(floor_and(one), 0.71, 0, false).mesh.leaves().size());
}

std::string mesh_shape(const TemporaryFolder& folder, const std::string& name, const std::string& obj,
                       const std::string& material) {
    folder.write(name, obj);
    return shape("obj", text("filename", folder / name), material);
}

// The ceiling is a mesh, first plain, then with triangles of no area: two equal
// corners, three equal corners, corners on a line.
TEST(DegeneratePatches, TrianglesWithoutAreaAreNoPatches) {
    const TemporaryFolder folder;
    const std::string corners = "v -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\nv 0 0 1\n";
    const std::string faces = "f 1 4 3\nf 1 3 2\n", lines = "f 1 1 3\nf 2 2 2\nf 1 5 3\nf 4 4 2\n";
    const PatchedScene plain(floor_and(mesh_shape(folder, "a.obj", corners + faces, diffuse_bsdf(0.8))), 0.71, 0,
                             false);
    const PatchedScene more(floor_and(mesh_shape(folder, "b.obj", corners + faces + lines, diffuse_bsdf(0.8))), 0.71, 0,
                            false);
    EXPECT_EQ(more.mesh.leaves().size(), plain.mesh.leaves().size());
    EXPECT_EQ(indirect_power(more)[0], indirect_power(plain)[0]);
    EXPECT_GT(indirect_power(plain)[0], 0);
}

std::string wall(double x, double y) {
    const std::string turned = fmt::format("<rotate x='{}' y='{}' angle='-90'/>", -y, x);
    return shape("rectangle", to_world(turned, translate(x, y, 0)), diffuse_bsdf(0.5));
}
std::string open_cube() { return wall(1, 0) + wall(-1, 0) + wall(0, 1) + wall(0, -1) + plate(1, diffuse_bsdf(0.5)); }

/// The floor z = -1 of a cube of side 2, in strips along x that end at these values of y.
std::string strips(const std::vector<double>& ends) {
    std::string obj = "v -1 -1 -1\nv 1 -1 -1\n";
    for (const double y : ends)
        obj += "v -1 " + fmt::to_string(y) + " -1\nv 1 " + fmt::to_string(y) + " -1\n";
    for (std::size_t i = 0; i < ends.size(); ++i) {
        const auto corner = [&](std::size_t k) { return std::to_string(2 * i + k); };
        obj += "f " + corner(1) + " " + corner(2) + " " + corner(4) + "\nf " + corner(1) + " " + corner(4) + " " +
               corner(3) + "\n";
    }
    return obj;
}

// The floor of a closed cube has strips and triangles a millionth as wide as long, or a strip a ten-thousandth as
// wide as the patches beside it. Rows of a closed system sum up to 1 with any patches: each factor of leaves is right
// to 1e-4 (methods/radiosity/form_factors/polygon_form_factor.h). The power is that of the series.
TEST(DegeneratePatches, NeedlesAndPatchesOfUnequalSizeCloseTheRoom) {
    const TemporaryFolder folder;
    std::vector<double> fine = {-2e-6, -1e-6, 0, 1e-6, 2e-6, 1};
    const std::map<std::string, std::string> floors = {
        {"even.obj", strips({0, 1})},
        {"ratio_1e4.obj", strips({-1e-4, 1e-4, 1})},
        {"needles_1e6.obj", strips(fine)},
        {"fan.obj",
         "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv 0.999998 0.999999 -1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n"},
    };
    for (const auto& [name, obj] : floors) {
        SCOPED_TRACE(name);
        const PatchedScene scene(
            open_cube() + mesh_shape(folder, name, obj, diffuse_bsdf(0.5)) + point_light(0.2, 0.1, 0.3, 1), 1.01);
        double area = 0;
        for (const std::uint32_t leaf : scene.system.leaves())
            area += scene.system.area(leaf);
        EXPECT_NEAR(area, 24, 1e-5);
        EXPECT_LT(scene.system.closure().mean, 2e-4);
        for (const std::size_t solver : {0u, 1u}) {
            RadiositySolution solution(scene.system, static_cast<RadiositySolver>(solver));
            while (solution.residual() > converged && solution.sweeps() < 30)
                solution.sweep();
            EXPECT_NEAR(power_of(scene, solution.radiosity()) * 0.5, first_power(scene),
                        (converged + 2 * row_rounding) * first_power(scene))
                << radiosity_solver_names[solver];
            for (const std::uint32_t leaf : scene.system.leaves()) {
                ASSERT_TRUE(solution.radiosity()[leaf].isFinite().all());
                EXPECT_GE(solution.radiosity()[leaf][0], 0);
            }
        }
    }
}

}  // namespace
}  // namespace gib::test::degenerate_patches_test
