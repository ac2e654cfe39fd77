// Seconds of unlike processors are not compared in silence.

#include "experiments/analysis/processors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gib::processors_test {
namespace {

Cell cell_of(const std::string& scene, const std::string& method, const std::string& cpu) {
    Cell cell;
    cell.scene = scene;
    cell.method = method;
    cell.cpu = cpu;
    return cell;
}

TEST(Processors, UnlikeOnesOfAScene) {
    const std::vector<Cell> cells = {cell_of("box", "path", "A"),   cell_of("box", "path", "A"),
                                     cell_of("box", "vcm", "B"),    cell_of("box", "path", "B"),
                                     cell_of("glass", "path", "A"), cell_of("glass", "vcm", "")};
    EXPECT_THAT(unlike_processors(cells, "box"), ::testing::HasSubstr("; on 'A': path; on 'B': path, vcm"));
    EXPECT_EQ(unlike_processors(cells, "glass"), "") << "a record of an older version has no name";
}

TEST(Processors, OfARow) {
    const std::vector<Cell> cells = {cell_of("box", "path", "B"), cell_of("box", "path", "A"),
                                     cell_of("box", "path", "B"), cell_of("box", "path", "")};
    EXPECT_EQ(processors_of({&cells[0], &cells[1], &cells[2], &cells[3]}), "A;B");
    EXPECT_EQ(processors_of({&cells[3]}), "");
}

}  // namespace
}  // namespace gib::processors_test
