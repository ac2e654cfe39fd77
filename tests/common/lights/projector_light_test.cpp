// Tests of the projector against closed forms of its irradiance, and as the counterpart of a camera.

#include "common/scene/scene.h"
#include "tests/support/light_fixtures.h"
#include "tests/support/scene_fixtures.h"

namespace gib::test::projector_light_test {
namespace {

/// A black ball far behind the projectors of these tests, since a scene needs a surface.
const std::string ball = shape("sphere", center(0, 0, -50));

std::string projector(const std::string& parameters) { return emitter("projector", parameters); }

/// The sum of the irradiances [W/m^2] at p on a surface of normal n. `p` is in the file's coordinates.
Color irradiance(const Scene& scene, const Vec3& p_file, const Vec3& n) {
    const Vec3 p = p_file + scene.sensor().generate_ray(0, 0, {0.5f, 0.5f}).o;
    const auto light = scene.sample_light(p, 0.5f, {0.5f, 0.5f});
    if (!light) return Color::Zero();
    EXPECT_TRUE(light->delta);
    return light->Le * (std::max(light->wi.dot(n), 0.f) / light->pdf_w);
}

// A plane across the axis at distance z receives pi B scale / z^2 everywhere within the image, and nothing beside it.
TEST(ProjectorLight, IrradianceOfAPlaneIsTheImage) {
    const auto scene = load(ball + projector(number("fov", 60) + number("scale", 3) + rgb("irradiance", "2, 1, 0.5")));
    const float edge = std::tan(30.f * pi / 180.f);
    for (const float z : {1.f, 4.f})
        for (const float x : {-0.99f, -0.3f, 0.f, 0.99f})
            for (const float y : {-0.98f, 0.1f, 0.7f}) {
                const Color E = irradiance(*scene.scene, Vec3(x * edge * z, y * edge * z, z), -Vec3::UnitZ());
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(E[c], pi * 3.f * (c == 0 ? 2.f : c == 1 ? 1.f : 0.5f) / sqr(z), 1e-3f) << x << ' ' << y;
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
         {std::string(number("fov", 50)), std::string(number("fov", 50) + text("fov_axis", "y")),
          std::string(text("focal_length", "35mm"))}) {
        const auto scene = scene_of(scene_xml(
            element("sensor", "perspective", view, pose,
                    element("film", "hdrfilm", integer("width", 6), integer("height", 4), element("rfilter", "box"))) +
            ball +
            projector(view + pose +
                      named("texture", "irradiance", "bitmap", filename((folder / "slide.exr")),
                            text("filter_type", "nearest")))));
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
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(light.power()[c], std::numbers::pi * area * mean[c], 5e-3 * light.power()[c]);
    }
}

/// A white screen at distance 2 in front of a projector, seen by a camera beside the projector, and a grey wall.
LoadedScene room() {
    return scene_of(scene_xml(camera(30, to_world(look_at("0, 0, 0", "0, 0, 2")), box_film(8)) +
                              shape("rectangle", to_world(scale(3), translate(0, 0, 2)), diffuse(0.5)) +
                              shape("rectangle", to_world(rotate('y', 90), translate(2, 0, 1)), diffuse(0.8)) +
                              projector(number("fov", 80) + rgb("irradiance", 4))));
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
}  // namespace gib::test::projector_light_test
