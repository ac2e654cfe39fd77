// Scenes of Mitsuba 0.3 to 1.x. Each is written twice, as its version has it and as version 3 does, and both give the same image
// bit for bit. What differs is stated in common/xml/xml_upgrade.h.

#include "common/color/srgb.h"
#include "tests/support/input_error.h"
#include "tests/support/scene_fixtures.h"
#include "tests/support/scene_text.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace gib::test::xml_upgrade_test {
namespace {

using ::testing::HasSubstr;

/// A part of a scene beside the ball, the floor and the light that all of them have.
struct OldScene {
    std::string name, version, old_body, new_body;
    std::vector<std::string> warnings = {};  ///< a part of each, in their order
};

const std::string old_sensor =
    "<sensor type='perspective'><float name='fov' value='60'/><transform name='toWorld'><lookAt origin='0,1,4' "
    "target='0,0,0' up='0,1,0'/></transform><film type='hdrfilm'><integer name='width' value='12'/><integer "
    "name='height' value='8'/><rfilter type='box'/></film></sensor>";
const std::string new_sensor =
    "<sensor type='perspective'><float name='fov' value='60'/><transform name='to_world'><lookat origin='0,1,4' "
    "target='0,0,0' up='0,1,0'/></transform><film type='hdrfilm'><integer name='width' value='12'/><integer "
    "name='height' value='8'/><rfilter type='box'/></film></sensor>";
const std::string sky = "<emitter type='constant'><rgb name='radiance' value='0.5'/></emitter>";

const std::string spots = "<texture type='bitmap'><string name='filename' value='spots.ppm'/></texture>";

/// A ball with a bsdf.
std::string ball(const std::string& bsdf) { return "<shape type='sphere'>" + bsdf + "</shape>"; }

OldScene with_bsdf(const std::string& name, const std::string& old_bsdf, const std::string& new_bsdf,
                   const std::vector<std::string>& warnings = {}) {
    return {name, "0.6.0", old_sensor + sky + ball(old_bsdf), new_sensor + sky + ball(new_bsdf), warnings};
}

std::vector<OldScene> cameras() {
    return {
        {"perspective",
         "0.6.0",
         "<sensor type='perspective'><string name='fovAxis' value='smaller'/><float name='fov' value='50'/><float "
         "name='nearClip' value='0.5'/><float name='farClip' value='100'/><float name='focusDistance' "
         "value='4'/><transform name='toWorld'><lookAt "
         "origin='0,1,4' target='0,0,0' up='0,1,0'/></transform><sampler type='sobol'><integer name='sampleCount' "
         "value='8'/><integer name='scramble' value='3'/></sampler><film type='ldrfilm'><integer name='width' "
         "value='10'/><integer name='height' "
         "value='8'/><float name='gamma' value='2.2'/><string name='tonemapMethod' value='gamma'/><boolean "
         "name='banner' value='false'/><integer name='cropOffsetX' value='2'/><integer name='cropWidth' "
         "value='6'/><rfilter "
         "type='mitchell'/></film></sensor>" +
             sky + ball(""),
         "<sensor type='perspective'><string name='fov_axis' value='smaller'/><float name='fov' value='50'/><float "
         "name='near_clip' value='0.5'/><float name='far_clip' value='100'/><transform name='to_world'><lookat "
         "origin='0,1,4' target='0,0,0' "
         "up='0,1,0'/></transform><sampler type='independent'><integer name='sample_count' value='8'/></sampler><film "
         "type='hdrfilm'><integer name='width' value='10'/><integer name='height' value='8'/><integer "
         "name='crop_offset_x' value='2'/><integer name='crop_width' value='6'/><rfilter "
         "type='gaussian'/></film></sensor>" +
             sky + ball(""),
         {"mitchell"}},
        {"thin lens", "0.5.0",
         "<sensor type='thinlens'><float name='fov' value='50'/><float name='apertureRadius' value='0.2'/><float "
         "name='focusDistance' value='3'/><transform name='toWorld'><translate z='4'/><rotate y='1' "
         "angle='180'/><scale x='1'/><translate z='8'/></transform><film type='mfilm'><integer "
         "name='width' value='8'/><integer name='height' value='8'/><rfilter type='tent'/></film></sensor>" +
             sky + ball(""),
         "<sensor type='thinlens'><float name='fov' value='50'/><float name='aperture_radius' value='0.2'/><float "
         "name='focus_distance' value='3'/><transform name='to_world'><translate z='4'/><rotate y='1' "
         "angle='180'/><scale x='1'/><translate z='8'/></transform><film type='hdrfilm'><integer "
         "name='width' value='8'/><integer name='height' value='8'/><rfilter type='tent'/></film></sensor>" +
             sky + ball("")},
        {"camera of 0.3", "0.3.0",
         "<camera type='perspective'><float name='fov' value='50'/><transform name='toWorld'><lookAt origin='0.5,1,4' "
         "target='0,0,0' up='0,1,0'/></transform><film type='exrfilm'><integer name='width' value='12'/><integer "
         "name='height' value='8'/><rfilter type='box'/></film></camera><luminaire type='point'><point name='position' "
         "x='2' y='3' z='2'/><spectrum name='intensity' value='20'/></luminaire><luminaire type='constant'><spectrum "
         "name='intensity' value='0.5'/></luminaire>" +
             ball(""),
         "<sensor type='perspective'><float name='fov' value='50'/><string name='fov_axis' value='smaller'/><transform "
         "name='to_world'><scale x='-1'/><lookat origin='0.5,1,4' target='0,0,0' up='0,1,0'/></transform><film "
         "type='hdrfilm'><integer name='width' value='12'/><integer name='height' value='8'/><rfilter "
         "type='box'/></film></sensor><emitter type='point'><point name='position' value='2,3,2'/><rgb "
         "name='intensity' value='20'/></emitter>" +
             sky + ball("")},
        {"integrator",
         "0.6.0",
         "<integrator type='photonmapper'><integer name='maxDepth' value='2'/><integer name='globalPhotons' "
         "value='1000'/></integrator>" +
             old_sensor + sky + ball(""),
         "<integrator type='path'><integer name='max_depth' value='2'/></integrator>" + new_sensor + sky + ball(""),
         {"integrator 'photonmapper'"}},
        {"integrator in another",
         "0.6.0",
         "<integrator type='adaptive'><float name='maxError' value='0.05'/><integrator type='path'><integer "
         "name='maxDepth' value='2'/><boolean name='strictNormals' value='true'/></integrator></integrator>" +
             old_sensor + sky + ball(""),
         "<integrator type='path'><integer name='max_depth' value='2'/></integrator>" + new_sensor + sky + ball(""),
         {"integrator 'adaptive'"}},
    };
}

std::vector<OldScene> materials() {
    return {
        with_bsdf("colours", "<bsdf type='diffuse'><spectrum name='diffuseReflectance' value='0.2, 0.5 0.8'/></bsdf>",
                  "<bsdf type='diffuse'><rgb name='reflectance' value='0.2 0.5 0.8'/></bsdf>"),
        with_bsdf("sRGB in hexadecimal digits",
                  "<bsdf type='diffuse'><srgb name='reflectance' value='#ff8000'/></bsdf>",
                  "<bsdf type='diffuse'><rgb name='reflectance' value='1 " +
                      fmt::format("{}", linear_from_srgb(128.f / 255)) + " 0'/></bsdf>"),
        with_bsdf(
            "checkerboard",
            "<bsdf type='diffuse'><texture type='checkerboard' name='reflectance'><float name='uscale' "
            "value='3'/><float name='voffset' value='0.25'/><float name='vscale' value='2'/><spectrum name='color0' "
            "value='0.9'/></texture></bsdf>",
            "<bsdf type='diffuse'><texture type='checkerboard' name='reflectance'><transform name='to_uv'><translate "
            "y='0.25'/><scale x='3' y='2'/></transform><rgb name='color0' value='0.9'/></texture></bsdf>"),
        with_bsdf(
            "conductor in water",
            "<bsdf type='conductor'><rgb name='eta' value='0.2'/><rgb name='k' value='3.6'/><string name='extEta' "
            "value='water'/></bsdf>",
            "<bsdf type='conductor'><rgb name='eta' value='0.15003751'/><rgb name='k' value='2.7006752'/></bsdf>"),
        with_bsdf("rough conductor",
                  "<bsdf type='roughconductor'><string name='material' value='Au'/><string name='distribution' "
                  "value='phong'/><float name='alphaU' value='0.2'/><float name='alphaV' value='0.3'/></bsdf>",
                  "<bsdf type='roughconductor'><string name='material' value='Au'/><string name='distribution' "
                  "value='beckmann'/><float name='alpha_u' value='0.2'/><float name='alpha_v' value='0.3'/></bsdf>",
                  {"'phong'"}),
        with_bsdf(
            "glass",
            "<bsdf type='dielectric'><string name='intIOR' value='water'/><float name='extIOR' value='1'/></bsdf>",
            "<bsdf type='dielectric'><string name='int_ior' value='water'/><float name='ext_ior' value='1'/></bsdf>"),
        with_bsdf("rough plastic",
                  "<bsdf type='roughplastic'><float name='alpha' value='0.2'/><spectrum name='diffuseReflectance' "
                  "value='0.1,0.4,0.2'/><boolean name='nonlinear' value='true'/></bsdf>",
                  "<bsdf type='roughplastic'><float name='alpha' value='0.2'/><rgb name='diffuse_reflectance' "
                  "value='0.1,0.4,0.2'/><boolean name='nonlinear' value='true'/></bsdf>"),
        with_bsdf("bump map of 0.6",
                  "<bsdf type='bumpmap'><texture type='scale'><float name='scale' value='0.05'/><texture "
                  "type='bitmap'><string name='filename' value='spots.ppm'/><float name='uscale' "
                  "value='3'/></texture></texture><bsdf type='diffuse'/></bsdf>",
                  "<bsdf type='bumpmap'><texture type='bitmap'><string name='filename' value='spots.ppm'/><transform "
                  "name='to_uv'><scale x='3'/></transform></texture><float name='scale' value='0.05'/><bsdf "
                  "type='diffuse'/></bsdf>"),
        with_bsdf("mixture",
                  "<bsdf type='mixturebsdf'><string name='weights' value='0.75, 0.25'/><bsdf type='diffuse'/><bsdf "
                  "type='plastic'/></bsdf>",
                  "<bsdf type='blendbsdf'><float name='weight' value='0.25'/><bsdf type='diffuse'/><bsdf "
                  "type='plastic'/></bsdf>"),
        with_bsdf("mixture that absorbs a quarter",
                  "<bsdf type='mixturebsdf'><string name='weights' value='0.25, 0.25, 0.25'/><bsdf "
                  "type='diffuse'/><bsdf type='plastic'/><bsdf type='phong'/></bsdf>",
                  "<bsdf type='blendbsdf'><float name='weight' value='0.25'/><bsdf type='blendbsdf'><float "
                  "name='weight' value='0.3333333333333333'/><bsdf type='blendbsdf'><float name='weight' "
                  "value='0.5'/><bsdf type='diffuse'/><bsdf type='plastic'/></bsdf><bsdf type='phong'/></bsdf><bsdf "
                  "type='diffuse'><rgb name='reflectance' value='0'/></bsdf></bsdf>"),
        with_bsdf("mixture of weights above 1",
                  "<bsdf type='mixturebsdf'><string name='weights' value='3, 1'/><bsdf type='diffuse'/><bsdf "
                  "type='plastic'/></bsdf>",
                  "<bsdf type='blendbsdf'><float name='weight' value='0.25'/><bsdf type='diffuse'/><bsdf "
                  "type='plastic'/></bsdf>",
                  {"the weights sum to 4"}),
        with_bsdf("white above 1",
                  "<bsdf type='plastic'><spectrum name='diffuseReflectance' value='1.1, 0.55, 0'/><float "
                  "name='specularReflectance' value='1'/></bsdf>",
                  "<bsdf type='plastic'><rgb name='diffuse_reflectance' value='0.99 0.495 0'/></bsdf>",
                  {"'diffuse_reflectance' is above 1"}),
        with_bsdf("roughness in one direction",
                  "<bsdf type='roughconductor'><string name='material' value='Au'/><float name='alpha' "
                  "value='0.2'/><float name='alphaV' value='0.4'/></bsdf>",
                  "<bsdf type='roughconductor'><string name='material' value='Au'/><float name='alpha_u' "
                  "value='0.2'/><float name='alpha_v' value='0.4'/></bsdf>"),
        with_bsdf("copper", "<bsdf type='conductor'/>",
                  "<bsdf type='conductor'><string name='material' value='Cu'/></bsdf>"),
        with_bsdf("rough copper", "<bsdf type='roughconductor'><float name='alpha' value='0.3'/></bsdf>",
                  "<bsdf type='roughconductor'><string name='material' value='Cu'/><float name='alpha' "
                  "value='0.3'/></bsdf>"),
        with_bsdf("mirror", "<bsdf type='conductor'><string name='material' value='none'/></bsdf>",
                  "<bsdf type='conductor'/>"),
        with_bsdf("normal map without a name",
                  "<bsdf type='normalmap'><texture type='bitmap'><string name='filename' value='spots.ppm'/><float "
                  "name='gamma' value='1'/><float name='uvscale' value='2'/><float name='vscale' "
                  "value='3'/></texture><bsdf type='diffuse'/></bsdf>",
                  "<bsdf type='normalmap'><texture type='bitmap' name='normalmap'><string name='filename' "
                  "value='spots.ppm'/><boolean name='raw' value='true'/><transform name='to_uv'><scale x='2' "
                  "y='3'/></transform></texture><bsdf type='diffuse'/></bsdf>"),
        with_bsdf("phong",
                  "<bsdf type='phong'><spectrum name='diffuseReflectance' value='0.8'/><spectrum "
                  "name='specularReflectance' value='0.8'/></bsdf>",
                  "<bsdf type='phong'><rgb name='diffuse_reflectance' value='0.5'/><rgb name='specular_reflectance' "
                  "value='0.5'/></bsdf>",
                  {"scaled down"}),
        {"bump map of 0.4", "0.4.1",
         old_sensor + sky + ball("<bsdf type='bump'>" + spots + "<bsdf type='diffuse'/></bsdf>"),
         new_sensor + sky + ball("<bsdf type='bumpmap'>" + spots + "<bsdf type='diffuse'/></bsdf>")},
    };
}

std::vector<OldScene> lights() {
    return {
        {"lights", "0.6.0",
         old_sensor + ball("") +
             "<emitter type='spot'><spectrum name='intensity' value='9,8,7'/><float name='cutoffAngle' "
             "value='40'/><float "
             "name='beamWidth' value='20'/><transform name='toWorld'><lookAt origin='2,2,2' "
             "target='0,0,0'/></transform></emitter>"
             "<emitter type='directional'><vector name='direction' x='0' y='-1' z='-1'/><spectrum name='irradiance' "
             "value='0.5'/><float name='samplingWeight' value='2'/></emitter>",
         new_sensor + ball("") +
             "<emitter type='spot'><rgb name='intensity' value='9,8,7'/><float name='cutoff_angle' value='40'/><float "
             "name='beam_width' value='20'/><transform name='to_world'><lookat origin='2,2,2' "
             "target='0,0,0'/></transform></emitter>"
             "<emitter type='directional'><vector name='direction' value='0,-1,-1'/><rgb name='irradiance' "
             "value='0.5'/></emitter>"},
        {"environment",
         "0.6.0",
         old_sensor + ball("") +
             "<emitter type='envmap'><string name='filename' value='spots.ppm'/><float name='gamma' "
             "value='2.2'/><boolean name='cache' value='false'/></emitter>",
         new_sensor + ball("") + "<emitter type='envmap'><string name='filename' value='spots.ppm'/></emitter>",
         {"'gamma' has no effect: the kind of the image decides"}},
        {"sky of 0.6",
         "0.6.0",
         old_sensor + ball("") +
             "<emitter type='sunsky'><float name='turbidity' value='4'/><vector name='sunDirection' x='1' y='1' "
             "z='2'/><float name='skyScale' value='3'/><float name='sunRadiusScale' value='2'/><spectrum "
             "name='albedo' value='0.2'/><integer name='resolution' value='256'/></emitter>",
         new_sensor + ball("") +
             "<emitter type='sunsky'><float name='turbidity' value='4'/><vector name='sun_direction' x='1' y='1' "
             "z='2'/><float name='sky_scale' value='3'/><float name='sun_radius_scale' value='2'/><transform "
             "name='to_world'><matrix value='0 -1 0 0 0 0 1 0 -1 0 0 0 0 0 0 1'/></transform></emitter>",
         {"Preetham"}},
        {"sky of 0.5 with z upwards",
         "0.5.0",
         old_sensor + ball("") +
             "<emitter type='sky'><float name='hour' value='10'/><transform name='toWorld'><rotate x='1' "
             "angle='90'/></transform></emitter>",
         // North is y there, and x in version 3.
         new_sensor + ball("") +
             "<emitter type='sky'><float name='hour' value='10'/><transform name='to_world'><matrix value='0 -1 0 0 0 "
             "0 "
             "1 0 -1 0 0 0 0 0 0 1'/><rotate x='1' angle='90'/></transform></emitter>",
         {"Preetham"}},
        {"blackbody lamp", "0.6.0",
         old_sensor + ball("") +
             "<emitter type='point'><point name='position' x='2' y='3' z='2'/><blackbody name='intensity' "
             "temperature='3000K' scale='0.05'/></emitter>",
         new_sensor + ball("") +
             "<emitter type='point'><point name='position' value='2,3,2'/><spectrum name='intensity' "
             "type='blackbody'><float name='temperature' value='3000'/><float name='scale' "
             "value='0.05'/></spectrum></emitter>"},
        {"area lamp in a file that is included", "0.6.0", old_sensor + "<include filename='lamp.xml'/>" + ball(""),
         new_sensor +
             "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='90'/><translate "
             "y='2'/></transform><emitter type='area'><rgb name='radiance' value='3'/></emitter></shape>" +
             ball("")},
    };
}

std::vector<OldScene> media_and_instances() {
    return {
        {"fog", "0.6.0",
         old_sensor + sky +
             "<shape type='cube'><medium type='homogeneous' name='interior'><spectrum name='sigmaS' "
             "value='0.5'/><spectrum name='sigmaA' value='0.25'/><float name='densityMultiplier' value='2'/><phase "
             "type='hg'><float name='g' value='0.3'/></phase></medium><bsdf type='null'/></shape>",
         new_sensor + sky +
             "<shape type='cube'><medium type='homogeneous' name='interior'><rgb name='sigma_s' value='0.5'/><rgb "
             "name='sigma_a' value='0.25'/><float name='scale' value='2'/><phase type='hg'><float name='g' "
             "value='0.3'/></phase></medium><bsdf type='null'/></shape>"},
        {"smoke", "0.6.0",
         old_sensor + sky +
             "<shape type='cube'><medium type='heterogeneous' name='interior'><string name='method' "
             "value='woodcock'/><float name='stepSize' value='0.1'/><volume type='constvolume' name='density'><float "
             "name='value' value='0.7'/></volume><volume type='constvolume' name='albedo'><spectrum name='value' "
             "value='0.9,0.5,0.2'/></volume><float name='densityMultiplier' value='2'/></medium><bsdf "
             "type='null'/></shape>",
         new_sensor + sky +
             "<shape type='cube'><medium type='homogeneous' name='interior'><float name='sigma_t' value='0.7'/><rgb "
             "name='albedo' value='0.9,0.5,0.2'/><float name='scale' value='2'/></medium><bsdf type='null'/></shape>"},
        {"medium without a scattering coefficient",
         "0.6.0",
         old_sensor + sky +
             "<shape type='cube'><medium type='homogeneous' name='interior'><spectrum name='sigmaA' "
             "value='0.5'/></medium><bsdf type='null'/></shape>",
         new_sensor + sky +
             "<shape type='cube'><medium type='homogeneous' name='interior'><rgb name='sigma_a' "
             "value='0.5'/></medium><bsdf type='null'/></shape>",
         {"'sigma_s' is not given"}},
        {"instances", "0.6.0",
         old_sensor + sky +
             "<shape type='shapegroup' id='g'><shape type='sphere'><float name='radius' "
             "value='0.3'/></shape></shape><shape type='instance'><ref id='g'/><transform name='toWorld'><translate "
             "x='1'/></transform></shape>",
         new_sensor + sky +
             "<shape type='shapegroup' id='g'><shape type='sphere'><float name='radius' "
             "value='0.3'/></shape></shape><shape type='instance'><ref id='g'/><transform name='to_world'><translate "
             "x='1'/></transform></shape>"},
        {"parameters", "0.6.0",
         "<default name='maxDepth' value='2'/><default name='grey' value='0.25,0.25,0.25'/><integrator "
         "type='path'><integer name='maxDepth' value='$maxDepth'/></integrator>" +
             old_sensor + sky + ball("<bsdf type='diffuse'><spectrum name='reflectance' value='$grey'/></bsdf>"),
         "<integrator type='path'><integer name='max_depth' value='2'/></integrator>" + new_sensor + sky +
             ball("<bsdf type='diffuse'><rgb name='reflectance' value='0.25'/></bsdf>")},
    };
}

/// The folder with the files that the scenes name.
class OldScenes : public ::testing::Test {
protected:
    OldScenes() {
        folder_.write(
            "lamp.xml",
            "<shape version='0.5.0' type='rectangle'><transform name='toWorld'><rotate x='1' angle='90'/><translate "
            "y='2'/></transform><emitter type='area'><spectrum name='radiance' value='3'/></emitter></shape>");
        std::string pixels = "P6\n4 4\n255\n";
        for (int i = 0; i < 48; ++i)
            pixels += static_cast<char>(5 * i);
        folder_.write("spots.ppm", pixels);
    }
    LoadedScene load(const std::string& version, const std::string& body) const {
        return parse_scene("<scene version='" + version + "'>" + body + "</scene>", folder_ / "scene.xml");
    }
    void expect_same(const OldScene& scene) const {
        const LoadedScene old_one = load(scene.version, scene.old_body), new_one = load("3.0.0", scene.new_body);
        EXPECT_EQ(old_one.sample_count, new_one.sample_count);
        EXPECT_EQ(render(old_one, "path", 4).total().rgb, render(new_one, "path", 4).total().rgb);
        EXPECT_GT(mean_of(render(old_one, "path", 4).total()).maxCoeff(), 0.01);
        ASSERT_EQ(old_one.warnings.size(), scene.warnings.size()) << ::testing::PrintToString(old_one.warnings);
        for (std::size_t i = 0; i < scene.warnings.size(); ++i)
            EXPECT_THAT(old_one.warnings[i], HasSubstr(scene.warnings[i]));
    }

    TemporaryFolder folder_;
};

TEST_F(OldScenes, AreThoseOfVersion3) {
    for (const auto& group : {cameras(), materials(), lights(), media_and_instances()})
        for (const OldScene& scene : group) {
            SCOPED_TRACE(scene.name);
            expect_same(scene);
        }
}

TEST_F(OldScenes, HaveTheTexturesOfVersion3) {
    const auto bitmap = [](const std::string& parameters) {
        return ball(
            "<bsdf type='diffuse'><texture type='bitmap' name='reflectance'><string name='filename' "
            "value='spots.ppm'/>" +
            parameters + "</texture></bsdf>");
    };
    const auto expect = [&](const std::string& old_parameters, const std::string& new_parameters,
                            const std::vector<std::string>& warnings) {
        expect_same({"bitmap", "0.6.0", old_sensor + sky + bitmap(old_parameters),
                     new_sensor + sky + bitmap(new_parameters), warnings});
    };
    expect(
        "<string name='filterType' value='ewa'/><float name='maxAnisotropy' value='8'/><float name='gamma' "
        "value='-1'/>",
        "", {"'ewa'"});
    expect("<string name='filterType' value='trilinear'/><float name='gamma' value='1'/>",
           "<boolean name='raw' value='true'/>", {"'trilinear'"});
    expect("<string name='wrapMode' value='clamp'/><string name='wrapModeV' value='clamp'/>",
           "<string name='wrap_mode' value='clamp'/>", {});
    expect(
        "<string name='wrapModeU' value='mirror'/><string name='wrapModeV' value='mirror'/><float name='gamma' "
        "value='1.8'/>",
        "<string name='wrap_mode' value='mirror'/>", {"gamma of 1.8"});
}

TEST(OldVersions, AreRefusedBefore03AndAfter3) {
    for (const std::string version : {"0.2.0", "0", "4.0.0", "0.x", "", "-1.0"})
        EXPECT_EQ(input_error_of([&] { parse_scene("<scene version='" + version + "'/>", "t.xml"); }),
                  "t.xml:1:8: version '" + version + "' is not supported: only 0.3 to 3.x");
}

TEST(OldVersions, RefuseWhatIsNotKnownByItsName) {
    for (const std::string bsdf : {"ward", "roughdiffuse", "coating"})
        EXPECT_THAT(input_error_of([&] {
                        parse_scene("<scene version='0.6.0'>" + old_sensor + sky + ball("<bsdf type='" + bsdf + "'/>") +
                                        "</scene>",
                                    "t.xml");
                    }),
                    HasSubstr("the bsdf '" + bsdf + "' is not supported"));
}

TEST(OldVersions, RefuseMediaThatArePresets) {
    for (const std::string medium : {"", "<string name='material' value='Ketchup'/>"})
        EXPECT_THAT(input_error_of([&] {
                        parse_scene("<scene version='0.6.0'>" + old_sensor + sky +
                                        ball("<medium type='homogeneous' name='interior'>" + medium + "</medium>") +
                                        "</scene>",
                                    "t.xml");
                    }),
                    HasSubstr("medium 'homogeneous' does not take a parameter 'material'"));
}

TEST(OldVersions, RefuseWeightsThatDoNotFitTheMixture) {
    const auto error_of = [](const std::string& weights) {
        return input_error_of([&] {
            parse_scene("<scene version='0.6.0'>" + old_sensor + sky +
                            ball("<bsdf type='mixturebsdf'>" + weights +
                                 "<bsdf type='diffuse'/><bsdf type='plastic'/></bsdf>") +
                            "</scene>",
                        "t.xml");
        });
    };
    EXPECT_THAT(error_of(""), HasSubstr("a mixturebsdf needs 'weights'"));
    EXPECT_THAT(error_of("<string name='weights' value='0.2'/>"), HasSubstr("found 1 weights of 2 bsdfs"));
    for (const std::string wrong : {"0, 0", "-0.5, 1"})
        EXPECT_THAT(error_of("<string name='weights' value='" + wrong + "'/>"),
                    HasSubstr("must not be negative, and their sum must be above 0"));
}

TEST(OldVersions, WarnOfWhatNothingRefersTo) {
    const auto load = [](const std::string& shape) {
        return scene_of(scene_xml(new_sensor + "<bsdf type='ward' id='unused'/>" + sky + shape));
    };
    const auto scene = load(ball(""));
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_THAT(scene.warnings[0], HasSubstr("the bsdf 'ward' is not supported"));
    EXPECT_THAT(input_error_of([&] { load(ball("<ref id='unused'/>")); }),
                HasSubstr("the bsdf 'ward' is not supported"));
}

}  // namespace
}  // namespace gib::test::xml_upgrade_test
