// Tests of sensors, films, samplers and integrators in scene files, which take Mitsuba 3's parameters.

#include "common/scene/effects.h"
#include "common/scene/scene.h"
#include "tests/support/scene_errors.h"

#include <climits>

namespace gib::test::scene_sensor_test {
namespace {

using ::testing::ElementsAre;

const std::string ball = "<shape type='sphere'/>";

/// A film of `size` x `size` pixels that starts on line 1.
std::string film(int size, const std::string& body = "") {
    return element("film", "hdrfilm", integer("width", size), integer("height", size), body);
}

std::string crop(const std::string& offset_x, const std::string& offset_y, const std::string& width,
                 const std::string& height) {
    const auto line = [](const std::string& name, const std::string& value) {
        return value.empty() ? "" : value_element("integer", "crop_" + name, value) + "\n";
    };
    return "\n" + line("offset_x", offset_x) + line("offset_y", offset_y) + line("width", width) +
           line("height", height);
}

LoadedScene load(const std::string& body, const SceneLoadOptions& options = {}) {
    return parse_scene(scene_xml(ball + body), "t.xml", options);
}

template <class... Content>
std::string perspective(const Content&... content) {
    return element("sensor", "perspective", content...);
}

Sensor sensor_of(const std::string& type, const std::string& body, const SceneLoadOptions& options = {}) {
    return load(element("sensor", type, body), options).scene->sensor();
}

Sensor camera_of(const std::string& film, const SceneLoadOptions& options = {}) {
    return sensor_of("perspective", number("fov", 40) + film, options);
}

const Vec2 middle(0.5f, 0.5f), rim(1.f, 0.5f);

TEST(SceneSensor, ThinLensesHaveAnApertureAndAFocus) {
    const auto lens = [](double radius, const std::string& more) {
        return sensor_of("thinlens", number("aperture_radius", radius) + more + film(8));
    };
    const Sensor focused = lens(0.5, number("focus_distance", 3) + number("fov", 50));
    const Ray chief = focused.generate_ray(2, 1, middle, middle), other = focused.generate_ray(2, 1, middle, rim);
    EXPECT_NEAR((other.o - chief.o).norm(), 0.5f, 1e-6f);
    EXPECT_LT((chief.o + 3.f / chief.d.z() * chief.d - other.o - 3.f / other.d.z() * other.d).norm(), 1e-5f);
    // The focus distance is the default far clip distance, 1e4, or the given one.
    const auto meet = [](const Sensor& sensor) {
        const Ray a = sensor.generate_ray(2, 1, middle, middle), b = sensor.generate_ray(2, 1, middle, rim);
        return (b.o - a.o).norm() / (a.d / a.d.z() - b.d / b.d.z()).norm();
    };
    EXPECT_NEAR(meet(lens(500, "")), 1e4f, 10.f);
    EXPECT_NEAR(meet(lens(5, number("far_clip", 70))), 70.f, 0.1f);
}

TEST(SceneSensor, ACropIsTheImage) {
    const Sensor whole = camera_of(film(16)), part = camera_of(film(16, crop("3", "9", "10", "2")));
    EXPECT_EQ(part.width(), 10);
    EXPECT_EQ(part.height(), 2);
    EXPECT_EQ(part.generate_ray(4, 1, rim).d, whole.generate_ray(7, 10, rim).d);
    // A crop with only a size starts at the film's top left corner.
    for (const std::string& window : {crop("", "", "4", "4"), crop("0", "0", "16", "16")})
        EXPECT_EQ(camera_of(film(16, window)).generate_ray(1, 2, rim).d, whole.generate_ray(1, 2, rim).d);
}

TEST(SceneSensor, AnotherResolutionShowsTheSameCrop) {
    const std::string cropped = film(16, crop("3", "9", "10", "2") + element("rfilter", "box"));
    const Sensor coarse = camera_of(cropped), fine = camera_of(cropped, {{}, std::pair(20, 4)});
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
    EXPECT_NEAR(offset(element("rfilter", "box")), 0.25f, 1e-6f);
    EXPECT_NEAR(offset(element("rfilter", "box", radius(3))), 1.5f, 1e-6f);
    EXPECT_NEAR(offset(element("rfilter", "tent")), 1 - std::sqrt(0.5f), 1e-6f);
    EXPECT_NEAR(offset(element("rfilter", "tent", radius(3))), 3 - 3 * std::sqrt(0.5f), 1e-6f);
    // The offset is the quartile of a normal distribution, less the small effect of the cut at 4 standard deviations.
    EXPECT_NEAR(offset(element("rfilter", "gaussian")), 0.6745f * 0.5f, 2e-3f);
    EXPECT_NEAR(offset(""), 0.6745f * 0.5f, 2e-3f);
}

TEST(SceneSensor, WhatExistingScenesSayOfFilmsAndSamplersIsAccepted) {
    const auto with = [](const std::string& body) { return load(perspective(body)); };
    for (const std::string type : {"independent", "stratified", "multijitter", "orthogonal", "ldsampler"}) {
        const std::string sampler = element("sampler", type, integer("sample_count", 25), integer("seed", 3));
        EXPECT_EQ(with(sampler).sample_count, 25) << type;
    }
    EXPECT_EQ(with(element("sampler", "independent")).sample_count, std::nullopt);
    with(film(4, text("pixel_format", "rgba") + text("component_format", "float32") + text("file_format", "OpenEXR") +
                     flag("sample_border")));
    with(number("shutter_open", 0) + number("shutter_close", 1) + number("focus_distance", 6));
    const auto referred =
        load(with_id("sampler", "orthogonal", "s", integer("sample_count", 49)) + with_id("rfilter", "box", "r") +
             with_id("film", "hdrfilm", "f", integer("width", 3), reference("r")) +
             perspective(reference("s"), reference("f")));
    EXPECT_EQ(referred.sample_count, 49);
    EXPECT_EQ(referred.scene->sensor().width(), 3);
}

// As in Mitsuba, only the first of several sensors counts by default.
TEST(SceneSensor, TheFirstOfSeveralCounts) {
    const auto scene = load(perspective(film(3)) + element("sensor", "orthographic", film(5)));
    EXPECT_EQ(scene.scene->sensor().width(), 3);
}

TEST(SceneSensor, NestedIntegratorsGiveTheLongestPath) {
    const auto integrator = [](const std::string& type, const std::string& more = "") {
        return element("integrator", type, more);
    };
    const std::string path = integrator("path", integer("max_depth", 5)), aovs = text("aovs", "dd.y:depth");
    for (const auto& [xml, edges] : {std::pair(integrator("moment", path), 5),
                                     {integrator("aov", aovs + path), 5},
                                     {integrator("moment", integrator("aov", aovs + path)), 5},
                                     {integrator("moment", integrator("direct")), 2},
                                     {integrator("aov", aovs), INT_MAX}})
        EXPECT_EQ(load(perspective() + xml).max_edges, edges) << xml;
}

std::string error_of(const std::string& sensor) {
    return input_error_of([&] { load("\n" + sensor); });
}

TEST(SceneSensorErrors, Crops) {
    expect_errors(
        {{crop("1", "", "", ""), "3:31", "the crop window from 1 to 17 is not within the film's 16 pixels"},
         {crop("", "", "17", ""), "3:28", "the crop window from 0 to 17 is not within the film's 16 pixels"},
         {crop("0", "10", "4", "7"), "4:31", "the crop window from 10 to 17 is not within the film's 16 pixels"},
         {crop("2147483647", "", "1", ""), "3:31", "from 2147483647 to 2147483648"},
         {crop("-1", "", "1", ""), "3:31", "'crop_offset_x' must be between 0 and"},
         {crop("", "", "", "0"), "3:29", "'crop_height' must be between 1 and"},
         {"\n" + number("crop_width", 3), "3:1", "cannot be a <float>"}},
        [](const std::string& body) { return error_of(perspective(film(16, body))); });
}

// Films, samplers and integrators of any name are taken for what counts here; a warning says what does not.
TEST(SceneSensor, WarnsOfWhatHasNoEffect) {
    const auto warnings = [](const std::string& body) { return load(perspective(body)).warnings; };
    EXPECT_THAT(warnings(film(4, "<rfilter type='lanczos'/>" + number("gain", 2))),
                ElementsAre("t.xml:1:161: the filter 'lanczos' has negative lobes: gaussian stands in for it",
                            "t.xml:1:186: film 'hdrfilm': 'gain' has no effect"));
    EXPECT_THAT(warnings(element("film", "newfilm")),
                ElementsAre("t.xml:1:73: film 'newfilm': only its size, its window and its filter are read"));
    EXPECT_THAT(warnings(element("sampler", "halton", integer("scramble", 1), number("x", 1))),
                ElementsAre("t.xml:1:132: sampler 'halton': 'x' has no effect"));
    const auto moments =
        load(perspective() + element("integrator", "moment", element("integrator", "pssmlt", integer("max_depth", 3))));
    EXPECT_EQ(moments.max_edges, 3);
    EXPECT_THAT(moments.warnings, ElementsAre(HasSubstr("integrator 'pssmlt'")));
}

}  // namespace
}  // namespace gib::test::scene_sensor_test
