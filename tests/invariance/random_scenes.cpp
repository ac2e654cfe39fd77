// Makes random scenes from seeds.
#include "tests/invariance/random_scenes.h"

#include "common/sampling/sampler.h"

#include <cmath>
#include <numbers>

namespace gib::test {

Dice::Dice(std::uint64_t seed) : state_(mix64(seed + 0x9e3779b97f4a7c15ull)) {}
std::uint64_t Dice::bits() { return mix64(state_ += 0x9e3779b97f4a7c15ull); }
double Dice::between(double lowest, double highest) {
    return lowest + (highest - lowest) * 0x1p-53 * static_cast<double>(bits() >> 11);
}
int Dice::below(int count) { return static_cast<int>(bits() % static_cast<std::uint64_t>(count)); }

namespace {

constexpr double entry_step = 0x1p-26, position_step = 0x1p-20, vertex_step = 0x1p-8;

double rounded(double x, double step) { return std::round(x / step) * step; }

Vec3d random_direction(Dice& dice) {
    const double z = dice.between(-1, 1), phi = dice.between(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

Mat4d placed(const Eigen::Matrix3d& linear, const Vec3d& at) {
    Mat4d m = Mat4d::Identity();
    m.topLeftCorner<3, 3>() = linear.unaryExpr([](double x) { return rounded(x, entry_step); });
    m.topRightCorner<3, 1>() = at.unaryExpr([](double x) { return rounded(x, position_step); });
    return m;
}

Colord random_color(Dice& dice, double lowest, double highest) {
    return {dice.between(lowest, highest), dice.between(lowest, highest), dice.between(lowest, highest)};
}

using MaterialKind = SceneMaterial::Kind;
using ShapeKind = SceneShape::Kind;
using LightKind = SceneLight::Kind;

bool transmits(MaterialKind kind) {
    return kind == MaterialKind::glass || kind == MaterialKind::dispersive_glass || kind == MaterialKind::thin_glass ||
           kind == MaterialKind::rough_glass || kind == MaterialKind::mask || kind == MaterialKind::nothing;
}

bool is_matt(SceneMood mood) { return mood == SceneMood::matt || mood == SceneMood::polygons; }

/// A random kind of material. If the surface is not `closed`, both of its sides lie
/// in the same space, so it cannot refract.
MaterialKind random_kind(Dice& dice, SceneMood mood, bool closed) {
    using enum SceneMaterial::Kind;
    if (is_matt(mood) || dice.chance(0.35)) return diffuse;
    const std::array solid = {mirror, conductor, rough_conductor, thin_glass, plastic, phong, mask, blend};
    const std::array hollow = {glass, dispersive_glass, rough_glass};
    if (closed && dice.chance(0.45)) return hollow[static_cast<std::size_t>(dice.below(hollow.size()))];
    if (mood == SceneMood::any && dice.chance(0.08)) return dice.chance(0.5) ? normal_map : nothing;
    if (dice.chance(0.02)) return rough_plastic;  // seldom: its table takes 60 ms
    return solid[static_cast<std::size_t>(dice.below(solid.size()))];
}

SceneMaterial random_material(Dice& dice, MaterialKind kind) {
    SceneMaterial m;
    m.kind = kind;
    m.color = random_color(dice, 0.1, 0.8);
    m.alpha = dice.between(0.03, 0.5);
    m.ior = dice.between(1.2, 1.8);
    m.share = dice.between(0.1, 0.9);
    m.ggx = dice.chance(0.5);
    m.two_sided = !transmits(kind) && dice.chance(0.7);
    if (dice.chance(0.2)) m.tiles = 1 + dice.below(4);
    return m;
}

/// A closed mesh is an octahedron with unequal corners, an open one a height field.
SceneMesh random_mesh(Dice& dice, bool closed) {
    SceneMesh mesh;
    const auto vertex = [&](double x, double y, double z) {
        mesh.vertices.emplace_back(rounded(x, vertex_step), rounded(y, vertex_step), rounded(z, vertex_step));
    };
    if (closed) {
        for (int axis = 0; axis < 3; ++axis)
            for (const double sign : {-1.0, 1.0}) {
                Vec3d v = Vec3d::Zero();
                v[axis] = sign * dice.between(0.5, 1);
                vertex(v.x(), v.y(), v.z());
            }
        for (int i = 0; i < 8; ++i) {
            const int a = i & 1, b = 2 + (i >> 1 & 1), c = 4 + (i >> 2 & 1);
            if ((a + b + c) % 2 == 1) mesh.triangles.push_back({a, b, c});
            else mesh.triangles.push_back({a, c, b});
        }
        return mesh;
    }
    const int n = 1 + dice.below(3);
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
            vertex(1.4 * i / n - 0.7, 1.4 * j / n - 0.7, dice.between(-0.15, 0.15));
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const int a = j * (n + 1) + i, b = a + n + 1;
            mesh.triangles.push_back({a, a + 1, b + 1});
            mesh.triangles.push_back({a, b + 1, b});
        }
    return mesh;
}

bool is_closed(ShapeKind kind) { return kind == ShapeKind::sphere || kind == ShapeKind::cube; }

/// Builds a scene in the box [-1, 1]^3 times `extent`; y is up.
class Generator {
public:
    Generator(std::uint64_t seed, SceneMood mood) : dice_(seed), mood_(mood) {
        extent_ = Vec3d(dice_.between(0.8, 1.4), dice_.between(0.8, 1.2), dice_.between(0.8, 1.4));
        extent_ = extent_.unaryExpr([](double x) { return rounded(x, position_step); });
        for (int i = 0; i < 27; ++i)
            cells_.push_back(i);
        for (std::size_t i = cells_.size(); i-- > 1;)
            std::swap(cells_[i], cells_[static_cast<std::size_t>(dice_.below(static_cast<int>(i) + 1))]);
    }

    RandomScene scene() {
        const bool closed = mood_ == SceneMood::reciprocal || dice_.chance(0.6);
        if (closed) add_room();
        else add_ground();
        add_camera();
        const int things = 1 + dice_.below(is_matt(mood_) ? 4 : 7);
        for (int i = 0; i < things; ++i)
            add_thing();
        if (mood_ == SceneMood::reciprocal) {
            add_patches();
        } else {
            add_lights(closed);
            if (!is_matt(mood_) && dice_.chance(0.15)) add_fog(closed);
        }
        scene_.max_depth = dice_.chance(0.4) ? -1 : 2 + dice_.below(7);
        return std::move(scene_);
    }

private:
    /// The middle of a free one of the box's 27 cells, moved a little.
    Vec3d free_place() {
        const int cell = cells_.back();
        cells_.pop_back();
        const auto at = [&](int i) { return (i - 1) * 2.0 / 3 + dice_.between(-0.05, 0.05); };
        return Vec3d(at(cell % 3), at(cell / 3 % 3), at(cell / 9)).cwiseProduct(extent_);
    }

    int add_material(MaterialKind kind) {
        scene_.materials.push_back(random_material(dice_, kind));
        return static_cast<int>(scene_.materials.size()) - 1;
    }
    int wall_material() {
        const bool plain = is_matt(mood_) || dice_.chance(0.8);
        const auto kind = plain ? MaterialKind::diffuse
                                : std::array{MaterialKind::plastic, MaterialKind::phong,
                                             MaterialKind::rough_conductor}[static_cast<std::size_t>(dice_.below(3))];
        const int material = add_material(kind);
        scene_.materials.back().two_sided = true;
        return material;
    }

    /// The rectangle on the room's side along `axis`; its front faces inwards.
    SceneShape wall(int axis, double sign) const {
        SceneShape shape;
        shape.kind = ShapeKind::rectangle;
        Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        axes(u, 0) = extent_[u];
        axes(v, 1) = -sign * extent_[v];
        axes(axis, 2) = -sign;
        shape.to_world = placed(axes, sign * extent_[axis] * Vec3d::Unit(axis));
        return shape;
    }
    void add_wall(int axis, double sign) {
        scene_.shapes.push_back(wall(axis, sign));
        scene_.shapes.back().material = wall_material();
    }
    void add_room() {
        if (dice_.chance(0.5)) {
            for (int axis = 0; axis < 3; ++axis)
                for (const double sign : {-1.0, 1.0})
                    add_wall(axis, sign);
            return;
        }
        SceneShape room;
        room.kind = ShapeKind::cube;
        room.to_world = placed(extent_.asDiagonal(), Vec3d::Zero());
        room.flip_normals = true;
        room.material = wall_material();
        scene_.shapes.push_back(room);
    }
    /// A floor, perhaps a wall behind it, and a small screen at the scene's greatest height, so
    /// that all bounds are those of rectangles.
    void add_ground() {
        add_wall(1, -1);
        if (dice_.chance(0.5)) add_wall(2, 1);
        SceneShape screen = wall(1, 1);
        for (int i = 0; i < 2; ++i)
            screen.to_world.col(i) *= 0.25;
        screen.material = wall_material();
        scene_.shapes.push_back(screen);
    }

    void add_camera() {
        SceneCamera& camera = scene_.camera;
        const Vec3d from = free_place();
        const Vec3d towards = 0.3 * random_direction(dice_) - from;
        camera.to_world = looking(from, from.norm() > 0.4 ? towards : random_direction(dice_));
        camera.fov = dice_.between(40, 90);
        if (mood_ == SceneMood::reciprocal) return;
        if (dice_.chance(0.15)) camera.half_extent = Vec2d::Constant(dice_.between(0.2, 0.6));
        else if (dice_.chance(0.15)) camera.aperture = dice_.between(0.005, 0.05);
        camera.focus = dice_.between(0.5, 2);
    }

    SceneShape random_shape(double smallest, double largest) {
        SceneShape shape;
        shape.kind = static_cast<ShapeKind>(dice_.below(6));
        if (mood_ == SceneMood::polygons)
            shape.kind = std::array{ShapeKind::rectangle, ShapeKind::cube, ShapeKind::mesh}[dice_.bits() % 3];
        const double size = dice_.between(smallest, largest) * 0.3 * extent_.minCoeff();
        Eigen::Matrix3d linear = random_rotation(dice_);
        if (shape.kind == ShapeKind::disk) linear.col(1) *= dice_.between(0.4, 1);
        if (shape.kind == ShapeKind::rectangle) linear *= 0.7;
        if (shape.kind == ShapeKind::cube) linear *= 0.57;
        if (shape.kind == ShapeKind::cylinder) linear *= 0.7;
        shape.to_world = placed(size * linear, free_place());
        if (shape.kind == ShapeKind::mesh) {
            shape.mesh = random_mesh(dice_, dice_.chance(0.6));
            shape.mesh.smooth = mood_ != SceneMood::reciprocal && dice_.chance(0.4);
        }
        return shape;
    }

    void add_thing() {
        SceneShape shape = random_shape(0.4, 1);
        const bool closed = is_closed(shape.kind) || shape.mesh.triangles.size() == 8;
        const MaterialKind kind = random_kind(dice_, mood_, closed);
        shape.material = add_material(kind);
        const bool hollow = transmits(kind) && kind != MaterialKind::thin_glass && kind != MaterialKind::mask;
        if (!is_matt(mood_) && closed && (hollow || kind == MaterialKind::nothing) && dice_.chance(0.3)) {
            scene_.media.push_back(random_medium());
            shape.interior = static_cast<int>(scene_.media.size()) - 1;
        }
        scene_.shapes.push_back(shape);
        if (!hollow || shape.kind != ShapeKind::sphere || !dice_.chance(0.5)) return;
        shape.to_world.topLeftCorner<3, 3>() *= 0.5;  // a shape inside the glass
        shape.interior = -1;
        shape.material = add_material(random_kind(dice_, mood_, false));
        scene_.shapes.push_back(shape);
    }

    SceneMedium random_medium() {
        SceneMedium medium;
        medium.sigma_t = dice_.between(0.5, 8) * random_color(dice_, 0.5, 1);
        medium.albedo = random_color(dice_, 0, 1);
        medium.g = dice_.between(-0.8, 0.8);
        return medium;
    }
    void add_fog(bool closed) {
        if (!closed && dice_.chance(0.7)) return;
        scene_.media.push_back(random_medium());
        scene_.media.back().sigma_t *= 0.1;
        scene_.camera_medium = static_cast<int>(scene_.media.size()) - 1;
    }

    void add_lamp() {
        SceneShape lamp = random_shape(0.3, 0.9);
        lamp.material = add_material(dice_.chance(0.5) ? MaterialKind::diffuse : random_kind(dice_, mood_, false));
        lamp.radiance = dice_.between(1, 20) * random_color(dice_, 0.3, 1);
        lamp.flip_normals = !is_closed(lamp.kind) && dice_.chance(0.3);
        scene_.shapes.push_back(lamp);
    }
    /// Two rectangles that face the middle and are small enough for their cells.
    void add_patches() {
        const Vec3d first = free_place(), second = free_place();
        const bool in_glass = dice_.chance(0.4);
        if (in_glass) {
            SceneShape shell;
            shell.to_world = placed(0.18 * random_rotation(dice_), first);
            shell.material = add_material(dice_.chance(0.5) ? MaterialKind::glass : MaterialKind::rough_glass);
            scene_.index_around_patch = scene_.materials.back().ior;
            scene_.shapes.push_back(shell);
        }
        add_patch(first, in_glass ? 0.1 : 0.18, 0.7);
        add_patch(second, 0.18, 0.4);
    }
    void add_patch(const Vec3d& at, double size, double reflectance) {
        SceneShape patch;
        patch.kind = ShapeKind::rectangle;
        patch.to_world = looking(at, 0.3 * random_direction(dice_) - at);
        patch.to_world.col(0) *= size * dice_.between(0.5, 1);
        patch.to_world.col(1) *= size * dice_.between(0.5, 1);
        patch.material = add_material(MaterialKind::diffuse);
        SceneMaterial& material = scene_.materials.back();
        material.color = Colord::Constant(reflectance);
        material.two_sided = false;
        material.tiles = 0;
        scene_.shapes.push_back(patch);
    }
    void add_lights(bool closed) {
        const int count = 1 + dice_.below(3);
        if (!closed && dice_.chance(0.6)) {
            SceneLight sky;
            sky.kind = LightKind::sky;
            sky.strength = random_color(dice_, 0.2, 1);
            scene_.lights.push_back(sky);
        }
        for (int i = 0; i < count; ++i) {
            if (dice_.chance(0.5)) {
                add_lamp();
                continue;
            }
            SceneLight light;
            light.kind = static_cast<LightKind>(dice_.below(closed ? 2 : 3));
            const bool sun = light.kind == LightKind::directional;
            const Vec3d from = sun ? Vec3d(Vec3d::Zero()) : free_place();
            const Vec3d down = Vec3d(0, -1, 0) + 0.7 * random_direction(dice_);
            light.to_world = looking(from, sun ? down : Vec3d(0.5 * random_direction(dice_) - from));
            light.strength = dice_.between(0.3, 2) * random_color(dice_, 0.3, 1);
            light.cutoff = dice_.between(15, 80);
            light.beam = dice_.between(0, 1) * light.cutoff;
            scene_.lights.push_back(light);
        }
    }

    Dice dice_;
    SceneMood mood_;
    Vec3d extent_;
    std::vector<int> cells_;
    RandomScene scene_;
};

}  // namespace

Eigen::Matrix3d random_rotation(Dice& dice) {
    const Eigen::Matrix3d r =
        Eigen::AngleAxisd(dice.between(0, 2 * std::numbers::pi), random_direction(dice)).toRotationMatrix();
    return r.unaryExpr([](double x) { return rounded(x, entry_step); });
}

Mat4d looking(const Vec3d& from, const Vec3d& forward) {
    const Vec3d z = forward.normalized();
    const Vec3d up = std::abs(z.y()) < 0.99 ? Vec3d(Vec3d::UnitY()) : Vec3d(Vec3d::UnitX());
    Eigen::Matrix3d axes;
    axes.col(2) = z;
    axes.col(0) = up.cross(z).normalized();
    axes.col(1) = z.cross(axes.col(0));
    return placed(axes, from);
}

RandomScene random_scene(std::uint64_t seed, SceneMood mood) { return Generator(seed, mood).scene(); }

}  // namespace gib::test
