// Damaged records and images of complete cells are found and reported, and the cells are done again.

#include "tests/machine/run_content.h"
#include "tests/support/run_fixtures.h"

#include <nlohmann/json.hpp>

#include <fstream>

namespace gib::test::damaged_cell_test {
namespace {

class DamagedCellTest : public ::testing::Test, protected ExperimentFolder {
protected:
    /// Overwrites a file in place; gibench itself only ever replaces whole files.
    static void damage(const std::string& file, const std::string& content) {
        std::ofstream(file, std::ios::binary | std::ios::trunc) << content;
    }
    /// Changes one bit at this share of a file.
    static void flip_bit(const std::string& file, double place) {
        std::string content = read_file(file);
        content[static_cast<std::size_t>(place * static_cast<double>(content.size()))] ^= 1;
        damage(file, content);
    }
    ProgramResult report() const { return gibench("report results/e"); }
    std::string file_of_cell(const std::string& name) const {
        return results("cells/" + cells().begin()->first + "/" + name);
    }
};

TEST_F(DamagedCellTest, IsFoundAndDoneAgain) {
    complete();
    const auto good = content_of(results(""));
    const std::string image = file_of_cell("final.exr"), record = file_of_cell("cell.json");
    const std::string pixels = read_file(image), text = read_file(record);

    std::string flipped = pixels, other_number = text;
    flipped[flipped.size() / 2] ^= 1;
    const std::size_t digit = other_number.find_first_of("12345678", other_number.find("\"rel_mse\": 0.") + 13);
    ++other_number[digit];
    const std::vector<std::tuple<std::string, std::string, std::string>> damages = {
        {image, flipped, "not that of the image that was rendered"},
        {image, pixels.substr(0, 100), "not that of the image that was rendered"},
        {record, other_number, "not what its digest says"},
        {record, text.substr(0, text.size() / 2), "not a record of a cell"},
        {record, "", "not a record of a cell"}};
    for (const auto& [file, content, said] : damages) {
        damage(file, content);
        EXPECT_THAT(run(), exits(0, HasSubstr("warning: results/e/cells/"), HasSubstr("not done again: 3"),
                                 HasSubstr(said + "; the cell is done again")));
        EXPECT_TRUE(content_of(results("")) == good) << said;
    }
    fs::remove(image);
    EXPECT_THAT(run().err, HasSubstr("the file is missing; the cell is done again"));
}

TEST_F(DamagedCellTest, IsLeftOutOfAReport) {
    complete();
    flip_bit(file_of_cell("final.exr"), 0.5);
    EXPECT_THAT(report(), exits(0, HasSubstr("final.exr: its content is not that of the image that was rendered; the "
                                             "cell is left out")));
    EXPECT_EQ(field_of(table(), "seeds"), "1") << "seeds of the first method";
}

TEST_F(DamagedCellTest, ADamagedImageOnTheWayIsLeftOutAndSaid) {
    complete();
    std::string frame;  // a frame of a cell with seed 1
    for (const auto& [name, time] : cells())
        if (fs::exists(results("cells/" + name + "/frames/2.exr"))) frame = "cells/" + name + "/frames/2.exr";
    ASSERT_FALSE(frame.empty());
    const std::string pixels = read_file(results(frame)), rows = read_file(results("table.csv"));
    std::string flipped = pixels;
    flipped[flipped.size() - 10] ^= 1;
    for (const std::string& content : {pixels.substr(0, pixels.size() / 2), std::string(), flipped}) {
        damage(results(frame), content);
        for (const ProgramResult& said : {run(), report()})
            EXPECT_THAT(said, exits(0, HasSubstr("warning: results/e/" + frame +
                                                 ": it cannot be read; the image on the way is left out\n")));
        EXPECT_EQ(read_file(results("table.csv")), rows);
    }
}

TEST_F(DamagedCellTest, DamagedFlipIsMeasuredAgain) {
    complete();
    const std::string record = file_of_cell("flip.json"), map = file_of_cell("flip.png");
    const std::string text = read_file(record), picture = read_file(map), rows = read_file(results("table.csv"));
    std::vector<std::pair<std::string, std::string>> damages = {
        {map, picture.substr(0, picture.size() / 2)}, {map, ""}, {record, ""}, {record, "[]"}};
    for (const nlohmann::json& value : {nlohmann::json(123), nlohmann::json(-5), nlohmann::json("x"),
                                        nlohmann::json(0.25), nlohmann::json(nullptr)}) {
        nlohmann::json other = nlohmann::json::parse(text);
        other["flip"] = value;
        damages.emplace_back(record, other.dump());
        damages.emplace_back(record, nlohmann::json({{"flip", value}}).dump());  // without any other field
    }
    for (const std::string& command : {std::string("run e.toml --threads 1"), std::string("report results/e")}) {
        for (const auto& [file, content] : damages) {
            damage(file, content);
            EXPECT_THAT(gibench(command), exits(0));
            EXPECT_EQ(read_file(record), text) << command << content;
            EXPECT_EQ(read_file(map), picture) << command << content;
            EXPECT_EQ(read_file(results("table.csv")), rows) << command << content;
        }
        fs::remove(map);
        EXPECT_EQ(gibench(command).code, 0);
        EXPECT_EQ(read_file(map), picture) << "it is made again";
    }
}

TEST_F(DamagedCellTest, WithoutItsReferenceOneSceneIsLeftOutOfAReport) {
    write("other.xml", tiny_scene_xml(6));
    write("e.toml",
          "scenes = ['tiny.xml', 'other.xml']\nseeds = 2\n[reference]\ntarget = '40%'\n[[method]]\nname = "
          "'path'\nspp = [4, 8]\n");
    ASSERT_EQ(run().code, 0);
    const std::string file = results("images/tiny-reference.exr");
    const auto left_out = [&](const std::string& said) {
        EXPECT_THAT(report(), exits(0, HasSubstr(said)));
        for (const char* name : {"table.csv", "curves.csv"}) {
            const CsvTable rows = table(name);
            EXPECT_FALSE(rows.rows.empty()) << name;
            for (const auto& row : rows.rows)
                EXPECT_EQ(row.at(0), "other") << name;
        }
        EXPECT_THAT(read_file(results("table.md")), HasSubstr("4 cells of the experiment are not complete"));
    };
    damage(file, read_file(file).substr(0, 200));
    left_out("warning: results/e/images/tiny-reference.exr:1:1: ");
    fs::remove(file);
    left_out("warning: results/e/images/tiny-reference.exr: the file is missing; the scene is left out\n");
    EXPECT_EQ(run().code, 0);  // the reference is made again
    EXPECT_EQ(table("table.csv").rows.at(0).at(0), "tiny");
}

TEST_F(DamagedCellTest, ADamagedReferenceIsSaidWhereItIsReadOnly) {
    complete();
    const std::string file = results("images/tiny-reference.exr");
    flip_bit(file, 0.9);  // behind the header, and in the cached reference: both names are one file
    const std::string rows = read_file(results("table.csv"));
    const auto refused = [&](const std::string& said) {
        EXPECT_THAT(report(), exits(2, HasSubstr(said),
                                    HasSubstr("no scene of 'results/e' has a reference that "
                                              "can be read")));
        EXPECT_EQ(read_file(results("table.csv")), rows) << "the last good one stays";
    };
    refused("warning: results/e/images/tiny-reference.exr:1:1: ");
    fs::remove(file);
    refused("warning: results/e/images/tiny-reference.exr: the file is missing; the scene is left out\n");
    EXPECT_THAT(run(), exits(0, HasSubstr("made again")));
    EXPECT_EQ(report().code, 0);
}

}  // namespace
}  // namespace gib::test::damaged_cell_test
