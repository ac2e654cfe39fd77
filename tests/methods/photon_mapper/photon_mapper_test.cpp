// The photon mapper as a method: its plan, its components against path tracing, its bias and its leaks.
#include "methods/photon_mapper/photon_mapper.h"

#include "experiments/metrics/statistics.h"
#include "tests/support/moments.h"
#include "tests/support/scene_fixtures.h"
#include "tests/support/scene_text.h"

#include <iostream>
#include <map>

namespace gib::photon_mapper_test {
namespace {

using test::mean_of;
using test::render;

/// Settings without a projection map: if photons were aimed, a map that no light can fill would trace none.
PhotonMapperSettings settings(std::uint64_t photons) {
    PhotonMapperSettings s{};
    s.photons = s.caustic_photons = s.volume_photons = photons;
    s.k = s.caustic_k = s.volume_k = 50;
    s.radius = 0.1;
    s.caustic_radius = 0.025;
    s.volume_radius = 0.05;
    s.area = DiscArea::surface;
    s.max_edges = 17;
    return s;
}

struct Rendered {
    ComponentImages image;
    RunCounts counts;
};

Rendered render_for(const Scene& scene, const Effects& effects) {
    StageTimes stages;
    const auto run = start_photon_mapper(scene, settings(20000), effects, 1, stages);
    for (std::uint32_t pass = 0; pass < 4; ++pass)
        run->advance(pass);
    return {run->image(), run->counts()};
}

TEST(PhotonMapper, SkippingWhatASceneDoesNotCallForChangesNoPixelAndSavesRays) {
    const auto scene = test::shipped_scene("cornell-box.xml", {{}, std::pair{32, 32}});
    const auto planned = render_for(*scene.scene, effects_of(*scene.scene));
    const auto everything = render_for(*scene.scene, Effects::all());
    for (Component c : all_components) {
        if (planned.image[c]) {
            EXPECT_EQ(planned.image[c]->rgb, everything.image[c]->rgb) << name_of(c);
        }
    }
    // The caustic map's photons are of no use here; each costs at least one ray.
    EXPECT_GE(everything.counts.rays, planned.counts.rays + 20000);
    EXPECT_EQ(planned.counts.photons, 20000u);
    EXPECT_EQ(everything.counts.photons, 40000u);
}

TEST(PhotonMapper, PlanSaysWhatIsSkippedAndWhy) {
    const auto plan_of = [](const char* file) {
        const auto& method = find_method("photon_mapper");
        const auto scene = test::shipped_scene(file);
        return method.create(ParameterValues(all_parameters(method), {"photon_mapper", {}}), {})->plan(*scene.scene);
    };
    const Plan box = plan_of("cornell-box.xml"), glass = plan_of("cornell-glass.xml");
    EXPECT_FALSE(box.runs("caustic map"));
    EXPECT_FALSE(box.runs("specular paths"));
    EXPECT_TRUE(box.runs("global map"));
    EXPECT_TRUE(glass.runs("caustic map"));
    EXPECT_TRUE(glass.runs("specular paths"));
    for (const auto& step : box.steps)
        EXPECT_NE(step.runs, !step.reason.empty()) << step.pass;
}

// Every path class is counted once. Emission, direct, caustic and indirect light each agree with the
// path tracer's within 1 %, which the density estimate may blur, and four standard errors of
// independent runs (each at most 3 % of the light).
TEST(PhotonMapper, EveryComponentAgreesWithThePathTracerOnGlass) {
    const auto scene = test::shipped_scene("cornell-glass.xml", {{}, std::pair{64, 64}});
    std::map<Component, test::Moments> path, photons;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        const auto by_path = render(scene, "path", 256, seed);
        const auto by_photons = render(scene, "photon_mapper photons=2e5", 8, seed);
        for (Component c : {Component::emission, Component::direct, Component::caustic, Component::indirect}) {
            path[c].add(mean_of(*by_path[c]).mean());
            photons[c].add(mean_of(*by_photons[c]).mean());
        }
    }
    for (const auto& [c, of_path] : path) {
        const double error = std::hypot(of_path.standard_error(), photons[c].standard_error());
        EXPECT_LT(error, 0.03 * of_path.mean()) << name_of(c);
        EXPECT_NEAR(photons[c].mean(), of_path.mean(), 0.01 * of_path.mean() + 4 * error) << name_of(c);
    }
}

/// A path-traced reference of one component from 16 independently seeded groups.
ReferenceLayer reference_of(const LoadedScene& scene, Component component, std::uint32_t passes_per_group) {
    std::vector<Image> groups;
    for (std::uint64_t g = 0; g < reference_groups; ++g)
        groups.push_back(*render(scene, "path", passes_per_group, 1'000'000 + g)[component]);
    return layer_of_groups(std::move(groups));
}

// With fixed k the look-up radius shrinks as photons^(-1/2). From 1e4 to 1e5 and 1e6 photons, bias^2 must fall by
// more than both 95 % intervals; k = 200 makes it large enough to be resolved. Only the light of the global map is
// judged, because the noise at the lamp's edge would widen the intervals.
TEST(PhotonMapper, BiasShrinksWithThePhotonCount) {
    const auto scene = test::shipped_scene("cornell-box.xml", {{}, std::pair{32, 32}});
    const ReferenceLayer reference = reference_of(scene, Component::indirect, 256);
    std::optional<Estimate> previous;
    for (const auto& [photons, seeds] : {std::pair{"1e4", 16u}, std::pair{"1e5", 16u}, std::pair{"1e6", 8u}}) {
        std::vector<Image> replicates;
        for (std::uint64_t seed = 1; seed <= seeds; ++seed)
            replicates.push_back(
                *render(scene, std::string("photon_mapper k=200 photons=") + photons, 16, seed)[Component::indirect]);
        const auto bias2 = replicate_statistics(replicates, reference, reference.mean, 0.01).bias2;
        ASSERT_TRUE(bias2 && bias2->interval);
        std::cout << "photons=" << photons << ": bias^2 " << bias2->value << " [" << bias2->interval->lo << ", "
                  << bias2->interval->hi << "]\n";
        if (previous) {
            EXPECT_LT(bias2->interval->hi, previous->interval->lo) << photons;
        }
        previous = bias2;
    }
}

TEST(PhotonMapper, ShortPathsNeedNoMaps) {
    const auto scene = test::shipped_scene("cornell-glass.xml");
    const auto& method = find_method("photon_mapper");
    const auto plan_of = [&](const std::string& depth) {
        const MethodLabel label{"photon_mapper", {{"max_depth", depth}}};
        return method.create(ParameterValues(all_parameters(method), label), {})->plan(*scene.scene);
    };
    EXPECT_FALSE(plan_of("2").runs("caustic map"));
    EXPECT_FALSE(plan_of("2").runs("global map"));
    EXPECT_TRUE(plan_of("2").runs("light sampling"));
    EXPECT_FALSE(plan_of("1").runs("light sampling"));
    EXPECT_TRUE(plan_of("3").runs("global map"));
}

// The floor's interpolated normals lean by 45 degrees; a wall beside it lights it indirectly, and
// nothing lies below it. Photons count irradiance on the geometric floor, whereas the path
// tracer's cosine is that of the shading normal.
TEST(PhotonMapper, InterpolatedNormalsReflectAsInThePathTracer) {
    const test::TemporaryFolder folder;
    const std::string file = folder.write("leaning_floor.obj",
                                          "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvn 0.7071068 0 0.7071068\n"
                                          "f 1//1 2//1 3//1\nf 1//1 3//1 4//1\n");
    const auto scene = test::scene_of(
        test::scene_xml("<sensor type='orthographic'><transform name='to_world'><scale value='0.8'/><lookat "
                        "origin='0,0,5' target='0,0,0' "
                        "up='0,1,0'/></transform>" +
                        test::box_film(16) + "</sensor><shape type='obj'><string name='filename' value='" + file +
                        "'/>" + test::diffuse(0.8) +
                        "</shape><shape type='rectangle'><transform name='to_world'>"
                        "<scale value='3'/><rotate y='1' angle='-90'/><translate x='3' z='3'/></transform>" +
                        test::diffuse(0.8) +
                        "</shape><emitter type='point'><point name='position' x='1' y='0' z='1.5'/><rgb "
                        "name='intensity' value='1'/></emitter>"));
    const auto path = render(scene, "path", 1024);
    test::Moments photons;
    for (std::uint64_t seed = 1; seed <= 4; ++seed)
        photons.add(mean_of(*render(scene, "photon_mapper photons=5e6", 4, seed)[Component::indirect]).mean());
    const double expected = mean_of(*path[Component::indirect]).mean();
    EXPECT_LT(photons.standard_error(), 0.015 * expected) << "the test would not see an error";
    EXPECT_NEAR(photons.mean() / expected, 1.0, 0.02);
}

// Discs are as wide as a fifth of the furnace's walls, so a quarter of them hang over an edge. If their own wall's
// photons are divided by pi r^2, estimates are 10 % too dark on average. If the other walls' photons count, too (half
// a disc each in the edge itself, more next to it), estimates are 4 % too bright.
TEST(PhotonMapper, DiscsThatLeaveTheSurfaceDoNotDarkenTheEdges) {
    const auto furnace = test::shipped_scene("furnace.xml", {{}, std::pair{24, 24}});
    const auto indirect = [&](const std::string& area) {
        return mean_of(*render(furnace, "photon_mapper photons=1e5 k=2500 area=" + area, 4)[Component::indirect])
            .mean();
    };
    EXPECT_NEAR(indirect("surface"), 0.25, 0.25 * 0.02);
    EXPECT_LT(indirect("rejected"), 0.25 * 0.95);
    EXPECT_GT(indirect("plain"), 0.25 * 1.03);
}

// If the dim lamp is off, both scenes are black where the camera stands: all visible light has leaked through a wall
// 4 mm thick, or through plates 0.5 mm apart. The leak of the plain estimate is 25 times the light of the dim lamp.
TEST(PhotonMapper, NoLightPassesThinWallsOrPlanesCloseTogether) {
    for (const char* file : {"thin-wall.xml", "parallel-planes.xml"})
        for (const char* k : {"50", "all radius=0.03 caustic_radius=0.02"}) {
            SCOPED_TRACE(std::string(file) + " k=" + k);
            const auto scene = test::shipped_scene(file, {{{"dim", "0"}}, std::pair{24, 18}});
            const auto light = [&](const std::string& area) {
                const auto image = render(scene, "photon_mapper photons=1e5 k=" + std::string(k) + " area=" + area, 1);
                return mean_of(*image[Component::indirect]).mean() + mean_of(*image[Component::caustic]).mean();
            };
            EXPECT_LT(light("surface"), 1e-3);
            EXPECT_GT(light("plain"), 1.0);
        }
}

TEST(PhotonMapper, AutomaticKGrowsWithThePhotons) {
    EXPECT_EQ(automatic_k(100000), 50u);
    EXPECT_EQ(automatic_k(100000000), 5000u);
    EXPECT_EQ(automatic_k(1), 4u);
}

}  // namespace
}  // namespace gib::photon_mapper_test
