// Findings of fuzzing and of reading the code for such inputs: short files that ask for too much memory, time or
// depth, and values that would pass the readers' checks. Each is refused with its place or has a defined result.

#include "common/images/image_file.h"
#include "common/images/linear_file.h"
#include "common/mesh_files/mesh_ms3d.h"
#include "common/scene/scene.h"
#include "experiments/plan/experiment_file.h"
#include "tests/support/scene_errors.h"

#include <zlib.h>

namespace gib::test::fuzz_findings_test {
namespace {

std::string ply(const std::string& vertex_properties, const std::string& body) {
    return "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n" +
           vertex_properties + "element face 1\nproperty list uchar int vertex_indices\nend_header\n" + body;
}

TEST(FuzzFindings, PlyElementsStandOnce) {
    // The file has normals for the first three of six vertices; those of the others would
    // be read from beyond the array.
    const std::string normals = "property float nx\nproperty float ny\nproperty float nz\n";
    const std::string text =
        ply(normals + "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n", "");
    EXPECT_THAT(input_error_of([&] { parse_ply(text, "m.ply"); }),
                StartsWith("m.ply:10:16: the element 'vertex' is given twice"));
}

TEST(FuzzFindings, PlyIndicesBeyondEveryInteger) {
    for (const std::string index : {"9223372036854775807", "-9223372036854775808", "4294967295", "3"})
        EXPECT_THAT(input_error_of([&] { parse_ply(ply("", "0 0 0\n1 0 0\n0 1 0\n3 0 1 " + index + "\n"), "m.ply"); }),
                    HasSubstr("is out of range: there are 3 vertices"))
            << index;
}

/// The error of an OBJ file with one triangle and `statement`.
std::string obj_error(const std::string& statement) {
    return input_error_of([&] { parse_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + statement + "\nf 1 2 3\n", "m.obj"); });
}

TEST(FuzzFindings, ObjNormalsAndUvFitFloat) {
    EXPECT_THAT(obj_error("vn 0 1e39 0"), StartsWith("m.obj:4:6: a normal is too large: 1e+39"));
    EXPECT_THAT(obj_error("vt 0 -1e300"), StartsWith("m.obj:4:6: a texture coordinate is too large: -1e+300"));
    EXPECT_THAT(obj_error("vn nan 0 0"), StartsWith("m.obj:4:4: a normal is not finite"));
    EXPECT_EQ(obj_error("vn 0 1e38 0"), "no error");
}

TEST(FuzzFindings, PlyNormalsAndUvFitFloat) {
    const std::string more =
        "property double nx\nproperty double ny\nproperty double nz\nproperty double u\nproperty double v\n";
    const auto error = [&](const std::string& values) {
        return input_error_of([&] {
            parse_ply(ply(more, "0 0 0 " + values + "\n1 0 0 0 0 1 0 0\n0 1 0 0 0 1 0 0\n3 0 1 2\n"), "m.ply");
        });
    };
    expect_errors({{"0 0 1e39 0 0", "15:11", "vertex 0: a normal or texture coordinate is too large"},
                   {"0 0 1 0 1e39", "15:15", "vertex 0: a normal or texture coordinate is too large"},
                   {"0 0 nan 0 0", "15:11", "vertex 0 is not finite"}},
                  error, "m.ply");
    EXPECT_EQ(error("0 0 1e38 0 1e38"), "no error");
}

TEST(FuzzFindings, Ms3dNormalsFitFloat) {
    const auto error = [](const std::string& normal) {
        return input_error_of([&] {
            parse_ms3d("Meshes: 1\n\"m\" 0 -1\n3\n0 0 0 0 0 0 -1\n0 1 0 0 1 0 -1\n0 0 1 0 0 1 -1\n1\n" + normal +
                           "\n1\n0 0 1 2 0 0 0 1\n",
                       "m.txt");
        });
    };
    EXPECT_THAT(error("0 0 1e39"), StartsWith("m.txt:8:5: a normal is too large: 1e+39"));
    EXPECT_THAT(error("0 0 inf"), StartsWith("m.txt:8:5: a normal is not finite"));
    EXPECT_EQ(error("0 0 1e38"), "no error");
}

/// A serialized mesh of a triangle in doubles, with these values in its normals and uv.
std::string serialized(double normal, double uv) {
    std::string raw;
    const auto put = [&](auto value) { raw.append(reinterpret_cast<const char*>(&value), sizeof value); };
    put(std::uint32_t{0x2003});
    raw += '\0';
    for (const std::uint64_t count : {3, 1})
        put(count);
    for (const double x : {0., 0., 0., 1., 0., 0., 0., 1., 0.})
        put(x);
    for (const double x : {0., 0., normal, 0., 0., 1., 0., 0., 1.})
        put(x);
    for (const double x : {0., uv, 1., 0., 0., 1.})
        put(x);
    for (const std::uint32_t i : {0, 1, 2})
        put(i);
    std::string stream(compressBound(raw.size()), '\0');
    uLongf size = stream.size();
    compress(reinterpret_cast<Bytef*>(stream.data()), &size, reinterpret_cast<const Bytef*>(raw.data()), raw.size());
    return std::string("\x1c\x04\x04\x00", 4) + stream.substr(0, size);
}

TEST(FuzzFindings, SerializedNormalsAndUvFitFloat) {
    const auto error = [](double normal, double uv) {
        return input_error_of([&] { parse_serialized(serialized(normal, uv), "m.serialized", 0); });
    };
    EXPECT_THAT(error(1e39, 0), HasSubstr("the normal of vertex 0 is too large"));
    EXPECT_THAT(error(1, -1e39), HasSubstr("the texture coordinate of vertex 0 is too large"));
    EXPECT_EQ(error(1e38, 1e38), "no error");
}

TEST(FuzzFindings, NormalsSurviveScalesWhoseProductsDoNot) {
    // The scales have determinants of 0, of infinity and of 0 again in double.
    MeshData mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    mesh.normals.assign(3, Vec3(0.6f, 0, 0.8f));
    for (const Vec3d& scale :
         {Vec3d(1e-110, 1e-110, 1e-110), Vec3d(1e120, 1e120, 1e120), Vec3d(-1e-150, 1e-150, 1e-150)}) {
        Mat4d to_world = Mat4d::Identity();
        to_world.topLeftCorner<3, 3>() = scale.asDiagonal();
        MeshData moved = mesh;
        transform_mesh(moved, to_world);
        // A uniform scale keeps directions; a mirrored axis turns its component.
        const Vec3 expected(scale.x() < 0 ? -0.6f : 0.6f, 0, 0.8f);
        EXPECT_LT((moved.normals[0] - expected).norm(), 1e-6f) << scale.transpose();
    }
    // n' = M^-T n: (0.6, 0.8) under (1e-200, 1) leans onto the first axis.
    Mat4d flat = Mat4d::Identity();
    flat(0, 0) = 1e-200;
    flat(1, 1) = 1e-200;
    transform_mesh(mesh, flat);
    EXPECT_LT((mesh.normals[0] - Vec3::UnitX()).norm(), 1e-6f);
}

TEST(FuzzFindings, NormalsOfFacesOfNearlyNoArea) {
    for (const double side : {1e-150, 1e-160, 1e-161}) {
        MeshData mesh;
        mesh.positions = {{0, 0, 0}, {side, 0, 0}, {0, side, 0}};
        mesh.triangles = {{0, 1, 2}};
        compute_normals(mesh);
        for (const Vec3& n : mesh.normals)
            EXPECT_LT((n - Vec3::UnitZ()).norm(), 1e-6f) << side;
    }
}

TEST(FuzzFindings, DisksKeepTheirNormalInFlatTransforms) {
    // A disk has no extent along its axis, so any scale there leaves it as it is.
    for (const char* z : {"1", "1e-320", "1e300"}) {
        const LoadedScene loaded = load(shape("disk", to_world("<scale z='", z, "'/>")));
        EXPECT_LT((std::get<Disk>(loaded.scene->shapes()[0]).normal - Vec3::UnitZ()).norm(), 1e-6f) << z;
    }
}

/// `count` masks, each of which holds the next one; the last holds a diffuse surface.
std::string chain(int count) {
    std::string text;
    for (int i = 0; i < count; ++i)
        text += with_id("bsdf", "mask", "m" + std::to_string(i), reference("m" + std::to_string(i + 1))) + "\n";
    return text + with_id("bsdf", "diffuse", "m" + std::to_string(count)) + "\n" + shape("sphere", reference("m0"));
}

TEST(FuzzFindings, MaterialsAreNotTooDeep) {
    EXPECT_THAT(scene_error(chain(100000)), HasSubstr("a material or texture of too many parts"));
    EXPECT_EQ(scene_error(chain(63)), "no error");
}

TEST(FuzzFindings, TexturesAreNotExponential) {
    std::string text;
    for (int i = 0; i < 50; ++i) {
        const std::string next = "t" + std::to_string(i + 1);
        text += with_id("texture", "checkerboard", "t" + std::to_string(i), reference("color0", next),
                        reference("color1", next));
    }
    text +=
        with_id("texture", "checkerboard", "t50") + shape("sphere", bsdf("diffuse", reference("reflectance", "t0")));
    EXPECT_THAT(scene_error(text), HasSubstr("a material or texture of too many parts"));
}

TEST(FuzzFindings, ManySmallMaterialsAreFine) {
    std::string text = shape("sphere");
    for (int i = 0; i < 2000; ++i)
        text += bsdf("mask", bsdf("diffuse")) + "\n";
    EXPECT_EQ(scene_error(text), "no error");
}

TEST(FuzzFindings, FilmsReachNoFurtherThanFloat) {
    const auto error = [](const std::string& sensor, const std::string& film) {
        const std::string view = element("sensor", "perspective", sensor, "\n", element("film", "hdrfilm", film));
        return input_error_of([&] { parse_scene(scene_xml(view + shape("sphere")), "t.xml"); });
    };
    const std::string message = "t.xml:2:1: the film reaches too far from the view's axis";
    EXPECT_THAT(error(number("principal_point_offset_x", 1e38), ""), StartsWith(message));
    EXPECT_THAT(error("", element("rfilter", "box", radius(1e38))), StartsWith(message));
    EXPECT_EQ(error(number("fov", 179.999), ""), "no error");
}

TEST(FuzzFindings, AreaEmittersHaveAnAreaInFloat) {
    const auto ball = [](double r) { return shape("sphere", radius(r), "\n", emitter("area")); };
    // The six sides of the cube have an area of 4e36 each.
    expect_errors({{ball(1e-25), "3:1", "an area emitter on a shape of area 1.25664e-49"},
                   {shape("cube", to_world(scale(1e18)), "\n", emitter("area")), "3:1",
                    "an area emitter on a shape of area 2.4e+37"}});
    EXPECT_EQ(scene_error(ball(1e-18)), "no error");
    EXPECT_EQ(scene_error(ball(1e17)), "no error");
}

TEST(FuzzFindings, CoordinatesThatOverflowInTheTransform) {
    // The transformed y is 1.5e308 * 8 - 1.5e308 * 8, the difference of two infinities. The other coordinates are
    // near the second mesh, so that nothing is too far from the scene's centre.
    const TemporaryFolder folder;
    folder.write("far.obj", "v 8 8 0\nv 8 8 1\nv 8 8 2\nf 1 2 3\n");
    folder.write("near.obj", "v 8e297 0 0\nv 8e297 1 0\nv 8e297 0 1\nf 1 2 3\n");
    const std::string far = to_world("<matrix value='1e297 0 0 1.5e308 -1.5e308 0 0 0 1'/>");
    EXPECT_THAT(scene_error(shape("obj", filename("far.obj"), far) + "\n" + shape("obj", filename("near.obj")),
                            folder / "t.xml"),
                HasSubstr("t.xml:1:1: the scene is too large"));
}

TEST(FuzzFindings, ImagesThatClaimMoreThanTheirFileHolds) {
    const TemporaryFolder folder;
    folder.write("sky.pfm", "PF\n100000 100000\n-1.0\n");
    folder.write("sky.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n");
    for (const std::string file : {"sky.pfm", "sky.hdr"}) {
        const std::string painted = bsdf("diffuse", named("texture", "reflectance", "bitmap", filename(file)));
        for (const auto& body : {shape("sphere") + emitter("envmap", filename(file)), shape("sphere", painted)})
            EXPECT_THAT(scene_error(body, folder / "t.xml"), StartsWith(folder / file + ":1:1: ")) << file;
    }
}

class ExperimentFindings : public ::testing::Test {
protected:
    std::string error(const std::string& rest, const std::string& scene = "a.xml") const {
        return input_error_of([&] { parse_experiment("scenes = [\"" + scene + "\"]\n" + rest, folder_ / "e.toml"); });
    }
    const TemporaryFolder folder_;
    const std::string scene_ = folder_.write("a.xml", "");
};

TEST_F(ExperimentFindings, SweepsDoNotMultiplyWithoutBound) {
    // The sweep has 10^9 labels.
    std::string method = "[[method]]\nname = \"photon_mapper\"\n";
    for (const char* key : {"photons", "caustic_photons", "volume_photons", "k", "gather", "spp", "max_depth",
                            "shadow_photons", "direct_samples"})
        method += std::string(key) + " = [2, 3, 4, 5, 6, 7, 8, 9, 10, 11]\n";
    EXPECT_THAT(error(method), HasSubstr("make more than 10000 combinations of values"));
}

TEST_F(ExperimentFindings, NamesThatNoFileCanHave) {
    EXPECT_THAT(error("", std::string(5000, 'x')), HasSubstr("e.toml:1:11: there is no scene file"));
}

}  // namespace
}  // namespace gib::test::fuzz_findings_test
