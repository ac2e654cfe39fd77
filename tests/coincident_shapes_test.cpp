// Surfaces in the same place: which of them a scene may not have.

#include "common/coincident_shapes.h"

#include "input_error.h"
#include "scene_text.h"

#include <gmock/gmock.h>

namespace gib::test {
namespace {

using ::testing::HasSubstr;

std::string sphere(const std::string& bsdf) { return "<shape type='sphere'>" + bsdf + "</shape>\n"; }
std::string glass(const std::string& parameters) {
    return "<bsdf type='dielectric'><float name='int_ior' value='1.5'/>" + parameters + "</bsdf>";
}
const std::string diffuse = "<bsdf type='diffuse'/>";
std::string blend(const std::string& first, const std::string& second) {
    return "<bsdf type='blendbsdf'><float name='weight' value='0.5'/>" + first + second + "</bsdf>";
}
std::string masked(const std::string& nested) {
    return "<bsdf type='mask'><float name='opacity' value='0.5'/>" + nested + "</bsdf>";
}
/// Of two spheres in one place.
std::string error_of(const std::string& bsdf, const std::string& other_bsdf) {
    return input_error_of([&] { load(sphere(bsdf) + sphere(other_bsdf)); });
}

TEST(CoincidentShapes, InterfacesThatRefractAlikeAreSeenAsOne) {
    const std::string water = "<bsdf type='dielectric'><float name='int_ior' value='1.33'/></bsdf>";
    for (const auto& [a, b] : std::vector<std::pair<std::string, std::string>>{
             {glass(""), glass("")}, {glass(""), diffuse}, {diffuse, diffuse}, {blend(glass(""), diffuse), glass("")}})
        EXPECT_EQ(error_of(a, b), "no error") << a << b;
    EXPECT_EQ(input_error_of([&] {
                  load("<shape type='sphere'><point name='center' x='9' y='0' z='0'/>" + water + "</shape>" +
                       sphere(glass("")));
              }),
              "no error")
        << "apart";
}

TEST(CoincidentShapes, InterfacesThatRefractOtherwiseAreRefused) {
    const std::string water = "<bsdf type='dielectric'><float name='int_ior' value='1.33'/></bsdf>";
    const std::string rough = "<bsdf type='roughdielectric'><float name='int_ior' value='1.33'/></bsdf>";
    const std::string dispersive = glass("<float name='cauchy_b' value='0.01'/>");
    for (const auto& [a, b] : std::vector<std::pair<std::string, std::string>>{{glass(""), water},
                                                                               {glass(""), rough},
                                                                               {glass(""), dispersive},
                                                                               {blend(diffuse, glass("")), water},
                                                                               {blend(water, glass("")), water},
                                                                               {masked(water), glass("")}})
        EXPECT_THAT(error_of(a, b),
                    HasSubstr("test.xml:3:1: this surface lies exactly in the place of the one at line 2, "
                              "which refracts otherwise"))
            << a << b;
}

TEST(CoincidentShapes, GroupsAreLookedInto) {
    const std::string water = "<bsdf type='dielectric'><float name='int_ior' value='1.33'/></bsdf>";
    const auto group = [&](const std::string& other) {
        return "<shape type='shapegroup' id='g'>\n" + sphere(glass("")) + sphere(other) +
               "</shape><shape type='instance'><ref id='g'/></shape>";
    };
    EXPECT_EQ(input_error_of([&] { load(group(glass(""))); }), "no error");
    EXPECT_THAT(input_error_of([&] { load(group(water)); }), HasSubstr("test.xml:4:1: this surface lies exactly"));
}

TEST(CoincidentShapes, LampsBehindSurfacesAreRefused) {
    const std::string emitter = "<emitter type='area'><rgb name='radiance' value='1'/></emitter>";
    EXPECT_EQ(error_of(emitter, diffuse), "no error") << "the lamp is seen";
    EXPECT_THAT(error_of(diffuse, emitter),
                HasSubstr("test.xml:3:1: this lamp lies exactly in the place of the surface at line 2: rays would"));
    const std::string square = "<shape type='rectangle'>";
    EXPECT_THAT(
        input_error_of([&] { load(square + "</shape><shape type='sphere'/>\n" + square + emitter + "</shape>"); }),
        HasSubstr("test.xml:3:1: this lamp lies exactly in the place of the surface at line 2"));
}

TEST(CoincidentShapes, LampsAreRefusedInOneFileAndInTwo) {
    const std::string lamp =
        "<shape type='sphere'><emitter type='area'><rgb name='radiance' value='1'/></emitter></shape>";
    EXPECT_THAT(input_error_of([&] { load(lamp + "\n" + lamp); }),
                HasSubstr("test.xml:3:1: this lamp lies exactly in the place of the one at line 2"));
    const TemporaryFolder folder;
    const std::string part = folder.write("part.xml", "<scene>\n\n" + lamp + "</scene>");
    const std::string text = scene_with("<include filename='part.xml'/>" + lamp);
    EXPECT_THAT(input_error_of([&] { parse_scene(text, folder / "main.xml"); }),
                HasSubstr("main.xml:2:31: this lamp lies exactly in the place of the one at " + part + ":3:"));
}

}  // namespace
}  // namespace gib::test
