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

/// The place (line:column) where the value of the property `tag` with this name stands on line 4.
std::string value_place(const std::string& tag, const std::string& name) {
    return "4:" + std::to_string((tag + name).size() + std::string("< name='' ").size() + 1);
}

std::string number_place(const std::string& name) { return value_place("float", name); }

const std::string textured_kinds = "<rgb>, <float>, <integer>, <spectrum>, <texture>";
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
                                 {number(name, -1), place, "'" + name + "' must be above 0, not -1"},
                                 {number(name, "1e-50"), place, "'" + name + "' must be above 0"},
                                 {number(name, "nan"), place, "bad number 'nan'"},
                                 {number(name, "inf"), place, "bad number 'inf'"},
                                 {number(name, "1e39"), place, "too large"},
                                 {number(name, "1e4"), place, "'int_ior' over 'ext_ior' must be between 0.01 and 100"},
                                 {number(name, "1e-4"), place, "'int_ior' over 'ext_ior' must be between 0.01 and 100"},
                                 {rgb(name, "1.5"), "4:1", "'" + name + "' cannot be a <rgb>" + kinds},
                                 {squares(name), "4:1", "'" + name + "' cannot be a <texture>" + kinds}});
        }
        expect_errors(type, {{number("int_ior", "1e30") + number("ext_ior", "1e-30"), "4:23", "not 1e+60"}});
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

TEST(BsdfErrors, Conductors) {
    const std::string gold = text("material", "Au"), either = "give either 'material' or 'eta' and 'k'";
    for (const std::string type : {"conductor", "roughconductor"}) {
        expect_errors(type, {{text("material", "Unobtainium"), "4:25",
                              "there is no material 'Unobtainium'; known are: none, a-C, Ag, Al, AlAs, AlAs_palik"},
                             {number("material", 1), "4:1", "'material' cannot be a <float>; it takes: <string>"},
                             {gold + number("eta", 1), "4:25", either},
                             {gold + number("k", 1), "4:25", either}});
        for (const std::string name : {"eta", "k"})
            expect_errors(
                type, {{number(name, -1), number_place(name), "'" + name + "' must not be negative: -1"},
                       {rgb(name, "1 1 -1"), value_place("rgb", name), "'" + name + "' must not be negative: -1"},
                       {"<spectrum name='" + name + "' value='400:-1 500:1'/>", value_place("spectrum", name),
                        "'" + name + "' must not be negative: -1"},
                       {number(name, "nan"), number_place(name), "bad number 'nan'"},
                       {number(name, "1e10"), number_place(name), "'" + name + "' must be at most 1e+06, not 1e+10"},
                       {text(name, "gold"), "4:1",
                        "cannot be a <string>; it takes: <rgb>, <float>, <integer>, <spectrum>, <texture>"},
                       {bitmap(name, "no.exr"), "5:1", "there is no file 'no.exr'"},
                       {"<texture name='" + name + "' type='checkerboard'>" + number("color0", "1e7") + "</texture>",
                        "4:1", "'" + name + "' must be at most 1e+06, not 1e+07 of its texture"}});
        EXPECT_EQ(error_of(type, text("material", "none") + number("k", 2)), "no error");
        EXPECT_EQ(error_of(type, number("eta", 0) + number("k", 0)), "no error");
    }
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

TEST(BsdfErrors, BumpAndNormalMaps) {
    const TemporaryFolder folder;
    const std::string height = bitmap("any", write_image(folder / "height.exr", 2, 1, 1, {0, 1})) + grey + "\n";
    const std::string needs = "a normalmap needs a texture named 'normalmap'";
    expect_errors("bumpmap", {{grey, "3:1", "a bumpmap needs a texture"},
                              {grey + "\n" + squares("any"), "5:1", "must be a bitmap: it needs a slope"},
                              {height + squares("other"), "6:1", "can hold only one <texture>"},
                              {bitmap("any", "no.png") + grey, "5:1", "there is no file 'no.png'"},
                              {"<texture type='bitmap'/>" + grey, "4:1", "'bitmap' needs 'filename'"},
                              {height + number("any_float", 1), "6:1", "does not take a parameter 'any_float'"},
                              {height + number("scale", "nan"), "6:21", "bad number 'nan'"},
                              {height + number("scale", "1e20"), "6:21", "'scale' must be between -1e+09 and 1e+09"},
                              {height + number("scale", "-1e20"), "6:21", "'scale' must be between -1e+09 and 1e+09"},
                              {height + text("scale", "1"), "6:1", "'scale' cannot be a <string>"},
                              {height + squares("scale"), "6:1", "'scale' cannot be a <texture>"}});
    expect_errors("normalmap",
                  {{grey, "3:1", needs},
                   {grey + squares("normals"), "3:1", needs},
                   {grey + "\n" + rgb("normalmap", "0 0 2"), "5:23", "between 0 and 1"},
                   {grey + "\n<bsdf name='normalmap' type='null'/>", "5:1", "'normalmap' cannot be a <bsdf>"},
                   {grey + squares("normalmap") + "\n" + squares("other"), "5:1",
                    "bsdf 'normalmap' does not take a <texture>; it takes: normalmap, flip_invalid_normals, "
                    "use_shadowing_function, <bsdf>"},
                   {bitmap("normalmap", "no.png") + grey, "5:1", "there is no file 'no.png'"}});
    EXPECT_EQ(error_of("bumpmap", height + number("scale", -3)), "no error");
    for (const std::string name : {"flip_invalid_normals", "use_shadowing_function"}) {
        const auto boolean = [&](const std::string& value) {
            return "<boolean name='" + name + "' value='" + value + "'/>";
        };
        const std::string place = "6" + value_place("boolean", name).substr(1);
        for (const auto& [type, sound] : {std::pair<std::string, std::string>("bumpmap", height),
                                          {"normalmap", grey + squares("normalmap") + "\n\n"}}) {
            EXPECT_EQ(error_of(type, sound + boolean("false")), "no error");
            expect_errors(type,
                          {{sound + boolean("1"), place, "'1' is neither true nor false"},
                           {sound + boolean(""), place, "'' is neither true nor false"},
                           {sound + number(name, 1), "6:1", "'" + name + "' cannot be a <float>; it takes: <boolean>"},
                           {sound + squares(name), "6:1", "'" + name + "' cannot be a <texture>"},
                           {sound + "<boolean name='" + name + "'/>", "6:1", "value"},
                           {sound + boolean("true") + "\n" + boolean("true"), "7:1", "'" + name + "'"}});
        }
    }
}

TEST(BsdfErrors, BitmapsThatCannotBeRead) {
    const TemporaryFolder folder;
    folder.write("text.png", "this is no image");
    write_image(folder / "bright.exr", 2, 1, 1, {0.5f, 1.5f});
    write_image(folder / "below.exr", 2, 1, 1, {0.5f, -0.5f});
    const auto error = [&](const std::string& type, const std::string& name, const std::string& file,
                           const std::string& nested = "") {
        return error_of(type, bitmap(name, file) + nested, folder / "t.xml");
    };
    const auto expect = [&](const std::string& type, const std::string& name, const std::string& nested = "") {
        EXPECT_THAT(error(type, name, "text.png", nested),
                    StartsWith((folder / "text.png") + ":1:1: not an image that can be read"))
            << type;
    };
    for (const auto& [type, names] : reflectances) {
        for (const std::string& name : names) {
            expect(type, name);
            EXPECT_THAT(error(type, name, "bright.exr"),
                        StartsWith((folder / "t.xml") + ":4:1: '" + name +
                                   "' must be between 0 and 1, but its texture has 1.5"))
                << type;
        }
    }
    expect("blendbsdf", "weight", grey + grey);
    expect("mask", "opacity", grey);
    expect("bumpmap", "any", grey);
    expect("normalmap", "normalmap", grey);
    const std::string at = (folder / "t.xml") + ":4:1: ";
    EXPECT_THAT(error("mask", "opacity", "bright.exr", grey), StartsWith(at + "'opacity' must be between 0 and 1"));
    EXPECT_THAT(error("blendbsdf", "weight", "below.exr", grey + grey), StartsWith(at + "'weight' must be between"));
    for (const auto& [type, name] :
         {std::pair("phong", "exponent"), std::pair("roughconductor", "alpha"), std::pair("roughdielectric", "alpha"),
          std::pair("conductor", "eta"), std::pair("roughconductor", "k")}) {
        expect(type, name);
        EXPECT_THAT(error(type, name, "below.exr"),
                    StartsWith(at + "'" + name + "' must not be negative, but its texture has -0.5"))
            << type;
    }
}

}  // namespace
}  // namespace gib::test::bsdf_error_test
