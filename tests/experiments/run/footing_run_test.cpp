// In the tables of a run, a method that is made too bright on purpose is flagged, and no other method.

#include "common/images/image_file.h"
#include "experiments/results/result_folder.h"
#include "tests/support/csv_reader.h"
#include "tests/support/driver_fixtures.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace gib::test::footing_run_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Scales every layer of the final images of a method's cells, and stores the
/// hashes of the new images in their records.
void brighten(const std::string& results, const std::string& method, float factor) {
    const ResultFolder folder(results);
    for (const auto& [name, key] : folder.read_index().cell_keys) {
        auto cell = folder.read_cell(name, key);
        if (!cell || cell->method != method) continue;
        const std::string path = folder.cell_image(name);
        ComponentImages image = components_in(read_image(path));
        for (Component c : all_components)
            if (image[c])
                for (float& v : image[c]->rgb)
                    v *= factor;
        write_exr(path, layers_of(image));
        cell->image_file = file_hash(path);
        folder.write_cell(name, *cell);
    }
}

/// The verdicts in the rows of one method, one for each component.
std::vector<std::string> footings(const std::string& folder, const std::string& method) {
    const CsvTable table = parse_csv(read_file(folder + "/table.csv"), "table.csv");
    const auto at = static_cast<std::size_t>(std::find(table.columns.begin(), table.columns.end(), "footing") -
                                             table.columns.begin());
    std::vector<std::string> verdicts;
    for (const auto& row : table.rows)
        if (row[1] == method) verdicts.push_back(row[2] + " " + row[at]);
    return verdicts;
}

TEST(FootingRun, FlagsAMethodThatIsOnePercentTooBright) {
    TemporaryFolder folder;
    folder.write("tiny.xml", tiny_scene_xml());
    folder.write("e.toml",
                 "title = 'Footing'\nscenes = ['tiny.xml']\nseeds = 5\n[reference]\ntarget = '0.1%'\n"
                 "[[method]]\nname = 'path'\nspp = [256, 512]\n");
    const ProgramResult result = run_gibench("run e.toml", folder / "");
    ASSERT_EQ(result.code, 0) << result.err;
    const std::string results = folder / "results/e";
    for (const char* method : {"path spp=256", "path spp=512"})
        EXPECT_THAT(footings(results, method), Not(::testing::Contains(HasSubstr("differs")))) << method;

    brighten(results, "path spp=512", 1.01f);
    ASSERT_EQ(run_gibench("report results/e", folder / "").code, 0);
    EXPECT_THAT(footings(results, "path spp=512"), ::testing::Contains("total differs"));
    EXPECT_THAT(footings(results, "path spp=256"), Not(::testing::Contains(HasSubstr("differs"))));
    const std::string text = read_file(results + "/table.md");
    EXPECT_THAT(text, HasSubstr("- tiny: Warning: path spp=512 differs from the reference in mean energy: `total` +"));
    EXPECT_LT(text.find("## Equal footing"), text.find("## Errors")) << "before any number";
}

}  // namespace
}  // namespace gib::test::footing_run_test
