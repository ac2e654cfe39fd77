// Warnings about media: boundaries that contradict each other along a ray, and open ones.

#include "tests/support/scene_text.h"

#include <gmock/gmock.h>

namespace gib::test::medium_check_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

const std::string fog = with_id("medium", "homogeneous", "fog") + "\n",
                  core = with_id("medium", "homogeneous", "core") + "\n";
const std::string sky = emitter("constant") + "\n";

std::string sphere(double radius, double z, const std::string& media) {
    return shape("sphere", number("radius", std::to_string(radius)),
                 to_world("<translate z='", std::to_string(z), "'/>"), bsdf("null"), media) +
           "\n";
}
std::string side(const std::string& name, const std::string& medium) {
    return "<ref name='" + name + "' id='" + medium + "'/>";
}

std::vector<std::string> warnings_of(const std::string& body) { return load(body).warnings; }

// The camera is at the origin and looks along z; the body begins on line 2.
TEST(MediumContradictions, ACameraInAMediumThatItDoesNotName) {
    EXPECT_THAT(warnings_of(fog + sky + sphere(1, 0, side("interior", "fog"))),
                ElementsAre(AllOf(StartsWith("test.xml:4:1: media contradict each other"),
                                  HasSubstr("rays of the camera arrive here in no medium (from the camera)"),
                                  HasSubstr("the interior of this shape is medium 'fog'"))));
    EXPECT_THAT(warnings_of(fog + sky + sphere(1, 5, side("interior", "fog"))), IsEmpty());
}

TEST(MediumContradictions, AnInnerBoundaryThatDoesNotNameItsOutside) {
    const std::string outer = sphere(2, 5, side("interior", "fog"));
    EXPECT_THAT(
        warnings_of(fog + core + sky + outer + sphere(1, 5, side("interior", "core"))),
        ElementsAre(AllOf(StartsWith("test.xml:6:1: "), HasSubstr("in medium 'fog' (since test.xml:5:1: the boundary)"),
                          HasSubstr("the exterior of this shape is no medium"))));
    EXPECT_THAT(
        warnings_of(fog + core + sky + outer + sphere(1, 5, side("interior", "core") + side("exterior", "fog"))),
        IsEmpty());
}

TEST(MediumContradictions, LightFromInfinityInAMediumWithoutABoundary) {
    const auto warnings = [](const std::string& more) {
        const std::string camera_in_fog = fog + element("sensor", "perspective", reference("fog")) + "\n";
        return parse_scene("<scene version='3.0.0'>" + camera_in_fog + sphere(1, 3, "") + more + "</scene>", "test.xml",
                           {})
            .warnings;
    };
    EXPECT_THAT(warnings(sky),
                ElementsAre(HasSubstr("medium 'fog' has no boundary around the scene, so that no light")));
    EXPECT_THAT(warnings(emitter("point", point("position", 0, 0, 2))), IsEmpty());
    EXPECT_THAT(warnings(sky + sphere(5, 0, side("interior", "fog"))), IsEmpty());
}

// The camera's rays end at a wall. Only those of the lamp behind it reach the media.
TEST(MediumContradictions, OnTheWayOfALampAlone) {
    const std::string wall = shape("rectangle", to_world(scale(3), translate(0, 0, 1)), bsdf("diffuse")) + "\n";
    const std::string lamp = emitter("point", point("position", 0, 0, 2)) + "\n";
    const std::string outer = sphere(2, 5, side("interior", "fog"));
    EXPECT_THAT(warnings_of(fog + core + wall + lamp + outer + sphere(1.8, 5, side("interior", "core"))),
                Contains(HasSubstr("rays of the lamp arrive here in medium 'fog'")));
    EXPECT_THAT(warnings_of(fog + core + wall + lamp + outer +
                            sphere(1.8, 5, side("interior", "core") + side("exterior", "fog"))),
                IsEmpty());
}

/// Rectangle after rectangle of the box [-1, 1]^3, shifted to z = 5.
std::string box_of_rectangles(int count, const std::string& media) {
    const std::string turns[] = {
        "", rotate('y', 180), rotate('y', 90), rotate('y', 270), rotate('x', 90), rotate('x', 270)};
    std::string body;
    for (int i = 0; i < count; ++i)
        body +=
            shape("rectangle", to_world(translate(0, 0, 1), turns[i], translate(0, 0, 5)), bsdf("null"), media) + "\n";
    return body;
}

TEST(OpenBoundaries, AreMeshesWithEdgesOfOneTriangle) {
    const std::string inside = side("interior", "fog");
    EXPECT_THAT(warnings_of(fog + box_of_rectangles(1, inside)),
                Contains(StartsWith("test.xml:3:1: the boundary of medium 'fog' is open: 4 of its edges")));
    EXPECT_THAT(warnings_of(fog + shape("cube", to_world(translate(0, 0, 5)), bsdf("null"), inside)), IsEmpty());
    EXPECT_THAT(warnings_of(fog + box_of_rectangles(6, inside)), IsEmpty());
    // Behind a floor there is no medium that could get out.
    EXPECT_THAT(warnings_of(fog + box_of_rectangles(1, side("exterior", "fog"))), IsEmpty());
}

}  // namespace
}  // namespace gib::test::medium_check_test
