// The equation system of radiosity and its solvers are compared with closed forms.
#include "tests/methods/radiosity/fixtures.h"
#include "tests/support/scene_text.h"

#include <numbers>

namespace gib::test::system_test {
namespace {

constexpr double pi = std::numbers::pi;

std::string grey(double rho) { return one_sided(std::to_string(rho)); }

/// A cubic room with a block in it. Its walls have different reflectances; one reflects nothing in two channels.
const std::string coloured_room =
    shape("rectangle", to_world(translate(0, 0, -1)), one_sided("0.8 0.6 0.4")) +
    shape("rectangle", to_world(rotate('x', 180), translate(0, 0, 1)), one_sided("0.3 0.3 0.9")) +
    shape("rectangle", to_world(rotate('y', 90), translate(-1, 0, 0)), one_sided("0.7 0 0")) +
    shape("rectangle", to_world(rotate('y', -90), translate(1, 0, 0)), one_sided("0.5")) +
    shape("cube", to_world(scale(0.3), translate(0, 0, -0.7)), one_sided("0.9")) + point_light(0.3, 0.2, 0.6, 1);

double mean_over(const RadiositySystem& system, const PatchColors& values, int channel) {
    double sum = 0, area = 0;
    for (const std::uint32_t leaf : system.leaves()) {
        sum += system.area(leaf) * values[leaf][channel];
        area += system.area(leaf);
    }
    return sum / area;
}

RadiositySolution solved(const RadiositySystem& system, RadiositySolver solver, double residual) {
    RadiositySolution solution(system, solver);
    while (solution.residual() > residual && solution.sweeps() < 100)
        solution.sweep();
    return solution;
}
RadiositySolution iterated(const RadiositySystem& system, double residual) {
    return solved(system, RadiositySolver::hierarchical, residual);
}

// Form factors between flat patches without occluders have a closed form, so the scaling of rows corrects little.
TEST(RadiositySystem, RowsOfAClosedRoomSumUpToOne) {
    const PatchedScene scene(hollow_cube(grey(0.5)) + point_light(0, 0, 0, 1), 0.51);
    EXPECT_LT(scene.system.closure().largest, 1e-4);
}

// Every point of a sphere receives the same indirect irradiance, whatever the
// light: 4 pi / (4 pi r^2) rho / (1 - rho).
TEST(RadiositySystem, AnIntegratingSpheresIndirectLightIsAGeometricSeries) {
    for (const double rho : {0.1, 0.5, 0.9, 0.99}) {
        const PatchedScene scene(hollow_sphere(grey(rho)) + point_light(0.3, 0.2, 0.1, 1), 0.45);
        const auto solution = iterated(scene.system, 1e-5);
        const PatchColors E = scene.system.irradiance(solution.radiosity());
        EXPECT_NEAR(mean_over(scene.system, E, 0) / (rho / (1 - rho)), 1, 0.005) << rho;
        for (const std::uint32_t leaf : scene.system.leaves())
            EXPECT_NEAR(E[leaf][0] / (rho / (1 - rho)), 1, 0.05) << rho;
    }
}

/// Standard deviation of the indirect irradiance of an integrating sphere's patches over its mean, which is 1.
double unevenness_of_a_sphere(double size) {
    const PatchedScene scene(hollow_sphere(grey(0.5)) + point_light(0.3, 0.2, 0.1, 1), size);
    const auto solution = iterated(scene.system, 1e-5);
    PatchColors E = scene.system.irradiance(solution.radiosity());
    for (Colord& e : E)
        e = (e - 1).square();
    return std::sqrt(mean_over(scene.system, E, 0));
}

// Chord polygons deviate from the sphere. Larger and smaller patches deviate by
// different shares, of second order in their size.
TEST(RadiositySystem, AnIntegratingSphereIsLitMoreEvenlyByFinerPatches) {
    const double coarse = unevenness_of_a_sphere(0.45), fine = unevenness_of_a_sphere(0.225);
    EXPECT_LT(fine, coarse / 2) << coarse << ' ' << fine;
}

// Links between groups transport the same light as links between all patches, and there are fewer of them.
TEST(PatchLinks, BetweenGroupsCarryTheSameLight) {
    const PatchedScene all(coloured_room, 0.26, 0, false), grouped(coloured_room, 0.26, 0.05, false);
    EXPECT_LT(grouped.links.size(), all.links.size() / 2);
    const auto truth = iterated(all.system, 1e-6);
    const auto found = iterated(grouped.system, 1e-6);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(mean_over(grouped.system, found.radiosity(), c) / mean_over(all.system, truth.radiosity(), c), 1,
                    0.01);
}

// Light that leaves a group arrives somewhere: without the scaling of rows, coarse links distribute the light of each
// leaf unevenly, but none of it is lost, and the mean row sum is 1.
TEST(PatchLinks, BetweenGroupsLoseNoLight) {
    const PatchedScene scene(hollow_cube(grey(0.5)) + point_light(0.3, 0.2, 0.6, 1), 0.26, 0.02, false);
    const PatchColors rows = scene.system.irradiance(PatchColors(scene.system.node_count(), Colord::Ones()));
    EXPECT_NEAR(mean_over(scene.system, rows, 0), 1, 1e-3);
    PatchColors X(scene.system.node_count(), Colord::Zero()), E;
    for (const std::uint32_t leaf : scene.system.leaves())
        X[leaf] = scene.system.first_reflection(leaf);
    E = scene.system.irradiance(X);
    EXPECT_NEAR(mean_over(scene.system, E, 0) / mean_over(scene.system, X, 0), 1, 0.01);
}

/// A sphere of radius 0.5 below the middle of the room, of n times 2 n facets.
std::string ball_mesh(const TemporaryFolder& folder, int n) {
    std::string obj;
    for (int k = 0; k <= n; ++k)
        for (int i = 0; i < 2 * n; ++i) {
            const double theta = pi * k / n, phi = pi * i / n;
            obj += fmt::format("v {} {} {}\n", 0.5 * std::sin(theta) * std::cos(phi),
                               0.5 * std::sin(theta) * std::sin(phi), 0.5 * std::cos(theta) - 0.3);
        }
    for (int k = 0; k < n; ++k)
        for (int i = 0; i < 2 * n; ++i) {
            const int a = 2 * n * k + i + 1, b = 2 * n * k + (i + 1) % (2 * n) + 1, c = a + 2 * n, d = b + 2 * n;
            if (k > 0) obj += fmt::format("f {} {} {}\n", a, d, b);
            if (k < n - 1) obj += fmt::format("f {} {} {}\n", a, c, d);
        }
    return shape("obj", text("filename", folder.write("ball.obj", obj)), flag("face_normals"), grey(0.7));
}

// Clusters of a mesh's triangles exchange the same light as all pairs of patches do.
TEST(PatchLinks, BetweenClustersCarryTheSameLight) {
    const TemporaryFolder folder;
    const std::string scene_text = hollow_cube(grey(0.5)) + ball_mesh(folder, 12) + point_light(0.3, 0.2, 0.8, 1);
    const PatchedScene all(scene_text, 0.51, 0, false), grouped(scene_text, 0.51, 0.02, false);
    EXPECT_LT(grouped.links.size(), all.links.size());
    const auto with_cluster = [&](const PatchLink& link) {
        return grouped.mesh.nodes()[link.p].is_cluster() || grouped.mesh.nodes()[link.q].is_cluster();
    };
    EXPECT_TRUE(std::any_of(grouped.links.begin(), grouped.links.end(), with_cluster));
    const PatchColors truth = all.system.irradiance(iterated(all.system, 1e-6).radiosity());
    const PatchColors found = grouped.system.irradiance(iterated(grouped.system, 1e-6).radiosity());
    for (const std::uint32_t shape : {0u, 1u}) {
        double expected = 0, sum = 0;
        for (const std::uint32_t leaf : all.system.leaves()) {
            if (all.mesh.chart_of(all.mesh.nodes()[leaf]).shape != shape) continue;
            expected += all.system.area(leaf) * truth[leaf][0];
            sum += all.system.area(leaf) * found[leaf][0];
        }
        EXPECT_NEAR(sum / expected, 1, 0.015) << shape;
    }
}

// A patch reflects the mean of its reflectance over evenly distributed light, be it constant, masked or textured.
TEST(PatchLight, ReflectsTheMeanOfAPatch) {
    const auto reflectance_of = [](const std::string& material) {
        const PatchedScene scene(shape("rectangle", material) + point_light(0, 0, 1, 1), 3, 0, false);
        EXPECT_EQ(scene.mesh.leaves().size(), 1u);
        return scene.light.reflectance[0][1];
    };
    EXPECT_NEAR(reflectance_of(grey(0.5)), 0.5, 1e-6);
    EXPECT_NEAR(reflectance_of(bsdf("mask", number("opacity", 0.3), grey(0.5))), 0.15, 1e-6);
    const std::string board = bsdf("diffuse", "<texture name='reflectance' type='checkerboard'>", rgb("color0", 0.2),
                                   rgb("color1", 0.8), "</texture>");
    EXPECT_NEAR(reflectance_of(board), 0.5, 0.05);
}

TEST(PatchLinks, BrightSourcesAreLinkedMoreFinelyThanDarkOnes) {
    const auto links_with = [](double height) {
        const PatchedScene scene(hollow_cube(grey(0.5)) + point_light(0, 0, height, 1), 0.26, 0.02);
        std::size_t low = 0, high = 0;
        for (const PatchLink& link : scene.links)
            for (const std::uint32_t end : {link.p, link.q})
                ++(scene.mesh.nodes()[end].center.z() > 0 ? high : low);
        return static_cast<double>(high) / static_cast<double>(low);
    };
    EXPECT_GT(links_with(0.9), 1.2 * links_with(-0.9));
}

}  // namespace
}  // namespace gib::test::system_test
