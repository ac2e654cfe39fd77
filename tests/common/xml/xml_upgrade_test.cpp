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
    camera(60, "<transform name='toWorld'><lookAt origin='0,1,4' target='0,0,0' up='0,1,0'/></transform>",
           element("film", "hdrfilm", integer("width", 12), integer("height", 8), element("rfilter", "box")));
const std::string new_sensor =
    camera(60, to_world(look_at("0,1,4", "0,0,0")),
           element("film", "hdrfilm", integer("width", 12), integer("height", 8), element("rfilter", "box")));
const std::string sky = constant_light(0.5);

const std::string spots = texture("bitmap", filename("spots.ppm"));

/// A ball with a bsdf.
std::string ball(const std::string& bsdf) { return shape("sphere", bsdf); }

OldScene with_bsdf(const std::string& name, const std::string& old_bsdf, const std::string& new_bsdf,
                   const std::vector<std::string>& warnings = {}) {
    return {name, "0.6.0", old_sensor + sky + ball(old_bsdf), new_sensor + sky + ball(new_bsdf), warnings};
}

std::vector<OldScene> cameras() {
    return {
        {"perspective",
         "0.6.0",
         element("sensor", "perspective", text("fovAxis", "smaller"), number("fov", 50), number("nearClip", 0.5),
                 number("farClip", 100), number("focusDistance", 4),
                 "<transform name='toWorld'><lookAt origin='0,1,4' target='0,0,0' up='0,1,0'/></transform>",
                 element("sampler", "sobol", integer("sampleCount", 8), integer("scramble", 3)),
                 element("film", "ldrfilm", integer("width", 10), integer("height", 8), number("gamma", 2.2),
                         text("tonemapMethod", "gamma"), flag("banner", false), integer("cropOffsetX", 2),
                         integer("cropWidth", 6), element("rfilter", "mitchell"))) +
             sky + ball(""),
         element("sensor", "perspective", text("fov_axis", "smaller"), number("fov", 50), number("near_clip", 0.5),
                 number("far_clip", 100), to_world(look_at("0,1,4", "0,0,0")),
                 element("sampler", "independent", integer("sample_count", 8)),
                 element("film", "hdrfilm", integer("width", 10), integer("height", 8), integer("crop_offset_x", 2),
                         integer("crop_width", 6), element("rfilter", "gaussian"))) +
             sky + ball(""),
         {"mitchell"}},
        {"thin lens", "0.5.0",
         element("sensor", "thinlens", number("fov", 50), number("apertureRadius", 0.2), number("focusDistance", 3),
                 "<transform name='toWorld'>", translate(0, 0, 4), rotate('y', 180), scale(1, 1, 1), translate(0, 0, 8),
                 "</transform>",
                 element("film", "mfilm", integer("width", 8), integer("height", 8), element("rfilter", "tent"))) +
             sky + ball(""),
         element("sensor", "thinlens", number("fov", 50), number("aperture_radius", 0.2), number("focus_distance", 3),
                 to_world(translate(0, 0, 4), rotate('y', 180), scale(1, 1, 1), translate(0, 0, 8)),
                 element("film", "hdrfilm", integer("width", 8), integer("height", 8), element("rfilter", "tent"))) +
             sky + ball("")},
        {"camera of 0.3", "0.3.0",
         "<camera type='perspective'>" + number("fov", 50) +
             "<transform name='toWorld'><lookAt origin='0.5,1,4' target='0,0,0' up='0,1,0'/></transform>" +
             element("film", "exrfilm", integer("width", 12), integer("height", 8), element("rfilter", "box")) +
             "</camera><luminaire type='point'>" + point("position", 2, 3, 2) + spectrum("intensity", 20) +
             "</luminaire><luminaire type='constant'>" + spectrum("intensity", 0.5) + "</luminaire>" + ball(""),
         camera(50, text("fov_axis", "smaller"), to_world(scale(-1, 1, 1), look_at("0.5,1,4", "0,0,0")),
                element("film", "hdrfilm", integer("width", 12), integer("height", 8), element("rfilter", "box"))) +
             emitter("point", point("position", 2, 3, 2), rgb("intensity", 20)) + sky + ball("")},
        {"integrator",
         "0.6.0",
         element("integrator", "photonmapper", integer("maxDepth", 2), integer("globalPhotons", 1000)) + old_sensor +
             sky + ball(""),
         element("integrator", "path", integer("max_depth", 2)) + new_sensor + sky + ball(""),
         {"integrator 'photonmapper'"}},
        {"integrator in another",
         "0.6.0",
         element("integrator", "adaptive", number("maxError", 0.05),
                 element("integrator", "path", integer("maxDepth", 2), flag("strictNormals"))) +
             old_sensor + sky + ball(""),
         element("integrator", "path", integer("max_depth", 2)) + new_sensor + sky + ball(""),
         {"integrator 'adaptive'"}},
    };
}

std::vector<OldScene> materials() {
    return {
        with_bsdf("colours", bsdf("diffuse", "<spectrum name='diffuseReflectance' value='0.2, 0.5 0.8'/>"),
                  one_sided("0.2 0.5 0.8")),
        with_bsdf("sRGB in hexadecimal digits", bsdf("diffuse", "<srgb name='reflectance' value='#ff8000'/>"),
                  one_sided("1 " + fmt::format("{}", linear_from_srgb(128.f / 255)) + " 0")),
        with_bsdf("checkerboard",
                  bsdf("diffuse", named("texture", "reflectance", "checkerboard", number("uscale", 3),
                                        number("voffset", 0.25), number("vscale", 2), spectrum("color0", 0.9))),
                  bsdf("diffuse", named("texture", "reflectance", "checkerboard",
                                        to_uv(translate(0, 0.25, 0), scale(3, 2, 1)), rgb("color0", 0.9)))),
        with_bsdf("conductor in water", bsdf("conductor", rgb("eta", 0.2), rgb("k", 3.6), text("extEta", "water")),
                  bsdf("conductor", rgb("eta", 0.15003751), rgb("k", 2.7006752))),
        with_bsdf("rough conductor",
                  bsdf("roughconductor", text("material", "Au"), text("distribution", "phong"), number("alphaU", 0.2),
                       number("alphaV", 0.3)),
                  bsdf("roughconductor", text("material", "Au"), text("distribution", "beckmann"),
                       number("alpha_u", 0.2), number("alpha_v", 0.3)),
                  {"'phong'"}),
        with_bsdf("glass", bsdf("dielectric", text("intIOR", "water"), number("extIOR", 1)),
                  bsdf("dielectric", text("int_ior", "water"), number("ext_ior", 1))),
        with_bsdf(
            "rough plastic",
            bsdf("roughplastic", number("alpha", 0.2), "<spectrum name='diffuseReflectance' value='0.1,0.4,0.2'/>",
                 flag("nonlinear")),
            bsdf("roughplastic", number("alpha", 0.2), rgb("diffuse_reflectance", "0.1,0.4,0.2"), flag("nonlinear"))),
        with_bsdf(
            "bump map of 0.6",
            bsdf("bumpmap",
                 texture("scale", number("scale", 0.05), texture("bitmap", filename("spots.ppm"), number("uscale", 3))),
                 bsdf("diffuse")),
            bsdf("bumpmap", texture("bitmap", filename("spots.ppm"), to_uv(scale(3, 1, 1))), number("scale", 0.05),
                 bsdf("diffuse"))),
        with_bsdf("mixture", bsdf("mixturebsdf", text("weights", "0.75, 0.25"), bsdf("diffuse"), bsdf("plastic")),
                  bsdf("blendbsdf", number("weight", 0.25), bsdf("diffuse"), bsdf("plastic"))),
        with_bsdf(
            "mixture that absorbs a quarter",
            bsdf("mixturebsdf", text("weights", "0.25, 0.25, 0.25"), bsdf("diffuse"), bsdf("plastic"), bsdf("phong")),
            bsdf("blendbsdf", number("weight", 0.25),
                 bsdf("blendbsdf", number("weight", 0.3333333333333333),
                      bsdf("blendbsdf", number("weight", 0.5), bsdf("diffuse"), bsdf("plastic")), bsdf("phong")),
                 one_sided("0"))),
        with_bsdf("mixture of weights above 1",
                  bsdf("mixturebsdf", text("weights", "3, 1"), bsdf("diffuse"), bsdf("plastic")),
                  bsdf("blendbsdf", number("weight", 0.25), bsdf("diffuse"), bsdf("plastic")),
                  {"the weights sum to 4"}),
        with_bsdf("white above 1",
                  bsdf("plastic", "<spectrum name='diffuseReflectance' value='1.1, 0.55, 0'/>",
                       number("specularReflectance", 1)),
                  bsdf("plastic", rgb("diffuse_reflectance", "0.99 0.495 0")), {"'diffuse_reflectance' is above 1"}),
        with_bsdf("roughness in one direction",
                  bsdf("roughconductor", text("material", "Au"), number("alpha", 0.2), number("alphaV", 0.4)),
                  bsdf("roughconductor", text("material", "Au"), number("alpha_u", 0.2), number("alpha_v", 0.4))),
        with_bsdf("copper", bsdf("conductor"), bsdf("conductor", text("material", "Cu"))),
        with_bsdf("rough copper", bsdf("roughconductor", number("alpha", 0.3)),
                  bsdf("roughconductor", text("material", "Cu"), number("alpha", 0.3))),
        with_bsdf("mirror", bsdf("conductor", text("material", "none")), bsdf("conductor")),
        with_bsdf(
            "normal map without a name",
            bsdf(
                "normalmap",
                texture("bitmap", filename("spots.ppm"), number("gamma", 1), number("uvscale", 2), number("vscale", 3)),
                bsdf("diffuse")),
            bsdf("normalmap",
                 named("texture", "normalmap", "bitmap", filename("spots.ppm"), flag("raw"), to_uv(scale(2, 3, 1))),
                 bsdf("diffuse"))),
        with_bsdf("phong", bsdf("phong", spectrum("diffuseReflectance", 0.8), spectrum("specularReflectance", 0.8)),
                  bsdf("phong", rgb("diffuse_reflectance", 0.5), rgb("specular_reflectance", 0.5)), {"scaled down"}),
        {"bump map of 0.4", "0.4.1", old_sensor + sky + ball(bsdf("bump", spots, bsdf("diffuse"))),
         new_sensor + sky + ball(bsdf("bumpmap", spots, bsdf("diffuse")))},
    };
}

std::vector<OldScene> lights() {
    return {
        {"lights", "0.6.0",
         old_sensor + ball("") +
             emitter("spot", "<spectrum name='intensity' value='9,8,7'/>", number("cutoffAngle", 40),
                     number("beamWidth", 20),
                     "<transform name='toWorld'><lookAt origin='2,2,2' target='0,0,0'/></transform>") +
             emitter("directional", vector("direction", 0, -1, -1), spectrum("irradiance", 0.5),
                     number("samplingWeight", 2)),
         new_sensor + ball("") +
             emitter("spot", rgb("intensity", "9,8,7"), number("cutoff_angle", 40), number("beam_width", 20),
                     to_world("<lookat origin='2,2,2' target='0,0,0'/>")) +
             emitter("directional", vector("direction", 0, -1, -1), rgb("irradiance", 0.5))},
        {"environment",
         "0.6.0",
         old_sensor + ball("") + emitter("envmap", filename("spots.ppm"), number("gamma", 2.2), flag("cache", false)),
         new_sensor + ball("") + emitter("envmap", filename("spots.ppm")),
         {"'gamma' has no effect: the kind of the image decides"}},
        {"sky of 0.6",
         "0.6.0",
         old_sensor + ball("") +
             emitter("sunsky", number("turbidity", 4), vector("sunDirection", 1, 1, 2), number("skyScale", 3),
                     number("sunRadiusScale", 2), spectrum("albedo", 0.2), integer("resolution", 256)),
         new_sensor + ball("") +
             emitter("sunsky", number("turbidity", 4), vector("sun_direction", 1, 1, 2), number("sky_scale", 3),
                     number("sun_radius_scale", 2), to_world("<matrix value='0 -1 0 0 0 0 1 0 -1 0 0 0 0 0 0 1'/>")),
         {"Preetham"}},
        {"sky of 0.5 with z upwards",
         "0.5.0",
         old_sensor + ball("") +
             emitter("sky", number("hour", 10), "<transform name='toWorld'>", rotate('x', 90), "</transform>"),
         // North is y there, and x in version 3.
         new_sensor + ball("") +
             emitter("sky", number("hour", 10),
                     to_world("<matrix value='0 -1 0 0 0 0 1 0 -1 0 0 0 0 0 0 1'/>", rotate('x', 90))),
         {"Preetham"}},
        {"blackbody lamp", "0.6.0",
         old_sensor + ball("") +
             emitter("point", point("position", 2, 3, 2),
                     "<blackbody name='intensity' temperature='3000K' scale='0.05'/>"),
         new_sensor + ball("") +
             emitter("point", point("position", 2, 3, 2),
                     named("spectrum", "intensity", "blackbody", number("temperature", 3000), number("scale", 0.05)))},
        {"area lamp in a file that is included", "0.6.0", old_sensor + "<include filename='lamp.xml'/>" + ball(""),
         new_sensor + shape("rectangle", to_world(rotate('x', 90), translate(0, 2, 0)), area_light(3)) + ball("")},
    };
}

std::vector<OldScene> media_and_instances() {
    return {
        {"fog", "0.6.0",
         old_sensor + sky +
             shape("cube",
                   named("medium", "interior", "homogeneous", spectrum("sigmaS", 0.5), spectrum("sigmaA", 0.25),
                         number("densityMultiplier", 2), element("phase", "hg", number("g", 0.3))),
                   bsdf("null")),
         new_sensor + sky +
             shape("cube",
                   named("medium", "interior", "homogeneous", rgb("sigma_s", 0.5), rgb("sigma_a", 0.25),
                         number("scale", 2), element("phase", "hg", number("g", 0.3))),
                   bsdf("null"))},
        {"smoke", "0.6.0",
         old_sensor + sky +
             shape("cube",
                   named("medium", "interior", "heterogeneous", text("method", "woodcock"), number("stepSize", 0.1),
                         named("volume", "density", "constvolume", number("value", 0.7)),
                         named("volume", "albedo", "constvolume", "<spectrum name='value' value='0.9,0.5,0.2'/>"),
                         number("densityMultiplier", 2)),
                   bsdf("null")),
         new_sensor + sky +
             shape("cube",
                   named("medium", "interior", "homogeneous", number("sigma_t", 0.7), rgb("albedo", "0.9,0.5,0.2"),
                         number("scale", 2)),
                   bsdf("null"))},
        {"medium without a scattering coefficient",
         "0.6.0",
         old_sensor + sky +
             shape("cube", named("medium", "interior", "homogeneous", spectrum("sigmaA", 0.5)), bsdf("null")),
         new_sensor + sky +
             shape("cube", named("medium", "interior", "homogeneous", rgb("sigma_a", 0.5)), bsdf("null")),
         {"'sigma_s' is not given"}},
        {"instances", "0.6.0",
         old_sensor + sky + with_id("shape", "shapegroup", "g", shape("sphere", radius(0.3))) +
             shape("instance", reference("g"), "<transform name='toWorld'>", translate(1, 0, 0), "</transform>"),
         new_sensor + sky + with_id("shape", "shapegroup", "g", shape("sphere", radius(0.3))) +
             shape("instance", reference("g"), to_world(translate(1, 0, 0)))},
        {"parameters", "0.6.0",
         "<default name='maxDepth' value='2'/><default name='grey' value='0.25,0.25,0.25'/>" +
             element("integrator", "path", "<integer name='maxDepth' value='$maxDepth'/>") + old_sensor + sky +
             ball(bsdf("diffuse", "<spectrum name='reflectance' value='$grey'/>")),
         element("integrator", "path", integer("max_depth", 2)) + new_sensor + sky + ball(one_sided("0.25"))},
    };
}

/// The folder with the files that the scenes name.
class OldScenes : public ::testing::Test {
protected:
    OldScenes() {
        folder_.write("lamp.xml", "<shape version='0.5.0' type='rectangle'><transform name='toWorld'>" +
                                      rotate('x', 90) + translate(0, 2, 0) + "</transform>" +
                                      emitter("area", spectrum("radiance", 3)) + "</shape>");
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
        return ball(bsdf("diffuse", named("texture", "reflectance", "bitmap", filename("spots.ppm"), parameters)));
    };
    const auto expect = [&](const std::string& old_parameters, const std::string& new_parameters,
                            const std::vector<std::string>& warnings) {
        expect_same({"bitmap", "0.6.0", old_sensor + sky + bitmap(old_parameters),
                     new_sensor + sky + bitmap(new_parameters), warnings});
    };
    expect(text("filterType", "ewa") + number("maxAnisotropy", 8) + number("gamma", -1), "", {"'ewa'"});
    expect(text("filterType", "trilinear") + number("gamma", 1), flag("raw"), {"'trilinear'"});
    expect(text("wrapMode", "clamp") + text("wrapModeV", "clamp"), text("wrap_mode", "clamp"), {});
    expect(text("wrapModeU", "mirror") + text("wrapModeV", "mirror") + number("gamma", 1.8),
           text("wrap_mode", "mirror"), {"gamma of 1.8"});
}

TEST(OldVersions, AreRefusedBefore03AndAfter3) {
    for (const std::string version : {"0.2.0", "0", "4.0.0", "0.x", "", "-1.0"})
        EXPECT_EQ(input_error_of([&] { parse_scene("<scene version='" + version + "'/>", "t.xml"); }),
                  "t.xml:1:8: version '" + version + "' is not supported: only 0.3 to 3.x");
}

TEST(OldVersions, RefuseWhatIsNotKnownByItsName) {
    for (const std::string bsdf : {"ward", "roughdiffuse", "coating"})
        EXPECT_THAT(input_error_of([&] {
                        parse_scene("<scene version='0.6.0'>" + old_sensor + sky + ball(bsdf(bsdf)) + "</scene>",
                                    "t.xml");
                    }),
                    HasSubstr("the bsdf '" + bsdf + "' is not supported"));
}

TEST(OldVersions, RefuseMediaThatArePresets) {
    for (const std::string medium : {"", text("material", "Ketchup")})
        EXPECT_THAT(input_error_of([&] {
                        parse_scene("<scene version='0.6.0'>" + old_sensor + sky +
                                        ball(named("medium", "interior", "homogeneous", medium)) + "</scene>",
                                    "t.xml");
                    }),
                    HasSubstr("medium 'homogeneous' does not take a parameter 'material'"));
}

TEST(OldVersions, RefuseWeightsThatDoNotFitTheMixture) {
    const auto error_of = [](const std::string& weights) {
        return input_error_of([&] {
            parse_scene("<scene version='0.6.0'>" + old_sensor + sky +
                            ball(bsdf("mixturebsdf", weights, bsdf("diffuse"), bsdf("plastic"))) + "</scene>",
                        "t.xml");
        });
    };
    EXPECT_THAT(error_of(""), HasSubstr("a mixturebsdf needs 'weights'"));
    EXPECT_THAT(error_of(text("weights", "0.2")), HasSubstr("found 1 weights of 2 bsdfs"));
    for (const std::string wrong : {"0, 0", "-0.5, 1"})
        EXPECT_THAT(error_of(text("weights", wrong)), HasSubstr("must not be negative, and their sum must be above 0"));
}

TEST(OldVersions, WarnOfWhatNothingRefersTo) {
    const auto load = [](const std::string& shape) {
        return scene_of(scene_xml(new_sensor + with_id("bsdf", "ward", "unused") + sky + shape));
    };
    const auto scene = load(ball(""));
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_THAT(scene.warnings[0], HasSubstr("the bsdf 'ward' is not supported"));
    EXPECT_THAT(input_error_of([&] { load(ball(reference("unused"))); }),
                HasSubstr("the bsdf 'ward' is not supported"));
}

}  // namespace
}  // namespace gib::test::xml_upgrade_test
