// Tests of <texture> elements: their meaning, and the errors of wrong ones with their place.

#include "common/reader/scene_texture.h"
#include "common/scene/scene.h"

#include "common/images/linear_file.h"
#include "common/materials/material.h"
#include "tests/support/scene_errors.h"
#include "tests/support/texture_fixtures.h"

namespace gib::test::scene_texture_test {
namespace {

constexpr float decoded_128 = 0.21586050f;  ///< the linear value of the sRGB byte 128
const FileFormat bytes{OIIO::TypeDesc::UINT8, 0, {}, {}};

class SceneTextures : public ::testing::Test {
protected:
    SceneTextures() {
        write_image(folder_ / "two.png", 2, 1, 3, {0, 0, 0, 1, byte(128), byte(64)}, bytes);
        write_image(folder_ / "bright.exr", 2, 1, 1, {0.5f, 1.5f});
        write_image(folder_ / "below.exr", 2, 1, 1, {0.5f, -0.25f});
    }

    struct Parsed {
        Texture texture;
        std::string hash;
    };
    enum class Kind { color, number };
    /// The reflectance of the first bsdf of `body`, which starts on line 2.
    Parsed parse(const std::string& body, ColorRange range = ColorRange::unit, Kind kind = Kind::color) const {
        ContentHash hash;
        LoadWarnings warnings;
        const ExpandedXml xml = expand_xml(scene_xml("\n" + body), main_, {}, {}, hash, warnings);
        const XmlIds ids(xml.root, warnings);
        TextureFiles files(xml.files, hash, ids);
        Properties properties(*std::find_if(xml.root.children.begin(), xml.root.children.end(),
                                            [](const XmlElement& e) { return e.tag == "bsdf"; }),
                              ids);
        const auto parse = kind == Kind::color ? parse_textured : parse_textured_number;
        const Texture texture = parse(properties, "reflectance", 0.5f, range, files);
        properties.finish();
        return {texture, hash.hex()};
    }
    /// The reflectance of a bsdf that holds `property`, on line 2.
    Texture reflectance(const std::string& property) const { return parse(bsdf("diffuse", property)).texture; }
    std::string error_of(const std::string& body, ColorRange range = ColorRange::unit, Kind kind = Kind::color) const {
        return input_error_of([&] { parse(body, range, kind); });
    }
    /// The error of a bsdf whose content starts on line 3.
    std::string error_in(const std::string& content, ColorRange range = ColorRange::unit) const {
        return error_of(bsdf("diffuse", "\n", content), range);
    }
    /// Expects errors of contents of a bsdf, which start on line 3.
    void expect_errors_in(const std::vector<ExpectedError>& rows, ColorRange range = ColorRange::unit) const {
        expect_errors(
            rows, [&](const std::string& content) { return error_in(content, range); }, main_);
    }
    static std::string bitmap(const std::string& file, const std::string& more = "") {
        return named("texture", "reflectance", "bitmap", filename(file), more);
    }
    template <class... Content>
    static std::string board(const Content&... content) {
        return named("texture", "reflectance", "checkerboard", content...);
    }
    static inline const std::string refers = bsdf("diffuse", reference("reflectance", "t"));

    TemporaryFolder folder_;
    std::string main_ = folder_ / "main.xml";
};

TEST_F(SceneTextures, OfABitmapTakeMitsubasParameters) {
    const auto red = [&](const std::string& more, float u) {
        return reflectance(bitmap("two.png", more)).color(Vec2{u, 0.5f})[0];
    };
    const std::string nearest = text("filter_type", "nearest");
    const auto wrap = [](const std::string& mode) { return text("wrap_mode", mode); };
    for (const auto& [more, u, value] : {std::tuple(nearest, 0.4f, 0.f),
                                         {nearest, 0.6f, 1.f},
                                         {nearest + wrap("repeat"), 1.3f, 0.f},
                                         {nearest + wrap("mirror"), 1.3f, 1.f},
                                         {wrap("clamp"), -5.f, 0.f},
                                         {wrap("clamp"), 5.f, 1.f},
                                         {wrap("zero"), 1.6f, 0.f},
                                         {wrap("white"), -0.6f, 1.f}})
        EXPECT_EQ(red(more, u), value) << more << u;
    const std::string matrix = "<matrix value='1 0 0 0.5  0 1 0 0  0 0 1 0  0 0 0 1'/>";
    for (const std::string& transform :
         {to_uv(scale(2, 3, 1), translate(0.25, 0, 0)), to_uv(rotate('z', 180)), to_uv(matrix)})
        EXPECT_NEAR(red(transform, 0.25f), 1, 1e-6) << transform;
    EXPECT_NEAR(red(text("channel", "b"), 0.75f), 0.0512695f, 1e-6);  // the value of byte 64
    EXPECT_NEAR(red(text("format", "fp16") + flag("accel", false), 0.75f), 1, 1e-6);
    const Texture raw = reflectance(bitmap("two.png", flag("raw")));
    EXPECT_NEAR(raw.color(Vec2{0.75f, 0.5f})[1], byte(128), 1e-6);
}

TEST_F(SceneTextures, MayBeReferredTo) {
    const std::string shared = with_id("texture", "bitmap", "t", filename("two.png")) + "\n";
    EXPECT_NEAR(parse(shared + refers).texture.color(Vec2{0.75f, 0.5f})[0], 1, 1e-6);
    EXPECT_NEAR(parse(refers + shared).texture.color(Vec2{0.75f, 0.5f})[0], 1, 1e-6);
    EXPECT_THAT(error_of(refers), StartsWith(main_ + ":2:46: there is no object with the id 't'"));
}

TEST_F(SceneTextures, OfACheckerboardMayHoldTextures) {
    const Texture plain = reflectance(board());
    EXPECT_EQ(plain.color(Vec2{0.2f, 0.2f})[0], 0.4f);
    EXPECT_EQ(plain.color(Vec2{0.2f, 0.7f})[0], 0.2f);
    const Texture nested =
        reflectance(board(rgb("color0", "0.1 0.2 0.3"), named("texture", "color1", "bitmap", filename("two.png")),
                          to_uv(scale(2, 2, 1))));
    EXPECT_EQ(nested.color(Vec2{0.1f, 0.1f})[2], 0.3f);
    EXPECT_EQ(nested.color(Vec2{0.6f, 0.6f})[2], 0.3f);
    EXPECT_NEAR(nested.color(Vec2{0.75f, 0.4f})[1], decoded_128, 1e-6) << "the bitmap keeps the surface's own uv";
    EXPECT_TRUE(nested.maximum().isApprox(Color(1, decoded_128, 0.3f), 1e-5f));
}

TEST_F(SceneTextures, AsNumbersTakeFloatsAndTextures) {
    const auto of = [&](const std::string& property) {
        return parse(bsdf("mask", property), ColorRange::unit, Kind::number).texture;
    };
    EXPECT_EQ(of("").value(Vec2{0, 0}), 0.5f);
    EXPECT_EQ(of(number("reflectance", 0.3)).value(Vec2{0, 0}), 0.3f);
    EXPECT_NEAR(of(bitmap("two.png")).value(Vec2{0.25f, 0.5f}), 0, 1e-6);
    // Mitsuba's eval_1 of a constant colour is the mean of its channels, also within a texture.
    const Texture colour = of(rgb("reflectance", "0.1 0.2 0.6"));
    EXPECT_NEAR(colour.value(Vec2{0, 0}), 0.3f, 1e-7f);
    EXPECT_EQ(colour.value(Vec2{0, 0}), colour.maximum()[0]);
    EXPECT_EQ(of(spectrum("reflectance", 0.25)).value(Vec2{0, 0}), 0.25f);
    EXPECT_NEAR(of(board(rgb("color1", "0.1 0.2 0.6"))).value(Vec2{0.25f, 0.25f}), 0.3f, 1e-7f);
    expect_errors(
        {{number("reflectance", 1.5), "3:27", "'reflectance' must be between 0 and 1, not 1.5"},
         {rgb("reflectance", "0.5 0.5 1.5"), "3:25", "'reflectance' must be between 0 and 1, not 1.5"},
         {text("reflectance", "0.5"), "3:1",
          "'reflectance' cannot be a <string>; it takes: <rgb>, <float>, <integer>, <spectrum>"}},
        [&](const std::string& property) {
            return error_of(bsdf("mask", "\n", property), ColorRange::unit, Kind::number);
        },
        main_);
}

// In Mitsuba both tags make objects of one class.
TEST_F(SceneTextures, AndSpectraMayStandUnderEitherTag) {
    const std::string colour = rgb("color", "0.4 0.2 0.1");
    for (const std::string tag : {"texture", "spectrum"}) {
        const auto object = [&](const std::string& type, const std::string& inside) {
            return named(tag, "reflectance", type, inside);
        };
        const Texture srgb = reflectance(object("srgb", colour));
        EXPECT_TRUE((srgb.color(Vec2{0, 0}) == Color(0.4f, 0.2f, 0.1f)).all());
        const Texture uniform = reflectance(object("uniform", number("value", 0.3)));
        EXPECT_TRUE((uniform.color(Vec2{0, 0}) == 0.3f).all());
        EXPECT_FALSE(reflectance(object("checkerboard", "")).constant());
        const Texture nested = reflectance(board(named(tag, "color0", "srgb", colour)));
        EXPECT_EQ(nested.color(Vec2{0.25f, 0.25f})[0], 0.4f);
        EXPECT_EQ(parse(with_id(tag, "srgb", "t", colour) + refers).texture.mean()[1], 0.2f);
        expect_errors_in(
            {{object("srgb", ""), "3:1", "'srgb' needs 'color'"},
             {object("marble", ""), tag == "texture" ? "3:29" : "3:30", "the " + tag + " 'marble' is not supported"}});
    }
}

TEST_F(SceneTextures, AddTheBytesOfTheirImagesToTheHash) {
    const std::string body = bsdf("diffuse", bitmap("two.png"));
    const std::string first = parse(body).hash;
    EXPECT_EQ(parse(body).hash, first);
    write_image(folder_ / "two.png", 2, 1, 3, {0, 0, 0, 1, byte(128), byte(65)}, bytes);
    EXPECT_NE(parse(body).hash, first);
}

TEST_F(SceneTextures, OutsideOfTheirRangeAreRefused) {
    const std::string unit = "'reflectance' must be between 0 and 1";
    expect_errors_in({{bitmap("bright.exr"), "3:1", unit + ", but its texture has 1.5"},
                      {bitmap("below.exr"), "3:1", unit},
                      {board("\n", number("color1", 1.5)), "4:22", "'color1' must be between 0 and 1"}});
    EXPECT_EQ(error_in(bitmap("bright.exr"), ColorRange::non_negative), "no error");
    expect_errors_in({{bitmap("below.exr"), "3:1", "'reflectance' must not be negative, but its texture has -0.25"}},
                     ColorRange::non_negative);
    const std::string shared = with_id("texture", "bitmap", "t", filename("bright.exr")) + "\n";
    EXPECT_THAT(error_of(shared + refers), StartsWith(main_ + ":3:22: " + unit));
}

TEST_F(SceneTextures, InImageFilesThatAreWrongAreErrorsOfTheFile) {
    const auto error = [&](const std::string& name) { return error_in(bitmap(name)); };
    const auto expect = [&](const std::string& name, const std::string& message) {
        EXPECT_THAT(error(name), AllOf(StartsWith((folder_ / name) + ":1:1: "), HasSubstr(message)));
    };
    folder_.write("text.png", "this is no image");
    expect("text.png", "not an image that can be read");
    folder_.write("empty.exr", "");
    expect("empty.exr", "not an image that can be read");
    folder_.write("sub/x", "");
    EXPECT_THAT(error("sub"), AllOf(StartsWith(folder_ / "sub"), HasSubstr("folder")));
    folder_.write("zero.ppm", "P6\n0 0\n255\n");
    expect("zero.ppm", "the image has no pixels");
    const auto values = random_values(64, 64, 3);
    const std::string whole = read_file(write_image(folder_ / "w.exr", 64, 64, 3, values));
    folder_.write("cut.exr", whole.substr(0, whole.size() / 2));
    expect("cut.exr", "the image is damaged");
    auto holed = values;
    holed[3 * (64 * 5 + 7) + 1] = std::numeric_limits<float>::quiet_NaN();
    write_image(folder_ / "nan.exr", 64, 64, 3, holed);
    expect("nan.exr", "the pixel in column 7, row 5 is not finite");
    write_image(folder_ / "uv.exr", 2, 1, 2, {0, 0, 0, 0}, {OIIO::TypeDesc::FLOAT, 0, {"u", "v"}, {}});
    expect("uv.exr", "no channels R,G,B or Y of one layer; the image has u, v");
    write_image(folder_ / "p3.exr", 1, 1, 3, {0, 0, 0},
                {OIIO::TypeDesc::FLOAT, 0, {}, {0.68f, 0.32f, 0.265f, 0.69f, 0.15f, 0.06f, 0.3127f, 0.329f}});
    expect("p3.exr", "the file's chromaticities are not those of sRGB");
    write_image(folder_ / "srgb.exr", 1, 1, 3, {0, 0, 0},
                {OIIO::TypeDesc::FLOAT, 0, {}, {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f}});
    EXPECT_EQ(error("srgb.exr"), "no error");
}

TEST(BumpAndNormalMaps, TurnAndShadowNormalsUnlessToldOtherwise) {
    const TemporaryFolder folder;
    const std::string height = write_image(folder / "height.exr", 2, 1, 1, {0, 1});
    const auto options = [](const std::string& type, const std::string& map, const std::string& booleans) {
        const auto loaded = load(shape("rectangle", bsdf(type, map, booleans, bsdf("diffuse"))));
        const Material& material = loaded.scene->material_of_shape(0);
        const auto* bump = std::get_if<BumpMap>(&material.node());
        return bump ? bump->options : std::get<NormalMap>(material.node()).options;
    };
    const std::string no_turn = flag("flip_invalid_normals", false), no_shadow = flag("use_shadowing_function", false);
    for (const auto& [type, map] : {std::pair("bumpmap", texture("bitmap", filename(height))),
                                    std::pair("normalmap", rgb("normalmap", "0.5 0.5 1"))})
        for (const auto& [booleans, turn, shadow] : {std::tuple(std::string(), true, true),
                                                     {no_turn, false, true},
                                                     {no_shadow, true, false},
                                                     {no_turn + no_shadow, false, false}}) {
            EXPECT_EQ(options(type, map, booleans).flip_invalid_normals, turn) << map << booleans;
            EXPECT_EQ(options(type, map, booleans).use_shadowing_function, shadow) << map << booleans;
        }
}

// The texture `scale` of Mitsuba 0.6 multiplies a texture, or the colour `value`.
TEST_F(SceneTextures, ScaleMultipliesATexture) {
    const auto scaled = [&](const std::string& factor, const std::string& inner) {
        return reflectance(named("texture", "reflectance", "scale", factor, inner));
    };
    const std::string nearest = text("filter_type", "nearest"), image = texture("bitmap", filename("two.png"), nearest);
    const std::string half = number("scale", 0.5), colour = rgb("scale", "0.5 1 0.25");
    const Texture plain = reflectance(bitmap("two.png", nearest));
    const Vec2 at(0.75f, 0.5f);
    EXPECT_TRUE(scaled(half, image).color(at).isApprox(0.5f * plain.color(at)));
    EXPECT_TRUE(scaled(half, image).mean().isApprox(0.5f * plain.mean()));
    EXPECT_TRUE(scaled(half, image).maximum().isApprox(0.5f * plain.maximum()));
    EXPECT_NEAR(scaled(half, image).value(at), 0.5f * plain.value(at), 1e-6f);
    EXPECT_EQ(scaled(half, image).aspect(), 2);
    const Color factor(0.5f, 1.f, 0.25f);
    EXPECT_TRUE(scaled(colour, image).color(at).isApprox(factor * plain.color(at)));
    EXPECT_NEAR(scaled(colour, image).value(at), luminance(factor * plain.color(at)), 1e-6f);
    EXPECT_TRUE(scaled(half, image).has_gradient());
    EXPECT_FALSE(scaled(colour, image).has_gradient());
    // Only the product must be a reflectance.
    const Texture squares = scaled(number("scale", 0.25), texture("checkerboard", rgb("color0", 4)));
    EXPECT_TRUE(squares.color(Vec2(0.2f, 0.2f)).isApprox(Color::Ones()));
    const Texture grey = scaled(half, rgb("value", 0.8));
    EXPECT_TRUE(grey.constant());
    EXPECT_NEAR(grey.color(at)[0], 0.4f, 1e-6f);
}

TEST_F(SceneTextures, ScaleErrors) {
    const auto error = [&](const std::string& inside) {
        return error_of(bsdf("diffuse", named("texture", "reflectance", "scale", inside)));
    };
    EXPECT_THAT(error(number("scale", 0.5)), HasSubstr("'scale' needs 'value'"));
    EXPECT_THAT(error(number("scale", -0.5) + rgb("value", 0.8)), HasSubstr("'scale' must not be negative"));
    EXPECT_THAT(error(number("scale", 2) + rgb("value", 0.8)),
                HasSubstr("'reflectance' must be between 0 and 1, but its texture has 1.6"));
}

}  // namespace
}  // namespace gib::test::scene_texture_test
