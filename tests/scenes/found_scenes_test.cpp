// Whole scenes as people have them, in the words of Mitsuba 0.6: rooms under a sky, an environment or lamps of a
// temperature. Each loads with the warnings that it should have, and path tracing and photon mapping agree about its
// mean.

#include "tests/support/light_fixtures.h"
#include "tests/support/scene_fixtures.h"

#include <gmock/gmock.h>

#include <array>

namespace gib::found_scenes_test {
namespace {

using ::testing::HasSubstr;

struct FoundScene {
    std::string name, xml;
    std::vector<std::string> warnings = {};  ///< a part of each, in their order
};

std::string scene_of_0_6(const std::string& body) {
    return "<?xml version='1.0' encoding='utf-8'?><scene version='0.6.0'><integrator type='path'><integer "
           "name='maxDepth' "
           "value='5'/></integrator>" +
           body + "</scene>";
}

std::string sensor(const std::string& look) {
    return "<sensor type='perspective'><float name='fov' value='55'/><string name='fovAxis' "
           "value='smaller'/><transform "
           "name='toWorld'><lookAt " +
           look +
           "/></transform><sampler type='independent'><integer name='sampleCount' value='16'/></sampler><film "
           "type='ldrfilm'><integer name='width' value='24'/><integer name='height' value='16'/><float name='gamma' "
           "value='-1'/><rfilter type='box'/></film></sensor>";
}

std::string rectangle(const std::string& placing, const std::string& inside) {
    return "<shape type='rectangle'><transform name='toWorld'>" + placing + "</transform>" + inside + "</shape>";
}

std::string reference(const std::string& id) { return "<ref id='" + id + "'/>"; }

/// A room of 4 x 3 x 4 without its front at z = 2 and, with a window, without its left wall.
std::string room(const std::string& wall, bool has_window) {
    const std::string bsdf = reference(wall), half = "<scale x='2' y='1.5'/>";
    return rectangle("<scale value='2'/><rotate x='1' angle='-90'/>", bsdf) +
           rectangle("<scale value='2'/><rotate x='1' angle='90'/><translate y='3'/>", bsdf) +
           rectangle(half + "<translate y='1.5' z='-2'/>", bsdf) +
           rectangle(half + "<rotate y='1' angle='-90'/><translate x='2' y='1.5'/>", bsdf) +
           (has_window ? "" : rectangle(half + "<rotate y='1' angle='90'/><translate x='-2' y='1.5'/>", bsdf));
}

const std::string wall =
    "<bsdf type='twosided' id='wall'><bsdf type='diffuse'><spectrum name='reflectance' value='0.7, 0.65, "
    "0.6'/></bsdf></bsdf>";
const std::string look_in = "origin='0, 1.5, 5' target='0, 1.3, 0' up='0, 1, 0'";

std::vector<FoundScene> found_scenes() {
    return {
        {"room with a window under sun and sky",
         scene_of_0_6(
             sensor(look_in) + wall + room("wall", true) +
             "<emitter type='sunsky'><vector name='sunDirection' x='-2' y='2' z='0.5'/><float name='turbidity' "
             "value='3.5'/><float name='skyScale' value='8'/><float name='sunScale' value='0.5'/><float "
             "name='sunRadiusScale' value='4'/><spectrum name='albedo' value='0.15'/></emitter>")},
        {"table under the sky of an hour",
         scene_of_0_6(
             sensor("origin='3, 3, 5' target='0, 0.5, 0' up='0, 1, 0'") +
             "<bsdf type='plastic' id='top'><spectrum name='diffuseReflectance' value='0.3, 0.1, 0.05'/><float "
             "name='intIOR' value='1.5'/></bsdf>" +
             rectangle("<scale value='20'/><rotate x='1' angle='-90'/>",
                       "<bsdf type='diffuse'><texture type='checkerboard' name='reflectance'><float "
                       "name='uscale' value='20'/><float name='vscale' value='20'/></texture></bsdf>") +
             "<shape type='cube'><transform name='toWorld'><scale x='1' y='0.4' z='0.7'/><translate "
             "y='0.4'/></transform>" +
             reference("top") +
             "</shape><emitter type='sky'><integer name='month' value='6'/><float name='hour' "
             "value='9.5'/><float name='latitude' value='48.1'/><float name='longitude' value='11.6'/><float "
             "name='timezone' value='1'/><integer name='resolution' value='1024'/><float name='scale' "
             "value='10'/></emitter>")},
        {"room with lamps of two temperatures",
         scene_of_0_6(sensor(look_in) + wall + room("wall", false) +
                      rectangle("<scale value='0.4'/><rotate x='1' angle='90'/><translate y='2.95'/>",
                                "<emitter type='area'><blackbody name='radiance' temperature='2700K' "
                                "scale='0.01'/></emitter>") +
                      "<shape type='sphere'><point name='center' x='1' y='0.4' z='0'/><float name='radius' "
                      "value='0.4'/><emitter type='area'><blackbody name='radiance' temperature='5500' "
                      "scale='2e-5'/></emitter></shape>")},
        {"pictures under an environment",
         scene_of_0_6(sensor(look_in) +
                      "<texture type='bitmap' id='picture'><string name='filename' value='picture.ppm'/><float "
                      "name='gamma' value='2.2'/><string name='filterType' value='ewa'/></texture><bsdf type='diffuse' "
                      "id='wall'><texture type='scale' name='reflectance'><ref id='picture'/><float name='scale' "
                      "value='0.6'/></texture></bsdf>" +
                      room("wall", true) +
                      "<emitter type='envmap'><string name='filename' value='picture.ppm'/><float name='scale' "
                      "value='2'/><transform name='toWorld'><rotate y='1' angle='70'/></transform></emitter>"),
         {"'ewa'"}},
        {"statue in the evening sun and in the fog that nothing refers to",
         scene_of_0_6(
             "<medium type='homogeneous' id='fog'><string name='material' value='Ketchup'/></medium>" +
             sensor("origin='0, 1.2, 4' target='0, 0.8, 0' up='0, 1, 0'") +
             rectangle("<scale value='8'/><rotate x='1' angle='-90'/>",
                       "<bsdf type='diffuse'><srgb name='reflectance' value='#a09080'/></bsdf>") +
             "<shape type='sphere'><point name='center' x='0' y='0.8' z='0'/><float name='radius' "
             "value='0.8'/><bsdf type='roughconductor'><string name='material' value='Cu'/><float name='alpha' "
             "value='0.3'/></bsdf></shape><emitter type='sun'><vector name='sunDirection' x='3' y='1' "
             "z='2'/><float name='scale' value='0.3'/></emitter><emitter type='point'><point name='position' "
             "x='-2' y='2' z='2'/><spectrum name='intensity' value='1'/></emitter>"),
         {"nothing refers to this medium"}},
        {"balls of copper and of mixtures",
         scene_of_0_6(
             sensor("origin='0, 2, 7' target='0, 0.7, 0' up='0, 1, 0'") +
             "<bsdf type='plastic' id='red'><spectrum name='diffuseReflectance' value='0.5, 0.05, 0.05'/></bsdf>" +
             rectangle("<scale value='6'/><rotate x='1' angle='-90'/>", "<bsdf type='diffuse'/>") +
             "<shape type='sphere'><point name='center' x='-1.8' y='0.8' z='0'/><float name='radius' "
             "value='0.8'/><bsdf type='roughconductor'><float name='alpha' value='0.3'/></bsdf></shape><shape "
             "type='sphere'><point name='center' x='0' y='0.8' z='0'/><float name='radius' value='0.8'/><bsdf "
             "type='mixturebsdf'><string name='weights' value='0.5, 0.2, 0.2'/><bsdf type='roughconductor'><string "
             "name='material' value='Cr'/><float name='alpha' value='0.25'/></bsdf><ref id='red'/><bsdf "
             "type='diffuse'><rgb name='reflectance' value='0.7 1 0.7'/></bsdf></bsdf></shape><shape "
             "type='sphere'><point name='center' x='1.8' y='0.8' z='0'/><float name='radius' value='0.8'/><bsdf "
             "type='blendbsdf'><texture name='weight' type='bitmap'><string name='filename' "
             "value='picture.ppm'/><float name='uvscale' value='3'/></texture><ref id='red'/><bsdf "
             "type='diffuse'/></bsdf></shape><emitter type='constant'><spectrum name='radiance' "
             "value='0.3'/></emitter><shape type='sphere'><point name='center' x='2' y='5' z='3'/><float "
             "name='radius' value='0.6'/><emitter type='area'><spectrum name='radiance' "
             "value='9'/></emitter></shape>")},
        {"tiles with a normal map, cropped",
         scene_of_0_6(
             "<sensor type='perspective'><float name='fov' value='50'/><float name='farClip' value='7.5'/><transform "
             "name='toWorld'><lookAt origin='0, 3, 6' target='0, 0.7, 0' up='0, 1, 0'/></transform><film "
             "type='hdrfilm'><integer name='width' value='40'/><integer name='height' value='30'/><integer "
             "name='cropOffsetX' value='8'/><integer name='cropOffsetY' value='6'/><integer name='cropWidth' "
             "value='24'/><integer name='cropHeight' value='18'/><rfilter type='gaussian'/></film></sensor>" +
             rectangle("<scale value='4'/><rotate x='1' angle='-90'/>",
                       "<bsdf type='normalmap'><texture type='bitmap'><string name='filename' "
                       "value='normals.ppm'/><float name='gamma' value='1.0'/><float name='uscale' value='3'/><float "
                       "name='vscale' value='3'/></texture><bsdf type='roughplastic'><float name='alpha' "
                       "value='0.25'/></bsdf></bsdf>") +
             "<shape type='cube'><transform name='toWorld'><scale value='0.7'/><translate y='0.7'/></transform><bsdf "
             "type='diffuse'><texture type='bitmap' name='reflectance'><string name='filename' "
             "value='picture.ppm'/><string name='wrapMode' value='mirror'/></texture></bsdf></shape><emitter "
             "type='point'><transform name='toWorld'><translate x='2' y='4' z='3'/></transform><spectrum "
             "name='intensity' value='60'/></emitter><emitter type='directional'><vector name='direction' x='1' "
             "y='-2' z='-1'/><rgb name='irradiance' value='1 0.9 0.8'/></emitter>")},
    };
}

class FoundScenes : public ::testing::TestWithParam<std::size_t> {
protected:
    FoundScenes() {
        std::string pixels = "P6\n8 4\n255\n";
        for (int i = 0; i < 96; ++i)
            pixels += static_cast<char>(30 + 2 * i);
        folder_.write("picture.ppm", pixels);
        std::string normals = "P6\n8 4\n255\n";
        for (int i = 0; i < 32; ++i) {
            normals += static_cast<char>(100 + 8 * (i % 8));
            normals += static_cast<char>(100 + 16 * (i / 8));
            normals += static_cast<char>(240);
        }
        folder_.write("normals.ppm", normals);
    }
    test::TemporaryFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(All, FoundScenes, ::testing::Range(std::size_t{0}, found_scenes().size()));

// The mean of the image over 8 seeds each. The tolerance is 4 standard errors of the difference, and 3 % for the bias of
// the photon map. With errors from 8 seeds, alpha is 3 % for all 7 scenes and 3 channels together. The seeds are fixed.
TEST_P(FoundScenes, LoadAndLookAlikeToPathTracingAndPhotonMapping) {
    const FoundScene found = found_scenes()[GetParam()];
    SCOPED_TRACE(found.name);
    const LoadedScene scene = parse_scene(found.xml, folder_ / "scene.xml");
    ASSERT_EQ(scene.warnings.size(), found.warnings.size()) << ::testing::PrintToString(scene.warnings);
    for (std::size_t i = 0; i < found.warnings.size(); ++i)
        EXPECT_THAT(scene.warnings[i], HasSubstr(found.warnings[i]));
    struct Sums {
        Colord sum = Colord::Zero(), squares = Colord::Zero();
    };
    constexpr int seeds = 8;
    std::array<Sums, 2> methods;
    const std::array<std::string, 2> labels = {"path", "photon_mapper photons=20000 k=40"};
    for (std::size_t m = 0; m < labels.size(); ++m)
        for (int seed = 1; seed <= seeds; ++seed) {
            const Colord mean =
                test::mean_of(test::render(scene, labels[m], 16, static_cast<std::uint64_t>(seed)).total());
            methods[m].sum += mean / seeds;
            methods[m].squares += mean * mean / seeds;
        }
    const Colord variance = (methods[0].squares - methods[0].sum * methods[0].sum +
                             (methods[1].squares - methods[1].sum * methods[1].sum)) /
                            (seeds - 1);
    for (int c = 0; c < 3; ++c) {
        EXPECT_GT(methods[0].sum[c], 1e-3);
        EXPECT_NEAR(methods[1].sum[c], methods[0].sum[c],
                    4 * std::sqrt(std::max(variance[c], 0.0)) + 0.03 * methods[0].sum[c]);
    }
}

}  // namespace
}  // namespace gib::found_scenes_test
