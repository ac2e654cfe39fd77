// Where a reference or a method leaves out light, the tables of a run name no winner that did not have to make it.

#include "tests/support/driver_fixtures.h"

#include <gmock/gmock.h>

namespace gib::test::unjudged_light_run_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A glass ball over a floor in the sun: the sun's light behind the ball is a caustic that no path from the eye finds.
std::string glass_in_the_sun() {
    return "<scene version='3.0.0'><sensor type='perspective'>"
           "<transform name='to_world'><lookat origin='0, 2, 3' target='0, 0, 0' up='0, 1, 0'/></transform>" +
           box_film(8) +
           "</sensor><shape type='rectangle'><transform name='to_world'><scale value='2'/><rotate x='1' angle='-90'/>"
           "<translate y='-1'/></transform>" +
           diffuse(0.5) +
           "</shape><shape type='sphere'><float name='radius' value='0.5'/><bsdf type='dielectric'/></shape>"
           "<emitter type='directional'><vector name='direction' x='0' y='-1' z='0'/></emitter></scene>";
}

class UnjudgedLight : public ::testing::Test {
protected:
    UnjudgedLight() { folder_.write("glass.xml", glass_in_the_sun()); }
    /// table.md of an experiment with this reference and these methods.
    std::string table(const std::string& reference, const std::string& methods) {
        folder_.write("e.toml", "scenes = ['glass.xml']\nseeds = 2\nreference = { method = '" + reference +
                                    "', target = '40%' }\n" + methods);
        const ProgramResult run = run_gibench("run e.toml", folder_ / "");
        EXPECT_EQ(run.code, 0) << run.err;
        return read_file(folder_ / "results/e/table.md");
    }
    TemporaryFolder folder_;
};

TEST_F(UnjudgedLight, HasNoCheapestMethod) {
    const std::string paths = table("path", "[[method]]\nname = 'path'\nmax_depth = [0, 9]\nspp = 1024\n");
    EXPECT_THAT(paths, AllOf(HasSubstr("No method is the cheapest: the reference does not judge the light of "
                                       "`caustic`"),
                             Not(HasSubstr("is the cheapest at")), Not(HasSubstr("## When the best method changes")),
                             Not(HasSubstr("## Pareto frontier"))))
        << "neither the reference nor a method has the caustic";
    EXPECT_THAT(read_file(folder_ / "results/e/report.html"), HasSubstr("not judged"));
}

TEST_F(UnjudgedLight, LeavesNoErrorWhereNothingIsJudged) {
    const std::string nothing = table("light_tracer", "[[method]]\nname = 'path'\nmax_depth = [0, 9]\nspp = 64\n");
    EXPECT_THAT(nothing, AllOf(HasSubstr("No method is the cheapest"), HasSubstr("not judged"),
                               Not(HasSubstr("is the cheapest at"))));
}

TEST_F(UnjudgedLight, KeepsAMethodThatLeavesItOutFromWinning) {
    const std::string judged =
        table("auto", "[[method]]\nname = 'path'\nspp = 4096\n[[method]]\nname = 'vcm'\nspp = 16\n");
    EXPECT_THAT(judged, AllOf(HasSubstr("light of caustic"), Not(HasSubstr("No method is the cheapest")),
                              Not(HasSubstr("`path spp=4096` is the cheapest"))));
}

}  // namespace
}  // namespace gib::test::unjudged_light_run_test
