// The page of stored light as text: it is one file, and its numbers are those of the run.
#include "experiments/photons/page.h"
#include "experiments/text/embedded_files.h"
#include "experiments/text/html.h"
#include "tests/support/driver_fixtures.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cstring>

namespace gib::test::page_test {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

CollectedLight light_of(const LoadedScene& scene, const std::string& label, std::size_t most, std::uint32_t passes) {
    const ConfiguredMethod method(MethodLabel::parse(label));
    return collect_stored_light({.scene = scene, .method = method, .most_passes = passes, .most_photons = most});
}

std::string element(const std::string& page, const std::string& id) {
    const std::size_t at = page.find("id=\"" + id + "\">");
    EXPECT_NE(at, std::string::npos) << id;
    const std::size_t begin = page.find('>', at) + 1;
    return page.substr(begin, page.find("</script>", begin) - begin);
}

template <typename T>
std::vector<T> array(const std::string& page, const std::string& name) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::vector<std::uint8_t> bytes;
    unsigned bits = 0;
    int count = 0;
    for (const char c : element(page, "array-" + name)) {
        if (c == '=') break;
        bits = (bits << 6) | static_cast<unsigned>(digits.find(c));
        if ((count += 6) < 8) continue;
        count -= 8;
        bytes.push_back(static_cast<std::uint8_t>((bits >> count) & 255u));
    }
    EXPECT_EQ(bytes.size() % sizeof(T), 0u);
    std::vector<T> values(bytes.size() / sizeof(T));
    if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

TEST(Rgbe, RoundsToAnEightBitMantissa) {
    for (const double scale : {1.0, 1e-30, 1e30, 255.9, 0.998}) {
        const Colord color = scale * Colord(1, 0.5, 0.013);
        const auto packed = rgbe_of(color);
        for (int i = 0; i < 3; ++i)
            EXPECT_NEAR(std::ldexp(packed[static_cast<std::size_t>(i)], packed[3] - 136), color[i], scale / 250)
                << scale;
    }
    EXPECT_EQ(rgbe_of(Colord::Zero())[3], 0);
    EXPECT_EQ(rgbe_of(Colord::Constant(std::nan("")))[3], 0);
}

TEST(PhotonsPage, HoldsThePhotonsOfTheRun) {
    const auto fog = shipped_scene("fog.xml", {{}, std::pair{4, 4}});
    const std::string label = "photon_mapper photons=3000";
    const CollectedLight light = light_of(fog, label, 900, 4);
    EXPECT_EQ(light.passes, 0u) << "passes store no other photons";
    const std::string page = photons_page({fog, label, 1, light});
    const json facts = json::parse(element(page, "facts"));
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

TEST(PhotonsPage, HoldsWavelengthsAndPasses) {
    const auto prism = scene_of(scene_xml(
        "<sensor type='perspective'>" + box_film(4) + "</sensor><shape type='rectangle'>" + diffuse(0.7) +
        "</shape><shape type='sphere'><point name='center' x='0' y='0' z='2'/><float name='radius' value='0.7'/><bsdf "
        "type='dielectric'><float name='cauchy_b' value='0.02'/></bsdf></shape><emitter type='point'><point "
        "name='position' x='0' y='0' z='5'/><rgb name='intensity' value='1'/></emitter>"));
    const CollectedLight light = light_of(prism, "progressive_photon_mapper photons=2000 radius=0.01", 5000, 3);
    EXPECT_EQ(light.passes, 3u);
    const auto infos =
        array<std::uint8_t>(photons_page({prism, "progressive_photon_mapper", 1, light}), "photon-infos");
    std::set<int> strata, passes;
    for (std::size_t i = 0; i < infos.size(); i += 4) {
        strata.insert(infos[i + 2]);
        passes.insert(infos[i + 3]);
    }
    EXPECT_GT(strata.size(), 16u);
    EXPECT_LE(*strata.rbegin(), 32);
    EXPECT_THAT(passes, ::testing::ElementsAre(0, 1, 2));
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
    const json camera = json::parse(element(photons_page({box, "photon_mapper", 1, light}), "facts"))["camera"];
    EXPECT_EQ(camera["aspect"], 2);
    EXPECT_NEAR(camera["up"][1].get<double>(), 1, 1e-3);
    const Ray top = box.scene->sensor().generate_ray(32, 0, Vec2(0.5f, 0.5f));
    const Vec3 direction(camera["direction"][0], camera["direction"][1], camera["direction"][2]);
    const double half = std::acos(std::min(1.0, static_cast<double>(top.d.normalized().dot(direction))));
    EXPECT_NEAR(camera["fov"].get<double>() / 2, half * 180 / std::numbers::pi, 1.5) << "of 32 rows";
}

TEST(Photons, CommandSaysWhatItShows) {
    const TemporaryFolder folder;
    const std::string box = "'" + source_path("scenes/cornell-box.xml") + "' --resolution 8x8 ";
    const auto run = [&](const std::string& arguments) { return run_gibench("photons " + arguments, folder / ""); };
    ProgramResult result = run(box + "--method 'photon_mapper photons=4000' --photons-shown 100 -o a.html");
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_THAT(result.out, ::testing::ContainsRegex("global map: 100 of [0-9]+ photons shown \\([0-9.]+ %\\)"));
    EXPECT_THAT(read_file(folder / "a.html"), HasSubstr("id=\"array-photon-positions\""));
    result = run(box + "--method 'path spp=4' -o b.html");
    EXPECT_EQ(result.code, 2);
    EXPECT_THAT(result.err, HasSubstr("photon_mapper, progressive_photon_mapper, radiosity"));
    for (const char* wrong : {"--method photon_mapper -o b.exr", "--method photon_mapper -o none/b.html",
                              "--method photon_mapper --photons-shown 0 -o b.html",
                              "--method progressive_photon_mapper --passes 256 -o b.html", "--method photon_mapper"}) {
        EXPECT_EQ(run(box + wrong).code, 2) << wrong;
        EXPECT_FALSE(std::filesystem::exists(folder / "b.html"));
    }
    result = run(box + "--method 'photon_mapper photons=0' -o c.html");
    EXPECT_EQ(result.code, 0);
    EXPECT_THAT(result.err, HasSubstr("stores no light in this scene; skipped: "));
}

TEST(Photons, ReportLinksThePages) {
    const TemporaryFolder folder;
    folder.write("tiny.xml", tiny_scene_xml());
    folder.write("e.toml",
                 "scenes = ['tiny.xml']\n[reference]\nmethod = 'path'\ntarget = '40%'\n[[method]]\n"
                 "name = 'photon_mapper'\nphotons = 100\nspp = 2\n");
    ASSERT_EQ(run_gibench("run e.toml --threads 1 --out results", folder / "").code, 0);
    const std::string page = "results/images/tiny-photon_mapper_photons=100_spp=2-photons.html";
    EXPECT_THAT(read_file(folder / "results/report.html"),
                AllOf(HasSubstr("gibench photons"), HasSubstr(page), Not(HasSubstr("href=\"images/"))));
    ASSERT_EQ(
        run_gibench("photons tiny.xml --method 'photon_mapper photons=100 spp=2' -o '" + page + "'", folder / "").code,
        0);
    ASSERT_EQ(run_gibench("report results", folder / "").code, 0);
    EXPECT_THAT(read_file(folder / "results/report.html"),
                HasSubstr("href=\"images/tiny-photon_mapper_photons=100_spp=2-photons.html\""));
}

}  // namespace
}  // namespace gib::test::page_test
