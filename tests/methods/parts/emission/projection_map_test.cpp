// Projection maps: the bounds of emission hold for every kind of light, no bin is dropped that can reach a target,
// and aimed photons carry the same power as others.
#include "methods/parts/emission/projection_map.h"

#include "methods/parts/photons/photon_walk.h"
#include "tests/support/light_fixtures.h"
#include "tests/support/moments.h"
#include "tests/support/scene_fixtures.h"

#include <fmt/format.h>
#include <functional>
#include <limits>

namespace gib::test::projection_map_test {
namespace {

constexpr int unlimited = std::numeric_limits<int>::max();

const std::string tiny_camera = element("sensor", "perspective", box_film(4));

struct LightCase {
    std::string name, xml;
};

std::string emitting(const std::string& type, const std::string& placing, const std::string& more = "",
                     const std::string& radiance = rgb("radiance", "3, 2, 1")) {
    return shape(type, more, to_world(placing), one_sided("0.2"), emitter("area", radiance));
}

/// The place of a lamp: 2 to 3 above the floor and turned so that none of its axes is one of the world's.
const std::string leaning = rotate('x', 160) + rotate('z', 35) + translate(-1, 0.5, 2.5);

std::vector<LightCase> light_cases(const TemporaryFolder& folder) {
    const std::string texture = "<texture type='checkerboard' name='radiance'>" + rgb("color0", 4.0) +
                                rgb("color1", 0.0) + "<transform name='to_uv'>" + scale(2) + "</transform></texture>";
    const auto mesh = [](const char* file) { return text("filename", source_path("scenes/meshes/") + file); };
    const std::string image = envmap_xml(
        folder, image_of(16, 9, [](int x, int y) { return Color(noise(x, y) * (x == 5 && y == 2 ? 90.f : 1.f)); }),
        to_world(rotate('x', 70), rotate('z', 20)));
    const std::string at = point("position", -1, 0.5, 2.5);
    const std::string aim = to_world(look_at("-1,0.5,2.5", "0,0.4,0"));
    const std::string wide = scale(0.3, 0.6, 1) + leaning, inside = flag("flip_normals");
    return {
        {"rectangle", emitting("rectangle", wide)},
        {"disk", emitting("disk", wide)},
        {"sphere", emitting("sphere", scale(0.4) + leaning)},
        {"sphere around", emitting("sphere", scale(6), inside)},
        {"cylinder", emitting("cylinder", scale(0.2, 0.2, 1.5) + leaning)},
        {"cylinder along z", emitting("cylinder", scale(0.2, 0.2, 1) + translate(-1, 0.5, 2))},
        {"cylinder inside", emitting("cylinder", scale(0.7, 0.7, 1) + leaning, inside)},
        {"cube", emitting("cube", scale(0.3) + leaning)},
        {"mesh", emitting("obj", scale(0.4) + leaning, mesh("square-10x10.obj"))},
        {"hollow mesh", emitting("obj", scale(0.8) + leaning, mesh("wedge.obj"))},
        {"textured rectangle", emitting("rectangle", wide, "", texture)},
        {"textured sphere", emitting("sphere", scale(0.4) + leaning, "", texture)},
        {"sunsky", emitter("sunsky", value_element("vector", "sun_direction", "1 2 4"))},
        {"point", emitter("point", at)},
        {"spot", emitter("spot", aim, number("cutoff_angle", 35))},
        {"wide spot", emitter("spot", aim, number("cutoff_angle", 140), number("beam_width", 0))},
        {"projector", emitter("projector", aim, number("fov", 60))},
        {"directional", emitter("directional", vector("direction", 0.3, 0.4, -1))},
        {"level directional", emitter("directional", vector("direction", 0.6, 0.8, 0))},
        {"constant", emitter("constant")},
        {"envmap", image},
        {"two lights", emitter("point", at, rgb("intensity", 1.0)) +
                           emitting("disk", scale(0.2) + rotate('x', 180) + translate(2, 0, 3))},
    };
}

/// A mirror and a glass body on a floor beside a wall, with a disk in front of them, lit by `light`.
LoadedScene scene_lit_by(const std::string& light) {
    return Scene(tiny_camera, shape("rectangle", to_world(scale(3)), diffuse(0.6)),
                 shape("rectangle", to_world(rotate('x', 90), translate(0, 3, 2)), diffuse(0.5)))
        .sphere(0.8, 0, 0.5, 0.45, bsdf("conductor", rgb("specular_reflectance", 0.9)))
        .add(shape("cube", to_world(scale(0.3), rotate('z', 30), translate(-0.3, 0.8, 0.4)), bsdf("dielectric")),
             shape("disk", to_world(scale(0.2), translate(0, 0.3, 1.6)), diffuse(0.4)), light)
        .load();
}

/// A sequence of random numbers; each call of next() takes a new dimension.
class Numbers {
public:
    explicit Numbers(std::uint64_t seed, std::uint64_t index) : sampler_(PointSet::independent, seed, index, 0) {}
    float next() { return sampler_.get_1d(dimension_++); }
    std::size_t below(std::size_t n) {
        return std::min(n - 1, static_cast<std::size_t>(next() * static_cast<float>(n)));
    }

private:
    Sampler sampler_;
    std::uint32_t dimension_ = 0;
};

using Point4 = std::array<float, 4>;

EmissionSample emit(const gib::Scene& scene, const Light& light, const Point4& x) {
    return sample_emission(light, scene.shapes(), Vec2(x[0], x[1]), Vec2(x[2], x[3]));
}
EmissionSample emit(const gib::Scene& scene, std::size_t light, const Point4& x) {
    return emit(scene, scene.lights()[light], x);
}
/// A ray of the light as the map sees it, from outside of the scene if it comes from infinity.
Ray ray_of(const gib::Scene& scene, const ProjectionMap& map, std::size_t light, const Point4& x) {
    const Light& seen = map.light_of(scene, light);
    Ray ray = emit(scene, seen, x).ray;
    if (is_at_infinity(seen)) ray.o -= BoundingSphere(scene.bounds()).distance_past(ray.o) * ray.d;
    return ray;
}

/// A random box of the kind that refinement makes, by up to 24 cuts.
EmissionBox random_box(const gib::Scene& scene, std::size_t light, Numbers& u) {
    EmissionBox box;
    const std::size_t cuts = u.below(25);
    for (std::size_t i = 0; i < cuts; ++i) {
        const std::size_t dimension = u.below(4);
        const float at = split_point(scene.lights()[light], scene.shapes(), box, dimension);
        if (!(at > box.lower[dimension] && at < box.upper[dimension])) continue;
        (u.next() < 0.5f ? box.lower : box.upper)[dimension] = at;
    }
    return box;
}

Point4 random_point(const EmissionBox& box, Numbers& u) {
    Point4 x;
    for (std::size_t i = 0; i < 4; ++i) {
        // A quarter of the coordinates lie on the edges of the box, where bounds are tight.
        const float choice = u.next(), last = std::nextafter(box.upper[i], 0.f);
        x[i] = choice < 0.125f  ? box.lower[i]
               : choice < 0.25f ? last
                                : std::min(box.lower[i] + u.next() * box.width(i), last);
    }
    return x;
}

double angle_between(const Vec3d& a, const Vec3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// Whether the bundle holds the ray: the direction lies in the cone, and the ray starts in the ball or has come
/// through it. If the bundle is one of lines, any part of the ray may cross the ball.
bool holds(const RayBundle& bundle, const Ray& ray) {
    const Vec3d d = ray.d.cast<double>().normalized(), to_center = bundle.center - ray.o.cast<double>();
    if (angle_between(d, bundle.cone.axis) > bundle.cone.half_angle + 1e-12) return false;
    const double across2 = (to_center - to_center.dot(d) * d).squaredNorm();
    if (across2 > sqr(bundle.radius)) {
        // The line of a single point misses it by rounding.
        return bundle.radius == 0 && to_center.norm() == 0;
    }
    return bundle.lines || to_center.dot(d) - std::sqrt(sqr(bundle.radius) - across2) <= 0;
}

// For every light, 10 rays are drawn in each of 1e4 boxes; none lies outside its box's bundle.
TEST(EmissionBounds, HoldEveryRayOfABox) {
    const TemporaryFolder folder;
    for (const auto& [name, xml] : light_cases(folder)) {
        const auto scene = scene_lit_by(xml);
        const gib::Scene& s = *scene.scene;
        int outside = 0;
        double half_angles = 0;
        for (std::uint64_t i = 0; i < 10000; ++i) {
            Numbers u(3, i);
            const std::size_t light = u.below(s.lights().size());
            const EmissionBox box = random_box(s, light, u);
            const RayBundle bundle = emission_bundle(s.lights()[light], s.shapes(), box);
            half_angles += std::min(bundle.cone.half_angle, std::numbers::pi);
            for (int ray = 0; ray < 10; ++ray)
                outside += !holds(bundle, emit(s, light, random_point(box, u)).ray);
        }
        EXPECT_EQ(outside, 0) << name;
        EXPECT_LT(half_angles / 10000, 2) << name;  // pi would be the mean for all directions
    }
}

/// A shallow bowl of four triangles that shines upwards.
struct Bowl {
    explicit Bowl(float size) {
        Mesh mesh;
        for (const Vec3& v :
             {Vec3(-1, -1, 0.1f), Vec3(1, -1, 0), Vec3(1.1f, 1, 0), Vec3(-1, 1, 0.05f), Vec3(0.1f, 0, -0.1f)})
            mesh.vertices.push_back({size * v.x(), size * v.y(), size * v.z()});
        mesh.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
        shapes.push_back(mesh);
    }
    AreaLight light() const { return {0, shapes[0], Texture(Color(Color::Ones()))}; }

    std::vector<Shape> shapes;
};

// The sizes are powers of two, so scaling rounds nothing. The last is smaller than a lamp of a scene may be: products
// of its edges underflow in float.
TEST(EmissionBounds, OfAMeshScaleWithIt) {
    const Bowl large(1.f);
    EmissionBox part;
    part.lower = {0.3f, 0.f, 0.25f, 0.25f};
    part.upper = {0.9f, 1.f, 0.5f, 0.5f};
    for (const float size : {0x1p-40f, 0x1p-60f, 0x1p-80f}) {
        const Bowl small(size);
        EXPECT_FALSE(cannot_see_itself(small.light(), small.shapes)) << size;
        for (const EmissionBox& box : {EmissionBox(), part}) {
            const RayBundle expected = emission_bundle(large.light(), large.shapes, box);
            const RayBundle bundle = emission_bundle(small.light(), small.shapes, box);
            EXPECT_LT(bundle.cone.half_angle, 2) << size;
            EXPECT_EQ(bundle.cone.half_angle, expected.cone.half_angle) << size;
            EXPECT_EQ(bundle.cone.axis, expected.cone.axis) << size;
            const double scale = static_cast<double>(size);
            EXPECT_EQ(bundle.center, Vec3d(scale * expected.center)) << size;
            if (size < 0x1p-60f) continue;  // the squares in its box's diagonal underflow, too
            EXPECT_NEAR(bundle.radius, scale * expected.radius, 1e-6 * scale * expected.radius) << size;
        }
    }
}

/// Whether the ray meets a surface that is a target, first or behind others.
bool meets(const gib::Scene& scene, Ray ray, TargetSurfaces targets) {
    for (int surfaces = 0; surfaces < 64; ++surfaces) {
        const auto hit = scene.intersect(ray);
        if (!hit) return false;
        if (targets == TargetSurfaces::all || scene.material_of_shape(hit->shape).traits().specular()) return true;
        ray = hit->spawn_ray(ray.d);
    }
    return false;
}

bool lies_in(const ProjectionMap& map, std::size_t light, const Point4& x) {
    return std::any_of(map.bins().begin(), map.bins().end(), [&](const ProjectionMap::Bin& bin) {
        bool inside = bin.light == light;
        for (std::size_t i = 0; i < 4; ++i)
            inside = inside && bin.box.lower[i] <= x[i] && x[i] < bin.box.upper[i];
        return inside;
    });
}

// Each of 1e5 rays of every light, as the map sees it, that meets a target lies in a kept bin. The map sees a light at infinity
// over the disc of the targets alone, which all of its rays that meet one cross.
TEST(ProjectionMap, KeepsEveryRayThatMeetsATarget) {
    const TemporaryFolder folder;
    for (const auto& [name, xml] : light_cases(folder)) {
        const auto scene = scene_lit_by(xml);
        const gib::Scene& s = *scene.scene;
        for (const TargetSurfaces targets : {TargetSurfaces::specular, TargetSurfaces::all}) {
            const ProjectionMap map(s, targets, targets == TargetSurfaces::all ? 1 << 12 : 1 << 14);
            int met = 0, lost = 0;
            bool is_cut = false;
            for (std::uint64_t i = 0; i < 100000; ++i) {
                Numbers u(5, i);
                const std::size_t light = u.below(s.lights().size());
                const Point4 x{u.next(), u.next(), u.next(), u.next()};
                const Ray any = emit(s, light, x).ray;
                if (meets(s, any, targets)) lost += !map.meets_target(s, light, any.o, any.d);
                if (map.kept(light) == 1) continue;
                is_cut = true;
                if (!meets(s, ray_of(s, map, light, x), targets)) continue;
                ++met;
                lost += !lies_in(map, light, x);
            }
            EXPECT_EQ(lost, 0) << name;
            if (is_cut) {
                EXPECT_GT(met, 300) << name;
            }
            // With so few bins, those of a light all around are too large to
            // miss any target, so the light is not aimed.
            const bool all_around = name == "sphere around" || name == "constant";
            if (targets == TargetSurfaces::specular && !all_around) {
                EXPECT_TRUE(map.aims()) << name;
            }
        }
    }
}

/// The stored power of independent walks and its mean place.
struct StoredPower {
    Moments power;
    std::array<Moments, 3> place;
};
StoredPower stored_power(const gib::Scene& scene, PhotonMapKind kind, const ProjectionMap* aim) {
    StoredPower result;
    for (std::uint64_t seed = 1; seed <= 32; ++seed) {
        double power = 0;
        Vec3d place = Vec3d::Zero();
        const auto walk = trace_photons(scene, kind, 20000, 8, seed + (aim ? 100 : 0), aim);
        for (const Photon& photon : walk.photons) {
            const double p = walk.unit * photon.power().cast<double>().mean();
            power += p;
            place += p * photon.p.cast<double>();
        }
        result.power.add(power);
        for (int i = 0; i < 3; ++i)
            result.place[static_cast<std::size_t>(i)].add(place[i]);
    }
    return result;
}

void expect_equal(const Moments& a, const Moments& b, const std::string& what) {
    EXPECT_NEAR(a.mean(), b.mean(), 5 * std::hypot(a.standard_error(), b.standard_error())) << what;
}

// 160 means agree, each within 5 standard errors of 32 walks (Student's t with 62 degrees of freedom: 5e-6 each, 1e-3
// together). The powers are known to 3 %, and better if photons are aimed.
TEST(ProjectionMap, AimedPhotonsStoreTheSamePowerInTheSamePlaces) {
    const TemporaryFolder folder;
    for (const auto& [name, xml] : light_cases(folder)) {
        const auto scene = scene_lit_by(xml);
        for (const PhotonMapKind kind : {PhotonMapKind::caustic, PhotonMapKind::global}) {
            const bool caustic = kind == PhotonMapKind::caustic;
            const std::string what = name + (caustic ? ", caustic" : ", global");
            const ProjectionMap map(*scene.scene, caustic ? TargetSurfaces::specular : TargetSurfaces::all,
                                    caustic ? 1 << 14 : 1 << 12);
            const StoredPower on = stored_power(*scene.scene, kind, &map),
                              off = stored_power(*scene.scene, kind, nullptr);
            expect_equal(on.power, off.power, what);
            for (std::size_t i = 0; i < 3; ++i)
                expect_equal(on.place[i], off.place[i], what);
            EXPECT_LT(off.power.standard_error(), 0.03 * off.power.mean()) << what;
            if (map.kept(0) < 0.3) {
                EXPECT_LT(on.power.standard_error(), off.power.standard_error()) << what;
            }
        }
    }
}

/// A mirror sphere at the distance 3 from the origin, with a light and `more`.
LoadedScene mirror_and(const std::string& light, const std::string& more = "") {
    return Scene(tiny_camera).sphere(1, 2, -2, 0.6, bsdf("conductor")).add(more, light).load();
}

// As seen from the origin, the sphere fills (1 - cos) / 2 of all directions, where
// sin = 0.6 / 3; the bins may keep a rim besides.
TEST(ProjectionMap, KeepsLittleMoreThanTheSolidAngle) {
    const auto scene = mirror_and(emitter("point"));
    const double truth = 0.5 * (1 - std::sqrt(1 - sqr(0.2)));
    const ProjectionMap map(*scene.scene, TargetSurfaces::specular);
    EXPECT_GE(map.kept(0), truth);
    EXPECT_LE(map.kept(0), 1.03 * truth);
}

// A point light of intensity 1e8 at the distance 1e4 sends a square of side 2, whose solid angle is 4e-8, 4 W. A
// spherical lamp of the same power sends as much.
TEST(ProjectionMap, FindsASceneThatIsFarAwayOnAnyAxis) {
    for (const auto& at :
         {Vec3d(0, 0, 1e4), Vec3d(0, 0, -1e4), Vec3d(1e4, 0, 0), Vec3d(0, -1e4, 0), Vec3d(0, 6e3, 8e3)})
        for (const bool sphere : {false, true}) {
            const std::string lamp = sphere ? shape("sphere", center(at.x(), at.y(), at.z()), radius(10),
                                                    area_light(1e8 / std::numbers::pi / 100))
                                            : point_light(at.x(), at.y(), at.z(), 1e8);
            // The square stands around the origin and faces the lamp.
            const std::string target = fmt::format("{},{},{}", at.x(), at.y(), at.z());
            const auto scene =
                Scene(tiny_camera, shape("rectangle", to_world(look_at("0,0,0", target, "1,2,3")), bsdf("diffuse")),
                      lamp)
                    .load();
            const ProjectionMap map(*scene.scene, TargetSurfaces::all, 1 << 12);
            Moments stored;
            for (std::uint64_t seed = 1; seed <= 8; ++seed) {
                double power = 0;
                const auto walk = trace_photons(*scene.scene, PhotonMapKind::full, 20000, 8, seed, &map);
                for (const Photon& photon : walk.photons)
                    power += walk.unit * photon.power().cast<double>().mean();
                stored.add(power);
            }
            EXPECT_NEAR(stored.mean(), 4, 6 * stored.standard_error() + 0.004) << target << (sphere ? " sphere" : "");
            EXPECT_LT(stored.standard_error(), 0.2) << target;
        }
}

// The voxels of the lamp's grid are smaller than the distance of two floats; the halving of its triangles must end.
TEST(ProjectionMap, ALampOfSomeUlpsIsATarget) {
    for (const float side : {1e-5f, 1e-6f, 3e-7f}) {
        const auto scene = mirror_and(shape(
            "rectangle", to_world(scale(static_cast<double>(0.5f * side)), rotate('x', 180), translate(3.3, 2.1, 5)),
            emitter("area")));
        const ProjectionMap map(*scene.scene, TargetSurfaces::all, 1 << 10);
        EXPECT_GT(map.kept(0), 0) << side;
    }
}

TEST(ProjectionMap, IsEmptyWhereNoLightReachesATarget) {
    const auto scene = mirror_and(emitter("spot", to_world(look_at("0,0,0", "-1,-2,2"))));
    const ProjectionMap map(*scene.scene, TargetSurfaces::specular);
    EXPECT_TRUE(map.empty());
    EXPECT_TRUE(map.aims());
    EXPECT_TRUE(trace_photons(*scene.scene, PhotonMapKind::caustic, 1000, unlimited, 1, &map).photons.empty());
}

TEST(ProjectionMap, KeepsEverythingForALampInsideGlass) {
    const auto scene = mirror_and(shape("sphere", radius(0.1), emitter("area")), shape("sphere", bsdf("dielectric")));
    const ProjectionMap map(*scene.scene, TargetSurfaces::specular);
    EXPECT_FALSE(map.aims());
    EXPECT_EQ(map.kept(0), 1);
}

// Copies of a group stand where their instances place them.
TEST(ProjectionMap, FindsWhatInstancesShow) {
    const std::string group = "<shape type='shapegroup' id='g'>" + shape("sphere", bsdf("conductor")) + "</shape>";
    const std::string place = to_world(scale(0.6, 0.3, 0.6), rotate('z', 30), translate(1, 2, -2));
    const auto scene = Scene(tiny_camera, group, shape("instance", reference("g"), place), emitter("point")).load();
    const ProjectionMap map(*scene.scene, TargetSurfaces::specular, 1 << 14);
    EXPECT_LT(map.kept(0), 0.0115);  // the ball around it fills 0.0101; the bins keep a rim
    int met = 0;
    for (std::uint64_t i = 0; i < 100000; ++i) {
        Numbers u(7, i);
        const Point4 x{u.next(), u.next(), u.next(), u.next()};
        if (!meets(*scene.scene, ray_of(*scene.scene, map, 0, x), TargetSurfaces::specular)) continue;
        ++met;
        EXPECT_TRUE(lies_in(map, 0, x));
    }
    EXPECT_GT(met, 300);
}

}  // namespace
}  // namespace gib::test::projection_map_test
