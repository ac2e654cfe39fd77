// The tables of a run flag a method that is made too bright on purpose, and no other method; where a reference or a method
// leaves out light, they name no winner that did not have to make it.

#include "common/images/image_file.h"
#include "experiments/results/result_folder.h"
#include "tests/support/run_fixtures.h"

namespace gib::test::judged_light_run_test {
namespace {

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

class BalanceRun : public ::testing::Test, protected ExperimentFolder {
protected:
    /// The verdicts in the rows of one method, one for each component.
    std::vector<std::string> balances(const std::string& method) const {
        const CsvTable rows = table();
        std::vector<std::string> verdicts;
        for (std::size_t i = 0; i < rows.rows.size(); ++i)
            if (rows.rows[i][1] == method) verdicts.push_back(rows.rows[i][2] + " " + field_of(rows, "footing", i));
        return verdicts;
    }
};

TEST_F(BalanceRun, FlagsAMethodThatIsOnePercentTooBright) {
    write("e.toml",
          "title = 'EnergyBalance'\nscenes = ['tiny.xml']\nseeds = 5\n[reference]\ntarget = '0.1%'\n"
          "[[method]]\nname = 'path'\nspp = [256, 512]\n");
    ASSERT_THAT(gibench("run e.toml"), exits(0));
    for (const char* method : {"path spp=256", "path spp=512"})
        EXPECT_THAT(balances(method), Not(Contains(HasSubstr("differs")))) << method;

    brighten(results(""), "path spp=512", 1.01f);
    ASSERT_EQ(gibench("report results/e").code, 0);
    EXPECT_THAT(balances("path spp=512"), Contains("total differs"));
    EXPECT_THAT(balances("path spp=256"), Not(Contains(HasSubstr("differs"))));
    const std::string text = read_file(results("table.md"));
    EXPECT_THAT(text, HasSubstr("- tiny: Warning: path differs from the reference in mean energy: `total` +"));
    EXPECT_LT(text.find("## Energy balance"), text.find("## Errors")) << "before any number";
}

// Three black images of an unbiased method give no interval of its mean: rare bright paths are missing in all of them.
TEST_F(BalanceRun, EqualImagesOfAnUnbiasedMethodAreInconclusive) {
    write("e.toml",
          "title = 'EnergyBalance'\nscenes = ['tiny.xml']\nseeds = 3\n[reference]\ntarget = '5%'\n"
          "[[method]]\nname = 'path'\nspp = [16, 32]\n");
    ASSERT_THAT(gibench("run e.toml"), exits(0));
    brighten(results(""), "path spp=32", 0.f);
    ASSERT_EQ(gibench("report results/e").code, 0);
    EXPECT_THAT(balances("path spp=32"), AllOf(Contains("total inconclusive"), Not(Contains(HasSubstr("differs")))));
    EXPECT_THAT(read_file(results("table.md")), Not(HasSubstr("Warning: path")));
}

// A path of direct light has two edges.
TEST_F(BalanceRun, AMethodWithShorterPathsThanTheReferenceIsNotWhole) {
    write("e.toml",
          "scenes = ['tiny.xml']\nseeds = 2\n[reference]\ntarget = '5%'\n"
          "[[method]]\nname = 'path'\nspp = 4\nmax_depth = [1, 0]\n");
    ASSERT_THAT(gibench("run e.toml"), exits(0));
    const CsvTable rows = table();
    for (std::size_t i = 0; i < rows.rows.size(); ++i)
        EXPECT_EQ(field_of(rows, "components_missing", i).find("direct") != std::string::npos,
                  rows.rows[i][1].find("max_depth=1") != std::string::npos)
            << rows.rows[i][1];
}

TEST_F(BalanceRun, AnExperimentWithoutLightHasNoTable) {
    write("dark.xml", Scene(element("sensor", "perspective", to_world(look_at("0, 2, 3", "0, 0, 0")), box_film(8)),
                            shape("sphere", radius(0.5), diffuse(0.5)))
                          .xml());
    write("e.toml",
          "title = 'Dark'\nscenes = ['dark.xml']\nseeds = 2\n[reference]\nmethod = 'path'\nseconds = 1\n"
          "[[method]]\nname = 'path'\nspp = 4\n[[method]]\nname = 'vcm'\nspp = 4\n");
    ASSERT_EQ(gibench("run e.toml").code, 0);
    EXPECT_THAT(read_file(results("table.md")),
                AllOf(HasSubstr("- dark: Warning: the scene has no light"), Not(HasSubstr("| dark |"))));
    EXPECT_TRUE(table().rows.empty());
}

class ReferenceFromElsewhere : public ::testing::Test, protected ExperimentFolder {
protected:
    ReferenceFromElsewhere() {
        for (const char* seed : {"1", "2", "3"})
            EXPECT_THAT(
                gibench(std::string("render tiny.xml --method 'path spp=64' --seed ") + seed + " -o r" + seed + ".exr"),
                exits(0));
    }
    ProgramResult run_with(const std::string& image) {
        write("e.toml", "title = 'Given'\nscenes = ['tiny.xml']\nseeds = 2\n[reference]\nimage = " + image +
                            "\n[[method]]\nname = 'photon_mapper'\nphotons = 1000\nspp = 2\n");
        return gibench("run e.toml --fresh");
    }
};

TEST_F(ReferenceFromElsewhere, WithoutAStandardErrorSeparatesNoBias) {
    ASSERT_THAT(run_with("'r1.exr'"), exits(0));
    EXPECT_THAT(read_file(results("table.md")), HasSubstr("inconclusive: reference's error unknown"));
    const CsvTable rows = table();
    for (const char* column : {"bias2", "bias2_lo", "bias2_hi", "bias_state"})
        EXPECT_EQ(field_of(rows, column, 0), "") << column;
    EXPECT_NE(field_of(rows, "rel_mse", 0), "");
}

TEST_F(ReferenceFromElsewhere, HasTheStandardErrorOfItsReplicates) {
    ASSERT_THAT(run_with("['r1.exr', 'r2.exr', 'r3.exr']"), exits(0));
    const Reference reference = read_reference(ResultFolder(results("")).reference_image("tiny"));
    ASSERT_TRUE(reference.total.standard_error);
    const std::array<float, 3> values = {read_reference(path("r1.exr")).total.mean.rgb[0],
                                         read_reference(path("r2.exr")).total.mean.rgb[0],
                                         read_reference(path("r3.exr")).total.mean.rgb[0]};
    const std::array<double, 3> doubles = {double{values[0]}, double{values[1]}, double{values[2]}};
    const SampleMean mean = sample_mean(doubles);
    EXPECT_NEAR(double{reference.total.mean.rgb[0]}, mean.value, 1e-6 * mean.value);
    EXPECT_NEAR(double{reference.total.standard_error->rgb[0]}, std::sqrt(mean.variance.variance), 1e-6 * mean.value);
    EXPECT_THAT(read_file(results("table.md")), Not(HasSubstr("no standard error")));
    EXPECT_NE(field_of(table(), "bias2", 0), "");
}

TEST_F(ReferenceFromElsewhere, IsNotTheSameImageTwice) {
    const ProgramResult result = run_with("['r1.exr', 'r1.exr']");
    EXPECT_NE(result.code, 0);
    EXPECT_THAT(result.err, HasSubstr("replicates need seeds of their own"));
}

class ContradictedReference : public ::testing::Test, protected ExperimentFolder {
protected:
    /// Scales the component of the result folder's reference of `tiny`.
    void scale(Component c, float factor) {
        const std::string path = ResultFolder(results("")).reference_image("tiny");
        Reference reference = read_reference(path);
        ReferenceLayer& layer = *reference.components[static_cast<std::size_t>(index_of(c))];
        for (Image* image : {&layer.mean, &*layer.standard_error})
            for (float& v : image->rgb)
                v *= factor;
        for (Image& group : layer.groups)
            for (float& v : group.rgb)
                v *= factor;
        // An attribute that the file's format adds is none of a reference.
        std::erase_if(reference.metadata, [](const auto& entry) {
            return entry.first != "scene_hash" && entry.first != "method" && entry.first != "passes" &&
                   entry.first != "makers";
        });
        write_reference(path, reference);
    }
};

TEST_F(ContradictedReference, IsToldOnTopAndItsComponentIsNotJudged) {
    write("e.toml",
          "title = 'Contradiction'\nscenes = ['tiny.xml']\nseeds = 5\n[reference]\nmethod = 'path'\ntarget = '1%'\n"
          "[[method]]\nname = 'bidirectional'\nspp = 64\n[[method]]\nname = 'path'\nspp = 64\n");
    ASSERT_THAT(gibench("run e.toml"), exits(0));
    EXPECT_THAT(read_file(results("table.md")), Not(HasSubstr("the reference is contradicted")));

    for (const float factor : {0.5f, 0.f}) {
        scale(Component::direct, factor);
        ASSERT_EQ(gibench("report results/e").code, 0);
        const std::string text = read_file(results("table.md"));
        EXPECT_THAT(text,
                    HasSubstr("the reference is contradicted by bidirectional spp=64, which finds light of direct"));
        EXPECT_LT(text.find("the reference is contradicted"), text.find("## Errors"));
        const CsvTable rows = table();
        for (std::size_t i = 0; i < rows.rows.size(); ++i)
            if (rows.rows[i][2] == "direct") {
                EXPECT_EQ(field_of(rows, "rel_mse", i), "") << rows.rows[i][1];
            }
        EXPECT_THAT(text, HasSubstr("--resolution 8x8 --seed 2"));
        const CsvTable curves = table("curves.csv");
        for (std::size_t i = 0; i < curves.rows.size(); ++i)
            EXPECT_EQ(field_of(curves, "rel_mse", i), "nan") << "measured with the wrong component";
    }
}

class UnjudgedLight : public ::testing::Test, protected ExperimentFolder {
protected:
    /// table.md of an experiment with this reference and these methods on a glass ball over a floor in the sun: the sun's
    /// light behind the ball is a caustic that no path from the eye finds.
    std::string table(const std::string& reference, const std::string& methods) {
        write("glass.xml",
              Scene(element("sensor", "perspective", to_world(look_at("0, 2, 3", "0, 0, 0")), box_film(8)),
                    shape("rectangle", to_world(scale(2), rotate('x', -90), translate(0, -1, 0)), diffuse(0.5)),
                    shape("sphere", radius(0.5), bsdf("dielectric")),
                    emitter("directional", vector("direction", 0, -1, 0)))
                  .xml());
        write("e.toml", "scenes = ['glass.xml']\nseeds = 2\nreference = { method = '" + reference +
                            "', target = '40%' }\n" + methods);
        EXPECT_THAT(gibench("run e.toml"), exits(0));
        return read_file(results("table.md"));
    }
};

TEST_F(UnjudgedLight, HasNoCheapestMethod) {
    EXPECT_THAT(table("path", "[[method]]\nname = 'path'\nmax_depth = [0, 9]\nspp = 1024\n"),
                AllOf(HasSubstr("the reference is incomplete or contradicted in caustic"), Not(HasSubstr("(cheapest")),
                      Not(HasSubstr("## When the best method changes")), Not(HasSubstr("## Pareto frontier"))))
        << "neither the reference nor a method has the caustic";
    EXPECT_THAT(read_file(results("report.html")), HasSubstr("no verdict"));
}

TEST_F(UnjudgedLight, LeavesNoErrorWhereNothingIsJudged) {
    EXPECT_THAT(table("light_tracer", "[[method]]\nname = 'path'\nmax_depth = [0, 9]\nspp = 64\n"),
                AllOf(HasSubstr("the reference is incomplete or contradicted"), HasSubstr("no verdict"),
                      Not(HasSubstr("(cheapest"))));
}

TEST_F(UnjudgedLight, KeepsAMethodThatLeavesItOutFromWinning) {
    EXPECT_THAT(table("auto", "[[method]]\nname = 'path'\nspp = 4096\n[[method]]\nname = 'vcm'\nspp = 16\n"),
                AllOf(HasSubstr("light of caustic"), Not(HasSubstr("the reference is incomplete or contradicted")),
                      Not(HasSubstr("| path (cheapest"))));
}

}  // namespace
}  // namespace gib::test::judged_light_run_test
