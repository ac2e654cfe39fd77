// Tests of lights that show an image: environment maps (orientation, interpolation, and the sampling of directions in
// proportion to their radiance), and projectors, against closed forms and as the counterpart of a camera.

#include "common/lights/environment_map.h"
#include "common/scene/scene.h"
#include "tests/support/light_fixtures.h"
#include "tests/support/moments.h"
#include "tests/support/scene_fixtures.h"

#include <array>

namespace gib::test::environment_map_test {
namespace {

EnvironmentMap map_of(const Image& image) { return {image, identity_frame()}; }

struct NamedMap {
    const char* name;
    Image image;
};

/// Maps that are hard to sample: one bright texel, light at a pole alone, black rows, one row, one column, one texel.
std::vector<NamedMap> hard_maps() {
    const Color white = Color::Ones(), black = Color::Zero();
    return {{"noise", image_of(7, 5, noise)},
            {"two by three", image_of(2, 3, noise)},
            {"constant", image_of(3, 4, [&](int, int) { return white; })},
            {"sun", image_of(16, 9, [&](int x, int y) { return x == 15 && y == 3 ? 1e6f * white : 1e-3f * white; })},
            {"sun on black", image_of(16, 9, [&](int x, int y) { return x == 0 && y == 3 ? white : black; })},
            {"black rows", image_of(6, 8, [&](int x, int y) { return y % 3 == 1 ? noise(x, y) : black; })},
            {"north pole", image_of(8, 6, [&](int, int y) { return y == 0 ? white : black; })},
            {"south pole", image_of(8, 6, [&](int, int y) { return y == 5 ? white : black; })},
            {"one row", image_of(5, 1, noise)},
            {"one column", image_of(1, 6, noise)},
            {"one texel", image_of(1, 1, noise)}};
}

/// The integral of f over the sphere by quadrature in cells with texel centres on their boundaries, where the
/// interpolation has its kinks.
double cell_integral(const Image& image, const std::function<double(const Vec3&)>& f) {
    // Texel centres are half a texel off the first column's edge, so two cells a texel put them on cell boundaries.
    return sphere_integral(4 * std::max(image.height - 1, 1), 2 * image.width, 16, f);
}

TEST(EnvironmentMap, TexelsLieWhereMitsubaPutsThem) {
    const int width = 8, height = 5;
    const Image image = image_of(width, height, noise);
    const EnvironmentMap map = map_of(image);
    for (int y = 1; y + 1 < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Vec3 w =
                envmap_direction(std::numbers::pi * y / (height - 1), 2 * std::numbers::pi * (x + 0.5) / width);
            EXPECT_TRUE(map.radiance(w).isApprox(noise(x, y), 1e-4f)) << x << ' ' << y;
        }
    // Row 0 is up (+y). The left edge is -z, a quarter of the width is +x and the centre is +z;
    // each lies between two columns.
    const auto middle_row = [&](int left) { return Color(0.5f * (noise(left, 2) + noise(left + 1, 2))); };
    EXPECT_TRUE(map.radiance(Vec3::UnitX()).isApprox(middle_row(1), 1e-4f));
    EXPECT_TRUE(map.radiance(Vec3::UnitZ()).isApprox(middle_row(3), 1e-4f));
    EXPECT_TRUE(map.radiance(-Vec3::UnitX()).isApprox(middle_row(5), 1e-4f));
    EXPECT_TRUE(map.radiance(-Vec3::UnitZ()).isApprox(0.5f * (noise(7, 2) + noise(0, 2)), 1e-4f));
    const Image poles = image_of(4, 3, [](int, int y) { return Color::Constant(static_cast<float>(y)); });
    EXPECT_NEAR(map_of(poles).radiance(Vec3::UnitY())[0], 0.f, 1e-5f);
    EXPECT_NEAR(map_of(poles).radiance(-Vec3::UnitY())[0], 2.f, 1e-5f);
    EXPECT_NEAR(map_of(poles).radiance(envmap_direction(std::numbers::pi / 4, 1))[0], 0.5f, 1e-5f);
}

TEST(EnvironmentMap, PdfIntegratesToOneAndTheIntegralIsThatOfRadiance) {
    for (const auto& [name, image] : hard_maps()) {
        SCOPED_TRACE(name);
        const EnvironmentMap map = map_of(image);
        EXPECT_NEAR(cell_integral(image, [&](const Vec3& w) { return static_cast<double>(map.pdf_w(w)); }), 1, 1e-3);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(cell_integral(image, [&](const Vec3& w) { return static_cast<double>(map.radiance(w)[c]); }),
                        map.integral()[c], 1e-3 * map.integral()[c]);
    }
}

TEST(EnvironmentMap, SamplesHaveTheDensityAndTheRadianceOfTheirDirection) {
    for (const auto& [name, image] : hard_maps()) {
        SCOPED_TRACE(name);
        const EnvironmentMap map = map_of(image);
        for (std::uint32_t i = 0; i < 4096; ++i) {
            const auto sample = map.sample(Sampler(PointSet::sobol, 3, 0, i).get_2d(0));
            EXPECT_NEAR(sample.w.norm(), 1.f, 1e-6f);
            // Rounding moves the direction by 1e-7, which is 1e-6 of the distance between texels; the radiance may
            // change by a factor of a million over that distance.
            EXPECT_TRUE(sample.radiance.isApprox(map.radiance(sample.w), 1e-3f) || sample.radiance.maxCoeff() < 1e-4f);
            EXPECT_NEAR(sample.pdf_w / map.pdf_w(sample.w), 1.f, 1e-3f);
        }
    }
}

TEST(EnvironmentMap, IsFiniteAtThePolesAndAtTheSeam) {
    for (const auto& [name, image] : hard_maps()) {
        SCOPED_TRACE(name);
        const EnvironmentMap map = map_of(image);
        for (const Vec3& w :
             {Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, -1), Vec3(-0.f, 0, -1), Vec3(1e-30f, 1, -1e-30f),
              Vec3(-1e-8f, 0, -1), Vec3(1e-8f, 0, -1), Vec3(0, 1.0000001f, 0)}) {
            EXPECT_TRUE(map.radiance(w).isFinite().all() && (map.radiance(w) >= 0).all());
            EXPECT_TRUE(std::isfinite(map.pdf_w(w)) && map.pdf_w(w) > 0);
        }
        for (const float a : {0.f, 0.1f, 0x1.fffffep-1f})
            for (const float b : {0.f, 0.5f, 0x1.fffffep-1f}) {
                const auto s = map.sample(Vec2(a, b));
                EXPECT_TRUE(s.w.allFinite() && s.radiance.isFinite().all() && std::isfinite(s.pdf_w) && s.pdf_w > 0)
                    << a << ' ' << b;
            }
    }
}

TEST(EnvironmentMap, RadianceOfAnyMagnitudeIsSampled) {
    for (const float scale : {1e-38f, 1e-30f, 1e30f}) {
        const Image dim = image_of(5, 4, [&](int x, int y) { return Color(scale * noise(x, y)); });
        const EnvironmentMap map = map_of(dim), plain = map_of(image_of(5, 4, noise));
        EXPECT_NEAR(map.integral()[0] / static_cast<double>(scale) / plain.integral()[0], 1, 1e-4);
        for (std::uint32_t i = 0; i < 64; ++i) {
            const Vec2 u = Sampler(PointSet::sobol, 3, 0, i).get_2d(0);
            EXPECT_NEAR(map.sample(u).pdf_w / plain.sample(u).pdf_w, 1.f, 1e-3f) << scale;
        }
    }
}

/// A black ball far behind the projectors of these tests, since a scene needs a surface.
const std::string ball = shape("sphere", center(0, 0, -50));

template <class... Content>
std::string projector(const Content&... parameters) {
    return emitter("projector", parameters...);
}

/// The sum of the irradiances [W/m^2] at p on a surface of normal n. `p` is in the file's coordinates.
Color irradiance(const gib::Scene& scene, const Vec3& p_file, const Vec3& n) {
    const Vec3 p = p_file + scene.sensor().generate_ray(0, 0, {0.5f, 0.5f}).o;
    const auto light = scene.sample_light(p, 0.5f, {0.5f, 0.5f});
    if (!light) return Color::Zero();
    EXPECT_TRUE(light->delta);
    return light->Le * (std::max(light->wi.dot(n), 0.f) / light->pdf_w);
}

// A plane across the axis at distance z receives pi B scale / z^2 everywhere within the image, and nothing beside it.
TEST(ProjectorLight, IrradianceOfAPlaneIsTheImage) {
    const auto scene = load(ball + projector(number("fov", 60), number("scale", 3), rgb("irradiance", "2, 1, 0.5")));
    const Color shown(2, 1, 0.5f);
    const float edge = std::tan(30.f * pi / 180.f);
    for (const float z : {1.f, 4.f})
        for (const float x : {-0.99f, -0.3f, 0.f, 0.99f})
            for (const float y : {-0.98f, 0.1f, 0.7f}) {
                const Color E = irradiance(*scene.scene, Vec3(x * edge * z, y * edge * z, z), -Vec3::UnitZ());
                EXPECT_TRUE(((E - pi * 3.f * shown / sqr(z)).abs() <= 1e-3f).all()) << x << ' ' << y;
            }
    for (const Vec3& p : {Vec3(1.01f * edge, 0, 1), Vec3(0, -1.01f * edge, 1), Vec3(0, 0, -1)})
        EXPECT_TRUE(is_black(irradiance(*scene.scene, p, -Vec3::UnitZ())));
    const double power = std::numbers::pi * 6 * 4 * sqr(static_cast<double>(edge));
    EXPECT_NEAR(power_of(scene.scene->lights()[0])[0], power, 1e-4 * power);
}

// A camera in the projector's place with the same angle of view sees each texel in the pixel that shows it: the
// irradiance of a plane at distance 1 is pi times that texel. The image has no symmetry.
TEST(ProjectorLight, ThrowsItsImageAsACameraTakesIt) {
    const TemporaryFolder folder;
    const Image image = image_of(6, 4, noise);
    write_exr(folder / "slide.exr", {{{"", image}}, {}});
    const std::string pose = to_world(look_at("1, 2, 3", "2, 2.5, 2", "0, 1, 0.3"));
    for (const std::string& view :
         {number("fov", 50), number("fov", 50) + text("fov_axis", "y"), text("focal_length", "35mm")}) {
        const std::string slide = named("texture", "irradiance", "bitmap", filename(folder / "slide.exr"),
                                        text("filter_type", "nearest")),
                          film = element("film", "hdrfilm", integer("width", 6), integer("height", 4),
                                         element("rfilter", "box"));
        const auto scene =
            Scene(element("sensor", "perspective", view, pose, film), ball, projector(view, pose, slide)).load();
        const Sensor& camera = scene.scene->sensor();
        const auto& light = std::get<ProjectorLight>(scene.scene->lights()[0]);
        EXPECT_TRUE(light.is_textured());
        const Vec3 axis = (camera.generate_ray(2, 1, {0.99999f, 0.99999f}).d).normalized();
        for (int y = 0; y < 4; ++y)
            for (int x = 0; x < 6; ++x) {
                const Vec3 w = camera.generate_ray(x, y, {0.5f, 0.5f}).d;
                const Color at_plane = light.intensity(w) * (std::pow(w.dot(axis), 3.f) * inv_pi);
                const Color texel = image.at(static_cast<std::size_t>(6 * y + x));
                EXPECT_TRUE(((at_plane - texel).abs() <= 1e-3f).all()) << x << ' ' << y << ": " << at_plane.transpose();
            }
        Colord mean = Colord::Zero();
        for (std::size_t i = 0; i < image.pixels(); ++i)
            mean += image.at(i).cast<double>() / 24;
        const double area = 1 / light.pdf_w(axis);
        EXPECT_TRUE(((std::numbers::pi * area * mean / light.power() - 1).abs() <= 5e-3).all());
    }
}

/// A white screen at distance 2 in front of a projector, seen by a camera beside the projector, and a grey wall.
LoadedScene room() {
    return Scene(camera(30, to_world(look_at("0, 0, 0", "0, 0, 2")), box_film(8)),
                 shape("rectangle", to_world(scale(3), translate(0, 0, 2)), diffuse(0.5)),
                 shape("rectangle", to_world(rotate('y', 90), translate(2, 0, 1)), diffuse(0.8)),
                 projector(number("fov", 80), rgb("irradiance", 4)))
        .load();
}

class ProjectedLight : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Registry, ProjectedLight, testing::ValuesIn(names_of_comparable_methods()),
                         [](const auto& name) { return name.param; });

// The screen of reflectance rho at distance z shows rho B / z^2; what the wall adds agrees with path tracing.
TEST_P(ProjectedLight, IsTheImageOnAScreenAndAgreesBeyondIt) {
    const LoadedScene scene = room();
    const Colord direct = mean_of(*render(scene, GetParam(), 256)[Component::direct]);
    // Light paths spread over the whole screen: 16384 of them reach the image's 64 pixels with an error of some 1 %.
    EXPECT_NEAR(direct[1], 0.5 * 4 / 4, samples_pixels(find_method(GetParam())) ? 1e-3 : 0.05);
    const double path = mean_of(render(scene, "path", 4096).total())[1];
    const double total = mean_of(render(scene, GetParam(), 1024).total())[1];
    EXPECT_NEAR(total, path, 0.02 * path);
}

}  // namespace
}  // namespace gib::test::environment_map_test
