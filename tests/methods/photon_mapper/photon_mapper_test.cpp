// The photon mapper as a method: its plan, its components against path tracing, its bias and its leaks; emission and direct light
// by eye paths of their own (direct_samples); and laws that hold for every combination of options that its table allows.
#include "methods/photon_mapper/photon_mapper.h"

#include "experiments/metrics/statistics.h"
#include "tests/support/moments.h"
#include "tests/support/scene_fixtures.h"
#include "tests/support/scene_text.h"

#include <algorithm>
#include <iostream>
#include <map>

namespace gib::test::photon_mapper_test {
namespace {

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

Rendered render_for(const gib::Scene& scene, const Effects& effects) {
    StageTimes stages;
    const auto run = start_photon_mapper(scene, settings(20000), effects, 1, stages);
    for (std::uint32_t pass = 0; pass < 4; ++pass)
        run->advance(pass);
    return {run->image(), run->counts()};
}

TEST(PhotonMapper, SkippingWhatASceneDoesNotCallForChangesNoPixelAndSavesRays) {
    const auto scene = shipped_scene("cornell-box.xml", {{}, std::pair{32, 32}});
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

Plan plan_of(const char* file, const std::string& options = "") {
    return ConfiguredMethod(MethodLabel::parse("photon_mapper" + options)).create({})->plan(*shipped_scene(file).scene);
}

// Every path class is counted once. Emission, direct, caustic and indirect light each agree with the
// path tracer's within 1 %, which the density estimate may blur, and four standard errors of
// independent runs (each at most 3 % of the light).
TEST(PhotonMapper, EveryComponentAgreesWithThePathTracerOnGlass) {
    const auto scene = shipped_scene("cornell-glass.xml", {{}, std::pair{64, 64}});
    std::map<Component, Moments> path, photons;
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
    const auto scene = shipped_scene("cornell-box.xml", {{}, std::pair{32, 32}});
    const ReferenceLayer reference = reference_of(scene, Component::indirect, 256);
    std::optional<Estimate> previous;
    for (const auto& [photons, seeds] : {std::pair{"1e4", 16u}, std::pair{"1e5", 16u}, std::pair{"1e6", 8u}}) {
        std::vector<Image> replicates;
        for (std::uint64_t seed = 1; seed <= seeds; ++seed)
            replicates.push_back(
                *render(scene, std::string("photon_mapper k=200 photons=") + photons, 16, seed)[Component::indirect]);
        const auto bias2 = replicate_statistics(replicates, reference, {reference.mean, 0.01}).bias2;
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
    const auto with_depth = [](const std::string& depth) {
        return plan_of("cornell-glass.xml", " max_depth=" + depth);
    };
    EXPECT_FALSE(with_depth("2").runs("caustic map"));
    EXPECT_FALSE(with_depth("2").runs("global map"));
    EXPECT_TRUE(with_depth("2").runs("light sampling"));
    EXPECT_FALSE(with_depth("1").runs("light sampling"));
    EXPECT_TRUE(with_depth("3").runs("global map"));
}

// The floor's interpolated normals lean by 45 degrees; a wall beside it lights it indirectly, and
// nothing lies below it. Photons count irradiance on the geometric floor, whereas the path
// tracer's cosine is that of the shading normal.
TEST(PhotonMapper, InterpolatedNormalsReflectAsInThePathTracer) {
    const TemporaryFolder folder;
    const std::string file = folder.write("leaning_floor.obj",
                                          "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvn 0.7071068 0 0.7071068\n"
                                          "f 1//1 2//1 3//1\nf 1//1 3//1 4//1\n");
    const auto scene =
        Scene(element("sensor", "orthographic", to_world(scale(0.8), look_at("0,0,5", "0,0,0")), box_film(16)),
              shape("obj", text("filename", file), diffuse(0.8)),
              shape("rectangle", to_world(scale(3), rotate('y', -90), translate(3, 0, 3)), diffuse(0.8)),
              point_light(1, 0, 1.5, 1))
            .load();
    const auto path = render(scene, "path", 1024);
    Moments photons;
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
    const auto furnace = shipped_scene("furnace.xml", {{}, std::pair{24, 24}});
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
            const auto scene = shipped_scene(file, {{{"dim", "0"}}, std::pair{24, 18}});
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

constexpr Component straight[] = {Component::emission, Component::direct};

/// The mean over pixels and channels of the variance over seeds.
double variance_over_seeds(const LoadedScene& scene, const std::string& label, std::uint32_t passes, Component c) {
    constexpr std::uint64_t seeds = 12;
    std::vector<Moments> values;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        const Image image = *render(scene, label, passes, seed)[c];
        values.resize(image.rgb.size());
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i].add(image.rgb[i]);
    }
    double sum = 0;
    for (const Moments& value : values)
        sum += static_cast<double>(seeds) * value.standard_error() * value.standard_error();
    return sum / static_cast<double>(values.size());
}

// The path that looks up photons takes the same random numbers with and without them.
TEST(DirectSamples, LeaveTheLightOfPhotonsAsItIs) {
    const auto scene = shipped_scene("cornell-glass.xml", {{}, std::pair{20, 20}});
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
        const auto scene = shipped_scene(file, {{}, std::pair{24, 24}});
        for (Component c : straight) {
            Moments path, photons;
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
    const auto scene = shipped_scene("cornell-glass.xml", {{}, std::pair{24, 24}});
    const std::string label = "photon_mapper photons=0 caustic_photons=0";
    for (Component c : straight) {
        const double of_passes = variance_over_seeds(scene, label, 16, c);
        for (const auto& [passes, count] : {std::pair{1u, 16}, std::pair{4u, 4}}) {
            const std::string many = label + " direct_samples=" + std::to_string(count);
            EXPECT_NEAR(variance_over_seeds(scene, many, passes, c) / of_passes, 1, 0.35) << name_of(c) << ' ' << count;
        }
    }
}

const std::vector<std::string> gathering = {"source", "cache"};

bool is_one_of(const std::string& name, const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

bool has(const std::string& label, const char* option) { return label.find(option) != std::string::npos; }

/// `start` with every combination of values of the parameters that `counts` accepts. The values are a parameter's
/// choices; if they stand beside a number, that number's default is one, too.
template <typename Counts>
std::vector<std::string> combined(const std::string& start, Counts&& counts) {
    std::vector<std::string> labels = {start};
    for (const Parameter& p : find_method("photon_mapper").parameters) {
        std::vector<std::string> values = p.choices;
        if (values.empty() || !counts(p.name)) continue;
        if (p.kind != Parameter::Kind::choice) values.push_back(p.default_value);
        std::vector<std::string> extended;
        for (const auto& label : labels)
            for (const auto& value : values)
                extended.push_back(label + " " + p.name + "=" + value);
        labels = std::move(extended);
    }
    return labels;
}

/// All combinations for density estimates without final gathering, and for final gathering those of its own options
/// and of the options that affect it.
std::vector<std::string> combinations() {
    auto labels = combined("photon_mapper", [](const std::string& name) {
        // Light along rays in media has tests of its own.
        return !is_one_of(name, gathering) && name != "volume";
    });
    auto gathered = combined("photon_mapper gather=32", [](const std::string& name) {
        return is_one_of(name, gathering) || name == "area" || name == "projection";
    });
    // Estimates at the end of every gather ray are slow, so fewer rays are used there. The records of a cache are
    // few; 8 rays would be too noisy for 1.5 % of the image's mean.
    for (std::string& label : gathered)
        if (has(label, "source=photons") && has(label, "cache=off"))
            label.replace(label.find("gather=32"), 9, "gather=8");
    labels.insert(labels.end(), gathered.begin(), gathered.end());
    return labels;
}

TEST(PhotonOptions, WithoutEffectAreRefused) {
    const std::pair<const char*, const char*> refused[] = {
        {"source=paths", "'source' has no effect with gather=0"},
        {"cache=on", "'cache' has no effect with gather=0"},
        {"gather=8 accuracy=0.2", "'accuracy' has no effect with cache=off"},
        {"photons=0 gather=8", "'gather' has no effect with photons=0, unless source=paths"},
        {"photons=0 caustic_photons=9 radius=0.1", "'radius' has no effect with photons=0"},
        {"caustic_photons=0 caustic_radius=0.1", "'caustic_radius' has no effect with caustic_photons=0"},
        {"volume_photons=0 volume_radius=0.1", "'volume_radius' has no effect with volume_photons=0"},
        {"photons=0 volume_photons=9 area=plain", "'area' has no effect with no photons on surfaces"},
        {"photons=0 kernel=cone", "'kernel' has no effect with no photons"},
    };
    for (const auto& [parameters, message] : refused)
        try {
            ConfiguredMethod(MethodLabel::parse(std::string("photon_mapper ") + parameters)).create({});
            ADD_FAILURE() << parameters;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
        }
    for (const char* kept : {"photons=0 gather=8 source=paths cache=on",
                             "photons=0 caustic_photons=9 caustic_radius=0.1 k=8 kernel=cone area=plain"})
        EXPECT_NO_THROW(ConfiguredMethod(MethodLabel::parse(std::string("photon_mapper ") + kept)).create({})) << kept;
}

// The radiance is 1 everywhere, and indirect light is rho^2 = 1/4 of it; 1e5 photons give it within 0.3 %. Whole
// discs are too dark along the edges of the box, or too bright if they count the photons of the next wall (plain).
TEST(PhotonOptions, FurnaceHasTheAnalyticRadiance) {
    const auto furnace = shipped_scene("furnace.xml", {{}, std::pair{16, 16}});
    for (const auto& label : combinations()) {
        const Image indirect = *render(furnace, label + " photons=100000 radius=0.03", 4)[Component::indirect];
        const double mean = 4 * mean_of(indirect).mean();
        EXPECT_GT(mean, has(label, "area=surface") ? 0.985 : 0.95) << label;
        EXPECT_LT(mean, has(label, "area=plain") ? 1.04 : 1.015) << label;
    }
}

// The image's mean is the path tracer's, so no option loses a path class or counts it twice.
TEST(PhotonOptions, MeanAgreesWithThePathTracer) {
    const auto glass = shipped_scene("cornell-glass.xml", {{}, std::pair{24, 24}});
    const double truth = mean_of(render(glass, "path", 1024).total()).mean();
    for (const auto& label : combinations()) {
        const double mean =
            mean_of(render(glass, label + " photons=20000 radius=0.03 caustic_radius=0.02", 4).total()).mean();
        EXPECT_NEAR(mean / truth, 1, has(label, "area=surface") ? 0.03 : 0.06) << label;
    }
}

TEST(PhotonOptions, ImagesAreTheSameForAnyNumberOfThreads) {
    for (const char* file : {"cornell-glass.xml", "fog.xml"}) {
        const auto scene = shipped_scene(file, {{}, std::pair{20, 20}});
        for (const auto& label : combinations()) {
            const std::string small = label + " photons=6000 radius=0.02 caustic_radius=0.02";
            // A pass sees the records that the passes before it added to the cache.
            const std::uint32_t passes = has(label, "cache=on") ? 3 : 1;
            const Image one = render(scene, small, passes, 1, 1).total();
            ASSERT_EQ(one.rgb, render(scene, small, passes, 1, 5).total().rgb) << label;
        }
    }
}

}  // namespace
}  // namespace gib::test::photon_mapper_test
