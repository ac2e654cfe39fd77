// The test cases of lights: sampled from a point, and as starts of light paths.

#include "common/scene/scene.h"
#include "tests/samplers/sampler_cases.h"
#include "tests/support/light_fixtures.h"
#include "tests/support/scene_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace gib::test {

namespace {

using ScenePointer = std::shared_ptr<const gib::Scene>;

/// The scene of `xml`, whose lights are all of type Kind; if they are not, throws std::logic_error.
template <typename Kind>
ScenePointer lit_by(const std::string& xml) {
    ScenePointer scene = load(xml).scene;
    const std::vector<Light>& lights = scene->lights();
    if (lights.empty() || !std::all_of(lights.begin(), lights.end(),
                                       [](const Light& light) { return std::holds_alternative<Kind>(light); }))
        throw std::logic_error("the lights are of another type: " + xml);
    return scene;
}

/// The same for area lights, all on shapes of type Form.
template <typename Form>
ScenePointer emitting(const std::string& xml) {
    ScenePointer scene = lit_by<AreaLight>(xml);
    for (const Light& light : scene->lights())
        if (!std::holds_alternative<Form>(scene->shapes()[std::get<AreaLight>(light).shape]))
            throw std::logic_error("the lights are on shapes of another type: " + xml);
    return scene;
}

/// An emitting shape; `placing` is the content of its to_world.
std::string area_light(const std::string& type, const std::string& placing, const std::string& parameters = "",
                       const std::string& radiance = "1") {
    return shape(type, parameters, to_world(placing), test::area_light(radiance));
}

/// The density that a path must assume if its ray hits a light by chance. Surfaces that do not emit count as
/// transparent, as they do for the samplers.
double light_pdf(const gib::Scene& scene, const Vec3& p, const Vec3& w) {
    const auto hit = scene.intersect(Ray{p, w});
    return static_cast<double>(hit && hit->emitter ? scene.light_pdf_w(p, *hit) : scene.environment_pdf_w(p, w));
}

double radiance(const gib::Scene& scene, const Vec3& p, const Vec3& w) {
    const auto hit = scene.intersect(Ray{p, w});
    return mean(hit && hit->emitter ? hit->Le(-w) : scene.environment_radiance(w));
}

struct Seen {
    Vec3 axis;  ///< roughly towards the light; a break's 1 - cos is measured from here
    std::optional<double> total = 1.0;
    std::vector<double> breaks = {};
};

/// Lights sampled from p. They must not hide each other, because the sampler does not test visibility.
SamplerCase light_case(const std::string& name, const ScenePointer& scene, const Vec3& p_file, const Seen& seen) {
    // Loading moves the scene to the centre of its bounds; the camera shows where the file's origin is.
    const Vec3 p = p_file + scene->sensor().generate_ray(0, 0, {0.5f, 0.5f}).o;
    const SphereChart chart(seen.axis.cast<double>());
    SamplerCase test = sphere_case(
        "light: " + name, chart,
        [scene, p](const RandomNumbers& r) -> std::optional<SampledDirection> {
            const auto s = scene->sample_light(p, r.choice.x(), r.u);
            if (!s) return std::nullopt;
            const auto pdf = static_cast<double>(s->pdf_w);
            return SampledDirection{s->wi, pdf, mean(s->Le) / pdf, s->delta};
        },
        [scene, p](const Vec3& w) { return light_pdf(*scene, p, w); });
    test.value = [scene, p, chart](const Vec2d& point) {
        return radiance(*scene, p, chart.direction(point).cast<float>());
    };
    test.domain = SphereChart::domain(seen.breaks);
    test.total = seen.total;
    return test;
}

/// A cylinder seen from outside, in the angle and height of its points. As a function of direction, the
/// density is unbounded at the silhouette, and the share of samples within the rounding of a float there
/// exceeds the scatter of the counts.
SamplerCase outside_of_cylinder_case() {
    const ScenePointer scene = emitting<Cylinder>(area_light("cylinder", ""));
    const Vec3 origin = scene->sensor().generate_ray(0, 0, {0.5f, 0.5f}).o;
    const Vec3d p(3, 1, 2);
    constexpr double per_area = 1 / (2 * std::numbers::pi);
    // A cosine in float has an error of some 1e-6. Above this cosine its relative error
    // is well below limits::pdf_mismatch.
    constexpr double clear_of_silhouette = 0.01;
    const auto normal = [](double phi) { return Vec3d(std::cos(phi), std::sin(phi), 0); };
    SamplerCase test;
    test.name = "light: cylinder";
    test.sample = [=](const RandomNumbers& r) -> std::optional<Sampled> {
        const auto s = scene->sample_light(Vec3(p.cast<float>() + origin), r.choice.x(), r.u);
        if (!s) return std::nullopt;
        const Vec3d target = (s->target - origin).cast<double>();
        const double phi = std::atan2(target.y(), target.x()), z = std::clamp(target.z(), 0.0, 1.0);
        const Vec3d n = normal(phi), to_p = p - n - Vec3d(0, 0, z);
        const double cosine = n.dot(to_p.normalized());
        const double pdf = static_cast<double>(s->pdf_w) * cosine / to_p.squaredNorm();
        return Sampled{{phi, z}, cosine > clear_of_silhouette ? pdf : per_area, per_area};
    };
    test.pdf = [=](const Vec2d& point) { return normal(point.x()).dot(p) > 1 ? per_area : 0; };
    const double axis = std::atan2(p.y(), p.x()), half = std::acos(1 / std::hypot(p.x(), p.y()));
    test.domain = {{-std::numbers::pi, axis - half, axis + half, std::numbers::pi}, {0, 1}};
    test.total = half / std::numbers::pi;
    return test;
}

/// 1 - cos of the half-angle of a sphere's cone.
double cone_of_sphere(double radius, double distance) { return 1 - std::sqrt(1 - sqr(radius / distance)); }

/// A sampler of the starts of light paths. `place` maps each start to a direction, where its density should be `pdf`.
/// The weight is the sample's power over the light's power, so that its mean must be 1.
template <typename Place>
auto emission_sampler(const ScenePointer& scene, const Place& place, const std::function<double(const Vec3&)>& pdf) {
    const double power = scene->emitted_power().mean();
    return [scene, place, pdf, power](const RandomNumbers& r) -> std::optional<SampledDirection> {
        const EmissionSample s = scene->sample_emission(r.choice.x(), r.u, r.v);
        const Vec3 w = place(s);
        return SampledDirection{w, pdf(w), s.power.mean() / power};
    };
}

/// The directions of light paths in the frame of the normal at their start (of z where there is no normal).
SamplerCase emission_direction_case(const std::string& name, const ScenePointer& scene,
                                    const std::function<double(const Vec3&)>& pdf,
                                    const std::vector<double>& breaks = {}) {
    const auto place = [](const EmissionSample& s) -> Vec3 {
        return s.normal.isZero() ? s.ray.d : Frame(s.normal).to_local(s.ray.d);
    };
    SamplerCase test =
        sphere_case("emission: direction, " + name, SphereChart(), emission_sampler(scene, place, pdf), pdf);
    test.domain = SphereChart::domain(breaks);
    test.mean_weight = 1;
    return test;
}

const std::function<double(const Vec3&)> uniform = [](const Vec3&) { return 1 / (4 * std::numbers::pi); };

/// The starts of light paths on a sphere at the origin.
SamplerCase emission_sphere_case() {
    const ScenePointer scene = emitting<Sphere>(area_light("sphere", "", number("radius", 2)));
    const auto place = [](const EmissionSample& s) -> Vec3 { return s.ray.o.normalized(); };
    return sphere_case("emission: position, sphere", SphereChart(), emission_sampler(scene, place, uniform), uniform);
}

/// The starts of light paths on a rectangle [-2, 2] x [-1, 1] in the plane z = 0.
SamplerCase emission_rectangle_case() {
    const ScenePointer scene = emitting<Mesh>(area_light("rectangle", scale(2, 1, 1)));
    return plane_case(
        "emission: position, rectangle", {{-2, 2}, {-1, 1}},
        [scene](const RandomNumbers& r) {
            return Vec2(scene->sample_emission(r.choice.x(), r.u, r.v).ray.o.head<2>());
        },
        [](const Vec2d&) { return 1.0 / 8; });
}

const std::string small_shape = shape("sphere", radius(0.5));

/// The starts of the paths of parallel light along z, on a disk that covers a sphere of
/// radius 1/2 and the box around it.
SamplerCase emission_disk_case() {
    const ScenePointer scene =
        lit_by<DirectionalLight>(small_shape + emitter("directional", vector("direction", 0, 0, 1)));
    const double radius = 0.5 * std::sqrt(3.0);
    return plane_case(
        "emission: position, directional", {{-1, 1}, {-1, 1}},
        [scene](const RandomNumbers& r) {
            return Vec2(scene->sample_emission(r.choice.x(), r.u, r.v).ray.o.head<2>());
        },
        [radius](const Vec2d& x) {
            // The program enlarges the disk's radius by a share of 1e-5.
            return x.norm() <= radius * (1 + 2e-5) ? 1 / (std::numbers::pi * sqr(radius)) : 0.0;
        });
}

/// A spot along z; the density is its fall-off, linear in the angle, over its integral.
SamplerCase emission_spot_case(double cutoff_degrees, double beam_degrees) {
    const double cutoff = cutoff_degrees * std::numbers::pi / 180, beam = beam_degrees * std::numbers::pi / 180;
    const auto falloff = [cutoff, beam](double theta) {
        return theta <= beam ? 1.0 : std::max((cutoff - theta) / (cutoff - beam), 0.0);
    };
    double integral = 0;
    constexpr int steps = 100'000;
    for (int i = 0; i < steps; ++i) {
        const double theta = cutoff * (i + 0.5) / steps;
        integral += 2 * std::numbers::pi * falloff(theta) * std::sin(theta) * cutoff / steps;
    }
    const auto pdf = [falloff, integral](const Vec3& w) {
        const Vec3d d = w.cast<double>();
        // A sample may lie where the fall-off ends at 0, and its density must be positive.
        return std::max(falloff(std::atan2(d.head<2>().norm(), d.z())), 1e-12) / integral;
    };
    return emission_direction_case(
        fmt::format("spot {} {}", cutoff_degrees, beam_degrees),
        lit_by<SpotLight>(small_shape +
                          emitter("spot", number("cutoff_angle", cutoff_degrees), number("beam_width", beam_degrees))),
        pdf, {1 - std::cos(beam), 1 - std::cos(cutoff)});
}

/// Where the rays of a projector along z cross the plane at distance 1: uniform over its image.
SamplerCase emission_projector_case(double fov_degrees) {
    const double size = std::tan(fov_degrees * std::numbers::pi / 360);
    const ScenePointer scene = lit_by<ProjectorLight>(small_shape + emitter("projector", number("fov", fov_degrees)));
    const double edge = size * (1 + 1e-5);  // holds the rounding of directions
    const std::vector<double> breaks = {-1.1 * size, -edge, edge, 1.1 * size};
    return plane_case(
        fmt::format("emission: image, projector {}", fov_degrees), {breaks, breaks},
        [scene](const RandomNumbers& r) {
            const Vec3 w = scene->sample_emission(r.choice.x(), r.u, r.v).ray.d;
            return Vec2(w.x() / w.z(), w.y() / w.z());
        },
        [edge](const Vec2d& x) { return x.cwiseAbs().maxCoeff() <= edge ? 1 / (4 * sqr(edge)) : 0; });
}

/// An environment map of noise and a sun of one texel, which has most of the light.
std::string sunny_map(const TemporaryFolder& folder) {
    return envmap_xml(folder, image_of(16, 9, [](int x, int y) {
                          return x == 11 && y == 2 ? Color(Color::Constant(300)) : Color(noise(x, y));
                      }));
}

SamplerCase emission_map_case() {
    const TemporaryFolder folder;
    const ScenePointer scene = lit_by<MappedEnvironment>(small_shape + sunny_map(folder));
    return emission_direction_case("envmap", scene, [scene](const Vec3& w) {
        return static_cast<double>(scene->environment_pdf_w(Vec3(0, 0, 0), -w));
    });
}

const Vec3 up(0, 1, 0), down(0, 0, -1);
const Vec3 beside_shape(2, 0, 0);  ///< where environments are seen from, beside small_shape

double cosine_density(const Vec3& w) { return std::max(static_cast<double>(w.z()), 0.0) / std::numbers::pi; }

using Cases = std::vector<SamplerCase>;

/// The cases of area lights by the shape that emits. Rectangles are [-1, 1]^2 and emit along +z.
struct AreaLightCasesOf {
    Cases operator()(std::type_identity<Mesh>) const {
        const ScenePointer rectangle = emitting<Mesh>(area_light("rectangle", ""));
        const ScenePointer moved = emitting<Mesh>(area_light("rectangle", translate(1, 2, 3)));
        const ScenePointer cube = emitting<Mesh>(area_light("cube", ""));
        return {
            light_case("rectangle", rectangle, {0, 0, 2}, {down}),
            light_case("rectangle from close by", rectangle, {0.3f, 0.2f, 0.05f}, {down}),
            light_case("rectangle at a grazing angle", rectangle, {30, 0, 0.5f}, {Vec3(-1, 0, 0)}),
            light_case("rectangle from behind", rectangle, {0, 0, -2}, {-down, 0.0}),
            light_case("cube", cube, {2, 1.5f, 3}, {Vec3(-2, -1.5f, -3), std::nullopt}),
            emission_rectangle_case(),
            emission_direction_case("rectangle", moved, cosine_density),
        };
    }
    Cases operator()(std::type_identity<Sphere>) const {
        const std::string inwards = flag("flip_normals");
        const ScenePointer sphere = emitting<Sphere>(area_light("sphere", ""));
        const ScenePointer hollow = emitting<Sphere>(area_light("sphere", "", inwards));
        const ScenePointer moved = emitting<Sphere>(area_light("sphere", translate(1, 2, 3)));
        return {
            light_case("sphere", sphere, {0, 0, 2}, {down, 1.0, {cone_of_sphere(1, 2)}}),
            light_case("sphere from close by", sphere, {0, 0, 1.01f}, {down, 1.0, {cone_of_sphere(1, 1.01)}}),
            light_case("sphere from far away", sphere, {0, 0, 300}, {down, 1.0, {cone_of_sphere(1, 300)}}),
            light_case("sphere from inside", hollow, {0.3f, 0.2f, 0.5f}, {down}),
            emission_sphere_case(),
            emission_direction_case("sphere", moved, cosine_density),
        };
    }
    Cases operator()(std::type_identity<Disk>) const {
        return {light_case("disk", emitting<Disk>(area_light("disk", "")), {1, 0, 2}, {Vec3(-0.5f, 0, -1)})};
    }
    Cases operator()(std::type_identity<Cylinder>) const {
        const std::string inwards = flag("flip_normals");
        const ScenePointer hollow = emitting<Cylinder>(area_light("cylinder", "", inwards));
        return {light_case("cylinder from inside", hollow, {0.3f, 0.2f, 0.5f}, {down}), outside_of_cylinder_case()};
    }
};

/// The cases of each kind of light. Delta lights have no density as seen from a point.
struct LightCasesOf {
    Cases operator()(std::type_identity<AreaLight>) const {
        return listed_for_every_alternative<Shape>(AreaLightCasesOf());
    }
    Cases operator()(std::type_identity<PointLight>) const {
        const ScenePointer scene = lit_by<PointLight>(small_shape + emitter("point"));
        return {emission_direction_case("point", scene, uniform)};
    }
    Cases operator()(std::type_identity<SpotLight>) const {
        return {emission_spot_case(20, 15), emission_spot_case(120, 0), emission_spot_case(1, 0.9)};
    }
    Cases operator()(std::type_identity<ProjectorLight>) const {
        return {emission_projector_case(40), emission_projector_case(110)};
    }
    Cases operator()(std::type_identity<DirectionalLight>) const { return {emission_disk_case()}; }
    Cases operator()(std::type_identity<ConstantEnvironment>) const {
        const ScenePointer scene = lit_by<ConstantEnvironment>(small_shape + emitter("constant"));
        return {light_case("constant", scene, beside_shape, {up}), emission_direction_case("constant", scene, uniform)};
    }
    Cases operator()(std::type_identity<MappedEnvironment>) const {
        const TemporaryFolder folder;
        const auto lit = [](const std::string& map) { return lit_by<MappedEnvironment>(small_shape + map); };
        const double sun_radius = 4 * std::numbers::pi / 180;
        const std::string sun_at_zenith =
            emitter("sunsky", number("sun_aperture", 8), vector("sun_direction", 0, 0, 1), to_world());
        return {
            light_case("envmap", lit(sunny_map(folder)), beside_shape, {up}),
            light_case("envmap of noise", lit(envmap_xml(folder, image_of(5, 4, noise))), beside_shape, {up}),
            light_case("sunsky", lit(sun_at_zenith), beside_shape,
                       {Vec3(0, 0, 1), 1.0, {1 - std::cos(sun_radius), 1.0}}),
            emission_direction_case("sunsky", lit(sun_at_zenith),
                                    [scene = lit(sun_at_zenith)](const Vec3& w) {
                                        return static_cast<double>(scene->environment_pdf_w(Vec3(0, 0, 0), -w));
                                    },
                                    {1.0, 1 + std::cos(sun_radius)}),
            light_case("envmap of one row", lit(envmap_xml(folder, image_of(4, 1, noise))), beside_shape, {up}),
            emission_map_case(),
        };
    }
};

/// The probability with which a point light is chosen at p_file, in a scene that has one.
double choice_of_point_light(const gib::Scene& scene, const Vec3& p_file) {
    const LitPoint at = p_file + scene.sensor().generate_ray(0, 0, {0.5f, 0.5f}).o;
    for (std::uint32_t i = 0; i < scene.lights().size(); ++i)
        if (std::holds_alternative<PointLight>(scene.lights()[i]))
            return static_cast<double>(scene.light_tree().probability(at, i));
    throw std::logic_error("the scene has no point light");
}

/// Several lights, so that the choice among them is tested, too.
Cases mixed_light_cases() {
    const std::string two_rectangles =
        area_light("rectangle", translate(-1.5, 0, 0)) + area_light("rectangle", translate(1.5, 0, 0), "", "5");
    const std::string three_lights = area_light("rectangle", "") + area_light("sphere", translate(5, 0, 0), "", "0.1") +
                                     emitter("point", point("position", -3, 0, 2));
    const std::string constant_and_point = small_shape + emitter("constant") + emitter("point");
    const ScenePointer point_and_others = load(three_lights).scene;
    const Vec3 above = {0, 0, 2};
    return {
        light_case("two rectangles", load(two_rectangles).scene, above, {down}),
        // The density belongs to the choices of the lights that have one.
        light_case("point, rectangle and sphere", point_and_others, above,
                   {down, 1 - choice_of_point_light(*point_and_others, above)}),
        light_case("constant and point", load(constant_and_point).scene, beside_shape, {up, std::nullopt}),
    };
}

}  // namespace

std::vector<SamplerCase> light_cases() {
    Cases cases = listed_for_every_alternative<Light>(LightCasesOf());
    for (SamplerCase& test : mixed_light_cases())
        cases.push_back(std::move(test));
    return cases;
}

}  // namespace gib::test
