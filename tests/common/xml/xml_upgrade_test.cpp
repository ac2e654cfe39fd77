// Scenes of Mitsuba 0.3 to 1.x. Each is written twice, as its version has it and as version 3 does, and both give the same
// image bit for bit. What differs is stated in common/xml/xml_upgrade.h.

#include "common/color/srgb.h"
#include "tests/support/scene_errors.h"
#include "tests/support/scene_fixtures.h"

namespace gib::test::xml_upgrade_test {
namespace {

struct OldScene {
    std::string name, version, old_body, new_body;
    std::vector<std::string> warnings = {};  ///< a part of each, in their order
};

std::string film(const std::string& type, int width, int height, const std::string& filter) {
    return element("film", type, integer("width", width), integer("height", height), element("rfilter", filter));
}
/// The to_world of versions before 2.
template <class... Steps>
std::string old_to_world(const Steps&... steps) {
    return "<transform name='toWorld'>" + (std::string() + ... + steps) + "</transform>";
}
std::string old_look_at(const std::string& origin) {
    return old_to_world("<lookAt origin='" + origin + "' target='0,0,0' up='0,1,0'/>");
}
/// A colour of versions before 2.
std::string old_rgb(const std::string& name, const std::string& values) {
    return value_element("spectrum", name, values);
}

const std::string old_sensor = camera(60, old_look_at("0,1,4"), film("hdrfilm", 12, 8, "box"));
const std::string new_sensor = camera(60, to_world(look_at("0,1,4", "0,0,0")), film("hdrfilm", 12, 8, "box"));
const std::string sky = constant_light(0.5), ball = shape("sphere");
const std::string image = filename("spots.ppm"), grey = bsdf("diffuse"), plastic = bsdf("plastic"),
                  depth = element("integrator", "path", integer("max_depth", 2)), gold = text("material", "Au");

using Warnings = std::vector<std::string>;

OldScene seen_by(const std::string& name, const std::string& version, const std::string& old_view,
                 const std::string& new_view, const Warnings& warnings = {}) {
    return {name, version, old_view + sky + ball, new_view + sky + ball, warnings};
}
OldScene under_sky(const std::string& name, const std::string& old_shape, const std::string& new_shape,
                   const Warnings& warnings = {}) {
    return {name, "0.6.0", old_sensor + sky + old_shape, new_sensor + sky + new_shape, warnings};
}
OldScene with_bsdf(const std::string& name, const std::string& old_bsdf, const std::string& new_bsdf,
                   const Warnings& warnings = {}) {
    return under_sky(name, shape("sphere", old_bsdf), shape("sphere", new_bsdf), warnings);
}
OldScene with_medium(const std::string& name, const std::string& old_medium, const std::string& new_medium,
                     const Warnings& warnings = {}) {
    return under_sky(name, shape("cube", old_medium, bsdf("null")), shape("cube", new_medium, bsdf("null")), warnings);
}
OldScene lit_by(const std::string& name, const std::string& version, const std::string& old_light,
                const std::string& new_light, const Warnings& warnings = {}) {
    return {name, version, old_sensor + ball + old_light, new_sensor + ball + new_light, warnings};
}

std::vector<OldScene> cameras() {
    return {
        seen_by("perspective", "0.6.0",
                element("sensor", "perspective", text("fovAxis", "smaller"), number("fov", 50), number("nearClip", 0.5),
                        number("farClip", 100), number("focusDistance", 4), old_look_at("0,1,4"),
                        element("sampler", "sobol", integer("sampleCount", 8), integer("scramble", 3)),
                        element("film", "ldrfilm", integer("width", 10), integer("height", 8), number("gamma", 2.2),
                                text("tonemapMethod", "gamma"), flag("banner", false), integer("cropOffsetX", 2),
                                integer("cropWidth", 6), element("rfilter", "mitchell"))),
                element("sensor", "perspective", text("fov_axis", "smaller"), number("fov", 50),
                        number("near_clip", 0.5), number("far_clip", 100), to_world(look_at("0,1,4", "0,0,0")),
                        element("sampler", "independent", integer("sample_count", 8)),
                        element("film", "hdrfilm", integer("width", 10), integer("height", 8),
                                integer("crop_offset_x", 2), integer("crop_width", 6), element("rfilter", "gaussian"))),
                {"mitchell"}),
        seen_by(
            "thin lens", "0.5.0",
            element("sensor", "thinlens", number("fov", 50), number("apertureRadius", 0.2), number("focusDistance", 3),
                    old_to_world(translate(0, 0, 4), rotate('y', 180), scale(1, 1, 1), translate(0, 0, 8)),
                    film("mfilm", 8, 8, "tent")),
            element("sensor", "thinlens", number("fov", 50), number("aperture_radius", 0.2),
                    number("focus_distance", 3),
                    to_world(translate(0, 0, 4), rotate('y', 180), scale(1, 1, 1), translate(0, 0, 8)),
                    film("hdrfilm", 8, 8, "tent"))),
        {"camera of 0.3", "0.3.0",
         element("camera", "perspective", number("fov", 50), old_look_at("0.5,1,4"), film("exrfilm", 12, 8, "box")) +
             element("luminaire", "point", point("position", 2, 3, 2), spectrum("intensity", 20)) +
             element("luminaire", "constant", spectrum("intensity", 0.5)) + ball,
         camera(50, text("fov_axis", "smaller"), to_world(scale(-1, 1, 1), look_at("0.5,1,4", "0,0,0")),
                film("hdrfilm", 12, 8, "box")) +
             point_light(2, 3, 2, 20) + sky + ball},
        seen_by(
            "integrator", "0.6.0",
            element("integrator", "photonmapper", integer("maxDepth", 2), integer("globalPhotons", 1000)) + old_sensor,
            depth + new_sensor, {"integrator 'photonmapper'"}),
        seen_by("integrator in another", "0.6.0",
                element("integrator", "adaptive", number("maxError", 0.05),
                        element("integrator", "path", integer("maxDepth", 2), flag("strictNormals"))) +
                    old_sensor,
                depth + new_sensor, {"integrator 'adaptive'"}),
    };
}

std::vector<OldScene> materials() {
    return {
        with_bsdf("colours", bsdf("diffuse", old_rgb("diffuseReflectance", "0.2, 0.5 0.8")), one_sided("0.2 0.5 0.8")),
        with_bsdf("the other name of a rough diffuse reflectance",
                  bsdf("roughdiffuse", old_rgb("diffuseReflectance", "0.2, 0.5 0.8")),
                  bsdf("roughdiffuse", rgb("reflectance", "0.2 0.5 0.8"))),
        with_bsdf("sRGB in hexadecimal digits", bsdf("diffuse", "<srgb name='reflectance' value='#ff8000'/>"),
                  one_sided("1 " + fmt::format("{}", linear_from_srgb(128.f / 255)) + " 0")),
        with_bsdf("checkerboard",
                  bsdf("diffuse", named("texture", "reflectance", "checkerboard", number("uscale", 3),
                                        number("voffset", 0.25), number("vscale", 2), spectrum("color0", 0.9))),
                  bsdf("diffuse", named("texture", "reflectance", "checkerboard",
                                        to_uv(translate(0, 0.25, 0), scale(3, 2, 1)), rgb("color0", 0.9)))),
        with_bsdf("conductor in water", bsdf("conductor", rgb("eta", 0.2), rgb("k", 3.6), text("extEta", "water")),
                  bsdf("conductor", rgb("eta", 0.15003751), rgb("k", 2.7006752))),
        with_bsdf(
            "rough conductor",
            bsdf("roughconductor", gold, text("distribution", "phong"), number("alphaU", 0.2), number("alphaV", 0.3)),
            bsdf("roughconductor", gold, text("distribution", "beckmann"), number("alpha_u", 0.2),
                 number("alpha_v", 0.3)),
            {"'phong'"}),
        with_bsdf("glass", bsdf("dielectric", text("intIOR", "water"), number("extIOR", 1)),
                  bsdf("dielectric", text("int_ior", "water"), number("ext_ior", 1))),
        with_bsdf(
            "rough plastic",
            bsdf("roughplastic", number("alpha", 0.2), old_rgb("diffuseReflectance", "0.1,0.4,0.2"), flag("nonlinear")),
            bsdf("roughplastic", number("alpha", 0.2), rgb("diffuse_reflectance", "0.1,0.4,0.2"), flag("nonlinear"))),
        with_bsdf("bump map of 0.6",
                  bsdf("bumpmap",
                       texture("scale", number("scale", 0.05), texture("bitmap", image, number("uscale", 3))), grey),
                  bsdf("bumpmap", texture("bitmap", image, to_uv(scale(3, 1, 1))), number("scale", 0.05), grey)),
        with_bsdf("mixture", bsdf("mixturebsdf", text("weights", "0.75, 0.25"), grey, plastic),
                  bsdf("blendbsdf", number("weight", 0.25), grey, plastic)),
        with_bsdf("mixture that absorbs a quarter",
                  bsdf("mixturebsdf", text("weights", "0.25, 0.25, 0.25"), grey, plastic, bsdf("phong")),
                  bsdf("blendbsdf", number("weight", 0.25),
                       bsdf("blendbsdf", number("weight", 0.3333333333333333),
                            bsdf("blendbsdf", number("weight", 0.5), grey, plastic), bsdf("phong")),
                       one_sided("0"))),
        with_bsdf("mixture of weights above 1", bsdf("mixturebsdf", text("weights", "3, 1"), grey, plastic),
                  bsdf("blendbsdf", number("weight", 0.25), grey, plastic), {"the weights sum to 4"}),
        with_bsdf("phong above 1", bsdf("phong", rgb("diffuseReflectance", "1 0.5 0"), rgb("specularReflectance", 8.9)),
                  bsdf("phong", rgb("diffuse_reflectance", "0.1 0.05 0"), rgb("specular_reflectance", 0.89)),
                  {"both are scaled down by 0.1"}),
        with_bsdf("white above 1",
                  bsdf("plastic", old_rgb("diffuseReflectance", "1.1, 0.55, 0"), number("specularReflectance", 1)),
                  bsdf("plastic", rgb("diffuse_reflectance", "0.99 0.495 0")), {"'diffuse_reflectance' is above 1"}),
        with_bsdf("roughness in one direction",
                  bsdf("roughconductor", gold, number("alpha", 0.2), number("alphaV", 0.4)),
                  bsdf("roughconductor", gold, number("alpha_u", 0.2), number("alpha_v", 0.4))),
        with_bsdf("copper", bsdf("conductor"), bsdf("conductor", text("material", "Cu"))),
        with_bsdf("rough copper", bsdf("roughconductor", number("alpha", 0.3)),
                  bsdf("roughconductor", text("material", "Cu"), number("alpha", 0.3))),
        with_bsdf("mirror", bsdf("conductor", text("material", "none")), bsdf("conductor")),
        with_bsdf("normal map without a name",
                  bsdf("normalmap",
                       texture("bitmap", image, number("gamma", 1), number("uvscale", 2), number("vscale", 3)), grey),
                  bsdf("normalmap", named("texture", "normalmap", "bitmap", image, flag("raw"), to_uv(scale(2, 3, 1))),
                       grey)),
        with_bsdf("phong", bsdf("phong", spectrum("diffuseReflectance", 0.8), spectrum("specularReflectance", 0.8)),
                  bsdf("phong", rgb("diffuse_reflectance", 0.495), rgb("specular_reflectance", 0.495)),
                  {"scaled down"}),
        {"bump map of 0.4", "0.4.1", old_sensor + sky + shape("sphere", bsdf("bump", texture("bitmap", image), grey)),
         new_sensor + sky + shape("sphere", bsdf("bumpmap", texture("bitmap", image), grey))},
    };
}

std::vector<OldScene> lights() {
    const std::string z_up = "<matrix value='0 -1 0 0 0 0 1 0 -1 0 0 0 0 0 0 1'/>";  // of version 3, seen from before
    return {
        lit_by("lights", "0.6.0",
               emitter("spot", old_rgb("intensity", "9,8,7"), number("cutoffAngle", 40), number("beamWidth", 20),
                       old_to_world("<lookAt origin='2,2,2' target='0,0,0'/>")) +
                   emitter("directional", vector("direction", 0, -1, -1), spectrum("irradiance", 0.5),
                           number("samplingWeight", 2)),
               emitter("spot", rgb("intensity", "9,8,7"), number("cutoff_angle", 40), number("beam_width", 20),
                       to_world("<lookat origin='2,2,2' target='0,0,0'/>")) +
                   emitter("directional", vector("direction", 0, -1, -1), rgb("irradiance", 0.5))),
        lit_by("environment", "0.6.0", emitter("envmap", image, number("gamma", 2.2), flag("cache", false)),
               emitter("envmap", image), {"'gamma' has no effect: the kind of the image decides"}),
        lit_by("sky of 0.6", "0.6.0",
               emitter("sunsky", number("turbidity", 4), vector("sunDirection", 1, 1, 2), number("skyScale", 3),
                       number("sunRadiusScale", 2), spectrum("albedo", 0.2), integer("resolution", 256)),
               emitter("sunsky", number("turbidity", 4), vector("sun_direction", 1, 1, 2), number("sky_scale", 3),
                       number("sun_radius_scale", 2), rgb("albedo", 0.2), to_world(z_up))),
        // North is y there, and x in version 3. The ground has the albedo 0.2 there, and 0.3 in version 3.
        lit_by("sky of 0.5 with z upwards", "0.5.0", emitter("sky", number("hour", 10), old_to_world(rotate('x', 90))),
               emitter("sky", number("hour", 10), rgb("albedo", 0.2), to_world(z_up, rotate('x', 90)))),
        lit_by(
            "blackbody lamp", "0.6.0",
            emitter("point", point("position", 2, 3, 2),
                    "<blackbody name='intensity' temperature='3000K' scale='0.05'/>"),
            emitter("point", point("position", 2, 3, 2),
                    named("spectrum", "intensity", "blackbody", number("temperature", 3000), number("scale", 0.05)))),
        lit_by("area lamp in a file that is included", "0.6.0", "<include filename='lamp.xml'/>",
               shape("rectangle", to_world(rotate('x', 90), translate(0, 2, 0)), area_light(3))),
    };
}

template <class... Content>
std::string inside(const std::string& type, const Content&... content) {
    return named("medium", "interior", type, content...);
}

std::vector<OldScene> media_and_instances() {
    const std::string phase = element("phase", "hg", number("g", 0.3)),
                      group = with_id("shape", "shapegroup", "g", shape("sphere", radius(0.3)));
    return {
        with_medium("fog",
                    inside("homogeneous", spectrum("sigmaS", 0.5), spectrum("sigmaA", 0.25),
                           number("densityMultiplier", 2), phase),
                    inside("homogeneous", rgb("sigma_s", 0.5), rgb("sigma_a", 0.25), number("scale", 2), phase)),
        with_medium(
            "sampling of distances",
            inside("homogeneous", spectrum("sigmaT", 0.5), spectrum("albedo", 0.5), number("mediumSamplingWeight", 0.5),
                   text("strategy", "balance"), number("samplingDensity", 2)),
            inside("homogeneous", number("sigma_t", 0.5), number("albedo", 0.5))),
        with_medium("smoke",
                    inside("heterogeneous", text("method", "woodcock"), number("stepSize", 0.1),
                           named("volume", "density", "constvolume", number("value", 0.7)),
                           named("volume", "albedo", "constvolume", old_rgb("value", "0.9,0.5,0.2")),
                           number("densityMultiplier", 2)),
                    inside("homogeneous", number("sigma_t", 0.7), rgb("albedo", "0.9,0.5,0.2"), number("scale", 2))),
        with_medium("medium without a scattering coefficient", inside("homogeneous", spectrum("sigmaA", 0.5)),
                    inside("homogeneous", rgb("sigma_a", 0.5)), {"'sigma_s' is not given"}),
        under_sky("instances", group + shape("instance", reference("g"), old_to_world(translate(1, 0, 0))),
                  group + shape("instance", reference("g"), to_world(translate(1, 0, 0)))),
        {"parameters", "0.6.0",
         "<default name='maxDepth' value='2'/><default name='grey' value='0.25,0.25,0.25'/>" +
             element("integrator", "path", value_element("integer", "maxDepth", "$maxDepth")) + old_sensor + sky +
             shape("sphere", bsdf("diffuse", old_rgb("reflectance", "$grey"))),
         depth + new_sensor + sky + shape("sphere", one_sided("0.25"))},
    };
}

/// The folder with the files that the scenes name.
class OldScenes : public ::testing::Test {
protected:
    OldScenes() {
        folder_.write("lamp.xml", "<shape version='0.5.0' type='rectangle'>" +
                                      old_to_world(rotate('x', 90), translate(0, 2, 0)) +
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
        // Reflectances that are scaled down differ by a rounding from typed ones.
        EXPECT_THAT(render(old_one, "path", 4).total().rgb,
                    ::testing::Pointwise(::testing::FloatNear(1e-5f), render(new_one, "path", 4).total().rgb));
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
        return bsdf("diffuse", named("texture", "reflectance", "bitmap", image, parameters));
    };
    const auto expect = [&](const std::string& old_parameters, const std::string& new_parameters,
                            const Warnings& warnings) {
        expect_same(with_bsdf("bitmap", bitmap(old_parameters), bitmap(new_parameters), warnings));
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

/// The error of a ball of version 0.6 with this content.
std::string error_of(const std::string& content) {
    const std::string body = old_sensor + sky + shape("sphere", content);
    return input_error_of([&] { parse_scene("<scene version='0.6.0'>" + body + "</scene>", "t.xml"); });
}

TEST(OldVersions, RefuseWhatIsNotKnownByItsName) {
    for (const std::string type : {"irawan", "hk", "difftrans"})
        EXPECT_THAT(error_of(bsdf(type)), HasSubstr("the bsdf '" + type + "' is not supported"));
}

TEST(OldVersions, RefuseMediaThatArePresets) {
    for (const std::string& preset : {std::string(), text("material", "Ketchup")})
        EXPECT_THAT(error_of(inside("homogeneous", preset)),
                    HasSubstr("medium 'homogeneous' does not take a parameter 'material'"));
}

TEST(OldVersions, RefuseWeightsThatDoNotFitTheMixture) {
    for (const auto& [weights, message] :
         {std::pair(std::string(), "a mixturebsdf needs 'weights'"),
          {text("weights", "0.2"), "found 1 weights of 2 bsdfs"},
          {text("weights", "0, 0"), "must not be negative, and their sum must be above 0"},
          {text("weights", "-0.5, 1"), "must not be negative, and their sum must be above 0"}})
        EXPECT_THAT(error_of(bsdf("mixturebsdf", weights, grey, plastic)), HasSubstr(message));
}

TEST(OldVersions, WarnOfWhatNothingRefersTo) {
    const auto load_with = [](const std::string& content) {
        return Scene(new_sensor, with_id("bsdf", "hk", "unused"), sky, shape("sphere", content)).load();
    };
    EXPECT_THAT(load_with("").warnings, ::testing::ElementsAre(HasSubstr("the bsdf 'hk' is not supported")));
    EXPECT_THAT(input_error_of([&] { load_with(reference("unused")); }), HasSubstr("the bsdf 'hk' is not supported"));
}

}  // namespace
}  // namespace gib::test::xml_upgrade_test
