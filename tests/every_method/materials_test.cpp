// Laws for every method and every material; the registry is walked, no method is named.
#include "common/sampling/sampler.h"
#include "tests/support/scene_fixtures.h"

#include <fmt/format.h>

namespace gib::materials_test {
namespace {

using test::mean_of;
using test::render;

struct NamedMaterial {
    std::string name, xml;
};
void PrintTo(const NamedMaterial& material, std::ostream* out) { *out << material.name; }

std::string rgb(const std::string& name, const std::string& value) {
    return "<rgb name='" + name + "' value='" + value + "'/>";
}
std::string number(const std::string& name, double value) {
    return "<float name='" + name + "' value='" + std::to_string(value) + "'/>";
}
std::string bsdf(const std::string& type, const std::string& inside = "") {
    return "<bsdf type='" + type + "'>" + inside + "</bsdf>";
}
std::string distribution(const std::string& type, double alpha) {
    return "<string name='distribution' value='" + type + "'/>" + number("alpha", alpha);
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

std::string boolean(const std::string& name, bool value) {
    return "<boolean name='" + name + "' value='" + (value ? "true" : "false") + "'/>";
}

/// A plate of the material in a black box whose walls emit radiance 1, seen at an angle from its front.
LoadedScene plate_in_furnace(const std::string& material, double degrees) {
    return test::scene_of(test::scene_xml(
        "<sensor type='orthographic'><transform name='to_world'><scale value='0.02'/>"
        "<translate z='-1'/><rotate y='1' angle='180'/>"
        "<rotate y='1' angle='" +
        std::to_string(degrees) + "'/></transform>" + test::box_film(16) + "</sensor><shape type='rectangle'>" +
        material +
        "</shape><shape type='cube'><boolean name='flip_normals' value='true'/><transform name='to_world'><scale "
        "value='4'/></transform><bsdf type='diffuse'>" +
        rgb("reflectance", "0") + "</bsdf><emitter type='area'>" + rgb("radiance", "1") + "</emitter></shape>"));
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

class MaskedLight : public testing::TestWithParam<std::string> {};

class EveryMaterial : public testing::TestWithParam<std::tuple<std::string, NamedMaterial>> {};

INSTANTIATE_TEST_SUITE_P(Registry, EveryMaterial,
                         testing::Combine(testing::ValuesIn(names_of_comparable_methods()),
                                          testing::ValuesIn(materials())),
                         [](const auto& test) { return std::get<0>(test.param) + "_" + std::get<1>(test.param).name; });

TEST_P(EveryMaterial, ShowsItsAlbedoInAWhiteFurnace) {
    const auto& [method, material] = GetParam();
    if (!test::samples_pixels(find_method(method))) GTEST_SKIP() << "too noisy";
    for (double degrees : {0.0, 45.0, 75.0}) {
        const auto scene = plate_in_furnace(material.xml, degrees);
        const Plan plan = ConfiguredMethod(MethodLabel{method, {}}).create({})->plan(*scene.scene);
        if (!plan.missing.empty() || !plan.unresolved.empty())
            GTEST_SKIP() << "the method leaves out a part of this material's light";
        const double angle = degrees * std::numbers::pi / 180;
        const Vec3 wo(static_cast<float>(std::sin(angle)), 0.f, static_cast<float>(std::cos(angle)));
        const Colord expected = albedo(scene.scene->material_of_shape(0), wo);
        const Colord found = mean_of(render(scene, method, 64).total());
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(found[c], expected[c], 0.01) << degrees << " channel " << c;
            EXPECT_LE(found[c], 1.005) << degrees;
        }
    }
}

// The sun is above two black masks, a floor below them and the camera between masks and floor. A shadow ray is dimmed
// by both masks. Nothing is left to chance, so the tolerance is rounding alone.
TEST_P(MaskedLight, IsWhatTheMasksLetThrough) {
    if (!test::samples_pixels(find_method(GetParam()))) GTEST_SKIP() << "too noisy";
    const auto sheet = [](double z, double opacity) {
        return fmt::format(
                   "<shape type='rectangle'><transform name='to_world'><scale value='9'/><translate "
                   "z='{}'/></transform>",
                   z) +
               bsdf("mask", number("opacity", opacity) + bsdf("twosided", bsdf("diffuse", rgb("reflectance", "0")))) +
               "</shape>";
    };
    const auto scene = test::scene_of(test::scene_xml(
        "<sensor type='perspective'><float name='fov' value='20'/><transform name='to_world'><rotate y='1' "
        "angle='180'/><translate z='1'/></transform>" +
        test::box_film(4) +
        "</sensor><emitter type='directional'><vector name='direction' value='0, 0, -1'/><rgb name='irradiance' "
        "value='2'/></emitter><shape type='rectangle'>" +
        bsdf("diffuse", rgb("reflectance", "0.5")) + "</shape>" + sheet(2, 0.4) + sheet(3, 0.7)));
    const double expected = 0.5 * 2 / std::numbers::pi * (1 - 0.4) * (1 - 0.7);
    EXPECT_NEAR(mean_of(render(scene, GetParam(), 1).total())[0], expected, 1e-5);
}
INSTANTIATE_TEST_SUITE_P(Registry, MaskedLight, testing::ValuesIn(names_of_comparable_methods()),
                         [](const auto& name) { return name.param; });

/// Light on a grey floor, seen from above, that comes by way of a wall. The wall's normals point steeply up, so from
/// the floor those of its upper part are seen from behind. A spot light grazes the wall from the side.
double light_by_way_of_a_wall(const std::string& method, std::uint32_t passes, int seeds, bool flip, bool shadow) {
    const std::string wall =
        bsdf("normalmap", rgb("normalmap", "0.933 0.5 0.75") + boolean("flip_invalid_normals", flip) +
                              boolean("use_shadowing_function", shadow) + bsdf("diffuse", rgb("reflectance", "0.8")));
    const auto scene = test::scene_of(test::scene_xml(
        "<sensor type='orthographic'><transform name='to_world'><scale value='0.1'/><rotate y='1' angle='180'/>"
        "<translate z='3'/></transform>" +
        test::box_film(4) +
        "</sensor><shape type='rectangle'><transform name='to_world'><scale value='3'/></transform>" +
        bsdf("diffuse", rgb("reflectance", "0.5")) +
        "</shape><shape type='rectangle'><transform name='to_world'><rotate y='1' angle='-90'/>"
        "<translate x='1' z='1.1'/></transform>" +
        wall +
        "</shape><emitter type='spot'><float name='cutoff_angle' value='30'/><transform name='to_world'><lookat "
        "origin='0.3 -2 1' target='1 0 1' up='0 0 1'/></transform></emitter>"));
    double sum = 0;
    for (int seed = 1; seed <= seeds; ++seed)
        sum += mean_of(render(scene, method, passes, static_cast<std::uint64_t>(seed))[Component::indirect].value())[0];
    return sum / seeds;
}

// The shadowing belongs to the light's direction and the turned normal to the eye's, from whichever end a path is
// followed. Each of them changes this light by 30 % or more. The tolerance allows for the standard error of eight
// photon maps, 4 to 6 %.
TEST(PerturbedNormals, LookAlikeToPathsAndPhotons) {
    double before = 0;
    for (bool both : {false, true}) {
        const double path = light_by_way_of_a_wall("path", 512, 1, both, both);
        const double photons =
            light_by_way_of_a_wall("photon_mapper photons=100000 caustic_photons=0 k=50", 1, 8, both, both);
        EXPECT_NEAR(photons, path, 0.15 * path) << both;
        EXPECT_GT(path, 1.5 * before) << "the case tells them apart";
        before = path;
    }
}

}  // namespace
}  // namespace gib::materials_test
