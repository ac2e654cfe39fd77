// [[method]] tables with a command: their meaning, and the messages about wrong ones.

#include "experiments/plan/experiment_file.h"

#include "tests/support/driver_fixtures.h"
#include "tests/support/input_error.h"

#include <gmock/gmock.h>

namespace gib::test::external_method_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ExternalMethodTest : public ::testing::Test {
protected:
    ExternalMethodTest() {
        folder_.write("a.xml", "<scene/>");
        folder_.write("b.xml", "<scene/>");
        folder_.write("r.exr", "");
    }
    /// Line 2 is the name, line 3 the command.
    Experiment parse(const std::string& command, const std::string& more = "", const std::string& name = "other") {
        return parse_experiment(
            "scenes = ['a.xml']\n[[method]]\nname = '" + name + "'\ncommand = '" + command + "'\n" + more,
            folder_ / "e.toml");
    }
    std::string error_of(const std::string& command, const std::string& more = "", const std::string& name = "other") {
        const std::string what = input_error_of([&] { parse(command, more, name); });
        const std::size_t place = what.find("e.toml");
        return place == std::string::npos ? what : what.substr(place);
    }
    TemporaryFolder folder_;
};

TEST_F(ExternalMethodTest, KeysOfItsOwnMakeASweep) {
    const Experiment e = parse("x {scene} {out} {spp} {mode}", "spp = [4, 16]\nmode = ['fast', 'slow']\n");
    std::vector<std::string> labels;
    for (const auto& label : e.methods)
        labels.push_back(label.text());
    EXPECT_THAT(labels, ElementsAre("other spp=4 mode=fast", "other spp=4 mode=slow", "other spp=16 mode=fast",
                                    "other spp=16 mode=slow"));
    const ExternalMethod* external = e.external(e.methods[3]);
    ASSERT_TRUE(external);
    EXPECT_EQ(external->spp, 16u);
    EXPECT_EQ(filled_command(*external, {{"scene", "s"}, {"out", "o"}, {"spp", "16"}}), "x s o 16 slow");
}

TEST_F(ExternalMethodTest, DefaultsAndFormats) {
    const Experiment e = parse("x {scene} {out}");
    const ExternalMethod& plain = *e.external(e.methods[0]);
    EXPECT_EQ(plain.scene_format, SceneFormat::mitsuba);
    EXPECT_EQ(plain.image_format, "exr");
    EXPECT_EQ(plain.timeout, 3600);
    const Experiment other = parse("x {scene} {out}", "scene_format = 'povray'\nimage_format = 'hdr'\ntimeout = 2.5\n");
    const ExternalMethod& given = *other.external(other.methods[0]);
    EXPECT_EQ(given.scene_format, SceneFormat::povray);
    EXPECT_EQ(given.image_format, "hdr");
    EXPECT_EQ(given.timeout, 2.5);
    EXPECT_NE(given.identity(), plain.identity());
}

TEST_F(ExternalMethodTest, ValuesAreQuotedForTheShell) {
    const Experiment e = parse("x {scene} {out} ${HOME} {} {A}");
    EXPECT_EQ(filled_command(*e.external(e.methods[0]), {{"scene", "a b'c"}, {"out", "/o.exr"}}),
              "x 'a b'\\''c' /o.exr ${HOME} {} {A}");
}

TEST_F(ExternalMethodTest, MessagesNameThePlaceAndWhatThereIs) {
    EXPECT_THAT(error_of("x {out}"), HasSubstr("e.toml:4:11: a command needs the placeholder {scene}"));
    EXPECT_THAT(error_of("x {scene}"), HasSubstr("a command needs the placeholder {out}"));
    EXPECT_THAT(error_of("x {scene} {out} {mode}"), HasSubstr("e.toml:4:11: the placeholder {mode} has no value"));
    EXPECT_THAT(error_of("x {scene} {out}", "mode = 3\n"), HasSubstr("e.toml:5:1: unknown key 'mode'"));
    EXPECT_THAT(error_of("x {scene} {out}", "spp = 3\n"), HasSubstr("e.toml:5:1: unknown key 'spp'"));
    EXPECT_THAT(error_of("x {scene} {out} {seed}", "seed = 3\n"), HasSubstr("e.toml:5:1: unknown key 'seed'"));
    EXPECT_THAT(error_of("x {scene} {out} {spp}", "spp = 0\n"),
                HasSubstr("e.toml:5:7: parameter 'spp' = 0 is out of range"));
    EXPECT_THAT(error_of("x {scene} {out} {m}", "m = 'a b'\n"), HasSubstr("e.toml:2:1: "));
    EXPECT_THAT(error_of("x {scene} {out}", "timeout = 0\n"), HasSubstr("'timeout' needs a number above 0"));
    EXPECT_THAT(error_of("x {scene} {out}", "scene_format = 'pbrt'\n"),
                HasSubstr("e.toml:5:16: 'scene_format' cannot be 'pbrt'; it is one of: mitsuba, povray"));
    EXPECT_THAT(error_of("x {scene} {out} {seconds}"),
                HasSubstr("e.toml:4:11: a command with {seconds} needs a budget"));
    EXPECT_THAT(error_of("x {scene} {out}", "", "path"), HasSubstr("e.toml:3:8: 'path' is a method of gibench"));
    EXPECT_THAT(error_of("x {scene} {out}", "", "a b"), HasSubstr("e.toml:3:8: "));
    EXPECT_THAT(error_of("x {scene} {out}", "[[method]]\nname = 'other'\ncommand = 'y {scene} {out}'\n"),
                HasSubstr("the method 'other' is listed twice"));
}

TEST_F(ExternalMethodTest, ReferenceImagesAreOneForEachScene) {
    const auto parse_reference = [&](const std::string& scenes, const std::string& reference) {
        return parse_experiment("scenes = " + scenes + "\n[reference]\n" + reference + "\n[[method]]\nname = 'path'\n",
                                folder_ / "e.toml");
    };
    EXPECT_EQ(parse_reference("['a.xml']", "image = 'r.exr'").scenes[0].reference_image, folder_ / "r.exr");
    EXPECT_EQ(parse_reference("['a.xml', 'b.xml']", "image = ['r.exr', 'r.exr']").scenes[1].reference_image,
              folder_ / "r.exr");
    EXPECT_EQ(parse_reference("['a.xml']", "target = '1%'").scenes[0].reference_image, "");
    const auto error = [&](const std::string& scenes, const std::string& reference) {
        return input_error_of([&] { parse_reference(scenes, reference); });
    };
    EXPECT_THAT(error("['a.xml', 'b.xml']", "image = 'r.exr'"),
                HasSubstr("e.toml:3:9: 'image' gives 1 references for 2 scenes"));
    EXPECT_THAT(error("['a.xml']", "image = 'none.exr'"), HasSubstr("e.toml:3:9: there is no image '"));
    EXPECT_THAT(error("['a.xml']", "image = 'r.exr'\ntarget = '1%'"), HasSubstr("e.toml:4:1: unknown key 'target'"));
}

}  // namespace
}  // namespace gib::test::external_method_test
