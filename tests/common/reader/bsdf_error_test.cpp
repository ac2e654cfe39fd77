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

TEST(BsdfErrors, UnknownParametersListWhatThePluginTakes) {
    const TemporaryFolder folder;
    const std::string bumps = bitmap("bumps", write_image(folder / "bumps.exr", 2, 1, 1, {0, 1})) + grey,
                      normals = squares("normalmap");
    const std::array<std::string, 3> rows[] = {
        {"diffuse", "", "reflectance"},
        {"dielectric", "", "int_ior, ext_ior, cauchy_b, abbe, specular_reflectance, specular_transmittance"},
        {"thindielectric", "", "int_ior, ext_ior, specular_reflectance, specular_transmittance"},
        {"roughdielectric", "",
         "int_ior, ext_ior, cauchy_b, abbe, sample_visible, distribution, alpha, alpha_u, alpha_v, "
         "specular_reflectance, specular_transmittance"},
        {"conductor", "", "material, eta, k, ext_eta, specular_reflectance"},
        {"roughconductor", "",
         "material, eta, k, ext_eta, sample_visible, distribution, alpha, alpha_u, alpha_v, specular_reflectance"},
        {"plastic", "", "int_ior, ext_ior, nonlinear, diffuse_reflectance, specular_reflectance"},
        {"roughplastic", "",
         "int_ior, ext_ior, nonlinear, sample_visible, distribution, alpha, alpha_u, alpha_v, diffuse_reflectance, "
         "specular_reflectance"},
        {"phong", "", "exponent, diffuse_reflectance, specular_reflectance"},
        {"principled", "",
         "base_color, roughness, anisotropic, metallic, spec_trans, spec_tint, sheen, sheen_tint, flatness, clearcoat, "
         "clearcoat_gloss, specular, eta, diffuse_reflectance_sampling_rate, main_specular_sampling_rate, "
         "clearcoat_sampling_rate"},
        {"blendbsdf", grey + grey, "<bsdf>, weight"},
        {"mask", grey, "opacity, <bsdf>"},
        {"null", "", "nothing"},
        {"bumpmap", bumps, "scale, flip_invalid_normals, use_shadowing_function, <texture>, <bsdf>"},
        {"normalmap", grey + normals, "normalmap, flip_invalid_normals, use_shadowing_function, <bsdf>"},
        {"twosided", grey, "<bsdf>"}};
    for (const auto& [type, parameters, takes] : rows) {
        EXPECT_EQ(error_of(type, parameters), "no error") << type;
        const std::string gloss = parameters + "\n" + number("gloss", 1),
                          medium = parameters + "\n" + element("medium", "homogeneous");
        const std::string place = type == "bumpmap" ? "6:1" : "5:1";  // the bitmap's name is on a line of its own
        expect_errors(type,
                      {{gloss, place, "bsdf '" + type + "' does not take a parameter 'gloss'; it takes: " + takes},
                       {medium, place, "bsdf '" + type + "' does not take a <medium>; it takes: " + takes}});
        EXPECT_TRUE(error_of(type, gloss).ends_with("; it takes: " + takes)) << type;
    }
}

TEST(BsdfErrors, Reflectances) {
    for (const auto& [type, names] : reflectances) {
        for (const std::string& name : names) {
            const std::string range = "'" + name + "' must be between 0 and 1, not ";
            const std::string kinds = "; it takes: " + textured_kinds;
            const std::string rgb_place = value_place("rgb", name), path = "5:1";
            expect_errors(type,
                          {{number(name, 1.5), number_place(name), range + "1.5"},
                           {number(name, -0.1), number_place(name), range + "-0.1"},
                           {rgb(name, "0.5 1.01 0"), rgb_place, range + "1.01"},
                           {rgb(name, -0.1), rgb_place, range + "-0.1"},
                           {rgb(name, "1 2"), rgb_place, "'" + name + "' takes one or three numbers, found 2"},
                           {rgb(name, "nan"), rgb_place, "bad number 'nan'"},
                           {rgb(name, "#ff00"), rgb_place, "bad colour '#ff00': expected #rrggbb"},
                           {"<spectrum name='" + name + "' value='2'/>", value_place("spectrum", name), range + "2"},
                           {"<integer name='" + name + "' value='0.5'/>", value_place("integer", name),
                            "bad number '0.5': expected an integer"},
                           {text(name, "0.5"), "4:1", "'" + name + "' cannot be a <string>" + kinds},
                           {"<vector name='" + name + "' value='1'/>", "4:1", "cannot be a <vector>" + kinds},
                           {"<bsdf name='" + name + "' type='null'/>", "4:1", "cannot be a <bsdf>" + kinds},
                           {"<texture name='" + name + "' type='bitmap'/>", "4:1", "'bitmap' needs 'filename'"},
                           {bitmap(name, "no.png"), path, "there is no file 'no.png'; searched: "}});
        }
    }
}

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

TEST(BsdfErrors, RoughCoatsThinnerThanWhatIsOutside) {
    const std::string thinner = number("int_ior", 1.3) + number("ext_ior", 1.5), outside = number("ext_ior", 1.6);
    for (const std::string type : {"roughdielectric", "plastic"})
        for (const std::string& indices : {thinner, outside})
            EXPECT_EQ(error_of(type, indices), "no error") << type;
    expect_errors("roughplastic", {{thinner, number_place("int_ior"), "'int_ior' must be above 'ext_ior'"},
                                   {outside, number_place("ext_ior"), "'int_ior' must be above 'ext_ior'"}});
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

TEST(BsdfErrors, Roughnesses) {
    const std::string either = "give either 'alpha' or both 'alpha_u' and 'alpha_v'";
    const std::string u = number("alpha_u", 0.1), v = number("alpha_v", 0.2);
    for (const std::string type : {"roughdielectric", "roughconductor", "roughplastic"}) {
        const std::string kinds = type == "roughplastic" ? "<float>, <integer>" : textured_kinds;
        expect_errors(
            type, {{number("alpha", -0.1), "4:21", "'alpha' must "},
                   {number("alpha", "nan"), "4:21", "bad number 'nan'"},
                   {number("alpha", "2e4"), "4:21", "10000, not 2"},
                   {text("alpha", "0.1"), "4:1", "'alpha' cannot be a <string>; it takes: " + kinds},
                   {"<vector name='alpha' value='1'/>", "4:1", "'alpha' cannot be a <vector>; it takes: " + kinds},
                   {number("alpha_u", -1) + v, "4:23", "'alpha_u' must "},
                   {u + "\n" + number("alpha_v", "nan"), "5:23", "bad number 'nan'"},
                   {u + "\n" + text("alpha_v", "1"), "5:1", "'alpha_v' cannot be a <string>"},
                   {u, "4:1", either},
                   {v, "4:1", either},
                   {number("alpha", 0.1) + "\n" + u, "5:1", either},
                   {number("alpha", 0.1) + "\n" + u + v, "5:1", either},
                   {text("distribution", "phong"), "4:29", "'distribution' cannot be 'phong'; it takes: beckmann, ggx"},
                   {text("distribution", ""), "4:29", "'distribution' cannot be ''; it takes: beckmann, ggx"},
                   {number("distribution", 1), "4:1", "'distribution' cannot be a <float>; it takes: <string>"},
                   {number("sample_visible", 1), "4:1", "'sample_visible' cannot be a <float>; it takes: <boolean>"},
                   {"<boolean name='sample_visible' value='yes'/>", "4:32", "'yes' is neither true nor false"}});
        // A roughness of 0 acts as MicrofacetDistribution::min_alpha, as in Mitsuba.
        EXPECT_EQ(error_of(type, number("alpha", 0)), "no error");
    }
    for (const std::string type : {"roughdielectric", "roughconductor"}) {
        EXPECT_EQ(error_of(type, squares("alpha")), "no error");
        EXPECT_EQ(error_of(type, u + v), "no error");
    }
}

/// The tables of a roughplastic are made for one roughness. Mitsuba takes a single number too, but it may be given as
/// two equal ones.
TEST(BsdfErrors, ARoughplasticHasOneRoughness) {
    const std::string u = number("alpha_u", 0.1);
    expect_errors("roughplastic",
                  {{squares("alpha"), "4:1", "'alpha' cannot be a <texture>; it takes: <float>, <integer>"},
                   {bitmap("alpha", "no.png"), "4:1", "'alpha' cannot be a <texture>"},
                   {squares("alpha_u") + squares("alpha_v"), "4:1", "'alpha_u' cannot be a <texture>"},
                   {u + "\n" + number("alpha_v", 0.2), "5:23",
                    "the 'alpha_u' and 'alpha_v' of a roughplastic must be the same"}});
    EXPECT_EQ(error_of("roughplastic", u + number("alpha_v", 0.1)), "no error");
}

TEST(BsdfErrors, Plastics) {
    for (const std::string type : {"plastic", "roughplastic"})
        expect_errors(type, {{number("nonlinear", 1), "4:1", "'nonlinear' cannot be a <float>; it takes: <boolean>"},
                             {"<boolean name='nonlinear' value='1'/>", "4:27", "'1' is neither true nor false"}});
}

TEST(BsdfErrors, Phong) {
    expect_errors("phong", {{number("exponent", -1), "4:24", "'exponent' must not be negative: -1"},
                            {number("exponent", "nan"), "4:24", "bad number 'nan'"},
                            {number("exponent", "1e9"), "4:24", "'exponent' must be at most 1e+08, not 1e+09"},
                            {"<integer name='exponent' value='2.5'/>", "4:26", "bad number '2.5': expected an integer"},
                            {text("exponent", "3"), "4:1", "cannot be a <string>; it takes: " + textured_kinds}});
    EXPECT_EQ(error_of("phong", number("diffuse_reflectance", 0.4) + number("specular_reflectance", 0.6)), "no error");
}

TEST(BsdfErrors, WeightsAndOpacities) {
    for (const auto& [type, name, nested] :
         {std::array<std::string, 3>{"blendbsdf", "weight", grey + grey}, {"mask", "opacity", grey}}) {
        const std::string place = number_place(name), range = "'" + name + "' must be between 0 and 1, not ";
        const std::string kinds = "; it takes: " + textured_kinds;
        expect_errors(type, {{number(name, 1.5) + nested, place, range + "1.5"},
                             {number(name, -0.1) + nested, place, range + "-0.1"},
                             {number(name, "nan") + nested, place, "bad number 'nan'"},
                             {text(name, "0.5") + nested, "4:1", "'" + name + "' cannot be a <string>" + kinds},
                             {rgb(name, "1.5") + nested, value_place("rgb", name), range + "1.5"},
                             {bitmap(name, "no.png") + nested, "5:1", "there is no file 'no.png'"}});
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

TEST(BsdfErrors, PrincipledTakesSharesOfOneAndOneIndex) {
    for (const char* name : {"roughness", "anisotropic", "metallic", "spec_trans", "spec_tint", "sheen", "sheen_tint",
                             "flatness", "clearcoat", "clearcoat_gloss"}) {
        const std::string quoted = std::string("'") + name + "'";
        EXPECT_EQ(error_of("principled", number(name, 1)), "no error");
        expect_errors("principled", {{number(name, 1.5), number_place(name), quoted + " must be at most 1, not 1.5"},
                                     {number(name, -0.5), number_place(name), quoted}});
    }
    expect_errors("principled", {{number("specular", 1.1), number_place("specular"), "must be between 0 and 1"},
                                 {number("eta", 0), number_place("eta"), "'eta' must be above 0"},
                                 {number("eta", 1000), number_place("eta"), "must be between 0.01 and 100"}});
    EXPECT_THAT(error_of("principled", number("eta", 1.5) + number("specular", 0.5)),
                HasSubstr("give either 'specular' or 'eta'"));
}

TEST(BsdfErrors, PrincipledThinTakesTwiceTheTransmittedShare) {
    EXPECT_EQ(error_of("principledthin", number("diff_trans", 2)), "no error");
    expect_errors("principledthin",
                  {{number("diff_trans", 2.5), number_place("diff_trans"), "must be at most 2, not 2.5"},
                   {number("spec_trans", 1.5), number_place("spec_trans"), "must be at most 1, not 1.5"},
                   {number("eta", 0), number_place("eta"), "'eta' must be between 0.01 and 100"},
                   {number("metallic", 1), "4:1", "does not take a parameter 'metallic'"}});
}

}  // namespace
}  // namespace gib::test::bsdf_error_test
