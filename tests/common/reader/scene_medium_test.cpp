// Tests of the reader of media: what it accepts has Mitsuba's meaning, and what is wrong is an error at its place.

#include "common/core/error.h"
#include "common/media/grid_volume.h"
#include "common/scene/effects.h"
#include "common/scene/scene.h"
#include "tests/support/input_error.h"
#include "tests/support/scene_text.h"
#include "tests/support/volume_file.h"

#include <gmock/gmock.h>

namespace gib::test::scene_medium_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string error_of(const std::string& body) {
    return input_error_of([&] { parse_scene(scene_with(body), "t.xml", {}); });
}

/// A shape with a medium inside, whose parameters are on line 3.
std::string in_ball(const std::string& type, const std::string& parameters) {
    return shape("sphere", named("medium", "interior", type, "\n", parameters));
}

struct Row {
    std::string type, parameters, place, message;
};

void expect_errors(const std::vector<Row>& rows) {
    for (const Row& row : rows) {
        const std::string error = error_of(in_ball(row.type, row.parameters));
        EXPECT_THAT(error, StartsWith("t.xml:" + row.place + ": ")) << row.parameters;
        EXPECT_THAT(error, HasSubstr(row.message)) << row.parameters;
    }
}

TEST(MediumErrors, Parameters) {
    expect_errors({
        {"fog", "", "2:46", "the medium 'fog' is not supported; supported are: homogeneous, heterogeneous"},
        {"homogeneous", number("sigma", 1), "3:1", "medium 'homogeneous' does not take a parameter 'sigma'"},
        {"homogeneous", bsdf("diffuse"), "3:1", "does not take a <bsdf>"},
        {"homogeneous", number("sigma_t", -1), "3:23", "-1"},
        {"homogeneous", number("sigma_t", "nan"), "3:23", "bad number 'nan'"},
        {"homogeneous", rgb("albedo", "0.5, 1.5, 0"), "3:20", "1.5"},
        {"homogeneous", number("scale", -2), "3:21", "'scale' must not be negative"},
        {"homogeneous", number("scale", 1e10), "3:21", "an extinction above 1e+09"},
        {"homogeneous", number("sigma_t", 1e10), "3:23", "an extinction above 1e+09"},
        {"homogeneous", number("sigma_a", 6e8) + number("sigma_s", 6e8), "3:23", "an extinction above 1e+09"},
        {"homogeneous", number("sigma_t", 1) + number("sigma_a", 1), "3:56",
         "give either 'sigma_t' and 'albedo' or 'sigma_s' and 'sigma_a'"},
        {"homogeneous", named("volume", "sigma_t", "constvolume"), "3:1", "'sigma_t' cannot be a <volume>"},
        {"homogeneous", element("phase", "kkay"), "3:8",
         "the phase 'kkay' is not supported; supported are: isotropic, hg, rayleigh"},
        {"homogeneous", element("phase", "rayleigh", number("g", 0.5)), "3:24",
         "phase 'rayleigh' does not take a parameter 'g'"},
        {"homogeneous", element("phase", "hg", number("g", 1)), "3:34", "'g' must be between -0.999 and 0.999, not 1"},
        {"homogeneous", element("phase", "isotropic", number("g", 0.5)), "3:25",
         "phase 'isotropic' does not take a parameter 'g'"},
        {"homogeneous", element("phase", "hg") + element("phase", "hg"), "3:19", "only one <phase>"},
        {"heterogeneous", number("sigma_s", 1), "3:1", "does not take a parameter 'sigma_s'"},
        {"heterogeneous", named("volume", "sigma_t", "vdb"), "3:24",
         "the volume 'vdb' is not supported; supported are: constvolume, gridvolume"},
        {"heterogeneous", named("volume", "sigma_t", "gridvolume"), "3:1", "'gridvolume' needs 'filename'"},
        {"heterogeneous", named("volume", "sigma_t", "gridvolume", filename("no.vol")), "3:42", "no.vol"},
        {"heterogeneous", named("volume", "albedo", "constvolume", number("value", 2)), "3:62", "2"},
    });
}

TEST(MediumErrors, Grids) {
    const TemporaryFolder folder;
    const std::string good = folder.write("good.vol", volume_bytes({2, 1, 1}, 1, {0.5f, 3.f}));
    const std::string negative = folder.write("negative.vol", volume_bytes({1, 1, 1}, 1, {-0.5f}));
    const auto grid = [](const std::string& name, const std::string& file, const std::string& more = "") {
        return named("volume", name, "gridvolume", filename(file), more);
    };
    const auto error = [&](const std::string& parameters) { return error_of(in_ball("heterogeneous", parameters)); };
    EXPECT_EQ(error(grid("sigma_t", good)), "no error");
    EXPECT_THAT(error(grid("albedo", good)),
                HasSubstr("t.xml:3:1: 'albedo' must be between 0 and 1, but its volume has 3"));
    EXPECT_THAT(error(grid("sigma_t", negative)),
                HasSubstr("t.xml:3:1: 'sigma_t' must not be negative, but its volume has -0.5"));
    EXPECT_THAT(error(grid("sigma_t", good, "\n" + text("filter_type", "cubic"))), HasSubstr("t.xml:4:28: "));
    EXPECT_THAT(error(grid("sigma_t", good, "\n" + text("wrap_type", "zero"))), HasSubstr("t.xml:4:26: "));
    EXPECT_THAT(error(grid("sigma_t", good, "\n" + to_world(scale(0, 1, 1)))), HasSubstr("t.xml:4:"));
    EXPECT_THAT(error(grid("sigma_t", good, "\n" + number("value", 1))),
                HasSubstr("t.xml:4:1: volume 'gridvolume' does not take a parameter 'value'"));
}

// The error of a wrong volume file names the file alone, because it has neither lines nor columns.
TEST(MediumErrors, VolumeFiles) {
    const TemporaryFolder folder;
    const std::string good = volume_bytes({2, 1, 1}, 1, {1, 2});
    const auto with = [&](std::size_t at, auto value) {
        std::string bytes = good;
        bytes.replace(at, sizeof value, reinterpret_cast<const char*>(&value), sizeof value);
        return bytes;
    };
    const std::vector<std::pair<std::string, std::string>> rows = {
        {"", "the file ends in its first bytes"},
        {good.substr(0, 3), "the file ends in its version"},
        {good.substr(0, 20), "the file ends in its number of channels"},
        {good.substr(0, 30), "the file ends in its box"},
        {"PLY" + good.substr(3), "it does not start with VOL"},
        {with(3, std::uint8_t{2}), "version 2 is not supported"},
        {with(4, std::int32_t{2}), "encoding 2 is not supported; 1, float32, and 3, uint8, are"},
        {with(4, std::int32_t{3}), "8 bytes of values where its size asks for 2"},
        {with(8, std::int32_t{0}), "a side of 0 voxels"},
        {with(12, std::int32_t{-4}), "a side of -4 voxels"},
        {with(16, std::int32_t{100000}), "a side of 100000 voxels"},
        {with(20, std::int32_t{2}), "2 channels; 1 or 3 are supported"},
        {good.substr(0, good.size() - 1), "7 bytes of values where its size asks for 8"},
        {good + "x", "9 bytes of values where its size asks for 8"},
        {with(48, std::numeric_limits<float>::quiet_NaN()), "a value is not finite"},
        {with(52, std::numeric_limits<float>::infinity()), "a value is not finite"},
    };
    for (const auto& [bytes, message] : rows) {
        const std::string file = folder.write("v.vol", bytes);
        const std::string error =
            error_of(in_ball("heterogeneous", named("volume", "sigma_t", "gridvolume", filename(file))));
        EXPECT_THAT(error, StartsWith(file + ":1:1: ")) << message;
        EXPECT_THAT(error, HasSubstr(message));
    }
}

// A file of bytes means what a file of these numbers over 255 does.
TEST(MediumReader, TakesVolumesOfBytes) {
    const TemporaryFolder folder;
    std::string bytes = volume_bytes({2, 1, 1}, 3, {});
    bytes[4] = 3;
    for (const int byte : {0, 51, 102, 153, 204, 255})
        bytes += static_cast<char>(byte);
    const GridVolume::Data data = load_volume(folder.write("bytes.vol", bytes));
    EXPECT_EQ(data.values, (std::vector<float>{0.f, 51 / 255.f, 102 / 255.f, 153 / 255.f, 204 / 255.f, 1.f}));
}

// The errors of a medium that nothing refers to are warnings, and it is left out.
TEST(MediumReader, ReadsWhatNothingRefersTo) {
    const std::string ball = shape("sphere");
    EXPECT_TRUE(load(with_id("medium", "homogeneous", "fog") + ball).warnings.empty());
    const LoadedScene scene = load(with_id("medium", "homogeneous", "fog", rgb("albedo", 2)) + ball);
    EXPECT_THAT(scene.warnings, ::testing::ElementsAre(::testing::AllOf(
                                    StartsWith("test.xml:2:1: nothing refers to this medium"), HasSubstr("'albedo'"))));
    EXPECT_FALSE(scene.scene->has_media());
}

// A medium may stand in the scene, and shapes and the camera refer to it; in a shape it needs the name of a side.
TEST(MediumReader, TakesReferences) {
    const std::string fog = with_id("medium", "homogeneous", "fog");
    EXPECT_EQ(error_of(fog + shape("sphere", "<ref name='exterior' id='fog'/>")), "no error");
    EXPECT_THAT(error_of(shape("sphere", "\n", element("medium", "homogeneous"))),
                StartsWith("t.xml:3:1: shape 'sphere' does not take a <medium>"));
    EXPECT_FALSE(effects_of(*load(fog + shape("sphere")).scene).has(Effect::participating_media));
    EXPECT_TRUE(effects_of(*load(fog + shape("sphere", "<ref name='interior' id='fog'/>")).scene)
                    .has(Effect::participating_media));
}

}  // namespace
}  // namespace gib::test::scene_medium_test
