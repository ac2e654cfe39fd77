// Tests of the reader of media: what it accepts has Mitsuba's meaning, what is wrong is an error at its place, and
// boundaries that contradict each other along a ray, or are open, are warned of.

#include "common/media/grid_volume.h"
#include "common/scene/effects.h"
#include "common/scene/scene.h"
#include "tests/support/scene_errors.h"
#include "tests/support/volume_file.h"

namespace gib::test::scene_medium_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// The error of a shape with a medium inside, whose parameters are on line 3.
std::string error_in(const std::string& type, const std::string& parameters) {
    return scene_error(shape("sphere", named("medium", "interior", type, "\n", parameters)));
}
const std::string fog = with_id("medium", "homogeneous", "fog") + "\n";
std::string grid(const std::string& name, const std::string& file, const std::string& more = "") {
    return named("volume", name, "gridvolume", filename(file), more);
}

TEST(MediumErrors, Parameters) {
    const auto in = [](const std::string& type) {
        return [=](const std::string& parameters) { return error_in(type, parameters); };
    };
    expect_errors({{"", "2:46", "the medium 'fog' is not supported; supported are: homogeneous, heterogeneous"}},
                  in("fog"));
    expect_errors(
        {
            {number("sigma_t", -1), "3:23", "-1"},
            {rgb("albedo", "0.5, 1.5, 0"), "3:20", "1.5"},
            {number("scale", 1e10), "3:21", "an extinction above 1e+09"},
            {number("sigma_t", 1e10), "3:23", "an extinction above 1e+09"},
            {number("sigma_a", 6e8) + number("sigma_s", 6e8), "3:23", "an extinction above 1e+09"},
            {number("sigma_t", 1) + number("sigma_a", 1), "3:56",
             "give either 'sigma_t' and 'albedo' or 'sigma_s' and 'sigma_a'"},
            {named("volume", "sigma_t", "constvolume"), "3:1", "'sigma_t' cannot be a <volume>"},
            {element("phase", "kkay"), "3:8",
             "the phase 'kkay' is not supported; supported are: isotropic, hg, rayleigh"},
            {element("phase", "hg", number("g", 1)), "3:34", "'g' must be between -0.999 and 0.999, not 1"},
            {element("phase", "isotropic", number("g", 0.5)), "3:25",
             "phase 'isotropic' does not take a parameter 'g'"},
        },
        in("homogeneous"));
    expect_errors(
        {
            {named("volume", "sigma_t", "vdb"), "3:24",
             "the volume 'vdb' is not supported; supported are: constvolume, gridvolume"},
            {grid("sigma_t", "no.vol"), "3:42", "no.vol"},
            {named("volume", "albedo", "constvolume", number("value", 2)), "3:62", "2"},
        },
        in("heterogeneous"));
}

TEST(MediumErrors, Grids) {
    const TemporaryFolder folder;
    const std::string good = folder.write("good.vol", volume_bytes({2, 1, 1}, 1, {0.5f, 3.f}));
    const std::string negative = folder.write("negative.vol", volume_bytes({1, 1, 1}, 1, {-0.5f}));
    const auto error = [](const std::string& parameters) { return error_in("heterogeneous", parameters); };
    EXPECT_EQ(error(grid("sigma_t", good)), "no error");
    expect_errors({{grid("albedo", good), "3:1", "'albedo' must be between 0 and 1, but its volume has 3"},
                   {grid("sigma_t", negative), "3:1", "'sigma_t' must not be negative, but its volume has -0.5"},
                   {grid("sigma_t", good, "\n" + text("filter_type", "cubic")), "4:28", ""},
                   {grid("sigma_t", good, "\n" + text("wrap_type", "zero")), "4:26", ""},
                   {grid("sigma_t", good, "\n" + to_world(scale(0, 1, 1))), "4:1", ""},
                   {grid("sigma_t", good, "\n" + number("value", 1)), "4:1",
                    "volume 'gridvolume' does not take a parameter 'value'"}},
                  error);
}

// A file of bytes means what a file of these numbers over 255 does.
TEST(MediumReader, TakesVolumesOfBytes) {
    const TemporaryFolder folder;
    std::string bytes = volume_bytes({2, 1, 1}, 3, {});
    bytes[4] = 3;
    for (const int byte : {0, 51, 102, 153, 204, 255})
        bytes += static_cast<char>(byte);
    const GridVolume::Data data = load_volume(folder.write("bytes.vol", bytes));
    EXPECT_EQ(data.values, (std::vector<float>{0.f, 51 / 255.f, 102 / 255.f, 153 / 255.f, 204 / 255.f, 1.f}));
}

// The errors of a medium that nothing refers to are warnings, and it is left out.
TEST(MediumReader, ReadsWhatNothingRefersTo) {
    EXPECT_TRUE(load(fog + shape("sphere")).warnings.empty());
    const LoadedScene scene = load(with_id("medium", "homogeneous", "fog", rgb("albedo", 2)) + shape("sphere"));
    EXPECT_THAT(scene.warnings,
                ElementsAre(AllOf(StartsWith("test.xml:2:1: nothing refers to this medium"), HasSubstr("'albedo'"))));
    EXPECT_FALSE(scene.scene->has_media());
}

// A medium may stand in the scene, and shapes and the camera refer to it; in a shape it needs the name of a side.
TEST(MediumReader, TakesReferences) {
    EXPECT_EQ(scene_error(fog + shape("sphere", reference("exterior", "fog"))), "no error");
    EXPECT_THAT(scene_error(shape("sphere", "\n", element("medium", "homogeneous"))),
                StartsWith("t.xml:3:1: shape 'sphere' does not take a <medium>"));
    const auto has_media = [](const std::string& inside) {
        return effects_of(*load(fog + shape("sphere", inside)).scene).has(Effect::participating_media);
    };
    EXPECT_FALSE(has_media(""));
    EXPECT_TRUE(has_media(reference("interior", "fog")));
}

const std::string core = with_id("medium", "homogeneous", "core") + "\n", sky = emitter("constant") + "\n";
const std::string with_fog = reference("interior", "fog"), with_core = reference("interior", "core"),
                  beside_fog = reference("exterior", "fog");

/// A boundary without a surface of its own, on a line of its own.
std::string sphere(double size, double z, const std::string& media) {
    return shape("sphere", radius(size), to_world(translate(0, 0, z)), bsdf("null"), media) + "\n";
}

std::vector<std::string> warnings_of(const std::string& body) { return load(body).warnings; }

// The camera is at the origin and looks along z; the body begins on line 2.
TEST(MediumContradictions, ACameraInAnOpenBoundaryWhoseMediumItDoesNotName) {
    const std::string behind =
        shape("rectangle", to_world(scale(9), translate(0, 0, 5)), bsdf("null"), with_fog) + "\n";
    EXPECT_THAT(warnings_of(fog + sky + behind),
                Contains(AllOf(StartsWith("test.xml:4:1: media contradict each other"),
                               HasSubstr("rays of the camera arrive here in no medium (from the camera)"),
                               HasSubstr("the interior of this shape is medium 'fog'"))));
    EXPECT_THAT(warnings_of(fog + sky + sphere(1, 5, with_fog)), IsEmpty());
}

// A sensor that names no medium stands in that of the closed boundary around it. A glass ball and a wall inside do not
// hide the boundary.
TEST(MediumContradictions, ACameraInAClosedBoundaryStandsInItsMedium) {
    const std::string things = shape("sphere", center(0.5f, 0, 0), radius(0.2), bsdf("dielectric"), beside_fog) +
                               shape("rectangle", to_world(scale(0.2), translate(0, 0, -0.5)), diffuse(0.5)) + "\n";
    for (const std::string& inside : {std::string(), things}) {
        const LoadedScene scene = load(fog + sky + sphere(1, 0, with_fog) + inside);
        EXPECT_THAT(scene.warnings, Contains(HasSubstr("the sensor names no medium, and stands in medium 'fog'")));
        EXPECT_THAT(scene.warnings, Not(Contains(HasSubstr("contradict"))));
        EXPECT_NE(scene.scene->camera_medium(), nullptr);
    }
    EXPECT_EQ(load(fog + sky + sphere(1, 1.5, with_fog)).scene->camera_medium(), nullptr) << "it stands outside";
}

TEST(MediumContradictions, AnInnerBoundaryThatDoesNotNameItsOutside) {
    const std::string outer = fog + core + sky + sphere(2, 5, with_fog);
    EXPECT_THAT(
        warnings_of(outer + sphere(1, 5, with_core)),
        ElementsAre(AllOf(StartsWith("test.xml:6:1: "), HasSubstr("in medium 'fog' (since test.xml:5:1: the boundary)"),
                          HasSubstr("the exterior of this shape is no medium"))));
    EXPECT_THAT(warnings_of(outer + sphere(1, 5, with_core + beside_fog)), IsEmpty());
}

TEST(MediumContradictions, LightFromInfinityInAMediumWithoutABoundary) {
    const auto warnings = [](const std::string& more) {
        const std::string camera_in_fog = fog + element("sensor", "perspective", reference("fog")) + "\n";
        return parse_scene(scene_xml(camera_in_fog + sphere(1, 3, "") + more), "test.xml").warnings;
    };
    EXPECT_THAT(warnings(sky),
                ElementsAre(HasSubstr("medium 'fog' has no boundary around the scene, so that no light")));
    EXPECT_THAT(warnings(emitter("point", point("position", 0, 0, 2))), IsEmpty());
    EXPECT_THAT(warnings(sky + sphere(5, 0, with_fog)), IsEmpty());
}

// The camera's rays end at a wall. Only those of the lamp behind it reach the media.
TEST(MediumContradictions, OnTheWayOfALampAlone) {
    const std::string wall = shape("rectangle", to_world(scale(3), translate(0, 0, 1)), bsdf("diffuse")) + "\n";
    const std::string lamp = emitter("point", point("position", 0, 0, 2)) + "\n";
    const std::string outer = fog + core + wall + lamp + sphere(2, 5, with_fog);
    EXPECT_THAT(warnings_of(outer + sphere(1.8, 5, with_core)),
                Contains(HasSubstr("rays of the lamp arrive here in medium 'fog'")));
    EXPECT_THAT(warnings_of(outer + sphere(1.8, 5, with_core + beside_fog)), IsEmpty());
}

/// Rectangle after rectangle of the box [-1, 1]^3, shifted to z = 5.
std::string box_of_rectangles(int count, const std::string& media) {
    const std::string turns[] = {
        "", rotate('y', 180), rotate('y', 90), rotate('y', 270), rotate('x', 90), rotate('x', 270)};
    std::string body;
    for (int i = 0; i < count; ++i) {
        const std::string place = to_world(translate(0, 0, 1), turns[i], translate(0, 0, 5));
        body += shape("rectangle", place, bsdf("null"), media) + "\n";
    }
    return body;
}

TEST(OpenBoundaries, AreMeshesWithEdgesOfOneTriangle) {
    EXPECT_THAT(warnings_of(fog + box_of_rectangles(1, with_fog)),
                Contains(StartsWith("test.xml:3:1: the boundary of medium 'fog' is open: 4 of its edges")));
    EXPECT_THAT(warnings_of(fog + shape("cube", to_world(translate(0, 0, 5)), bsdf("null"), with_fog)), IsEmpty());
    EXPECT_THAT(warnings_of(fog + box_of_rectangles(6, with_fog)), IsEmpty());
    // Behind a floor there is no medium that could get out.
    EXPECT_THAT(warnings_of(fog + box_of_rectangles(1, beside_fog)), IsEmpty());
}

}  // namespace
}  // namespace gib::test::scene_medium_test
