// Scene files with small faults, which other programs write or forgive. Each is read as it is meant, with a warning.

#include "common/color/srgb.h"
#include "common/scene/scene.h"
#include "tests/support/scene_errors.h"

#include <climits>

namespace gib::test::forgiven_faults_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;

const std::string ball = shape("sphere");

/// The diffuse light that the material of the first shape reflects.
Color diffuse_of(const LoadedScene& loaded) {
    return loaded.scene->material_of_shape(0).constant()->coefficients_local(Vec3(0, 0, 1)).diffuse;
}
float radius_of(const LoadedScene& loaded, std::size_t i = 0) {
    return std::get<Sphere>(loaded.scene->shapes()[i]).radius;
}
LoadedScene load_version(const std::string& version, const std::string& body) {
    return parse_scene("<scene" + version + ">" + sensor_xml + body + "</scene>", "t.xml");
}

TEST(ForgivenFaults, AValueWhoseParameterHasNoneIsThatOfThePlugin) {
    const std::string body =
        element("integrator", "path", value_element("integer", "max_depth", "$depth")) +
        shape("sphere", value_element("float", "radius", "$r"), bsdf("diffuse", rgb("reflectance", "$c")));
    const LoadedScene loaded = load(body);
    EXPECT_EQ(loaded.max_edges, INT_MAX);
    EXPECT_EQ(radius_of(loaded), 1);
    EXPECT_EQ(diffuse_of(loaded)[0], 0.5f);
    EXPECT_THAT(
        loaded.warnings,
        ElementsAre(HasSubstr("no value for $depth, $r, $c: 'max_depth' (line 2), 'radius' (line 2), 'reflectance' "
                              "(line 2) are left out, and their defaults count; --set depth=... --set r=... --set "
                              "c=... would give them")));
    const LoadedScene given = load(body, {{{"depth", "3"}, {"r", "2"}, {"c", "0.25"}}, {}});
    EXPECT_EQ(given.max_edges, 3);
    EXPECT_EQ(radius_of(given), 2);
    EXPECT_THAT(given.warnings, ElementsAre());
}

TEST(ForgivenFaults, ParametersThatAreNeededAreNamedAtOnce) {
    EXPECT_THAT(scene_error(shape("$kind", to_world("<scale x='$x' y='$y' z='$z'/>"))),
                HasSubstr("no value for $kind, $x, $y, $z: "));
    EXPECT_THAT(
        scene_error(shape("sphere", value_element("float", "radius", "$r")) + "\n" +
                    shape("obj", filename("$mesh"), to_world("<scale value='$size'/>")) +
                    shape("$kind", value_element("float", "radius", "$r"))),
        StartsWith("t.xml:2:43: no value for $r, $mesh, $size, $kind: --set r=... --set mesh=... --set size=... "
                   "--set kind=... would give them"));
}

TEST(ForgivenFaults, HtmlColoursHaveTheCurveOfSrgbButInRgbOfMitsuba06) {
    const Color bytes = Color(0xd9, 0xe7, 0xf1) / 255.f;
    const auto colour = [](const std::string& version, const std::string& tag) {
        return diffuse_of(
            load_version(version, shape("sphere", bsdf("diffuse", value_element(tag, "reflectance", "#d9E7f1")))));
    };
    for (int k = 0; k < 3; ++k) {
        const float linear = linear_from_srgb(bytes[k]);
        for (const auto& [version, tag] : {std::pair(" version='3.0.0'", "rgb"),
                                           {" version='3.0.0'", "spectrum"},
                                           {" version='0.6.0'", "spectrum"},
                                           {" version='0.6.0'", "srgb"}})
            EXPECT_FLOAT_EQ(colour(version, tag)[k], linear) << version << tag;
        EXPECT_FLOAT_EQ(colour(" version='0.6.0'", "rgb")[k], bytes[k]);
    }
}

TEST(ForgivenFaults, SmallNegativeChannelsOfMeasuredDataCountAsZero) {
    const auto metal = [](const std::string& eta) {
        return load(shape("sphere", bsdf("conductor", eta, rgb("k", "3 2 1"))));
    };
    const auto reflected = [](const LoadedScene& loaded) {
        return loaded.scene->material_of_shape(0).constant()->coefficients_local(Vec3(0, 0, 1)).specular;
    };
    const LoadedScene clamped = metal(rgb("eta", "0.2 1 -0.0485"));
    EXPECT_TRUE((reflected(clamped) == reflected(metal(rgb("eta", "0.2 1 0")))).all());
    EXPECT_THAT(clamped.warnings, ElementsAre(HasSubstr("'eta' must not be negative: -0.0485 counts as 0")));
    const auto list = [](const std::string& last) {
        return value_element("spectrum", "eta", "400:1 600:1 700:" + last);
    };
    const LoadedScene samples = metal(list("-0.01"));
    EXPECT_TRUE((reflected(samples) == reflected(metal(list("0")))).all());
    EXPECT_THAT(samples.warnings, ElementsAre(HasSubstr("'eta' must not be negative: -0.01 counts as 0")));
    const LoadedScene fog = load(shape("sphere", center(0, 0, 10), bsdf("null"),
                                       named("medium", "interior", "homogeneous", rgb("sigma_t", "0.2 0.1 -0.004"))));
    EXPECT_THAT(fog.warnings, ElementsAre(HasSubstr("'sigma_t' must not be negative: -0.004")));
}

TEST(ForgivenFaults, TheLastOfSeveralFiltersCountsAndTheFilmsBeforeTheSensors) {
    const std::string box = element("rfilter", "box"), tent = element("rfilter", "tent", radius(3)),
                      gauss = element("rfilter", "gaussian", number("stddev", 1));
    const auto filter_of = [](const std::string& in_film, const std::string& in_sensor) {
        const LoadedScene loaded = parse_scene(
            scene_xml(element("sensor", "perspective", element("film", "hdrfilm", in_film), in_sensor) + ball),
            "t.xml");
        return std::pair(loaded.scene->sensor().filter().radius(), loaded.warnings.size());
    };
    EXPECT_EQ(filter_of(box + tent, ""), std::pair(3.f, std::size_t{1}));
    EXPECT_EQ(filter_of(tent + box, ""), std::pair(0.5f, std::size_t{1}));
    EXPECT_EQ(filter_of("", tent), std::pair(3.f, std::size_t{0}));
    EXPECT_EQ(filter_of(tent, gauss), std::pair(3.f, std::size_t{0}));
}

TEST(ForgivenFaults, AReferenceMeansTheLastObjectOfItsIdBeforeIt) {
    const auto grey = [](double value) { return with_id("bsdf", "diffuse", "a", rgb("reflectance", value)); };
    const std::string use = shape("sphere", reference("a"));
    const LoadedScene loaded = load(grey(0.1) + use + "\n" + grey(0.9) + grey(0.2) + shape("cube", reference("a")));
    EXPECT_EQ(diffuse_of(loaded)[0], 0.1f);
    EXPECT_EQ(loaded.scene->material_of_shape(1).constant()->coefficients_local(Vec3(0, 0, 1)).diffuse[0], 0.2f);
    EXPECT_THAT(loaded.warnings,
                ElementsAre(HasSubstr("the id 'a' is given twice, before at test.xml:2:1: a reference means the last"),
                            HasSubstr("the id 'a' is given twice, before at test.xml:3:1")));
    EXPECT_EQ(diffuse_of(load(use + grey(0.3)))[0], 0.3f);  // one that stands before its object
}

TEST(ForgivenFaults, NamesOfPluginsMayHaveCapitals) {
    const LoadedScene loaded = load(shape("Sphere", radius(2), bsdf("Diffuse")));
    EXPECT_EQ(radius_of(loaded), 2);
    EXPECT_THAT(loaded.warnings, ElementsAre());
}

TEST(ForgivenFaults, AFileWithoutAVersionHasThatOfItsNames) {
    // A spectrum of one number is grey in version 0.6 and reddish in version 3.
    const auto radiance_of = [](const std::string& more) {
        const LoadedScene loaded = load_version("", shape("sphere", emitter("area", spectrum("radiance", 1))) + more);
        EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("the file states no version")));
        return std::get<AreaLight>(loaded.scene->lights()[0]).radiance;
    };
    const Color grey = radiance_of(shape("cube", flag("flipNormals"))),
                reddish = radiance_of(shape("cube", flag("flip_normals")));
    EXPECT_EQ(grey[0], grey[2]);
    EXPECT_GT(reddish[0], 1.1f * reddish[2]);
}

TEST(ForgivenFaults, ABeamWithoutWidthIsANarrowSpotOfItsPower) {
    const LoadedScene loaded =
        load(ball + emitter("collimated", rgb("power", "3 2 1"), to_world(look_at("0,0,5", "0,0,0"))));
    ASSERT_EQ(loaded.scene->lights().size(), 1u);
    const Colord power = std::get<SpotLight>(loaded.scene->lights()[0]).power();
    EXPECT_NEAR(power[0], 3, 1e-4);
    EXPECT_NEAR(power[2], 1, 1e-4);
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("'collimated' is read as a spot of the same power")));
}

TEST(ForgivenFaults, AFileWithoutASensorIsToldWhatItLacks) {
    EXPECT_THAT(input_error_of([] { parse_scene("<scene version='3.0.0'>" + ball + "</scene>", "t.xml"); }),
                HasSubstr("the scene has no sensor: add a <sensor type=\"perspective\">"));
    EXPECT_THAT(input_error_of([] {
                    parse_scene("<scene version='0.6.0'>\n" + shape("sphere", "\n", element("sensor", "perspective")) +
                                    "</scene>",
                                "t.xml");
                }),
                StartsWith("t.xml:3:1: the scene has no sensor: this one would measure the element that it stands in"));
}

TEST(ForgivenFaults, OldFilesMayHaveParametersThatNobodyKnows) {
    const std::string body = shape("sphere", "\n", text("comment", "x"), bsdf("diffuse"));
    EXPECT_THAT(
        load_version(" version='0.6.0'", body).warnings,
        ElementsAre(AllOf(HasSubstr("t.xml:3:1: shape 'sphere' does not take a parameter 'comment', which has no "
                                    "effect; it takes: "),
                          HasSubstr("radius"))));
    for (const auto& [version, wrong] :
         {std::pair(" version='2.0.0'", body),
          {" version='0.6.0'", shape("sphere", element("film", "hdrfilm"))},
          {" version='0.6.0'", shape("sphere", value_element("integer", "shapeIndex", "1"))}})
        EXPECT_THAT(input_error_of([&] { load_version(version, wrong); }), HasSubstr("shape 'sphere' does not take a"));
}

TEST(ForgivenFaults, OldFilesMayGiveAValueTwice) {
    const std::string twice = shape("sphere", radius(2), "\n", radius(3));
    const LoadedScene loaded = load_version(" version='0.5.0'", twice);
    EXPECT_EQ(radius_of(loaded), 3);
    EXPECT_THAT(loaded.warnings,
                ElementsAre(HasSubstr("t.xml:3:1: 'radius' is given twice, first at line 2: the last")));
    EXPECT_THAT(input_error_of([&] { load_version(" version='3.0.0'", twice); }), HasSubstr("'radius' is given twice"));
}

TEST(ForgivenFaults, APathWithoutAFolderIsThatOfTheScene) {
    EXPECT_THAT(load("<path value=''/>" + ball).warnings, ElementsAre());
}

}  // namespace
}  // namespace gib::test::forgiven_faults_test
