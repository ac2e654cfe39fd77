// Laws for every method and every material; the registry is walked, no method is named.
#include "common/sampling/sampler.h"
#include "tests/support/methods_under_test.h"
#include "tests/support/moments.h"

#include <numbers>

namespace gib::materials_test {
namespace {

using namespace test;

struct NamedMaterial {
    std::string name, xml;
};
void PrintTo(const NamedMaterial& material, std::ostream* out) { *out << material.name; }

std::string distribution(const std::string& type, double alpha) {
    return text("distribution", type) + number("alpha", alpha);
}

std::vector<NamedMaterial> materials() {
    const std::string grey = bsdf("diffuse", rgb("reflectance", "0.6"));
    const std::string gold = "<string name='material' value='Au'/>";
    return {
        {"diffuse", grey},
        {"dielectric", bsdf("dielectric")},
        {"thindielectric", bsdf("thindielectric")},
        {"conductor", bsdf("conductor", gold)},
        {"roughconductor_sharp", bsdf("roughconductor", gold + distribution("ggx", 0.05))},
        {"roughconductor_dull", bsdf("roughconductor", gold + distribution("beckmann", 0.4))},
        {"roughconductor_brushed", bsdf("roughconductor", gold + number("alpha_u", 0.3) + number("alpha_v", 0.05))},
        {"roughdielectric_sharp", bsdf("roughdielectric", distribution("beckmann", 0.05))},
        {"roughdielectric_dull", bsdf("roughdielectric", distribution("ggx", 0.3))},
        {"plastic", bsdf("plastic", rgb("diffuse_reflectance", "0.7"))},
        {"roughplastic_sharp", bsdf("roughplastic", rgb("diffuse_reflectance", "0.7") + distribution("ggx", 0.08))},
        {"roughplastic_dull", bsdf("roughplastic", rgb("diffuse_reflectance", "0.7") + distribution("beckmann", 0.3))},
        {"phong_sharp", bsdf("phong", number("exponent", 400))},
        {"phong_dull", bsdf("phong", number("exponent", 10))},
        {"principled_coated", bsdf("principled", rgb("base_color", "0.6 0.3 0.2") + number("clearcoat", 1) +
                                                     number("clearcoat_gloss", 0.2) + number("metallic", 0.3))},
        {"principled_glass",
         bsdf("principled", rgb("base_color", "0.6 0.3 0.2") + number("spec_trans", 0.6) + number("roughness", 0.6))},
        {"principledthin", bsdf("principledthin", rgb("base_color", "0.6 0.3 0.2") + number("spec_trans", 0.5) +
                                                      number("roughness", 0.6) + number("diff_trans", 1.2))},
        {"blend", bsdf("blendbsdf", number("weight", 0.3) + grey + bsdf("roughconductor", distribution("ggx", 0.05)))},
        {"mask", bsdf("mask", number("opacity", 0.4) + grey)},
        {"null", bsdf("null")},
        {"twosided", bsdf("twosided", bsdf("plastic"))},
        {"normalmap",
         bsdf("normalmap", "<texture type='checkerboard' name='normalmap'>" + rgb("color0", "0.6 0.5 0.9") +
                               rgb("color1", "0.6 0.5 0.9") + "</texture>" + grey)},
        {"normalmap_turned",
         bsdf("normalmap", rgb("normalmap", "0.1 0.4 0.8") + bsdf("diffuse", rgb("reflectance", "1")))},
    };
}

/// A plate of the material in a black box whose walls emit radiance 1, seen at an angle from its front.
LoadedScene plate_in_furnace(const std::string& material, double degrees) {
    return test::Scene(element("sensor", "orthographic",
                               to_world(scale(0.02), translate(0, 0, -1), rotate('y', 180), rotate('y', degrees)),
                               box_film(16)),
                       shape("rectangle", material),
                       shape("cube", flag("flip_normals"), to_world(scale(4)), one_sided("0"), area_light(1)))
        .load();
}

/// The share of uniform light that the front of a material sends towards wo, including light that passes
/// straight through. It is the mean weight of the material's samples, which the laws of
/// bsdf_laws_test.cpp tie to the integral of f.
Colord albedo(const Material& material, const Vec3& wo) {
    constexpr std::uint32_t n = 1 << 16;
    const MaterialPoint point{
        {0.25f, 0.25f}, Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitY(), frame_along(Vec3::UnitZ(), Vec3::UnitX())};
    const Bsdf at = material.at(point);
    Colord scattered = Colord::Zero();
    for (std::uint32_t i = 0; i < n; ++i) {
        const Sampler u(PointSet::sobol, 9, 0, i);
        const auto s = at.sample_local(wo, u.get_2d(0), u.get_2d(1), Transport::radiance);
        if (s) scattered += (s->f * (std::abs(s->wi.z()) / s->pdf_w)).cast<double>() / n;
    }
    return at.straight_on_local(wo).cast<double>() + (1 - static_cast<double>(at.pass_through())) * scattered;
}

class EveryMaterial : public testing::TestWithParam<std::tuple<MethodUnderTest, NamedMaterial>> {};

INSTANTIATE_TEST_SUITE_P(Registry, EveryMaterial,
                         testing::Combine(testing::ValuesIn(methods_that_sample_pixels()),
                                          testing::ValuesIn(materials())),
                         [](const auto& test) {
                             return std::get<0>(test.param).name + "_" + std::get<1>(test.param).name;
                         });

TEST_P(EveryMaterial, ShowsItsAlbedoInAWhiteFurnace) {
    const auto& [method, material] = GetParam();
    for (double degrees : {0.0, 45.0, 75.0}) {
        const auto scene = plate_in_furnace(material.xml, degrees);
        if (!method.resolves(*scene.scene)) GTEST_SKIP() << "the method leaves out a part of this material's light";
        const double angle = degrees * std::numbers::pi / 180;
        const Vec3 wo(static_cast<float>(std::sin(angle)), 0.f, static_cast<float>(std::cos(angle)));
        const Colord expected = albedo(scene.scene->material_of_shape(0), wo);
        const Colord found = mean_of(render(scene, method.label, 64).total());
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(found[c], expected[c], 0.01) << degrees << " channel " << c;
            EXPECT_LE(found[c], 1.005) << degrees;
        }
    }
}

class MaskedLight : public OfAMethod {};
INSTANTIATE_TEST_SUITE_P(Registry, MaskedLight, testing::ValuesIn(methods_that_sample_pixels(Work::small)),
                         name_of_method);

// The sun is above two black masks, a floor below them and the camera between masks and floor. A shadow ray is dimmed
// by both masks. Nothing is left to chance, so the tolerance is rounding alone.
TEST_P(MaskedLight, IsWhatTheMasksLetThrough) {
    const auto sheet = [](double z, double opacity) {
        return shape("rectangle", to_world(scale(9), translate(0, 0, z)),
                     bsdf("mask", number("opacity", opacity), diffuse(0)));
    };
    const auto scene = test::Scene(camera(20, to_world(rotate('y', 180), translate(0, 0, 1)), box_film(4)),
                                   emitter("directional", vector("direction", 0, 0, -1), rgb("irradiance", 2)),
                                   shape("rectangle", one_sided("0.5")), sheet(2, 0.4), sheet(3, 0.7))
                           .load();
    const double expected = 0.5 * 2 / std::numbers::pi * (1 - 0.4) * (1 - 0.7);
    EXPECT_NEAR(mean_of(rendered(scene, 1).total())[0], expected, 1e-5);
}

/// Light on a grey floor, seen from above, that comes by way of a wall. The wall's normals point steeply up, so from
/// the floor those of its upper part are seen from behind. A spot light grazes the wall from the side.
LoadedScene light_by_way_of_a_wall(bool flip, bool shadow) {
    const std::string wall = bsdf("normalmap", rgb("normalmap", "0.933 0.5 0.75"), flag("flip_invalid_normals", flip),
                                  flag("use_shadowing_function", shadow), bsdf("diffuse", rgb("reflectance", 0.8)));
    return test::Scene(element("sensor", "orthographic", to_world(scale(0.1), rotate('y', 180), translate(0, 0, 3)),
                               box_film(4)),
                       shape("rectangle", to_world(scale(3)), one_sided("0.5")),
                       shape("rectangle", to_world(rotate('y', -90), translate(1, 0, 1.1)), wall),
                       emitter("spot", number("cutoff_angle", 30), to_world(look_at("0.3 -2 1", "1 0 1", "0 0 1"))))
        .load();
}

/// The mean of the indirect light over so many seeds that its standard error is 2 %, but at most over 256.
Moments indirect_light(const LoadedScene& scene, const std::string& label, std::uint32_t passes) {
    Moments moments;
    for (std::uint64_t seed = 1; seed <= 256; ++seed) {
        moments.add(mean_of(*render(scene, label, passes, seed)[Component::indirect])[0]);
        if (seed >= 8 && moments.standard_error() < 0.02 * moments.mean()) break;
    }
    return moments;
}

class PerturbedNormals : public OfAMethod {};
INSTANTIATE_TEST_SUITE_P(Registry, PerturbedNormals, testing::ValuesIn(methods_under_test(Work::fine)), name_of_method);

// The shadowing belongs to the light's direction and the turned normal to the eye's, from whichever end a path is
// followed. Each of them changes this light by 30 % or more.
TEST_P(PerturbedNormals, LookAlikeFromBothEnds) {
    if (!method().simulates(Effect::bump_maps)) GTEST_SKIP();
    if (!method().samples_pixels()) GTEST_SKIP() << "too noisy";
    double before = 0;
    for (bool both : {false, true}) {
        const auto scene = light_by_way_of_a_wall(both, both);
        const double path = indirect_light(scene, "path", 256).mean();
        const Moments found = indirect_light(scene, method().label, 64);
        EXPECT_LT(found.standard_error(), 0.03 * path) << both;
        EXPECT_NEAR(found.mean(), path, 0.15 * path) << both;
        EXPECT_GT(path, 1.5 * before) << "the case tells them apart";
        before = path;
    }
}

}  // namespace
}  // namespace gib::materials_test
