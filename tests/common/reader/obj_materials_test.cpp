// OBJ files with a bsdf for each of their materials, as Mitsuba 0.6 takes them, and merged shapes.

#include "common/scene/scene.h"
#include "tests/support/input_error.h"
#include "tests/support/scene_text.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace gib::test::obj_materials_test {
namespace {

using ::testing::HasSubstr;

std::string diffuse(const std::string& name, double reflectance) {
    return fmt::format("<bsdf type='diffuse'{}><float name='reflectance' value='{}'/></bsdf>",
                       name.empty() ? "" : " name='" + name + "'", reflectance);
}

class ObjMaterials : public ::testing::Test {
protected:
    ObjMaterials() {
        // Three unit squares beside each other in the plane z = 0: Wood_A, glass and Wood_A.
        folder_.write("m.obj",
                      "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 3 1 0\nusemtl Wood_A\nf 1 2 6 "
                      "5\nusemtl glass\nf 2 3 7 6\nusemtl Wood_A\nf 3 4 8 7\n");
    }
    LoadedScene load(const std::string& bsdfs, const std::string& version = "3.0.0") const {
        return parse_scene("<scene version='" + version + "'>\n" + sensor_xml + shape(bsdfs) + "</scene>",
                           folder_ / "s.xml");
    }
    static std::string shape(const std::string& bsdfs) { return shape("obj", filename("m.obj"), bsdfs); }
    /// The reflectance of the square whose middle is at x.
    static float at(const LoadedScene& loaded, float x) {
        const auto hit = loaded.scene->intersect(Ray{Vec3(x - 1.5f, 0, 1), -Vec3::UnitZ()});  // the scene is recentred
        return hit ? hit->bsdf->coefficients_local(Vec3(0, 0, 1)).diffuse[0] : -1.f;
    }
    static std::vector<float> squares(const LoadedScene& loaded) {
        return {at(loaded, 0.5f), at(loaded, 1.5f), at(loaded, 2.5f)};
    }
    TemporaryFolder folder_;
};

TEST_F(ObjMaterials, HaveTheBsdfOfTheirName) {
    const LoadedScene scene = load(diffuse("glass", 0.1) + diffuse("Wood_A", 0.2));
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(squares(scene), (std::vector{0.2f, 0.1f, 0.2f}));
}

TEST_F(ObjMaterials, OfOlderScenesMayHaveCapitals) {
    EXPECT_EQ(squares(load(diffuse("", 0.4) + diffuse("Wood_A", 0.2), "0.6.0")), (std::vector{0.2f, 0.4f, 0.2f}));
    EXPECT_EQ(squares(load(diffuse("glass", 0.1) + diffuse("Wood_A", 0.2), "0.6.0")), (std::vector{0.2f, 0.1f, 0.2f}));
}

TEST_F(ObjMaterials, TakeReferences) {
    const LoadedScene scene = parse_scene("<scene version='0.6.0'>" + sensor_xml +
                                              with_id("bsdf", "diffuse", "a", number("reflectance", 0.3)) +
                                              shape("<ref id='a' name='Wood_A'/>" + diffuse("glass", 0.1)) + "</scene>",
                                          folder_ / "s.xml");
    EXPECT_EQ(squares(scene), (std::vector{0.3f, 0.1f, 0.3f}));
}

TEST_F(ObjMaterials, WithoutABsdfOfTheirNameHaveTheOneWithoutAName) {
    EXPECT_EQ(squares(load(diffuse("", 0.4) + diffuse("glass", 0.1))), (std::vector{0.4f, 0.1f, 0.4f}));
}

TEST_F(ObjMaterials, WithoutAnyBsdfAreGreyWithAWarning) {
    const LoadedScene scene = load(diffuse("glass", 0.1));
    EXPECT_EQ(squares(scene), (std::vector{0.5f, 0.1f, 0.5f}));
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_THAT(scene.warnings[0], HasSubstr("s.xml:3:1: the material 'Wood_A' of the OBJ file has no bsdf here"));
}

TEST_F(ObjMaterials, OfABsdfThatNoFaceHasAreWarnedOf) {
    const LoadedScene scene = load(diffuse("", 0.4) + diffuse("iron", 0.1));
    EXPECT_EQ(squares(scene), (std::vector{0.4f, 0.4f, 0.4f}));
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_THAT(scene.warnings[0], HasSubstr("no face of the OBJ file has the material 'iron'"));
}

TEST_F(ObjMaterials, DoNotMatterToOneBsdfWithAnotherName) {
    const LoadedScene scene = load(diffuse("bsdf", 0.6));
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.scene->shapes().size(), 1u);
    EXPECT_EQ(squares(scene), (std::vector{0.6f, 0.6f, 0.6f}));
}

TEST(ShapeErrors, SecondBsdf) {
    EXPECT_THAT(input_error_of([] { test::load(shape("sphere", bsdf("null"), "\n", bsdf("null"))); }),
                HasSubstr("test.xml:3:1: <shape> can hold only one <bsdf>"));
}

TEST(MergedShapes, AreThoseInTheMerge) {
    const auto loaded = test::load(shape("merge", shape("cube"), shape("rectangle", bsdf("null"))));
    EXPECT_EQ(loaded.scene->shapes().size(), 2u);
    EXPECT_THAT(input_error_of([] { test::load(shape("merge", "\n", shape("merge"))); }),
                HasSubstr("test.xml:3:1: a merge cannot hold a shape 'merge'"));
}

}  // namespace
}  // namespace gib::test::obj_materials_test
