// Wrong <bsdf> elements: each is an error that names the place and what would be right.

#include "tests/support/scene_errors.h"
#include "tests/support/texture_fixtures.h"

namespace gib::test::bsdf_error_test {
namespace {

/// The error of a bsdf, which starts on line 3, and its parameters on line 4.
std::string error_of(const std::string& type, const std::string& parameters, const std::string& path = "t.xml") {
    return scene_error(shape("sphere", "\n", bsdf(type, "\n", parameters)), path);
}

void expect_errors(const std::string& type, const std::vector<ExpectedError>& rows) {
    SCOPED_TRACE(type);
    test::expect_errors(rows, [&](const std::string& parameters) { return error_of(type, parameters); });
}

std::string squares(const std::string& name) { return named("texture", name, "checkerboard"); }
std::string bitmap(const std::string& name, const std::string& file) {
    return named("texture", name, "bitmap", "\n", filename(file));
}

/// The place (line:column) where the value of the number with this name stands on line 4.
std::string number_place(const std::string& name) {
    return "4:" + std::to_string(name.size() + std::string("<float name='' ").size() + 1);
}

const std::string grey = "<bsdf type='diffuse'/>", glass = "<bsdf type='dielectric'/>";

const std::pair<std::string, std::vector<std::string>> reflectances[] = {
    {"diffuse", {"reflectance"}},
    {"dielectric", {"specular_reflectance", "specular_transmittance"}},
    {"thindielectric", {"specular_reflectance", "specular_transmittance"}},
    {"roughdielectric", {"specular_reflectance", "specular_transmittance"}},
    {"conductor", {"specular_reflectance"}},
    {"roughconductor", {"specular_reflectance"}},
    {"plastic", {"diffuse_reflectance", "specular_reflectance"}},
    {"roughplastic", {"diffuse_reflectance", "specular_reflectance"}},
    {"phong", {"diffuse_reflectance", "specular_reflectance"}},
    {"principled", {"base_color"}}};

TEST(BsdfErrors, IndicesOfRefraction) {
    const std::string kinds = "; it takes: <float>, <integer>, <string>";
    for (const std::string type : {"dielectric", "thindielectric", "roughdielectric", "plastic", "roughplastic"}) {
        for (const std::string name : {"int_ior", "ext_ior"}) {
            const std::string place = number_place(name);
            expect_errors(type, {{text(name, "butter"), "4:24",
                                  "'" + name + "': there is no material 'butter'; known are: vacuum, helium, "},
                                 {number(name, 0), place, "'" + name + "' must be above 0, not 0"},
                                 {number(name, "1e4"), place, "'int_ior' over 'ext_ior' must be between 0.01 and 100"},
                                 {number(name, "1e-4"), place, "'int_ior' over 'ext_ior' must be between 0.01 and 100"},
                                 {rgb(name, "1.5"), "4:1", "'" + name + "' cannot be a <rgb>" + kinds},
                                 {squares(name), "4:1", "'" + name + "' cannot be a <texture>" + kinds}});
        }
    }
}

/// As in Mitsuba, the smooth models accept equal indices and the rough ones do not.
TEST(BsdfErrors, RoughInterfacesWithoutAChangeOfIndex) {
    const std::string by_number = number("int_ior", 1.5) + number("ext_ior", 1.5), by_name = text("int_ior", "air"),
                      outside = text("ext_ior", "polypropylene");
    for (const std::string type : {"dielectric", "thindielectric", "plastic"})
        EXPECT_EQ(error_of(type, by_number), "no error");
    for (const std::string type : {"roughdielectric", "roughplastic"})
        expect_errors(type, {{by_number, "4:23", "'int_ior' and 'ext_ior' must differ"},
                             {by_name, "4:24", "'int_ior' and 'ext_ior' must differ"}});
    expect_errors("roughplastic", {{outside, "4:24", "'int_ior' and 'ext_ior' must differ"}});
}

TEST(BsdfErrors, NestedBsdfs) {
    const std::string any = squares("any"), normals = squares("normalmap");
    expect_errors("blendbsdf", {{"", "3:1", "blendbsdf takes two bsdfs, found 0"},
                                {grey, "3:1", "blendbsdf takes two bsdfs, found 1"},
                                {grey + grey + grey, "3:1", "blendbsdf takes two bsdfs, found 3"}});
    for (const auto& [type, more] :
         {std::pair<std::string, std::string>("mask", ""), {"bumpmap", any}, {"normalmap", normals}})
        expect_errors(type, {{more, "3:1", type + " takes one bsdf, found 0"},
                             {more + grey + grey, "3:1", type + " takes one bsdf, found 2"}});
    expect_errors("twosided", {{"", "3:1", "twosided takes one or two bsdfs, found 0"},
                               {grey + grey + grey, "3:1", "twosided takes one or two bsdfs, found 3"},
                               {bsdf("diffuse", "\n", number("gloss", 1)), "5:1",
                                "bsdf 'diffuse' does not take a parameter 'gloss'"}});
    expect_errors("diffuse", {{grey, "4:1", "bsdf 'diffuse' does not take a <bsdf>"}});
    expect_errors("mask", {{"<ref id='none'/>", "4:6", "there is no object with the id 'none'"},
                           {"<bsdf type='hair'/>", "4:7", "the bsdf 'hair' is not supported; supported are: diffuse"},
                           {"<bsdf type='mask' id='m'>\n<ref id='m'/></bsdf>", "5:1", "the bsdf holds itself"}});
}

TEST(BsdfErrors, TwosidedAroundWhatTransmits) {
    const std::string message = "a bsdf inside twosided must not transmit light";
    for (const std::string type : {"dielectric", "thindielectric", "roughdielectric", "null"})
        expect_errors("twosided", {{"<bsdf type='" + type + "'/>", "4:1", message}});
    expect_errors("twosided", {{grey + "\n" + glass, "5:1", message},
                               {bsdf("blendbsdf", number("weight", 0.5), grey, glass), "4:1", message},
                               {bsdf("mask", grey), "4:1", message},
                               {bsdf("normalmap", squares("normalmap"), glass), "4:1", message},
                               {bsdf("twosided", grey), "4:1", "cannot be twosided"}});
}

TEST(BsdfErrors, BitmapsOutsideOfTheirRange) {
    const TemporaryFolder folder;
    write_image(folder / "bright.exr", 2, 1, 1, {0.5f, 1.5f});
    write_image(folder / "below.exr", 2, 1, 1, {0.5f, -0.5f});
    const auto expect = [&](const std::string& type, const std::string& name, const std::string& file,
                            const std::string& message, const std::string& nested = "") {
        EXPECT_THAT(error_of(type, bitmap(name, file) + nested, folder / "t.xml"),
                    StartsWith((folder / "t.xml") + ":4:1: '" + name + "' must " + message))
            << type;
    };
    for (const auto& [type, names] : reflectances)
        for (const std::string& name : names)
            expect(type, name, "bright.exr", "be between 0 and 1, but its texture has 1.5");
    expect("mask", "opacity", "bright.exr", "be between 0 and 1", grey);
    expect("blendbsdf", "weight", "below.exr", "be between 0 and 1", grey + grey);
    for (const auto& [type, name] :
         {std::pair("phong", "exponent"), std::pair("roughconductor", "alpha"), std::pair("roughdielectric", "alpha"),
          std::pair("conductor", "eta"), std::pair("roughconductor", "k")})
        expect(type, name, "below.exr", "not be negative, but its texture has -0.5");
}

}  // namespace
}  // namespace gib::test::bsdf_error_test
