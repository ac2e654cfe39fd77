// Tests that spectra become the RGB that Mitsuba's RGB variants make of them.

#include "common/xml/scene_spectrum.h"

#include "common/color/cie.h"
#include "common/core/float_traps.h"
#include "common/scene/scene.h"
#include "tests/support/scene_errors.h"

namespace gib::test::scene_spectrum_test {
namespace {

Color color_of(const std::string& element, ColorRange range) {
    const XmlElement root = parse_xml("<scene>" + element + "</scene>", "t.xml");
    LoadWarnings warnings;
    return parse_spectrum(root.children[0], XmlIds(root, warnings), "x", range);
}

Color color_of_list(const std::string& list, ColorRange range) {
    return color_of(value_element("spectrum", "x", list), range);
}

void expect_near(const Color& a, const Color& b, float tolerance) {
    EXPECT_LT((a - b).abs().maxCoeff(), tolerance) << "(" << a.transpose() << ") is not (" << b.transpose() << ")";
}

/// The chromaticity (x, y) of a colour in RGB with the primaries and the white point of ITU-R BT.709.
Vec2d chromaticity(const Color& rgb) {
    Eigen::Matrix3d from_rgb;
    for (int i = 0; i < 3; ++i)
        from_rgb.col(i) = rgb_of_xyz(Vec3d::Unit(i).array()).matrix();
    const Vec3d xyz = from_rgb.inverse() * rgb.matrix().cast<double>();
    return xyz.head<2>() / xyz.sum();
}

// The expected values are the sums that CIE 15:2004 prints below its table of the observer, from 380 nm to 780 nm in
// steps of 5 nm.
TEST(Cie, TheObserversCurvesHaveTheirPublishedSums) {
    Colord sum = Colord::Zero();
    for (int wavelength = 380; wavelength <= 780; wavelength += 5)
        sum += cie_1931_xyz(wavelength);
    EXPECT_LT((sum - Colord(21.371524, 21.371327, 21.371540)).abs().maxCoeff(), 2e-6) << sum.transpose();
}

// CIE defines D65 at every 10 nm, and by straight lines in between.
TEST(Cie, D65IsLinearOverTenNanometres) {
    for (int wavelength = 365; wavelength < 830; wavelength += 10)
        EXPECT_NEAR(cie_d65(wavelength), (cie_d65(wavelength - 5) + cie_d65(wavelength + 5)) / 2, 1e-5) << wavelength;
}

// The expected values are the chromaticities that CIE 15 gives for equal energy and for D65. The latter is the white
// point of RGB.
TEST(Cie, WhitesHaveTheirChromaticities) {
    const Colord equal = rgb_of_spectrum([](double) { return 1.0; }, Illuminant::none);
    EXPECT_LT((chromaticity(equal.cast<float>()) - Vec2d(1.0 / 3, 1.0 / 3)).norm(), 1e-4);
    const Colord white = rgb_of_spectrum([](double) { return 1.0; }, Illuminant::d65);
    EXPECT_LT((chromaticity(white.cast<float>()) - Vec2d(0.31272, 0.32903)).norm(), 1e-4);
    expect_near(white.cast<float>(), Color::Ones(), 1.5e-3f);
}

TEST(Spectrum, AConstantIsGreyAsAReflectanceAndReddishAsAnEmission) {
    for (const auto range : {ColorRange::unit, ColorRange::non_negative})
        EXPECT_TRUE((color_of_list("0.7", range) == 0.7f).all());
    expect_near(color_of_list(" 10\n", ColorRange::emission), Color(12.04794f, 9.48291f, 9.08916f), 1e-5f);
}

TEST(Spectrum, AListThatIsConstantAgreesWithAConstant) {
    expect_near(color_of_list("300:0.5, 900:0.5", ColorRange::unit), Color::Constant(0.5f), 1e-3f);
    expect_near(color_of_list("300:10 900:10", ColorRange::emission), color_of_list("10", ColorRange::emission), 5e-3f);
}

// The colour that Mitsuba 3's own test expects of this list without D65 (src/core/tests/test_dict.py).
TEST(Spectrum, AnEmissionIsMitsubas) {
    expect_near(color_of_list("400:0.1, 500:0.2, 600:0.4, 700:0.1", ColorRange::emission),
                Color(0.442717f, 0.278474f, 0.118373f), 1e-6f);
}

TEST(Spectrum, AReflectanceIsSeenUnderD65) {
    const SampledSpectrum list{{400, 500, 600, 700}, {0.1, 0.2, 0.4, 0.1}};
    const Colord expected = rgb_of_spectrum([&](double w) { return list(w) * cie_d65(w); }, Illuminant::none);
    for (const auto range : {ColorRange::unit, ColorRange::non_negative})
        expect_near(color_of_list("400:0.1, 500:0.2, 600:0.4, 700:0.1", range), expected.cast<float>(), 1e-6f);
}

TEST(Spectrum, ColoursOutOfGamutAreClamped) {
    const Color cyan = color_of_list("490:5 500:5", ColorRange::emission);
    EXPECT_EQ(cyan[0], 0.f);
    EXPECT_GT(cyan[1], 0.f);
    // This spectrum is redder than any RGB reflectance.
    EXPECT_EQ(color_of_list("580:1 780:1", ColorRange::unit)[0], 1.f);
    EXPECT_GT(color_of_list("580:1 780:1", ColorRange::non_negative)[0], 1.f);
}

TEST(Spectrum, PluginsMeanTheSameAsLists) {
    const auto plugin = [](const std::string& type, const std::string& body, ColorRange range) {
        return color_of(named("spectrum", "x", type, body), range);
    };
    const auto emission = ColorRange::emission;
    const Color list = color_of_list("400:1 500:2 600:4", emission);
    expect_near(plugin("irregular", text("wavelengths", "400, 500, 600") + text("values", "1 2 4"), emission), list,
                1e-7f);
    expect_near(
        plugin("regular", number("wavelength_min", 400) + number("wavelength_max", 600) + text("values", "1, 2, 4"),
               emission),
        list, 1e-7f);
    EXPECT_TRUE((plugin("uniform", number("value", 3), emission) == 3.f).all());
    EXPECT_TRUE((plugin("d65", "", emission) == 1.f).all());
    expect_near(plugin("d65", number("scale", 2) + rgb("color", "1 2 3"), emission), Color(2, 4, 6), 1e-7f);
    expect_near(plugin("srgb", rgb("color", "0.1 0.2 0.3"), ColorRange::unit), Color(0.1f, 0.2f, 0.3f), 1e-7f);
}

Color blackbody(double temperature) {
    return color_of(named("spectrum", "x", "blackbody", number("temperature", std::to_string(temperature))),
                    ColorRange::emission);
}

// CIE's illuminant A is Planck's radiation of 2848 K for a second radiation constant of 14350 um K. The candela was
// once defined as a sixtieth of the intensity of a square centimetre of freezing platinum, 2041.4 K, whose luminance
// is therefore 60e4 cd/m^2; the luminance is 683 lm/W times the integral of y.
TEST(Spectrum, BlackbodiesHaveTheirColourAndLuminance) {
    EXPECT_LT((chromaticity(blackbody(2848 * 14387.77 / 14350)) - Vec2d(0.44757, 0.40745)).norm(), 1e-4);
    const double luminance_at_platinum = static_cast<double>(luminance(blackbody(2041.4))) * 683 * 106.857;
    EXPECT_NEAR(luminance_at_platinum, 60e4, 0.01 * 60e4);
}

TEST(Spectrum, ABlackbodyTakesAScale) {
    const std::string scaled = named("spectrum", "x", "blackbody", number("temperature", 3000), number("scale", 0.25));
    EXPECT_TRUE(color_of(scaled, ColorRange::emission).isApprox(0.25f * blackbody(3000), 1e-6f));
}

TEST(Spectrum, StandsWhereverAColourDoes) {
    const TemporaryFolder folder;
    folder.write("data/a.spd", "# wavelengths\n400 0.1 # first\r\n\n  500\t0.2\n600 0.4\n700 0.1");
    const std::string file = "<spectrum name='intensity' filename='a.spd'/>";
    const auto scene = [&](const std::string& intensity) {
        return load_in(folder, "<path value='data'/>" +
                                   shape("sphere", bsdf("diffuse", "<spectrum name='reflectance' filename='a.spd'/>")) +
                                   with_id("spectrum", "d65", "white") + emitter("point", intensity));
    };
    const auto intensity = [](const LoadedScene& loaded) {
        return std::get<PointLight>(loaded.scene->lights().at(0)).intensity;
    };
    const LoadedScene first = scene(file);
    expect_near(intensity(first), Color(0.442717f, 0.278474f, 0.118373f), 1e-6f);
    EXPECT_TRUE((intensity(scene(reference("intensity", "white"))) == 1.f).all());
    EXPECT_TRUE((intensity(scene(integer("intensity", 2))) == 2.f).all());
    folder.write("data/a.spd", "400 0.1\n500 0.2\n600 0.5\n700 0.1");
    EXPECT_NE(scene(file).content_hash, first.content_hash);
}

/// The error of a lamp whose emitter's content is on line 3.
std::string lamp_error(const std::string& content, const std::string& path = "t.xml") {
    return scene_error(shape("sphere", emitter("area", "\n", content)), path);
}

TEST(SpectrumErrors, Lists) {
    expect_errors({{"400:0.1 500", "3:30", "bad spectrum '500': expected wavelength:value"},
                   {"0.1 0.2", "3:30", "bad spectrum '0.1'"},
                   {"400:0.1 300:0.2", "3:30", "the wavelengths must increase: 300 follows 400"},
                   {"400:-0.1 500:0.2", "3:30", "'reflectance' must be between 0 and 1, not -0.1"},
                   {"400:1.1 500:0.2", "3:30", "'reflectance' must be between 0 and 1, not 1.1"},
                   {"400: 0.1", "3:30", "bad number ''"},
                   {"400:0.1", "3:30", "a spectrum needs two wavelengths or more, found 1"},
                   {"1.5", "3:30", "'reflectance' must be between 0 and 1, not 1.5"}},
                  [](const std::string& list) {
                      const std::string reflectance = value_element("spectrum", "reflectance", list);
                      return scene_error(shape("sphere", bsdf("diffuse", "\n", reflectance)));
                  });
    const auto list = [](const std::string& value) { return value_element("spectrum", "radiance", value); };
    expect_errors({{list("400:-1 500:2"), "3:27", "'radiance' must not be negative: -1"},
                   {list("-1"), "3:27", "'radiance' must not be negative: -1"},
                   {list("400:1e39 500:0"), "3:27", "too large"},
                   {"<spectrum name='radiance'/>", "3:1", "<spectrum> needs the attribute"},
                   {"<spectrum name='radiance' value='1' filename='a'/>", "3:37", "there is no file 'a'"},
                   {rgb("radiance", "#ff00"), "3:22", "bad colour '#ff00': expected #rrggbb"}},
                  [](const std::string& content) { return lamp_error(content); });
}

}  // namespace
}  // namespace gib::test::scene_spectrum_test
