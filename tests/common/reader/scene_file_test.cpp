// Tests the meaning of scene files, which is that of Mitsuba 3's variant scalar_rgb.

#include "common/scene/scene.h"
#include "tests/support/scene_builder.h"
#include "tests/support/scene_text.h"

#include <climits>

namespace gib::test::scene_file_test {
namespace {

const std::string ball = shape("sphere");

Ray camera_ray(const std::string& sensor, int x = 0, int y = 0) {
    return parse_scene(scene_xml(sensor + ball), "test.xml").scene->sensor().generate_ray(x, y, Vec2(0.5f, 0.5f));
}

std::string film(int width, int height) {
    return element("film", "hdrfilm", integer("width", width), integer("height", height), element("rfilter", "box"));
}

template <class Kind>
const Kind& shape_of(const LoadedScene& loaded, std::size_t i = 0) {
    return std::get<Kind>(loaded.scene->shapes()[i]);
}
template <class Kind>
const Kind& light_of(const LoadedScene& loaded, std::size_t i = 0) {
    return std::get<Kind>(loaded.scene->lights()[i]);
}
/// The diffuse light that the material of shape i reflects, seen along (0, 0, z).
Color diffuse_of(const LoadedScene& loaded, std::size_t i = 0, float z = 1) {
    return loaded.scene->material_of_shape(i).constant()->coefficients_local(Vec3(0, 0, z)).diffuse;
}

void expect_near(const Vec3& a, const Vec3& b, float tolerance = 1e-5f) {
    EXPECT_LT((a - b).norm(), tolerance) << "(" << a.transpose() << ") is not (" << b.transpose() << ")";
}

TEST(SceneFile, TransformsApplyInDocumentOrder) {
    const auto bounds_of_order = [](const std::string& a, const std::string& b) {
        const auto loaded = load(shape("sphere") + shape("sphere", to_world(a, b)));
        return Vec3(shape_of<Sphere>(loaded, 1).center - shape_of<Sphere>(loaded).center);
    };
    const std::string move = translate(1, 0, 0), grow = scale(3), turn = rotate('z', 90);
    expect_near(bounds_of_order(move, grow), Vec3(3, 0, 0));
    expect_near(bounds_of_order(grow, move), Vec3(1, 0, 0));
    expect_near(bounds_of_order(move, turn), Vec3(0, 1, 0));
    expect_near(bounds_of_order(turn, move), Vec3(1, 0, 0));
    expect_near(bounds_of_order("<matrix value='0 -1 0 5  1 0 0 6  0 0 1 7  0 0 0 1'/>", move), Vec3(6, 6, 7));
    expect_near(bounds_of_order(move, "<matrix value='0 -1 0, 1 0 0, 0 0 1'/>"), Vec3(0, 1, 0));
}

TEST(SceneFile, LookatTurnsTheZAxisToTheTarget) {
    const auto normal_of_disk = [](const std::string& step) {
        return shape_of<Disk>(load(shape("disk", to_world(step)))).normal;
    };
    expect_near(normal_of_disk(look_at("0,0,0", "5,0,0", "0,0,1")), Vec3(1, 0, 0));
    expect_near(normal_of_disk("<lookat origin='1 2 3' target='1 2 1'/>"), Vec3(0, 0, -1));
}

TEST(SceneFile, CameraRaysFollowTheFieldOfView) {
    // An image of 4 x 2 seen along +z with x to the left: pixel centres at (3/4, 1/2) of the half extents.
    const auto sensor = [](const std::string& view) { return element("sensor", "perspective", view, film(4, 2)); };
    const auto axis = [&](const std::string& name) { return sensor(text("fov_axis", name) + number("fov", 90)); };
    const auto expected = [](double half_width) {
        return Vec3d(0.75 * half_width, 0.5 * half_width / 2, 1).normalized().cast<float>().eval();
    };
    for (const auto& [name, half_width] : {std::pair("x", 1.0), std::pair("larger", 1.0), std::pair("y", 2.0),
                                           std::pair("smaller", 2.0), std::pair("diagonal", 2 / std::sqrt(5.0))})
        expect_near(camera_ray(axis(name)).d, expected(half_width));
    // The default is 35 mm film: a diagonal of 43.27 mm, seen from 50 mm.
    const double half_diagonal = std::hypot(36, 24) / 100;
    expect_near(camera_ray(sensor("")).d, expected(half_diagonal * 2 / std::sqrt(5.0)));
    expect_near(camera_ray(sensor(text("focal_length", "100mm"))).d, expected(half_diagonal / std::sqrt(5.0)));
    expect_near(camera_ray(axis("x"), 3, 1).d, expected(1).cwiseProduct(Vec3(-1, -1, 1)));
}

TEST(SceneFile, ClipDistancesActOnlyIfGiven) {
    const Ray plain = camera_ray(camera(50, film(1, 1))),
              clipped = camera_ray(camera(50, number("near_clip", 2), number("far_clip", 3), film(1, 1)));
    EXPECT_EQ(plain.t_min, 0.f);
    EXPECT_EQ(plain.t_max, infinity);
    EXPECT_EQ(clipped.t_min, 2.f);
    EXPECT_EQ(clipped.t_max, 3.f);
}

TEST(SceneFile, OrthographicSensorsAreScaledByTheirTransform) {
    const Ray ray =
        camera_ray(element("sensor", "orthographic", to_world(scale(10, 10, 1), translate(0, 0, -5)), film(2, 2)));
    expect_near(ray.o, Vec3(5, 5, -5));
    expect_near(ray.d, Vec3(0, 0, 1));
}

TEST(SceneFile, IntegratorsGiveTheLongestPath) {
    const auto path = [](int depth) {
        return element("integrator", "path", integer("max_depth", depth), integer("rr_depth", 9));
    };
    for (const auto& [integrator, edges] : {std::pair(std::string(), INT_MAX),
                                            {element("integrator", "path"), INT_MAX},
                                            {path(-1), INT_MAX},
                                            {path(0), 0},
                                            {path(17), 17},
                                            {element("integrator", "direct", integer("emitter_samples", 4)), 2}})
        EXPECT_EQ(load(integrator + ball).max_edges, edges) << integrator;
}

TEST(SceneFile, ParametersReplaceDefaults) {
    const std::string body =
        "<default name='r' value='2'/><default name='r' value='9'/><default name='rx' value='4'/>" +
        shape("sphere", number("radius", "$r")) + shape("sphere", number("radius", "$rx"));
    EXPECT_EQ(shape_of<Sphere>(load(body)).radius, 2.f);
    EXPECT_EQ(shape_of<Sphere>(load(body), 1).radius, 4.f);
    EXPECT_EQ(shape_of<Sphere>(load(body, {{{"r", "3"}}, {}})).radius, 3.f);
}

TEST(SceneFile, ReferencesShareOneMaterial) {
    const auto loaded =
        load(shape("sphere", reference("b")) + with_id("bsdf", "diffuse", "a", rgb("reflectance", "0.1, 0.2 0.3")) +
             "<alias id='a' as='b'/>" + shape("sphere", "<ref name='bsdf' id='a'/>"));
    ASSERT_EQ(loaded.scene->materials().size(), 1u);
    EXPECT_EQ(diffuse_of(loaded)[0], 0.1f);
    EXPECT_EQ(diffuse_of(loaded)[2], 0.3f);
    EXPECT_EQ(&loaded.scene->material_of_shape(0), &loaded.scene->material_of_shape(1));
}

TEST(SceneFile, ShapesWithoutAMaterialAreGreyAndLightsBlack) {
    const auto loaded = load(shape("sphere") + shape("disk", area_light(3)));
    EXPECT_EQ(diffuse_of(loaded)[1], 0.5f);
    EXPECT_FALSE(loaded.scene->material_of_shape(0).two_sided());
    EXPECT_EQ(diffuse_of(loaded, 1)[1], 0.f);
    ASSERT_EQ(loaded.scene->lights().size(), 1u);
    EXPECT_EQ(light_of<AreaLight>(loaded).radiance[2], 3.f);
}

TEST(SceneFile, PointEmittersStandAtTheirPosition) {
    const auto loaded = load(ball + emitter("point", point("position", 1, 2, 3), rgb("intensity", 5)) +
                             emitter("point", to_world(translate(0, 4, 0))));
    ASSERT_EQ(loaded.scene->lights().size(), 2u);
    expect_near(light_of<PointLight>(loaded).position, Vec3(1, 2, 3));
    EXPECT_EQ(light_of<PointLight>(loaded).intensity[0], 5.f);
    expect_near(light_of<PointLight>(loaded, 1).position, Vec3(0, 4, 0));
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
    EXPECT_EQ(shape_of<Sphere>(loaded, 1).radius, 2.f);
}

TEST(SceneFile, NormalMapsMayBeOneColour) {
    const auto normal = [](const std::string& map) {
        const auto loaded = load(shape("rectangle", bsdf("normalmap", map, bsdf("diffuse"))));
        const Material& material = loaded.scene->material_of_shape(0);
        EXPECT_TRUE(material.is_bumped());
        return std::get<NormalMap>(material.node()).normal.color(Vec2{0.5f, 0.5f});
    };
    const Color expected(0.5f, 0.25f, 1.f);
    for (const std::string& map :
         {rgb("normalmap", "0.5 0.25 1"), named("spectrum", "normalmap", "srgb", rgb("color", "0.5 0.25 1")),
          named("texture", "normalmap", "srgb", rgb("color", "0.5 0.25 1"))})
        EXPECT_TRUE((normal(map) == expected).all()) << map;
}

TEST(SceneFile, ShapesMayReferToAnAreaEmitterOfTheScene) {
    const std::string lamp = with_id("emitter", "area", "e", rgb("radiance", 7)), lit = shape("sphere", reference("e"));
    for (const std::string& body : {lamp + lit, lit + lamp}) {
        const auto loaded = load(body);
        ASSERT_EQ(loaded.scene->lights().size(), 1u);
        EXPECT_EQ(light_of<AreaLight>(loaded).radiance[0], 7.f);
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
        const auto loaded = load_in(folder, body);
        ASSERT_TRUE(loaded.scene->material_of_shape(0).constant());
        EXPECT_EQ(diffuse_of(loaded)[2], 0.3f);
    }
}

TEST(SceneFile, NestedIncludesAreFoundBesideTheirFileFirst) {
    const TemporaryFolder folder;
    folder.write("ball.xml", shape("sphere", radius(1)));
    folder.write("sub/ball.xml", shape("sphere", radius(2)));
    folder.write("sub/deep/ball.xml", shape("sphere", radius(3)));
    folder.write("sub/beside.xml", shape("sphere", radius(4)));
    folder.write("sub/part.xml", "<scene><include filename='ball.xml'/><include filename='deep/part.xml'/></scene>");
    folder.write("sub/deep/part.xml", "<scene><include filename='ball.xml'/><include filename='beside.xml'/></scene>");
    std::vector<float> radii;
    const auto loaded = load_in(folder, "<include filename='sub/part.xml'/><include filename='ball.xml'/>");
    for (std::size_t i = 0; i < loaded.scene->shapes().size(); ++i)
        radii.push_back(shape_of<Sphere>(loaded, i).radius);
    EXPECT_EQ(radii, (std::vector<float>{2, 3, 4, 1}));
}

/// The geometric normal of the first hit along -z from (0.1, 0.2, 9).
Vec3 normal_from_above(const std::string& body) {
    const auto loaded = load(body);
    const auto h = loaded.scene->intersect({Vec3(0.1f, 0.2f, 9), Vec3(0, 0, -1)});
    EXPECT_TRUE(h.has_value());
    if (!h) return Vec3::Zero();
    EXPECT_GT(h->ng.dot(h->ns), 0.f);
    return h->ng;
}

TEST(SceneFile, NormalsFollowMitsuba) {
    const std::string mirror_x = to_world(scale(-1, 1, 1)), mirror_z = to_world(scale(1, 1, -1));
    const Vec3 up(0, 0, 1), down(0, 0, -1);
    for (const std::string type : {"rectangle", "disk", "cube", "sphere"}) {
        EXPECT_GT(normal_from_above(shape(type)).z(), 0) << type;
        EXPECT_LE(normal_from_above(shape(type, flag("flip_normals"))).z(), 0) << type;
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
    const auto& mesh = shape_of<Mesh>(loaded);
    EXPECT_NEAR(area_of(loaded.scene->shapes()[0]), 8 + 2 * 16, 1e-4);
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_EQ(mesh.vertices.size(), 25u);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        EXPECT_GT(mesh.normal_of(i).dot(mesh.vertex(mesh.triangles[i][0]).cast<double>()), 0) << i;
    const auto top = loaded.scene->intersect({Vec3(0, 0, 5), Vec3(0, 0, -1)});
    ASSERT_TRUE(top);
    const Vec2 uv =
        mesh.surface_at(top->primitive, top->weights.x(), top->weights.y()).uv;  // no material asks a hit for it
    expect_near(Vec3(uv.x(), uv.y(), 0), Vec3(0.5f, 0.5f, 0));
}

TEST(SceneFile, ATransformMovesFileNormalsByItsInverseTranspose) {
    const TemporaryFolder folder;
    folder.write("n.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0.25\nvn 0 3 3\nf 1/1/1 2/1/1 3/1/1\n");
    const auto load_with = [&](const std::string& step) {
        return shape_of<Mesh>(load_in(folder, shape("obj", filename("n.obj"), to_world(step))));
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
    expect_near(shape_of<Sphere>(loaded).center, Vec3(-2, 0, 0), 1e-7f);
    expect_near(shape_of<Sphere>(loaded, 1).center, Vec3(2, 0, 0), 1e-7f);
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

// Two images of one size may be compared although their files ask for other sizes, sample counts, samplers or file formats.
TEST(SceneFile, TheHashOfTheViewCoversOnlyWhatIsSeen) {
    const TemporaryFolder folder;
    folder.write("i.xml", ball);
    const auto view_of = [&](const std::string& film, const std::string& rest, const SceneLoadOptions& options = {}) {
        const std::string xml = "<scene version='3.0.0'><sensor type='perspective'>" + film + "</sensor>" + rest +
                                "<include filename='i.xml'/></scene>";
        return load_scene(folder.write("main.xml", xml), options).view_hash;
    };
    const auto film = [](int size, const std::string& more = "") {
        return fmt::format(
            "<film type='hdrfilm'><integer name='width' value='{0}'/><integer name='height' "
            "value='{0}'/>{1}</film>",
            size, more);
    };
    const std::string box = "<rfilter type='box'/>", deep = "<integrator type='path'/>";
    const std::string first = view_of(film(16, box), deep);
    EXPECT_EQ(view_of(film(64, box), deep), first);
    EXPECT_EQ(view_of(film(64, box), deep, {{}, std::pair(16, 16)}), first);
    EXPECT_EQ(view_of(film(16, "<string name='file_format' value='openexr'/>" + box), deep), first);
    EXPECT_EQ(view_of(film(16, box) + "<sampler type='multijitter'><integer name='sample_count' value='9'/></sampler>",
                      "<!-- a comment -->"),
              first);
    EXPECT_EQ(view_of("<film type='ldrfilm'><integer name='width' value='$size'/>" + box + "</film>",
                      "<default name='size' value='4'/>", {{{"size", "8"}}, {}}),
              first);

    EXPECT_NE(view_of(film(16), deep), first) << "the filter decides what a pixel shows";
    EXPECT_NE(view_of(film(16, box), "<integrator type='path'><integer name='max_depth' value='2'/></integrator>"),
              first);
    EXPECT_NE(
        view_of(film(16, box), "<integrator type='path'><boolean name='hide_emitters' value='true'/></integrator>"),
        first);
    EXPECT_NE(view_of("<float name='fov' value='30'/>" + film(16, box), deep), first);
    folder.write("i.xml", shape("sphere", center(0, 0, 9)));
    EXPECT_NE(view_of(film(16, box), deep), first);
}

TEST(SceneFile, TheHashOfTheViewKnowsTheCropWindowByItsShareOfTheFilm) {
    const auto view_of = [&](int film, int offset, int size, const SceneLoadOptions& options = {}) {
        return parse_scene(
                   fmt::format("<scene version='3.0.0'><sensor type='perspective'><film type='hdrfilm'><integer "
                               "name='width' value='{0}'/><integer name='height' value='{0}'/><integer "
                               "name='crop_offset_x' value='{1}'/><integer name='crop_width' value='{2}'/>"
                               "<integer name='crop_height' value='{2}'/></film></sensor>{3}</scene>",
                               film, offset, size, ball),
                   "main.xml", options)
            .view_hash;
    };
    const std::string third = view_of(9, 3, 3);
    EXPECT_EQ(view_of(18, 6, 6), third);
    EXPECT_EQ(view_of(9, 3, 3, {{}, std::pair(7, 7)}), third);
    EXPECT_NE(view_of(9, 0, 3), third);
    EXPECT_NE(view_of(9, 0, 9), third);
}

}  // namespace
}  // namespace gib::test::scene_file_test
