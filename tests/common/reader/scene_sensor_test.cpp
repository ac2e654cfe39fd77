// Tests of sensors, films, samplers and integrators in scene files, which take Mitsuba 3's parameters.

#include "common/core/error.h"
#include "common/scene/effects.h"
#include "common/scene/scene.h"
#include "tests/support/scene_text.h"

#include <gmock/gmock.h>
#include <climits>

namespace gib::test::scene_sensor_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string ball = shape("sphere");

/// A film of `size` x `size` pixels that starts on line 1.
std::string film(int size, const std::string& body = "") {
    const std::string pixels = std::to_string(size);
    return element("film", "hdrfilm", "<integer name='width' value='", pixels, "'/><integer name='height' value='",
                   pixels, "'/>", body);
}

std::string crop(const std::string& offset_x, const std::string& offset_y, const std::string& width,
                 const std::string& height) {
    const auto integer = [](const std::string& name, const std::string& value) {
        return value.empty() ? "" : "<integer name='crop_" + name + "' value='" + value + "'/>\n";
    };
    return "\n" + integer("offset_x", offset_x) + integer("offset_y", offset_y) + integer("width", width) +
           integer("height", height);
}

LoadedScene load(const std::string& body, const SceneLoadOptions& options = {}) {
    return parse_scene("<scene version='3.0.0'>" + ball + body + "</scene>", "t.xml", options);
}

Sensor sensor_of(const std::string& type, const std::string& body, const SceneLoadOptions& options = {}) {
    return load(element("sensor", type, body), options).scene->sensor();
}

std::string number(const std::string& name, const std::string& value) { return number(name, value); }

const Vec2 middle(0.5f, 0.5f), rim(1.f, 0.5f);

TEST(SceneSensor, ThinLensesHaveAnApertureAndAFocus) {
    const auto lens = sensor_of(
        "thinlens", number("aperture_radius", "0.5") + number("focus_distance", "3") + number("fov", "50") + film(8));
    const Ray chief = lens.generate_ray(2, 1, middle, middle), other = lens.generate_ray(2, 1, middle, rim);
    EXPECT_NEAR((other.o - chief.o).norm(), 0.5f, 1e-6f);
    EXPECT_LT((chief.o + 3.f / chief.d.z() * chief.d - other.o - 3.f / other.d.z() * other.d).norm(), 1e-5f);
    // The focus distance is the default far clip distance, 1e4, or the given one.
    const auto meet = [](const Sensor& sensor) {
        const Ray a = sensor.generate_ray(2, 1, middle, middle), b = sensor.generate_ray(2, 1, middle, rim);
        return (b.o - a.o).norm() / (a.d / a.d.z() - b.d / b.d.z()).norm();
    };
    EXPECT_NEAR(meet(sensor_of("thinlens", number("aperture_radius", "500") + film(8))), 1e4f, 10.f);
    EXPECT_NEAR(meet(sensor_of("thinlens", number("aperture_radius", "5") + number("far_clip", "70") + film(8))), 70.f,
                0.1f);
}

TEST(SceneSensor, OnlyAnOpenLensCallsForDepthOfField) {
    const auto effects = [](const std::string& sensor) {
        return effects_of(*load(sensor).scene).has(Effect::depth_of_field);
    };
    const auto lens = [](const std::string& radius) {
        return element("sensor", "thinlens", number("aperture_radius", radius));
    };
    EXPECT_TRUE(effects(lens("0.1")));
    EXPECT_FALSE(effects(lens("0")));
    EXPECT_FALSE(effects(element("sensor", "perspective", number("focus_distance", "5.8"))));
}

TEST(SceneSensor, ACropIsTheImage) {
    const Sensor whole = sensor_of("perspective", number("fov", "40") + film(16));
    const Sensor part = sensor_of("perspective", number("fov", "40") + film(16, crop("3", "9", "10", "2")));
    EXPECT_EQ(part.width(), 10);
    EXPECT_EQ(part.height(), 2);
    EXPECT_EQ(part.generate_ray(4, 1, rim).d, whole.generate_ray(7, 10, rim).d);
    // A crop with only a size starts at the film's top left corner.
    const Sensor corner = sensor_of("perspective", number("fov", "40") + film(16, crop("", "", "4", "4")));
    EXPECT_EQ(corner.generate_ray(1, 2, rim).d, whole.generate_ray(1, 2, rim).d);
    const Sensor all = sensor_of("perspective", number("fov", "40") + film(16, crop("0", "0", "16", "16")));
    EXPECT_EQ(all.generate_ray(1, 2, rim).d, whole.generate_ray(1, 2, rim).d);
}

TEST(SceneSensor, AnotherResolutionShowsTheSameCrop) {
    const std::string body = number("fov", "40") + film(16, crop("3", "9", "10", "2") + element("rfilter", "box"));
    const Sensor coarse = sensor_of("perspective", body);
    const Sensor fine = sensor_of("perspective", body, {{}, std::pair(20, 4)});
    EXPECT_EQ(fine.width(), 20);
    EXPECT_EQ(fine.height(), 4);
    const Vec2 first(0.f, 0.f), last(1.f, 1.f);
    EXPECT_LT((fine.generate_ray(0, 0, first).d - coarse.generate_ray(0, 0, first).d).norm(), 1e-6f);
    EXPECT_LT((fine.generate_ray(19, 3, last).d - coarse.generate_ray(9, 1, last).d).norm(), 1e-6f);
}

TEST(SceneSensor, FiltersSpreadByTheirParameter) {
    // The offset of the film position [pixels] that the random number 3/4 gives.
    const auto offset = [](const std::string& filter) {
        const Sensor sensor = sensor_of("orthographic", film(2, filter));
        return (sensor.generate_ray(0, 0, middle).o - sensor.generate_ray(0, 0, {0.75f, 0.5f}).o).x();
    };
    const std::string radius = radius(3);
    EXPECT_NEAR(offset(element("rfilter", "box")), 0.25f, 1e-6f);
    EXPECT_NEAR(offset(element("rfilter", "box", radius)), 1.5f, 1e-6f);
    EXPECT_NEAR(offset(element("rfilter", "tent")), 1 - std::sqrt(0.5f), 1e-6f);
    EXPECT_NEAR(offset(element("rfilter", "tent", radius)), 3 - 3 * std::sqrt(0.5f), 1e-6f);
    // The offset is the quartile of a normal distribution, less the small effect of the cut at 4 standard deviations.
    EXPECT_NEAR(offset(element("rfilter", "gaussian")), 0.6745f * 0.5f, 2e-3f);
    EXPECT_NEAR(offset(""), 0.6745f * 0.5f, 2e-3f);
}

TEST(SceneSensor, WhatExistingScenesSayOfFilmsAndSamplersIsAccepted) {
    const auto with = [](const std::string& body) { return load(element("sensor", "perspective", body)); };
    for (const std::string type : {"independent", "stratified", "multijitter", "orthogonal", "ldsampler"}) {
        const auto scene = with(element("sampler", type, integer("sample_count", 25), integer("seed", 3)));
        EXPECT_EQ(scene.sample_count, 25) << type;
    }
    EXPECT_EQ(with(element("sampler", "independent")).sample_count, std::nullopt);
    with(film(4, text("pixel_format", "rgba") + text("component_format", "float32") + text("file_format", "OpenEXR") +
                     flag("sample_border")));
    with(number("shutter_open", "0") + number("shutter_close", "1") + number("focus_distance", "6"));
    const auto referred =
        load(with_id("sampler", "orthogonal", "s", integer("sample_count", 49)) + with_id("rfilter", "box", "r") +
             with_id("film", "hdrfilm", "f", integer("width", 3), reference("r")) +
             element("sensor", "perspective", reference("s"), reference("f")));
    EXPECT_EQ(referred.sample_count, 49);
    EXPECT_EQ(referred.scene->sensor().width(), 3);
}

// As in Mitsuba, only the first of several sensors counts by default.
TEST(SceneSensor, TheFirstOfSeveralCounts) {
    const auto scene = load(element("sensor", "perspective", film(3)) + element("sensor", "orthographic", film(5)));
    EXPECT_EQ(scene.scene->sensor().width(), 3);
}

TEST(SceneSensor, NestedIntegratorsGiveTheLongestPath) {
    const auto edges = [](const std::string& integrator) {
        return load(element("sensor", "perspective") + integrator).max_edges;
    };
    const std::string path = element("integrator", "path", integer("max_depth", 5));
    const std::string aovs = text("aovs", "dd.y:depth");
    EXPECT_EQ(edges(element("integrator", "moment", path)), 5);
    EXPECT_EQ(edges(element("integrator", "aov", aovs, path)), 5);
    EXPECT_EQ(edges(element("integrator", "moment", element("integrator", "aov", aovs, path))), 5);
    EXPECT_EQ(edges(element("integrator", "moment", element("integrator", "direct"))), 2);
    EXPECT_EQ(edges(element("integrator", "aov", aovs)), INT_MAX);
}

std::string error_of(const std::string& sensor) {
    try {
        load("\n" + sensor);
    } catch (const InputError& e) {
        return e.what();
    }
    return "no error";
}

TEST(SceneSensorErrors, Lenses) {
    const auto lens = [](const std::string& body) { return error_of(element("sensor", "thinlens", "\n", body)); };
    const std::string radius = number("aperture_radius", "1") + "\n";
    EXPECT_THAT(lens(""), StartsWith("t.xml:2:1: 'thinlens' needs 'aperture_radius'"));
    EXPECT_THAT(lens(number("aperture_radius", "-1")),
                StartsWith("t.xml:3:31: 'aperture_radius' must not be negative: -1"));
    EXPECT_THAT(lens(number("aperture_radius", "x")), StartsWith("t.xml:3:31: bad number 'x'"));
    EXPECT_THAT(lens(number("aperture_radius", "nan")), StartsWith("t.xml:3:31: bad number 'nan'"));
    EXPECT_THAT(lens(radius + number("focus_distance", "inf")), StartsWith("t.xml:4:30: bad number 'inf'"));
    EXPECT_THAT(lens(radius + rgb("focus_distance", 1)),
                StartsWith("t.xml:4:1: 'focus_distance' cannot be a <rgb>; it takes: <float>, <integer>"));
    EXPECT_THAT(error_of(element("sensor", "orthographic", "\n", radius)),
                StartsWith("t.xml:3:1: sensor 'orthographic' does not take a parameter 'aperture_radius'"));
    EXPECT_THAT(error_of(element("sensor", "orthographic", "\n", number("fov", "50"))),
                StartsWith("t.xml:3:1: sensor 'orthographic' does not take a parameter 'fov'; it takes: to_world"));
    EXPECT_THAT(lens(text("aperture_radius", "1")), HasSubstr("cannot be a <string>"));
    for (const char* distance : {"0", "-2"})
        EXPECT_THAT(lens(radius + number("focus_distance", distance)),
                    StartsWith("t.xml:4:30: 'focus_distance' must be above 0, not "))
            << distance;
    EXPECT_THAT(lens(radius + to_world(scale(2))),
                StartsWith("t.xml:4:1: the to_world of a perspective sensor must not scale"));
    EXPECT_THAT(lens(radius + number("principal_point_offset_x", "1")),
                HasSubstr("sensor 'thinlens' does not take a parameter 'principal_point_offset_x'"));
    EXPECT_THAT(error_of(element("sensor", "perspective", "\n", radius)),
                HasSubstr("sensor 'perspective' does not take a parameter 'aperture_radius'"));
}

TEST(SceneSensorErrors, Crops) {
    const auto cropped = [](const std::string& body) {
        return error_of(element("sensor", "perspective", film(16, body)));
    };
    EXPECT_THAT(cropped(crop("1", "", "", "")),
                StartsWith("t.xml:3:31: the crop window from 1 to 17 is not within the film's 16 pixels"));
    EXPECT_THAT(cropped(crop("", "", "17", "")),
                StartsWith("t.xml:3:28: the crop window from 0 to 17 is not within the film's 16 pixels"));
    EXPECT_THAT(cropped(crop("0", "10", "4", "7")),
                StartsWith("t.xml:4:31: the crop window from 10 to 17 is not within the film's 16 pixels"));
    EXPECT_THAT(cropped(crop("2147483647", "", "1", "")), HasSubstr("from 2147483647 to 2147483648"));
    EXPECT_THAT(cropped(crop("-1", "", "1", "")), StartsWith("t.xml:3:31: 'crop_offset_x' must be between 0 and"));
    EXPECT_THAT(cropped(crop("", "", "", "0")), StartsWith("t.xml:3:29: 'crop_height' must be between 1 and"));
    EXPECT_THAT(cropped("\n" + number("crop_width", 3)), HasSubstr("cannot be a <float>"));
}

TEST(SceneSensorErrors, FiltersSamplersAndIntegrators) {
    const auto filter = [](const std::string& body) {
        return error_of(element("sensor", "perspective", film(4, "\n" + body)));
    };
    EXPECT_THAT(filter(element("rfilter", "sinc")),
                StartsWith("t.xml:3:10: the rfilter 'sinc' is not supported; supported are: box, tent, gaussian"));
    EXPECT_THAT(filter(element("rfilter", "tent", radius(0))), StartsWith("t.xml:3:43: 'radius' must be above 0"));
    EXPECT_THAT(filter(element("rfilter", "tent", number("stddev", 1))),
                HasSubstr("rfilter 'tent' does not take a parameter 'stddev'; it takes: radius"));
    EXPECT_THAT(filter(element("rfilter", "gaussian", number("stddev", 0))),
                StartsWith("t.xml:3:47: 'stddev' must be above 0"));
    EXPECT_THAT(filter(element("rfilter", "gaussian", radius(2))),
                StartsWith("t.xml:3:26: rfilter 'gaussian' does not take a parameter 'radius'; it takes: stddev"));
    EXPECT_THAT(
        error_of(element("sensor", "perspective", "\n", element("sampler", "independent", integer("sample_count", 0)))),
        StartsWith("t.xml:3:58: 'sample_count' must be between 1 and"));
}

// Films, samplers and integrators of any name are taken for what counts here; a warning says what does not.
TEST(SceneSensor, WarnsOfWhatHasNoEffect) {
    const auto warnings = [](const std::string& body) { return load(element("sensor", "perspective", body)).warnings; };
    EXPECT_THAT(warnings(film(4, element("rfilter", "lanczos") + number("gain", 2))),
                ElementsAre("t.xml:1:161: the filter 'lanczos' has negative lobes: gaussian stands in for it",
                            "t.xml:1:186: film 'hdrfilm': 'gain' has no effect"));
    EXPECT_THAT(warnings(element("film", "newfilm")),
                ElementsAre("t.xml:1:73: film 'newfilm': only its size, its window and its filter are read"));
    EXPECT_THAT(warnings(element("sampler", "halton", integer("scramble", 1), number("x", 1))),
                ElementsAre("t.xml:1:132: sampler 'halton': 'x' has no effect"));
    const auto moments =
        load(element("sensor", "perspective") +
             element("integrator", "moment", element("integrator", "pssmlt", integer("max_depth", 3))));
    EXPECT_EQ(moments.max_edges, 3);
    EXPECT_THAT(moments.warnings, ElementsAre(HasSubstr("integrator 'pssmlt'")));
}

// A warning comes once, however often its cause does.
TEST(SceneSensor, WarnsOnce) {
    const std::string body = film(4, element("rfilter", "lanczos"));
    const auto scene = load(element("sensor", "perspective", body) + element("sensor", "perspective", body));
    EXPECT_EQ(scene.warnings.size(), 1u);
}

}  // namespace
}  // namespace gib::test::scene_sensor_test
