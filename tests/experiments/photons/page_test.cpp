// The page of stored light: as text, one file whose numbers are those of the run; its subset of the photons, with its size,
// shares and uniformity; and the scene's surfaces as triangles, with their places, colours and shares.
#include "experiments/photons/page.h"

#include "experiments/photons/stored_light.h"
#include "experiments/photons/surfaces.h"
#include "experiments/text/html.h"
#include "methods/parts/photons/photon_walk.h"
#include "tests/support/page_reader.h"
#include "tests/support/run_fixtures.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace gib::test::page_test {
namespace {

using nlohmann::json;

CollectedLight light_of(const LoadedScene& scene, const std::string& label, std::size_t most, std::uint32_t passes) {
    const ConfiguredMethod method(MethodLabel::parse(label));
    return collect_stored_light({.scene = scene, .method = method, .most_passes = passes, .most_photons = most});
}

template <typename T>
std::vector<T> array(const std::string& page, const std::string& name) {
    const std::vector<std::uint8_t> bytes = bytes_of_base64(element_of_page(page, "array-" + name));
    EXPECT_EQ(bytes.size() % sizeof(T), 0u);
    std::vector<T> values(bytes.size() / sizeof(T));
    if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

TEST(PhotonsPage, HoldsThePhotonsOfTheRun) {
    const auto fog = shipped_scene("fog.xml", {{}, std::pair{4, 4}});
    const std::string label = "photon_mapper photons=3000";
    const CollectedLight light = light_of(fog, label, 900, 4);
    EXPECT_EQ(light.passes, 0u) << "passes store no other photons";
    const std::string page = photons_page({fog, label, 1, light});
    const json facts = json::parse(element_of_page(page, "facts"));
    EXPECT_EQ(facts.at("method"), label);
    const auto positions = array<float>(page, "photon-positions");
    const auto powers = array<std::uint8_t>(page, "photon-powers"), infos = array<std::uint8_t>(page, "photon-infos");
    ASSERT_EQ(infos.size(), 4u * 900);
    ASSERT_EQ(positions.size(), 3u * 900);
    std::size_t at = 0;
    for (std::size_t m = 0; m < 3; ++m) {
        const auto& map = light.photons[m];
        EXPECT_EQ(facts["maps"][m]["shown"], map.shown.size());
        EXPECT_EQ(facts["maps"][m]["stored"], map.stored);
        for (const auto& shown : map.shown) {
            EXPECT_EQ(positions[3 * at + 1], shown.photon.p.y());
            EXPECT_EQ(infos[4 * at], shown.photon.edges - 1) << "bounces";
            EXPECT_EQ(infos[4 * at + 1], m);
            const double power = map.unit * static_cast<double>(shown.photon.power()[0]) / map.mean_power();
            EXPECT_NEAR(std::ldexp(powers[4 * at], powers[4 * at + 3] - 136), power,
                        0.005 * map.unit * static_cast<double>(shown.photon.power().maxCoeff()) / map.mean_power());
            ++at;
        }
    }
}

TEST(PhotonsPage, HoldsTheBeamsOfTheRun) {
    const auto fog = shipped_scene("fog.xml", {{}, std::pair{4, 4}});
    const std::string label = "photon_mapper photons=3000 volume=beams volume_photons=200 projection=off";
    const CollectedLight light = light_of(fog, label, 50, 4);
    const auto walk = trace_photons(*fog.scene, PhotonMapKind::beams, 200, fog.max_edges, 1);
    EXPECT_EQ(light.stored_beams, walk.beams.size());
    const std::string page = photons_page({fog, label, 1, light});
    const json facts = json::parse(element_of_page(page, "facts"));
    EXPECT_EQ(facts["beams"], (json{{"stored", walk.beams.size()}, {"shown", 50}, {"emitted", 200}}));
    EXPECT_EQ(facts["maps"][0]["emitted"], 3000);
    const auto ends = array<float>(page, "beam-ends"), powers = array<float>(page, "beam-powers");
    ASSERT_EQ(ends.size(), 6u * 50);
    ASSERT_EQ(powers.size(), 3u * 50);
    std::size_t at = 0;
    for (std::size_t i = 0; i < walk.beams.size(); ++i) {
        if (!is_at_step(i, walk.beams.size(), 50)) continue;
        EXPECT_EQ(ends[6 * at + 1], walk.beams[i].p.y());
        EXPECT_EQ(ends[6 * at + 5], walk.beams[i].end().z());
        EXPECT_FLOAT_EQ(powers[3 * at], static_cast<float>(walk.unit) * walk.beams[i].power()[0]);
        ++at;
    }
}

TEST(PhotonsPage, AsksForNothingOutsideTheFile) {
    const auto box = shipped_scene("cornell-box.xml", {{}, std::pair{4, 4}});
    const CollectedLight light = light_of(box, "photon_mapper photons=500", 100, 1);
    const std::string page = photons_page({box, "photon_mapper <b> photons=500", 1, light});
    EXPECT_THAT(page, AllOf(HasSubstr("default-src 'none'"), HasSubstr("&lt;b&gt;"), Not(HasSubstr("<b>")),
                            Not(HasSubstr("://")), Not(HasSubstr("{{"))));
    EXPECT_THAT(std::string(embedded_file("three.js")), HasSubstr("SPDX-License-Identifier: MIT"));
}

TEST(PhotonsPage, LooksThroughTheScenesCamera) {
    const auto box = shipped_scene("cornell-box.xml", {{}, std::pair{64, 32}});
    const CollectedLight light = light_of(box, "photon_mapper photons=500", 100, 1);
    const json camera = json::parse(element_of_page(photons_page({box, "photon_mapper", 1, light}), "facts"))["camera"];
    EXPECT_EQ(camera["aspect"], 2);
    EXPECT_NEAR(camera["up"][1].get<double>(), 1, 1e-3);
    const Ray top = box.scene->sensor().generate_ray(32, 0, Vec2(0.5f, 0.5f));
    const Vec3 direction(camera["direction"][0], camera["direction"][1], camera["direction"][2]);
    const double half = std::acos(std::min(1.0, static_cast<double>(top.d.normalized().dot(direction))));
    EXPECT_NEAR(camera["fov"].get<double>() / 2, half * 180 / std::numbers::pi, 1.5) << "of 32 rows";
}

/// A channel of an image of the page at the pixels of its grid.
std::vector<float> red_of(const std::string& page, const json& name) {
    std::vector<float> values = array<float>(page, name), red;
    for (std::size_t i = 0; i < values.size(); i += 3)
        red.push_back(values[i]);
    return red;
}

std::vector<float> red_of(const Image& image, const PixelGrid& grid) {
    std::vector<float> red;
    for (std::size_t i = 0; i < grid.count(); ++i)
        red.push_back(image.at(static_cast<std::size_t>(grid.y(i) * image.width + grid.x(i)))[0]);
    return red;
}

TEST(PhotonsPage, HoldsTheImageAndWhatItUses) {
    const auto box = shipped_scene("cornell-box.xml", {{}, std::pair{250, 100}});
    const std::string label = "photon_mapper photons=2000 k=20";
    const CollectedLight light = light_of(box, label, 100, 4);
    const ConfiguredMethod method(MethodLabel::parse(label));
    const ShownImage estimate = shown_image({.scene = box, .method = method, .seed = 1, .passes = 2});
    EXPECT_EQ(estimate.k, 20);
    EXPECT_EQ(estimate.passes, 2u);
    EXPECT_EQ(estimate.emitted, 2000u) << "the box has no caustics";
    EXPECT_FLOAT_EQ(static_cast<float>(estimate.radii.at("global")), 0.1f * box.scene->diagonal());

    const std::string page = photons_page({box, label, 1, light, &estimate});
    const json facts = json::parse(element_of_page(page, "facts"))["estimate"];
    const PixelGrid grid(250, 100, 10000);
    EXPECT_EQ(facts["grid"], json({158, 63, 250, 100})) << "not all of the 25000 pixels";
    const ComponentImages image = render(box, label, 2);
    const json& names = facts["image"];
    EXPECT_EQ(red_of(page, names["direct"]), red_of(*image[Component::direct], grid));
    EXPECT_EQ(red_of(page, names["indirect"]), red_of(*image[Component::indirect], grid));
    EXPECT_FALSE(names.contains("caustic"));
    EXPECT_EQ(array<float>(page, "pixel-points").size(), 3 * grid.count());
    const std::vector<float> emission = red_of(*image[Component::emission], grid);
    const auto reflections = array<std::uint8_t>(page, "pixel-reflections");
    for (std::size_t i = 0; i < grid.count(); ++i)
        EXPECT_TRUE(emission[i] == 0 || reflections[i] == 0) << "the lamp is black";
    EXPECT_EQ(std::ranges::count(reflections, 1), 0) << "nothing is specular";
    EXPECT_GT(std::ranges::count(reflections, 2), 1000);
}

TEST(Photons, CommandSaysWhatItShows) {
    const TemporaryFolder folder;
    const std::string box = "'" + source_path("scenes/cornell-box.xml") + "' --resolution 8x8 ";
    const auto run = [&](const std::string& arguments) {
        return run_gibench("photons " + box + arguments, folder / "");
    };
    EXPECT_THAT(run("--method 'photon_mapper photons=4000' --photons-shown 100 -o a.html"),
                prints(ContainsRegex("global map: 100 of [0-9]+ photons shown \\([0-9.]+ %\\)")));
    EXPECT_THAT(read_file(folder / "a.html"), HasSubstr("id=\"array-photon-positions\""));
    EXPECT_THAT(run("--method 'path spp=4' -o b.html"),
                exits(2, HasSubstr("photon_mapper, progressive_photon_mapper, radiosity")));
    for (const char* wrong : {"--method photon_mapper -o b.exr", "--method photon_mapper -o none/b.html",
                              "--method photon_mapper --photons-shown 0 -o b.html",
                              "--method progressive_photon_mapper --passes 256 -o b.html", "--method photon_mapper"}) {
        EXPECT_EQ(run(wrong).code, 2) << wrong;
        EXPECT_FALSE(fs::exists(folder / "b.html"));
    }
    EXPECT_THAT(run("--method 'photon_mapper photons=0' -o c.html"),
                exits(0, HasSubstr("stores no light in this scene; skipped: ")));
}

TEST(Photons, ReportLinksThePages) {
    ExperimentFolder folder;
    folder.write("e.toml",
                 "scenes = ['tiny.xml']\n[reference]\nmethod = 'path'\ntarget = '40%'\n[[method]]\n"
                 "name = 'photon_mapper'\nphotons = 100\nspp = 2\n");
    ASSERT_EQ(folder.run("--out results").code, 0);
    const std::string page = "images/tiny-photon_mapper_photons=100_spp=2-photons.html";
    const auto report = [&] { return read_file(folder.path("results/report.html")); };
    EXPECT_THAT(report(),
                AllOf(HasSubstr("gibench photons"), HasSubstr("results/" + page), Not(HasSubstr("href=\"images/"))));
    ASSERT_EQ(
        folder.gibench("photons tiny.xml --method 'photon_mapper photons=100 spp=2' -o 'results/" + page + "'").code,
        0);
    ASSERT_EQ(folder.gibench("report results").code, 0);
    EXPECT_THAT(report(), HasSubstr("href=\"" + page + "\""));
}

/// A map of `count` photons of power 1 at x = first, first + 1, ...
StoredPhotons photons_from(std::string_view map, std::size_t count, std::size_t first = 0) {
    StoredPhotons stored{.map = map, .unit = 2, .photons = {}};
    for (std::size_t i = 0; i < count; ++i)
        stored.photons.emplace_back(Vec3(static_cast<float>(first + i), 0, 0), Color::Ones(), Vec3::UnitZ(),
                                    Vec3::UnitZ(), 1);
    return stored;
}

TEST(EvenShares, GiveToLargeGroupsWhatSmallOnesLeave) {
    EXPECT_THAT(even_shares({100, 2, 50}, 42), ElementsAre(20, 2, 20));
    EXPECT_THAT(even_shares({3, 5}, 100), ElementsAre(3, 5));
    EXPECT_THAT(even_shares({}, 10), ElementsAre());
    EXPECT_THAT(even_shares({5, 5}, 0), ElementsAre(0, 0));
    for (const std::size_t shown : {0u, 1u, 7u, 99u, 100u}) {
        std::size_t taken = 0;
        for (std::size_t i = 0; i < 100; ++i)
            taken += is_at_step(i, 100, shown);
        EXPECT_EQ(taken, shown);
    }
}

// Chi-square test at alpha = 0.001: photons fall into 16 bins by when they came, in four passes. Of 8000 photons each bin
// expects 500; being drawn without replacement from 160000 lowers the sum by 5 %, which makes the test stricter in the
// right direction only for the upper bound, 37.7 (15 degrees of freedom).
TEST(PhotonSubset, IsUniformOverPhotonsAndPasses) {
    constexpr std::size_t passes = 4, each = 40000, shown = 8000, bins = 16;
    PhotonSubset subset(shown);
    for (std::uint32_t pass = 0; pass < passes; ++pass)
        subset.add(photons_from("global", each, pass * each), pass);
    const auto maps = subset.maps();
    ASSERT_EQ(maps[0].shown.size(), shown);
    std::array<double, bins> counts{};
    for (const auto& one : maps[0].shown)
        ++counts[static_cast<std::size_t>(one.photon.p.x()) / (passes * each / bins)];
    double sum = 0;
    for (const double count : counts)
        sum += sqr(count - shown / bins) / (shown / bins);
    EXPECT_LT(sum, 37.7);
}

TEST(PhotonSubset, CountsPowersThatAreNotFinite) {
    StoredPhotons stored = photons_from("global", 3);
    stored.photons[1].set_power(Color::Constant(std::numeric_limits<float>::quiet_NaN()));
    PhotonSubset subset(10);
    subset.add(stored, 0);
    const auto maps = subset.maps();
    EXPECT_EQ(maps[0].not_finite, 1u);
    EXPECT_EQ(maps[0].mean_power(), 2) << "of the two others";
}

Vec3 corner(const SurfaceTriangles& t, std::size_t i) {
    return {t.positions[i][0], t.positions[i][1], t.positions[i][2]};
}

double area_of(const SurfaceTriangles& t) {
    double area = 0;
    for (std::size_t i = 0; i < t.positions.size(); i += 3)
        area +=
            0.5 * static_cast<double>((corner(t, i + 1) - corner(t, i)).cross(corner(t, i + 2) - corner(t, i)).norm());
    return area;
}

TEST(SurfaceTriangles, CoverCurvedShapes) {
    const std::vector<std::pair<std::string, double>> shapes = {
        {shape("sphere", center(1, 2, 3), radius(2), diffuse(0.5)), 16 * std::numbers::pi},
        {shape("disk", to_world(scale(3)), diffuse(0.5)), 9 * std::numbers::pi},
        {shape("cylinder", point("p0", 0, 0, 0), point("p1", 0, 0, 4), radius(0.5), diffuse(0.5)),
         4 * std::numbers::pi}};
    for (const auto& [curved, area] : shapes) {
        const auto scene = Scene(element("sensor", "perspective", box_film(4)), curved).load();
        const SurfaceTriangles triangles = surface_triangles(*scene.scene, 100000);
        EXPECT_NEAR(area_of(triangles), area, 0.005 * area) << curved;
        EXPECT_GE(triangles.whole, triangles.count());
        for (const auto& color : triangles.colors)
            EXPECT_EQ(color, (std::array<std::uint8_t, 4>{128, 128, 128, 255}));
    }
}

TEST(SurfaceTriangles, OfInstancesStandInTheirPlaces) {
    const auto scene = Scene(element("sensor", "perspective", box_film(4)),
                             "<shape type='shapegroup' id='g'>" + shape("sphere", diffuse(0.5)) + "</shape>",
                             shape("instance", to_world(scale(2), translate(10, 0, 0)), reference("g")))
                           .load();
    const SurfaceTriangles triangles = surface_triangles(*scene.scene, 100000);
    ASSERT_GT(triangles.count(), 100u);
    for (std::size_t i = 0; i < triangles.positions.size(); ++i) {
        const Vec3 from_center = corner(triangles, i) - scene.scene->bounds().center();
        EXPECT_NEAR(from_center.norm(), 2.f, 1e-4f);
        EXPECT_NEAR(from_center.x() / 2, triangles.normals[i][0] / 127.f, 0.006f);
    }
}

}  // namespace
}  // namespace gib::test::page_test
