// Tests of indices of refraction: conductors' by the name of the material, and dispersion: the strata of wavelengths and
// their weights, the prism's angle of minimum deviation, and the means that dispersion must not change.

#include "common/color/dispersion.h"
#include "common/color/cie.h"
#include "common/color/conductor_index.h"
#include "common/scene/effects.h"
#include "tests/support/scene_errors.h"
#include "tests/support/seed_means.h"

#include <numbers>

namespace gib::test::dispersion_test {
namespace {

// Palik's measurements of copper (Handbook of Optical Constants of Solids, 1985) give the same index as the preset
// that was made from them.
TEST(ConductorIndex, IsTheMeanOfItsSpectrum) {
    const SampledSpectrum palik{
        {344.389008, 364.647003, 387.437988, 413.266998, 442.785980, 476.846008, 516.583008, 539.044006, 563.545044,
         590.381042, 619.900024, 652.526001, 670.162048, 688.778015, 708.456970, 729.294006, 826.533020},
        {1.31, 1.27, 1.18, 1.18, 1.17, 1.15, 1.12, 1.04, 0.826, 0.468, 0.272, 0.214, 0.215, 0.213, 0.214, 0.223, 0.26}};
    const Colord eta = rgb_of_spectrum(palik, Illuminant::none);
    EXPECT_LT((conductor_index("Cu_palik")->eta - eta.cast<float>()).abs().maxCoeff(), 1e-6f);
}

/// Means over seeds are tested at this many standard errors. Student's t with 15 degrees of freedom
/// exceeds them with a probability of 6e-5, so that some 20 tests in this file give a false alarm for at
/// most 1 in 800 choices of seeds.
constexpr double sigmas = 5.5;
constexpr int seeds = 16;

TEST(Dispersion, WeightsAreNotNegativeAndAverageToOne) {
    Colord sum = Colord::Zero();
    for (int k = 0; k < wavelength_strata; ++k) {
        EXPECT_GE(stratum_weight(k).minCoeff(), 0) << k;
        EXPECT_GT(stratum_weight(k).maxCoeff(), 0) << k;
        sum += stratum_weight(k).cast<double>();
    }
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(sum[c] / wavelength_strata, 1, 1e-6);
}

// The strata run from violet to red: 620 nm is red, 530 nm green and 450 nm blue.
TEST(Dispersion, StrataHaveTheColoursOfTheirWavelengths) {
    const auto weight_at = [](double wavelength) {
        int nearest = 0;
        for (int k = 1; k < wavelength_strata; ++k)
            if (std::abs(stratum_wavelength(k) - wavelength) < std::abs(stratum_wavelength(nearest) - wavelength))
                nearest = k;
        return stratum_weight(nearest);
    };
    const Color red = weight_at(620), green = weight_at(530), blue = weight_at(450);
    EXPECT_GT(red[0], 4 * std::max(red[1], red[2]));
    EXPECT_GT(green[1], 4 * std::max(green[0], green[2]));
    EXPECT_GT(blue[2], 4 * std::max(blue[0], blue[1]));
    EXPECT_NEAR(stratum_wavelength(0), 400 + 300 / 64.0, 1e-9);
    EXPECT_NEAR(stratum_wavelength(wavelength_strata - 1), 700 - 300 / 64.0, 1e-9);
}

// Schott's BK7 has n_d = 1.5168 and Abbe's number 64.17; tables give B = 0.0042 um^2 for it.
TEST(Dispersion, AbbesNumberGivesTheIndexAtTheLines) {
    const double b = cauchy_b_of_abbe(1.5168, 64.17);
    EXPECT_NEAR(b, 0.0042, 5e-5);
    EXPECT_DOUBLE_EQ(cauchy_index(1.5168, b, d_line), 1.5168);
    EXPECT_NEAR(0.5168 / (cauchy_index(1.5168, b, f_line) - cauchy_index(1.5168, b, c_line)), 64.17, 1e-9);
    EXPECT_GT(cauchy_index(1.5168, b, 400), cauchy_index(1.5168, b, 700));
}

const std::string flint = number("int_ior", 1.6) + number("ext_ior", 1) + number("abbe", 30);

/// A prism along z with an apex angle of 60 degrees, whose apex is above; the middle of its box is the origin.
std::string prism(const TemporaryFolder& folder, const std::string& material) {
    const std::string mesh =
        folder.write("prism.obj",
                     "v -1 -0.8660254 -9\nv 1 -0.8660254 -9\nv 0 0.8660254 -9\nv -1 -0.8660254 9\nv 1 -0.8660254 9\n"
                     "v 0 0.8660254 9\nf 1 3 2\nf 4 5 6\nf 1 2 5\nf 1 5 4\nf 2 3 6\nf 2 6 5\nf 3 1 4\nf 3 4 6\n");
    return shape("obj", filename(mesh), flag("face_normals"), material);
}

/// A direction in the plane of the prism's cross-section.
Vec3 direction_at(double angle) {
    return {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0.f};
}
/// The angle [rad] of the direction of light that meets the left face at `incidence`. The face rises at 60 degrees,
/// so its normal points to (-sin 60, cos 60).
double angle_of(double incidence) { return std::numbers::pi / 6 + incidence - std::numbers::pi / 3; }
const Vec3 on_left_face(-0.5f, 0.f, 0.1f);

struct Passage {
    Ray ray;               ///< after it has left the prism
    double transmittance;  ///< the product over both interfaces
};

/// The passage of light of a stratum through the prism; both interfaces transmit it.
Passage passage(const gib::Scene& scene, int stratum, double incidence) {
    const Vec3 w = direction_at(angle_of(incidence));
    // Loading moves the scene's origin, so the start is relative to the prism's box.
    const Vec3 start = bounds_of(scene.shapes()[0]).center() + on_left_face - 3.f * w;
    Passage result{Ray{start, w}, 1};
    for (int interface = 0; interface < 2; ++interface) {
        auto hit = scene.intersect(result.ray);
        EXPECT_TRUE(hit);
        if (!hit) return result;
        scene.disperse(*hit, stratum);
        const Vec3 wo = hit->shading.to_local(-result.ray.d);
        const auto next = hit->bsdf->sample_local(wo, Vec2(0.9999f, 0.5f), Vec2(0.5f, 0.5f), Transport::radiance);
        EXPECT_TRUE(next && next->wi.z() * wo.z() < 0) << "not transmitted";
        if (!next) return result;
        result.transmittance *= double{next->pdf_w};  // a delta lobe's pdf_w is its share of light
        result.ray = hit->spawn_ray(hit->shading.to_world(next->wi));
    }
    return result;
}

/// The angle by which the prism turns light, in radians.
double deviation(const gib::Scene& scene, int stratum, double incidence) {
    const Vec3 w = direction_at(angle_of(incidence));
    const double cosine = static_cast<double>(passage(scene, stratum, incidence).ray.d.dot(w));
    return std::acos(std::clamp(cosine, -1.0, 1.0));
}

// A prism of apex angle A turns light by at least delta, where sin((A + delta) / 2) = n sin(A / 2), at the angle of
// incidence (A + delta) / 2 (Born and Wolf, section 4.7.2). Here A is 60 degrees.
TEST(Dispersion, APrismTurnsEveryWavelengthByItsAngleOfMinimumDeviation) {
    const TemporaryFolder folder;
    const std::string textured =
        named("texture", "specular_transmittance", "checkerboard", rgb("color0", 0.9), rgb("color1", 0.8));
    for (const std::string& transmittance : {std::string(), textured}) {
        const auto scene = load(prism(folder, bsdf("dielectric", flint, transmittance)));
        ASSERT_TRUE(scene.scene->has_dispersion());
        double before = std::numbers::pi;
        for (int k = 0; k < wavelength_strata; ++k) {
            const double n = cauchy_index(1.6, cauchy_b_of_abbe(1.6, 30), stratum_wavelength(k));
            const double incidence = std::asin(n / 2), least = 2 * incidence - std::numbers::pi / 3;
            EXPECT_NEAR(deviation(*scene.scene, k, incidence), least, 2e-6) << k;
            EXPECT_GT(deviation(*scene.scene, k, incidence + 0.05), least + 1e-4) << k;
            EXPECT_GT(deviation(*scene.scene, k, incidence - 0.05), least + 1e-4) << k;
            EXPECT_LT(least, before) << "longer waves are turned less";
            before = least;
        }
    }
}

// The lamp stands where the prism sends only the shorter waves. The camera looks into the prism along one ray and
// sees their share of white light.
TEST(Dispersion, ThePathTracerSeesTheWavesThatThePrismSendsToALamp) {
    const TemporaryFolder folder;
    const double incidence = std::asin(0.8), degree = std::numbers::pi / 180;
    const Vec3 w = direction_at(angle_of(incidence)), eye = on_left_face - 3.f * w,
               lamp = 100.f * direction_at(angle_of(incidence) - 49 * degree);
    const auto xyz = [](const Vec3& v) { return fmt::format("{}, {}, {}", v.x(), v.y(), v.z()); };
    const auto scene = scene_of(scene_xml(
        camera(0.0001, to_world(look_at(xyz(eye), xyz(on_left_face), "0, 0, 1")), box_film(2)) +
        prism(folder, bsdf("dielectric", flint)) +
        shape("rectangle", to_world(scale(3.5, 20, 1), look_at(xyz(lamp), "0, 0, 0", "0, 0, 1")), area_light(1))));
    Colord expected = Colord::Zero();
    int seen = 0;
    for (int k = 0; k < wavelength_strata; ++k) {
        const Passage way = passage(*scene.scene, k, incidence);
        const auto hit = scene.scene->intersect(way.ray);
        if (!hit || !hit->emitter) continue;
        ++seen;
        expected += way.transmittance / wavelength_strata * stratum_weight(k).cast<double>();
    }
    EXPECT_GT(seen, 5);
    EXPECT_LT(seen, wavelength_strata - 5);
    EXPECT_GT(expected[2], 2 * expected[0]) << "the lamp is bluish";
    const std::array<Moments, 3> found = means_over_seeds(scene, 4096, seeds);
    for (std::size_t c = 0; c < 3; ++c) {
        const double value = expected[static_cast<int>(c)];
        // Light that is reflected once at each of the three faces inside leaves in the same direction; it is below
        // 1e-3 of the rest.
        EXPECT_NEAR(found[c].mean(), value, sigmas * found[c].standard_error() + 1e-3 * value) << c;
        EXPECT_LT(found[c].standard_error(), 0.02 * value) << "the test would not see an error";
    }
}

/// A ball of glass of index 1.5; `parameters` are the further ones of its bsdf.
std::string glass_ball(const std::string& type, const std::string& parameters) {
    return shape("sphere", bsdf(type, number("int_ior", 1.5), parameters));
}
const std::string view = camera(40, to_world(translate(0, 0, -4)), box_film(16));
const std::string floor_and_lamp =
    shape("rectangle", to_world(scale(4), rotate('x', -90), translate(0, -1, 0)), bsdf("diffuse")) +
    shape("sphere", center(1, 3, 0), radius(1.2), area_light("20, 10, 5"));

// Lossless glass under a white sky is invisible in every channel, however strongly it splits light.
TEST(Dispersion, WhiteLightStaysWhiteInTheMean) {
    for (const bool rough : {false, true}) {
        const std::string type = rough ? "roughdielectric" : "dielectric",
                          split = number("cauchy_b", 0.05) + (rough ? number("alpha", 0.01) : "");
        const LoadedScene scene = Scene(view, constant_light(1), glass_ball(type, split)).load();
        for (const Moments& m : means_over_seeds(scene, 64, seeds)) {
            // A rough interface loses the light that its facets would scatter a second time, which
            // is below 1e-3 at this roughness.
            EXPECT_NEAR(m.mean(), 1, sigmas * m.standard_error() + (rough ? 1e-3 : 1e-6)) << type;
            EXPECT_LT(m.standard_error(), 0.01) << "the test would not see an error";
        }
    }
}

// Without dispersion, the code for it is not run; with very little dispersion, that code
// gives the same image in the mean.
TEST(Dispersion, OfNothingIsThatOfPlainGlass) {
    const auto scene = [](const std::string& more) {
        return Scene(view, floor_and_lamp, glass_ball("dielectric", more)).load();
    };
    const auto plain = scene(""), zero = scene(number("cauchy_b", 0)), tiny = scene(number("cauchy_b", 1e-9));
    EXPECT_FALSE(effects_of(*zero.scene).has(Effect::dispersion));
    EXPECT_TRUE(effects_of(*tiny.scene).has(Effect::dispersion));
    const Image a = render(plain, "path", 4).total(), b = render(zero, "path", 4).total();
    for (std::size_t i = 0; i < a.pixels(); ++i)
        ASSERT_TRUE((a.at(i) == b.at(i)).all()) << i;
    const auto means = means_over_seeds(plain, 512, seeds), split = means_over_seeds(tiny, 512, seeds);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(means[c].mean(), split[c].mean(),
                    sigmas * std::hypot(means[c].standard_error(), split[c].standard_error()));
        EXPECT_LT(split[c].standard_error(), 0.02 * split[c].mean()) << "the test would not see an error";
    }
}

}  // namespace
}  // namespace gib::test::dispersion_test
