// Scenes as other programs and people write them, each with one cause that this program did not read, or read wrongly. The files
// are in files/; each opens with the answer that the format gives it.

#include "common/scene/scene.h"
#include "tests/support/scene_errors.h"
#include "tests/support/scene_fixtures.h"

#include <cmath>

namespace gib::test::foreign_files_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const std::string folder = "tests/common/reader/files/";
const double one_length = std::exp(-1);  // what one mean free path lets through

std::string path_of(const std::string& name) { return source_path(folder + name + ".xml"); }
LoadedScene load_file(const std::string& name) { return load_scene(path_of(name)); }

/// Changes the working folder while it lives.
class WorkingFolder {
public:
    explicit WorkingFolder(const std::string& path) { std::filesystem::current_path(path); }
    ~WorkingFolder() { std::filesystem::current_path(before_); }
    WorkingFolder(const WorkingFolder&) = delete;
    WorkingFolder& operator=(const WorkingFolder&) = delete;

private:
    std::filesystem::path before_ = std::filesystem::current_path();
};

/// Expects the mean radiance of 64 pixels within 1 %, and warnings with these parts. The standard error of each test is below
/// 0.3 %.
void expect_radiance(const LoadedScene& scene, const Colord& expected, const std::vector<std::string>& warnings,
                     std::uint32_t passes = 64) {
    const Colord mean = mean_of(render(scene, "path", passes).total());
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(mean[k], expected[k], 0.01 * expected[k]) << "channel " << k;
    ASSERT_EQ(scene.warnings.size(), warnings.size()) << ::testing::PrintToString(scene.warnings);
    for (std::size_t i = 0; i < warnings.size(); ++i)
        EXPECT_THAT(scene.warnings[i], HasSubstr(warnings[i]));
}
void expect_radiance(const LoadedScene& scene, double expected, const std::vector<std::string>& warnings,
                     std::uint32_t passes = 64) {
    expect_radiance(scene, Colord(Colord::Constant(expected)), warnings, passes);
}

/// The linear RGB of a spectrum of 1 at all wavelengths, which has X = Y = Z = 1: the sums of the rows of the matrix of ITU-R BT.709.
const Colord equal_energy(1.2048, 0.9483, 0.9089);

TEST(ForeignFiles, ABoundaryWithoutABsdfIsOpenIn06AndGreyIn3) {
    expect_radiance(load_file("boundary-without-bsdf-0.6"), one_length, {});
    expect_radiance(load_file("boundary-without-bsdf-3.0"), 0.5,
                    {"boundary-without-bsdf-3.0.xml:11:5: the boundary of a medium without a bsdf is grey and opaque, "
                     "as in Mitsuba, so that light hardly reaches the medium"});
}

TEST(ForeignFiles, ALampThatIsABoundaryIsBlackInAllVersions) {
    for (const std::string version : {"0.6.0", "3.0.0"}) {
        const std::string medium = named("medium", "exterior", "homogeneous", rgb("sigma_a", 1), rgb("sigma_s", 0));
        const LoadedScene scene =
            parse_scene("<scene version='" + version + "'>" + sensor_xml +
                            shape("sphere", medium, emitter("area", rgb("radiance", 1))) + "</scene>",
                        "t.xml");
        const Material& material = scene.scene->material_of_shape(0);
        EXPECT_FALSE(material.has_holes()) << version;
        EXPECT_TRUE(is_black(material.constant()->coefficients_local(Vec3(0, 0, 1)).diffuse)) << version;
        EXPECT_THAT(scene.warnings, IsEmpty()) << version;
    }
}

TEST(ForeignFiles, SpectraOf06AreConvertedWithoutAnIlluminant) {
    expect_radiance(load_file("reflectance-by-wavelength-0.6"), 0.5 * equal_energy, {});
    expect_radiance(load_file("white-by-wavelength-0.6"), 0.99 / equal_energy[0] * equal_energy,
                    {"'reflectance' is above 1: it is scaled down to 0.99"});
    const Colord eta = 0.5 * equal_energy, k2 = (2 * equal_energy).square();
    expect_radiance(load_file("metal-by-wavelength-0.6"), ((eta - 1).square() + k2) / ((eta + 1).square() + k2), {});
}

TEST(ForeignFiles, AreSearchedInTheWorkingFolderAtLast) {
    EXPECT_THAT(input_error_of([] { load_file("from-working-folder"); }), HasSubstr("searched: "));
    const WorkingFolder tests(source_path("tests"));
    expect_radiance(load_file("from-working-folder"), 0.5, {});
    // The scene's own folder goes before: its mesh is a ball's width away from the one in the working folder.
    const TemporaryFolder own;
    own.write("common/reader/files/square.obj", "v 0 0 9\nv 1 0 9\nv 0 1 9\nf 1 2 3\n");
    const LoadedScene scene = parse_scene(read_file(path_of("from-working-folder")), own / "s.xml");
    EXPECT_EQ(std::get<Mesh>(scene.scene->shapes()[0]).triangles.size(), 1u);
}

TEST(ForeignFiles, BackslashesSeparateFolders) {
    expect_radiance(load_file("backslashes"), 0.5, {R"('..\files\square.obj' is read as '../files/square.obj')"});
}

TEST(ForeignFiles, AFileInOtherCapitalsIsNamed) {
    const std::string found = source_path(folder) + "../files/square.obj";
    EXPECT_THAT(input_error_of([] { load_file("capitals"); }),
                HasSubstr("there is no file '../Files/Square.OBJ', but there is '" + found + "': capitals matter"));
    EXPECT_THAT(
        input_error_of([] { parse_scene(scene_with(shape("obj", text("filename", path_of("Capitals")))), "t.xml"); }),
        HasSubstr("there is '" + path_of("capitals") + "'"));
}

TEST(ForeignFiles, TheDensityOfVersion2IsTheScaleOfAMedium) {
    expect_radiance(load_file("medium-density-2.0"), one_length, {});
    expect_radiance(load_file("medium-density-scale-2.0"), one_length, {});
    EXPECT_THAT(scene_error(shape("cube", named("medium", "interior", "homogeneous", number("density", 2)))),
                HasSubstr("medium 'homogeneous' does not take a parameter 'density'"));
}

TEST(ForeignFiles, AGridWrapsByTheNameOfMitsuba) {
    expect_radiance(load_file("volume-wrap-mode"), 1 - one_length, {}, 256);
    std::string old_name = read_file(path_of("volume-wrap-mode"));
    old_name.replace(old_name.find("wrap_mode"), 9, "wrap_type");
    expect_radiance(parse_scene(old_name, path_of("volume-wrap-mode")), 1 - one_length, {}, 256);
}

TEST(ForeignFiles, CellsOfAGridSlightlyBelow0CountAs0) {
    expect_radiance(load_file("volume-below-zero"), (1 + one_length) / 2,
                    {"'sigma_t' must not be negative: cells below 0, down to -0.01, count as 0"}, 256);
}

TEST(ForeignFiles, PolarizersLetHalfOfTheLightThrough) {
    // A path passes both with a probability of 0.2, and then has weight 1: 524,288 paths have a standard error of 0.28 %.
    constexpr std::uint32_t passes = 8192;
    expect_radiance(load_file("polarizer"), 0.2, {"polarizer.xml:12:9: polarization is left out"}, passes);
    std::string circular = read_file(path_of("polarizer"));
    for (std::size_t at; (at = circular.find("\"polarizer")) != circular.npos;)
        circular.replace(at, 10, "\"circular");
    expect_radiance(parse_scene(circular, "t.xml"), 0.2, {"polarization is left out"}, passes);
    const std::string retarder = bsdf("retarder", spectrum("theta", -45), spectrum("delta", 90));
    EXPECT_TRUE(load(shape("rectangle", retarder)).scene->material_of_shape(0).has_holes());
}

TEST(ForeignFiles, APhongAbove1WithATextureIsScaledDown) {
    expect_radiance(
        load_file("phong-with-texture-0.6"), (0.99 + 0.66 * 1.1) / 2,
        {"phong's diffuse_reflectance and specular_reflectance exceed 1 together: both are scaled down by 0.66"}, 256);
}

TEST(ForeignFiles, ANumberOfSamplesBeyondAllBudgetsIsLeftOut) {
    const LoadedScene scene = load_file("sample-count");
    EXPECT_FALSE(scene.sample_count);
    EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("a 'sample_count' above 2147483647 is left out")));
}

TEST(ForeignFiles, AnIntegratorNeedsNoName) {
    const LoadedScene scene = load_file("integrator-without-name");
    EXPECT_EQ(scene.max_edges, 3);
    EXPECT_THAT(scene.warnings,
                ElementsAre(HasSubstr("no value for $integrator: the type of <integrator> is left out")));
}

TEST(ForeignFiles, ARotationByNothingNeedsNoAxis) {
    expect_radiance(load_file("rotation-by-nothing"), 0.5, {});
    EXPECT_THAT(scene_error(shape("sphere", to_world("<rotate value='0,0,0' angle='1'/>"))),
                HasSubstr("the rotation's axis is zero"));
}

TEST(ForeignFiles, AllUnknownParametersAreInOneError) {
    const std::string error = input_error_of([] { load_file("unknown-parameters"); });
    std::vector<std::string> lines;
    for (std::size_t begin = 0, end = 0; end != error.npos; begin = end + 1) {
        end = error.find('\n', begin);
        lines.push_back(error.substr(begin, end - begin));
    }
    ASSERT_EQ(lines.size(), 21u) << error;
    const std::string file = path_of("unknown-parameters");
    EXPECT_THAT(lines[0], StartsWith(file + ":9:26: shape 'sphere' does not take a parameter 'size0'"));
    EXPECT_THAT(lines[1], StartsWith(file + ":9:78: bsdf 'diffuse' does not take a parameter 'gloss0'"));
    EXPECT_THAT(lines[19], StartsWith(file + ":18:78: bsdf 'diffuse' does not take a parameter 'gloss9'"));
    EXPECT_EQ(lines[20], "and 3 more");
}

TEST(ForeignFiles, AnErrorThatEndsTheReadingFollowsTheUnknownParameters) {
    EXPECT_THAT(
        scene_error(shape("sphere", number("size", 1)) + "\n" + shape("sphere", radius(-1))),
        ::testing::MatchesRegex("t.xml:2:[0-9]+: shape 'sphere' does not take a parameter 'size'.*\nt.xml:3:[0-9]+: "
                                "'radius' must be above 0, not -1"));
}

// An object without a use is left out with one warning, also if it has an unknown parameter.
TEST(ForeignFiles, AnUnknownParameterOfAnUnusedObjectIsAWarning) {
    const LoadedScene scene = load(with_id("bsdf", "diffuse", "unused", number("gloss", 1)) + shape("sphere"));
    EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("nothing refers to this bsdf, which is left out")));
}

}  // namespace
}  // namespace gib::test::foreign_files_test
