// Tests the meaning of scene files, which is that of Mitsuba 3's variant scalar_rgb.

#include "common/core/error.h"
#include "common/scene/scene.h"
#include "tests/support/scene_text.h"
#include "tests/support/source_path.h"

#include <climits>

namespace gib::test::scene_file_test {
namespace {

const std::string ball = shape("sphere");

/// The hit of a ray in the file's coordinates; those of the loaded scene are relative to the centre of its bounds.
std::optional<SurfaceHit> hit(const LoadedScene& loaded, const Vec3& o, const Vec3& d, const Vec3& center) {
    return loaded.scene->intersect({o - center, d});
}

Ray camera_ray(const std::string& sensor, int x, int y) {
    const auto loaded = parse_scene("<scene version='3.0.0'>" + sensor + ball + "</scene>", "test.xml");
    return loaded.scene->sensor().generate_ray(x, y, Vec2(0.5f, 0.5f));
}

std::string film(int width, int height) {
    return element("film", "hdrfilm", "<integer name='width' value='", std::to_string(width),
                   "'/><integer name='height' value='", std::to_string(height), "'/>", element("rfilter", "box"));
}

void expect_near(const Vec3& a, const Vec3& b, float tolerance = 1e-5f) {
    EXPECT_LT((a - b).norm(), tolerance) << "(" << a.transpose() << ") is not (" << b.transpose() << ")";
}

Vec3 center_of_disk(const std::string& operations) {
    // The transform also moves the scene's origin, but the normal of the disk does not depend on it.
    const auto loaded = load(shape("disk", to_world(operations)));
    return std::get<Disk>(loaded.scene->shapes()[0]).normal;
}

TEST(SceneFile, TransformsApplyInDocumentOrder) {
    const auto bounds_of_order = [](const std::string& a, const std::string& b) {
        const auto loaded = load(shape("sphere") + shape("sphere", to_world(a, b)));
        const auto& first = std::get<Sphere>(loaded.scene->shapes()[0]);
        const auto& second = std::get<Sphere>(loaded.scene->shapes()[1]);
        return Vec3(second.center - first.center);
    };
    const std::string translate = translate(1, 0, 0), scale = scale(3), turn = rotate('z', 90);
    expect_near(bounds_of_order(translate, scale), Vec3(3, 0, 0));
    expect_near(bounds_of_order(scale, translate), Vec3(1, 0, 0));
    expect_near(bounds_of_order(translate, turn), Vec3(0, 1, 0));
    expect_near(bounds_of_order(turn, translate), Vec3(1, 0, 0));
    expect_near(bounds_of_order("<matrix value='0 -1 0 5  1 0 0 6  0 0 1 7  0 0 0 1'/>", translate), Vec3(6, 6, 7));
    expect_near(bounds_of_order(translate, "<matrix value='0 -1 0, 1 0 0, 0 0 1'/>"), Vec3(0, 1, 0));
}

TEST(SceneFile, LookatTurnsTheZAxisToTheTarget) {
    expect_near(center_of_disk(look_at("0,0,0", "5,0,0", "0,0,1")), Vec3(1, 0, 0));
    expect_near(center_of_disk("<lookat origin='1 2 3' target='1 2 1'/>"), Vec3(0, 0, -1));
}

TEST(SceneFile, CameraRaysFollowTheFieldOfView) {
    // An image of 4 x 2 seen along +z with x to the left: pixel centres at (3/4, 1/2) of the half extents.
    const auto sensor = [](const std::string& axis, double fov) {
        return element("sensor", "perspective", text("fov_axis", axis), number("fov", std::to_string(fov)), film(4, 2));
    };
    const auto expected = [](double half_width) {
        return Vec3d(0.75 * half_width, 0.5 * half_width / 2, 1).normalized().cast<float>().eval();
    };
    expect_near(camera_ray(sensor("x", 90), 0, 0).d, expected(1));
    expect_near(camera_ray(sensor("larger", 90), 0, 0).d, expected(1));
    expect_near(camera_ray(sensor("y", 90), 0, 0).d, expected(2));
    expect_near(camera_ray(sensor("smaller", 90), 0, 0).d, expected(2));
    expect_near(camera_ray(sensor("diagonal", 90), 0, 0).d, expected(2 / std::sqrt(5.0)));
    // The default is 35 mm film: a diagonal of 43.27 mm, seen from 50 mm.
    const double half_diagonal = std::hypot(36, 24) / 100;
    expect_near(camera_ray(element("sensor", "perspective", film(4, 2)), 0, 0).d,
                expected(half_diagonal * 2 / std::sqrt(5.0)));
    expect_near(camera_ray(element("sensor", "perspective", text("focal_length", "100mm"), film(4, 2)), 0, 0).d,
                expected(half_diagonal / std::sqrt(5.0)));
    const Vec3 last = camera_ray(sensor("x", 90), 3, 1).d;
    expect_near(last, expected(1).cwiseProduct(Vec3(-1, -1, 1)));
}

TEST(SceneFile, ClipDistancesActOnlyIfGiven) {
    const std::string open = "<sensor type='perspective'><float name='fov' value='50'/>";
    const Ray plain = camera_ray(open + film(1, 1) + "</sensor>", 0, 0);
    EXPECT_EQ(plain.t_min, 0.f);
    EXPECT_EQ(plain.t_max, infinity);
    const Ray clipped = camera_ray(
        open + "<float name='near_clip' value='2'/><float name='far_clip' value='3'/>" + film(1, 1) + "</sensor>", 0,
        0);
    EXPECT_EQ(clipped.t_min, 2.f);
    EXPECT_EQ(clipped.t_max, 3.f);
}

TEST(SceneFile, OrthographicSensorsAreScaledByTheirTransform) {
    const Ray ray = camera_ray(
        element("sensor", "orthographic", to_world(scale(10, 10, 1), translate(0, 0, -5)), film(2, 2)), 0, 0);
    expect_near(ray.o, Vec3(5, 5, -5));
    expect_near(ray.d, Vec3(0, 0, 1));
}

TEST(SceneFile, ResolutionOverridesTheFilm) {
    const auto loaded = load(ball, {{}, std::pair(7, 5)});
    EXPECT_EQ(loaded.scene->sensor().width(), 7);
    EXPECT_EQ(loaded.scene->sensor().height(), 5);
}

TEST(SceneFile, IntegratorsGiveTheLongestPath) {
    const auto edges = [](const std::string& integrator) { return load(integrator + ball).max_edges; };
    const auto path = [](const std::string& depth) {
        return element("integrator", "path", "<integer name='max_depth' value='", depth, "'/>", integer("rr_depth", 9));
    };
    EXPECT_EQ(edges(""), INT_MAX);
    EXPECT_EQ(edges(element("integrator", "path")), INT_MAX);
    EXPECT_EQ(edges(path("-1")), INT_MAX);
    EXPECT_EQ(edges(path("0")), 0);
    EXPECT_EQ(edges(path("17")), 17);
    EXPECT_EQ(edges(element("integrator", "direct", integer("emitter_samples", 4))), 2);
    EXPECT_EQ(edges(element("integrator", "moment", path("6"))), 6);
}

TEST(SceneFile, ParametersReplaceDefaults) {
    const std::string body =
        "<default name='r' value='2'/><default name='r' value='9'/><default name='rx' value='4'/>" +
        shape("sphere", number("radius", "$r")) + shape("sphere", number("radius", "$rx"));
    const auto radius = [](const LoadedScene& l, std::size_t i) {
        return std::get<Sphere>(l.scene->shapes()[i]).radius;
    };
    EXPECT_EQ(radius(load(body), 0), 2.f);
    EXPECT_EQ(radius(load(body), 1), 4.f);
    EXPECT_EQ(radius(load(body, {{{"r", "3"}}, {}}), 0), 3.f);
}

TEST(SceneFile, ReferencesShareOneMaterial) {
    const auto loaded =
        load(shape("sphere", reference("b")) + with_id("bsdf", "diffuse", "a", rgb("reflectance", "0.1, 0.2 0.3")) +
             "<alias id='a' as='b'/>" + shape("sphere", "<ref name='bsdf' id='a'/>"));
    ASSERT_EQ(loaded.scene->materials().size(), 1u);
    const auto color = loaded.scene->material_of_shape(0).constant()->coefficients_local(Vec3(0, 0, 1)).diffuse;
    EXPECT_EQ(color[0], 0.1f);
    EXPECT_EQ(color[2], 0.3f);
    EXPECT_EQ(&loaded.scene->material_of_shape(0), &loaded.scene->material_of_shape(1));
}

TEST(SceneFile, ShapesWithoutAMaterialAreGreyAndLightsBlack) {
    const auto loaded = load(shape("sphere") + shape("disk", area_light(3)));
    EXPECT_EQ(loaded.scene->material_of_shape(0).constant()->coefficients_local(Vec3(0, 0, 1)).diffuse[1], 0.5f);
    EXPECT_FALSE(loaded.scene->material_of_shape(0).two_sided());
    EXPECT_EQ(loaded.scene->material_of_shape(1).constant()->coefficients_local(Vec3(0, 0, 1)).diffuse[1], 0.f);
    ASSERT_EQ(loaded.scene->lights().size(), 1u);
    EXPECT_EQ(std::get<AreaLight>(loaded.scene->lights()[0]).radiance[2], 3.f);
}

TEST(SceneFile, MaterialsKeepMitsubasDefaults) {
    const auto bsdf = [](const std::string& xml) {
        return *load("<shape type='sphere'><bsdf " + xml + "</shape>").scene->materials()[0].constant();
    };
    const auto eta_of = [](const Bsdf& b) {
        const auto s = b.sample_local(Vec3(0, 0, 1), Vec2(0.999f, 0.5f), Vec2(0.5f, 0.5f), Transport::power);
        return s->eta;
    };
    EXPECT_NEAR(eta_of(bsdf("type='dielectric'/>")), 1.5046 / 1.000277, 1e-6);
    EXPECT_NEAR(eta_of(bsdf("type='dielectric'><string name='int_ior' value='water'/><float name='ext_ior' "
                            "value='1'/></bsdf>")),
                1.333, 1e-6);
    EXPECT_EQ(bsdf("type='conductor'/>").coefficients_local(Vec3(0, 0, 1)).specular[0], 1.f);
    // R = ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2) at normal incidence.
    EXPECT_NEAR(bsdf("type='conductor'><rgb name='eta' value='0.2'/><rgb name='k' value='3'/></bsdf>")
                    .coefficients_local(Vec3(0, 0, 1))
                    .specular[0],
                (0.64 + 9) / (1.44 + 9), 1e-5);
    const Bsdf two = bsdf(
        "type='twosided'><bsdf type='diffuse'><float name='reflectance' value='0.25'/></bsdf><bsdf "
        "type='diffuse'/></bsdf>");
    EXPECT_EQ(two.coefficients_local(Vec3(0, 0, 1)).diffuse[0], 0.25f);
    EXPECT_EQ(two.coefficients_local(Vec3(0, 0, -1)).diffuse[0], 0.5f);
}

TEST(SceneFile, PointEmittersStandAtTheirPosition) {
    const auto loaded = load(ball + emitter("point", point("position", 1, 2, 3), rgb("intensity", 5)) +
                             emitter("point", to_world(translate(0, 4, 0))));
    ASSERT_EQ(loaded.scene->lights().size(), 2u);
    expect_near(std::get<PointLight>(loaded.scene->lights()[0]).position, Vec3(1, 2, 3));
    EXPECT_EQ(std::get<PointLight>(loaded.scene->lights()[0]).intensity[0], 5.f);
    expect_near(std::get<PointLight>(loaded.scene->lights()[1]).position, Vec3(0, 4, 0));
}

TEST(SceneFile, IncludesAndPathsAreFound) {
    const TemporaryFolder folder;
    folder.write("sub/part.xml", "<scene version='3.1.0'>" + shape("obj", filename("m.obj")) + "</scene>");
    folder.write("one.xml", shape("sphere", number("radius", "$r")));
    folder.write("sub/m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const auto main = folder.write("main.xml", scene_with("<default name='r' value='2'/><path value='sub'/><include "
                                                          "filename='part.xml'/><include filename='one.xml'/>"));
    const auto loaded = load_scene(main);
    EXPECT_EQ(loaded.name, "main");
    ASSERT_EQ(loaded.scene->shapes().size(), 2u);
    EXPECT_TRUE(std::holds_alternative<Mesh>(loaded.scene->shapes()[0]));
    EXPECT_EQ(std::get<Sphere>(loaded.scene->shapes()[1]).radius, 2.f);
}

TEST(SceneFile, NormalMapsMayBeOneColour) {
    const auto normal = [](const std::string& map) {
        const auto loaded = load(shape("rectangle", bsdf("normalmap", map, bsdf("diffuse"))));
        const Material& material = loaded.scene->material_of_shape(0);
        EXPECT_TRUE(material.is_bumped());
        return std::get<NormalMap>(material.node()).normal.color(Vec2{0.5f, 0.5f});
    };
    const Color expected(0.5f, 0.25f, 1.f);
    for (const char* map :
         {rgb("normalmap", "0.5 0.25 1"), named("spectrum", "normalmap", "srgb", rgb("color", "0.5 0.25 1")),
          named("texture", "normalmap", "srgb", rgb("color", "0.5 0.25 1"))})
        EXPECT_TRUE((normal(map) == expected).all()) << map;
}

TEST(SceneFile, ShapesMayReferToAnAreaEmitterOfTheScene) {
    const std::string emitter = with_id("emitter", "area", "e", rgb("radiance", 7)),
                      shape = shape("sphere", reference("e"));
    for (const std::string& body : {emitter + shape, shape + emitter}) {
        const auto loaded = load(body);
        ASSERT_EQ(loaded.scene->lights().size(), 1u);
        EXPECT_EQ(std::get<AreaLight>(loaded.scene->lights()[0]).radiance[0], 7.f);
    }
}

TEST(SceneFile, IncludesMayBeOneObjectOfWhatHoldsThem) {
    const TemporaryFolder folder;
    folder.write("grey.xml",
                 "<bsdf version='3.0.0' type='diffuse' id='grey'><include filename='colour.xml' "
                 "name='reflectance'/></bsdf>");
    folder.write("colour.xml",
                 "<texture version='3.0.0' name='other' type='srgb'>" + rgb("color", "0.1 0.2 0.3") + "</texture>");
    const std::string include = "<include filename='grey.xml'/>";
    for (const std::string& body : {shape("sphere", include), include + shape("sphere", reference("grey"))}) {
        const auto loaded = load_scene(folder.write("main.xml", scene_with(body)));
        const Bsdf* bsdf = loaded.scene->material_of_shape(0).constant();
        ASSERT_TRUE(bsdf);
        EXPECT_EQ(std::get<Diffuse>(bsdf->layers()[0].model).reflectance[2], 0.3f);
    }
}

TEST(SceneFile, NestedIncludesAreFoundBesideTheirFileFirst) {
    const TemporaryFolder folder;
    const auto ball_of = [](const std::string& radius) { return shape("sphere", number("radius", radius)); };
    folder.write("ball.xml", ball_of("1"));
    folder.write("sub/ball.xml", ball_of("2"));
    folder.write("sub/deep/ball.xml", ball_of("3"));
    folder.write("sub/beside.xml", ball_of("4"));
    folder.write("sub/part.xml", "<scene><include filename='ball.xml'/><include filename='deep/part.xml'/></scene>");
    folder.write("sub/deep/part.xml", "<scene><include filename='ball.xml'/><include filename='beside.xml'/></scene>");
    const auto main =
        folder.write("main.xml", scene_with("<include filename='sub/part.xml'/><include filename='ball.xml'/>"));
    std::vector<float> radii;
    const auto loaded = load_scene(main);
    for (const auto& shape : loaded.scene->shapes())
        radii.push_back(std::get<Sphere>(shape).radius);
    EXPECT_EQ(radii, (std::vector<float>{2, 3, 4, 1}));
}

/// The geometric normal of the first hit along -z from (0.1, 0.2, 9).
Vec3 normal_from_above(const std::string& shape) {
    const auto loaded = load(shape);
    const auto h = hit(loaded, Vec3(0.1f, 0.2f, 9), Vec3(0, 0, -1), Vec3::Zero());
    EXPECT_TRUE(h.has_value());
    if (!h) return Vec3::Zero();
    EXPECT_GT(h->ng.dot(h->ns), 0.f);
    return h->ng;
}

TEST(SceneFile, NormalsFollowMitsuba) {
    const std::string flip = flag("flip_normals");
    const std::string mirror_x = to_world(scale(-1, 1, 1));
    const std::string mirror_z = to_world(scale(1, 1, -1));
    const Vec3 up(0, 0, 1), down(0, 0, -1);
    for (const std::string type : {"rectangle", "disk", "cube", "sphere"}) {
        const auto shape = [&](const std::string& body) { return shape(type, body); };
        const auto sign = [&](const std::string& body) { return normal_from_above(shape(body)).z() > 0 ? 1 : -1; };
        EXPECT_EQ(sign(""), 1) << type;
        EXPECT_EQ(sign(flip), -1) << type;
    }
    // The normals of flat shapes and cubes follow the inverse transpose; a mirrored sphere turns inside out.
    for (const std::string type : {"rectangle", "disk"}) {
        expect_near(normal_from_above(shape(type, mirror_x)), up);
        expect_near(normal_from_above(shape(type, mirror_z)), down);
    }
    expect_near(normal_from_above(shape("cube", mirror_x)), up);
    expect_near(normal_from_above(shape("cube", mirror_x, flag("face_normals"))), down);
    EXPECT_LT(normal_from_above(shape("sphere", mirror_x)).z(), 0.f);
}

TEST(SceneFile, CubesAreClosedAndFaceOutwards) {
    const auto loaded = load(shape("cube", to_world(scale(2, 1, 1), rotate('z', 30))));
    const auto& mesh = std::get<Mesh>(loaded.scene->shapes()[0]);
    EXPECT_NEAR(area_of(loaded.scene->shapes()[0]), 8 + 2 * 16, 1e-4);
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_EQ(mesh.vertices.size(), 25u);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        EXPECT_GT(mesh.normal_of(i).dot(mesh.vertex(mesh.triangles[i][0]).cast<double>()), 0) << i;
    const auto top = hit(loaded, Vec3(0, 0, 5), Vec3(0, 0, -1), Vec3::Zero());
    ASSERT_TRUE(top);
    expect_near(Vec3(top->uv.x(), top->uv.y(), 0), Vec3(0.5f, 0.5f, 0));
}

TEST(SceneFile, MeshNormalsAreSmoothUnlessFaceNormals) {
    const TemporaryFolder folder;
    // A roof: two slopes that share their ridge.
    folder.write("roof.obj", "v 0 0 1\nv 1 0 1\nv 1 -1 0\nv 0 -1 0\nv 1 1 0\nv 0 1 0\nf 4 3 2 1\nf 1 2 5 6\n");
    const auto mesh = [&](const std::string& body) {
        const auto path = folder.write("s.xml", scene_with(shape("obj", filename("roof.obj"), body)));
        return std::get<Mesh>(load_scene(path).scene->shapes()[0]);
    };
    const Mesh smooth = mesh("");
    ASSERT_EQ(smooth.normals.size() + 1, smooth.vertices.size());
    bool ridge = false;
    for (std::size_t i = 0; i < smooth.normals.size(); ++i)
        if (smooth.vertex(static_cast<std::uint32_t>(i)).z() > 0.4f) {
            ridge = true;
            EXPECT_GT(smooth.normals[i].z(), 0.99f);
        }
    EXPECT_TRUE(ridge);
    EXPECT_TRUE(mesh(flag("face_normals")).normals.empty());
}

TEST(SceneFile, ATransformMovesFileNormalsByItsInverseTranspose) {
    const TemporaryFolder folder;
    folder.write("n.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0.25\nvn 0 3 3\nf 1/1/1 2/1/1 3/1/1\n");
    const auto load_with = [&](const std::string& scale) {
        return std::get<Mesh>(
            load_scene(folder.write("s.xml", scene_with(shape("obj", filename("n.obj"), to_world(scale)))))
                .scene->shapes()[0]);
    };
    const Mesh mesh = load_with(scale(1, 1, 2));
    expect_near(mesh.normals[0], Vec3(0, 1, 0.5f).normalized());
    EXPECT_EQ(mesh.uvs[0], Vec2(0, 0.75f));  // OBJ turns v over, as Mitsuba's default
    // The side that the file's normals call the front stays the front under a mirror.
    const Mesh mirrored = load_with(scale(-1, 1, 1));
    EXPECT_GT(mirrored.normal_of(0).z(), 0);
}

TEST(SceneFile, AFarSceneIsRecentredInDouble) {
    const auto loaded = load(shape("sphere", center(1e8, -2e8, 0.25)) + shape("sphere", center(100000004, -2e8, 0.25)));
    expect_near(std::get<Sphere>(loaded.scene->shapes()[0]).center, Vec3(-2, 0, 0), 1e-7f);
    expect_near(std::get<Sphere>(loaded.scene->shapes()[1]).center, Vec3(2, 0, 0), 1e-7f);
    EXPECT_NEAR(loaded.scene->sensor().generate_ray(0, 0, Vec2(0.5f, 0.5f)).o.y(), 2e8f, 16.f);
}

TEST(SceneFile, TheHashCoversWhateverTheImageDependsOn) {
    const TemporaryFolder folder;
    const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    folder.write("m.obj", obj);
    folder.write("i.xml", ball);
    const auto path = folder.write("main.xml", scene_with("<default name='a' value='1'/><include filename='i.xml'/>" +
                                                          shape("obj", filename("m.obj"))));
    const std::string first = load_scene(path).content_hash;
    EXPECT_EQ(first.size(), 40u);
    EXPECT_EQ(load_scene(path).content_hash, first);
    EXPECT_NE(load_scene(path, {{{"a", "2"}}, {}}).content_hash, first);
    EXPECT_NE(load_scene(path, {{}, std::pair(4, 4)}).content_hash, first);
    folder.write("m.obj", obj + "\n");
    const std::string with_mesh = load_scene(path).content_hash;
    EXPECT_NE(with_mesh, first);
    folder.write("i.xml", ball + "\n");
    EXPECT_NE(load_scene(path).content_hash, with_mesh);
}

TEST(SceneFile, ShippedScenesLoad) {
    const std::string folder = source_path("scenes/");
    const auto box = load_scene(folder + "cornell-box.xml"), glass = load_scene(folder + "cornell-glass.xml");
    EXPECT_EQ(box.scene->shapes().size(), 8u);
    EXPECT_EQ(glass.scene->shapes().size(), 8u);
    EXPECT_EQ(box.max_edges, 17);
    EXPECT_EQ(box.sample_count, 128);
    EXPECT_NEAR(area_of(box.scene->shapes()[7]), 130 * 105, 0.1);
    // The lamp radiates pi A L.
    EXPECT_NEAR(box.scene->emitted_power()[0], std::numbers::pi * 130 * 105 * 15, 10);
    for (const char* name : {"furnace", "furnace-sphere"}) {
        const auto furnace = load_scene(folder + name + ".xml", {{{"rho", "0.9"}, {"emission", "0.1"}}, {}});
        const Vec3 d(0.3f, -0.5f, 0.7f);
        const auto h = furnace.scene->intersect({Vec3(0.1f, -0.2f, 0.3f), d});
        ASSERT_TRUE(h);
        EXPECT_FLOAT_EQ(h->Le(-d)[0], 0.1f);
        EXPECT_FLOAT_EQ(h->bsdf->coefficients_local(Vec3(0, 0, 1)).diffuse[0], 0.9f);
    }
}

TEST(Files, AreWrittenWholeOrNotAtAll) {
    const TemporaryFolder folder;
    write_file(folder / "a", "one");
    write_file(folder / "a", std::string("t\0o", 3));
    EXPECT_EQ(read_file(folder / "a"), std::string("t\0o", 3));
    EXPECT_THROW(write_file(folder / "missing/a", "x"), RunError);
    std::filesystem::create_directories(folder / "taken/full");
    EXPECT_THROW(write_file(folder / "taken", "x"), RunError);
    EXPECT_THROW(read_file(folder / "taken"), InputError);
    EXPECT_THROW(read_file(folder / "b"), InputError);
    std::size_t files = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder / ""))
        ++files;
    EXPECT_EQ(files, 2u) << "a temporary file was left behind";
}

TEST(ContentHash, PiecesDoNotRunIntoEachOther) {
    ContentHash a, b, none;
    a.add("ab");
    a.add("c");
    b.add("a");
    b.add("bc");
    EXPECT_NE(a.hex(), b.hex());
    EXPECT_EQ(none.hex(), "da39a3ee5e6b4b0d3255bfef95601890afd80709");  // SHA-1 of nothing (FIPS 180-4)
}

}  // namespace
}  // namespace gib::test::scene_file_test
