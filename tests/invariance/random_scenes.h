#pragma once
// Random scenes as data: they are made from a seed, transformed by tests and written as scene files.
//
// All positions are dyadic: the entries of matrices are multiples of 2^-26, positions of 2^-20 and vertices of meshes
// of 2^-8, and no magnitude reaches 8. Therefore a matrix times a vertex is a multiple of 2^-34 below 32. A double
// (53 bits) holds it exactly, even after a move by a multiple of 2^-20 below 2^17.

#include "tests/support/scene_text.h"

#include "common/core/math.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gib::test {

struct SceneMaterial {
    enum class Kind {
        diffuse,
        mirror,
        conductor,
        rough_conductor,
        glass,
        dispersive_glass,
        thin_glass,
        rough_glass,
        plastic,
        rough_plastic,
        phong,
        mask,
        blend,
        normal_map,
        nothing
    };
    Kind kind = Kind::diffuse;
    Colord color = Colord::Constant(0.5);  ///< reflectance of the diffuse part, or of a conductor
    double alpha = 0.1;                    ///< roughness
    double ior = 1.5;
    double share = 0.5;      ///< a mask's opacity, a blend's weight
    bool ggx = false;        ///< else Beckmann's distribution
    bool two_sided = false;  ///< only for materials that do not transmit
    int tiles = 0;           ///< tiles of a checkerboard of `color` and half of it; 0: an even colour
};

struct SceneMesh {
    std::vector<Vec3d> vertices;
    std::vector<std::array<int, 3>> triangles;
    bool smooth = false;  ///< interpolates normals between the vertices
};

struct SceneShape {
    enum class Kind { sphere, disk, rectangle, cube, cylinder, mesh };
    Kind kind = Kind::sphere;
    Mat4d to_world = Mat4d::Identity();
    SceneMesh mesh = {};
    int material = 0;
    Colord radiance = Colord::Zero();  ///< [W/(sr m^2)] of a light
    bool flip_normals = false;
    int interior = -1;  ///< the medium behind its surface; -1: as outside

    bool emits() const { return radiance.maxCoeff() > 0; }
};

struct SceneLight {
    enum class Kind { point, spot, directional, sky };
    Kind kind = Kind::point;
    Mat4d to_world = Mat4d::Identity();  ///< rigid; a spot and a directional light shine along its z
    Colord strength = Colord::Ones();    ///< intensity [W/sr], irradiance [W/m^2] or radiance [W/(sr m^2)]
    double cutoff = 40, beam = 20;       ///< [degrees]
};

struct SceneMedium {
    Colord sigma_t = Colord::Ones();  ///< [1/scene unit]
    Colord albedo = Colord::Constant(0.8);
    double g = 0;
};

struct SceneCamera {
    Mat4d to_world = Mat4d::Identity();  ///< rigid
    std::optional<Vec2d> half_extent;    ///< [scene units] of an orthographic image; none: perspective
    double fov = 60;                     ///< [degrees]
    double aperture = 0, focus = 1;      ///< [scene units]; 0: a pinhole
    int size = 8;                        ///< pixels, square
};

struct RandomScene {
    std::vector<SceneShape> shapes;
    std::vector<SceneMaterial> materials;
    std::vector<SceneLight> lights;
    std::vector<SceneMedium> media;
    int camera_medium = -1;
    SceneCamera camera;
    int max_depth = -1;             ///< as in scene files: -1 is unlimited
    double index_around_patch = 1;  ///< index of refraction around the last shape but one (SceneMood::reciprocal)
};

/// The materials, shapes and media that scenes are made of.
enum class SceneMood {
    any,        ///< all that the scene language supports without image files
    matt,       ///< diffuse surfaces without media, which every method simulates
    polygons,   ///< as matt, but without curved shapes, which radiosity divides into many patches
    reciprocal  ///< f(wo, wi) = f(wi, wo) except for the eta^2 of refraction, which only closed shapes have; no
                ///< smooth normals, no normal maps. The room is closed and has no lights. The last two shapes are
                ///< diffuse rectangles, the first of them perhaps in a sphere of glass
};

/// Random numbers from a seed, the same on every platform.
class Dice {
public:
    explicit Dice(std::uint64_t seed);
    double between(double lowest, double highest);
    int below(int count);
    bool chance(double probability) { return between(0, 1) < probability; }
    std::uint64_t bits();

private:
    std::uint64_t state_;
};

/// A room (a cube, or walls of their own), or a floor under a sky, with up to eight shapes that touch nothing, lights
/// of every kind, and sometimes a medium.
RandomScene random_scene(std::uint64_t seed, SceneMood mood = SceneMood::any);
/// A rotation whose entries are dyadic, so that it is orthogonal to 1e-7.
Eigen::Matrix3d random_rotation(Dice& dice);
/// A rigid transform whose z axis points along `forward`.
Mat4d looking(const Vec3d& from, const Vec3d& forward);

/// The scene as XML in Mitsuba 3's language; its meshes are written to the folder.
std::string scene_file(const RandomScene& scene, const TemporaryFolder& folder);

}  // namespace gib::test
