// The lights, as seen from a point, and as sources of light paths.

#include "tests/sampler_cases.h"
#include "tests/scene_text.h"

#include <fmt/format.h>

namespace gib::test {

namespace {

using ScenePointer = std::shared_ptr<const Scene>;

double mean(const Color& c) { return c.cast<double>().mean(); }

std::string emitter(const std::string& radiance) {
    return "<emitter type='area'><rgb name='radiance' value='" + radiance + "'/></emitter>";
}

/// A shape that emits; `placing` stands inside its to_world.
std::string area_light(const std::string& type, const std::string& placing, const std::string& parameters = "",
                       const std::string& radiance = "1") {
    return "<shape type='" + type + "'>" + parameters + "<transform name='to_world'>" + placing + "</transform>" +
           emitter(radiance) + "</shape>";
}

std::string translate(double x, double y, double z) {
    return fmt::format("<translate x='{}' y='{}' z='{}'/>", x, y, z);
}

/// What a path that finds the light by chance must assume: the density of the light that the ray meets.
double light_pdf(const Scene& scene, const Vec3& p, const Vec3& w) {
    const auto hit = scene.intersect(Ray{p, w});
    return hit && hit->emitter ? static_cast<double>(scene.light_pdf_w(p, *hit)) : 0.0;
}

double radiance(const Scene& scene, const Vec3& p, const Vec3& w) {
    const auto hit = scene.intersect(Ray{p, w});
    return hit ? mean(hit->Le(-w)) : 0.0;
}

struct Seen {
    Vec3 axis;  ///< roughly towards the light; a break's 1 - cos is measured from here
    std::optional<double> total = 1.0;
    std::vector<double> breaks = {};
};

/// Lights as they are seen from p. They must not hide each other: the sampler does not look.
SamplerCase light_case(const std::string& name, const std::string& xml, const Vec3& p_file, const Seen& seen) {
    const ScenePointer scene = load(xml).scene;
    // Scenes are recentred when they are loaded; the camera stands at the file's origin.
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

/// 1 - cos of the half-angle of a sphere's cone.
double cone_of_sphere(double radius, double distance) { return 1 - std::sqrt(1 - sqr(radius / distance)); }

/// The directions of light paths against `pdf`, about the normal where they start (z where there is none).
SamplerCase emission_direction_case(const std::string& name, const std::string& xml,
                                    const std::function<double(const Vec3&)>& pdf) {
    const ScenePointer scene = load(xml).scene;
    return sphere_case(
        "emission: direction, " + name, SphereChart(),
        [scene, pdf](const RandomNumbers& r) -> std::optional<SampledDirection> {
            const EmissionSample s = scene->sample_emission(r.choice.x(), r.u, r.v);
            const Vec3 w = s.normal.isZero() ? s.ray.d : Frame(s.normal).to_local(s.ray.d);
            return SampledDirection{w, pdf(w)};
        },
        pdf);
}

/// The starts of light paths on a sphere at the origin.
SamplerCase emission_sphere_case() {
    const ScenePointer scene = load(area_light("sphere", translate(0, 0, 0), "<float name='radius' value='2'/>")).scene;
    const double density = 1 / (4 * std::numbers::pi);
    return sphere_case(
        "emission: position, sphere", SphereChart(),
        [scene, density](const RandomNumbers& r) -> std::optional<SampledDirection> {
            return SampledDirection{scene->sample_emission(r.choice.x(), r.u, r.v).ray.o.normalized(), density};
        },
        [density](const Vec3&) { return density; });
}

/// The starts of light paths on a rectangle [-2, 2] x [-1, 1] in the plane z = 0.
SamplerCase emission_rectangle_case() {
    const ScenePointer scene = load(area_light("rectangle", "<scale x='2' y='1' z='1'/>")).scene;
    return plane_case(
        "emission: position, rectangle", {{-2, 2}, {-1, 1}},
        [scene](const RandomNumbers& r) {
            return Vec2(scene->sample_emission(r.choice.x(), r.u, r.v).ray.o.head<2>());
        },
        [](const Vec2d&) { return 1.0 / 8; });
}

std::vector<SamplerCase> emission_cases() {
    const auto cosine = [](const Vec3& w) { return std::max(static_cast<double>(w.z()), 0.0) / std::numbers::pi; };
    const auto uniform = [](const Vec3&) { return 1 / (4 * std::numbers::pi); };
    return {
        emission_sphere_case(),
        emission_rectangle_case(),
        emission_direction_case("sphere", area_light("sphere", translate(1, 2, 3)), cosine),
        emission_direction_case("rectangle", area_light("rectangle", translate(1, 2, 3)), cosine),
        emission_direction_case("point", "<shape type='sphere'/><emitter type='point'/>", uniform),
    };
}

}  // namespace

std::vector<SamplerCase> light_cases() {
    // Rectangles are [-1, 1]^2 and emit along +z; p looks at them from above.
    const std::string rectangle = area_light("rectangle", "");
    const std::string disk = area_light("disk", "");
    const std::string cube = area_light("cube", "");
    const std::string sphere = area_light("sphere", "");
    const std::string hollow = area_light("sphere", "", "<boolean name='flip_normals' value='true'/>");
    // Powers 4 pi, pi 4 and 4 pi^2 / 10; a tenth of the choices goes to all lights alike.
    const double share_of_point = 0.9 / (2 + std::numbers::pi / 10) + 0.1 / 3;
    const Vec3 down(0, 0, -1), aslant(-0.5f, 0, -1);
    std::vector<SamplerCase> cases = {
        light_case("rectangle", rectangle, {0, 0, 2}, {down}),
        light_case("rectangle from close by", rectangle, {0.3f, 0.2f, 0.05f}, {down}),
        light_case("rectangle at a grazing angle", rectangle, {30, 0, 0.5f}, {Vec3(-1, 0, 0)}),
        light_case("rectangle from behind", rectangle, {0, 0, -2}, {-down, 0.0}),
        light_case("disk", disk, {1, 0, 2}, {aslant}),
        light_case("cube", cube, {2, 1.5f, 3}, {Vec3(-2, -1.5f, -3), std::nullopt}),
        light_case("sphere", sphere, {0, 0, 2}, {down, 1.0, {cone_of_sphere(1, 2)}}),
        light_case("sphere from close by", sphere, {0, 0, 1.01f}, {down, 1.0, {cone_of_sphere(1, 1.01)}}),
        light_case("sphere from far away", sphere, {0, 0, 300}, {down, 1.0, {cone_of_sphere(1, 300)}}),
        light_case("sphere from inside", hollow, {0.3f, 0.2f, 0.5f}, {down}),
        light_case(
            "two rectangles",
            area_light("rectangle", translate(-1.5, 0, 0)) + area_light("rectangle", translate(1.5, 0, 0), "", "5"),
            {0, 0, 2}, {down}),
        light_case("point, rectangle and sphere",
                   rectangle + area_light("sphere", translate(5, 0, 0), "", "0.1") +
                       "<emitter type='point'><point name='position' x='-3' y='0' z='2'/></emitter>",
                   {0, 0, 2}, {down, 1 - share_of_point}),
    };
    for (SamplerCase& test : emission_cases())
        cases.push_back(std::move(test));
    return cases;
}

}  // namespace gib::test
