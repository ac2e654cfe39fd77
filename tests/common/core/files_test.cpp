// Written files, and the hash of content against hashes that Python's hashlib has computed.
#include "common/core/files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

namespace gib::test::files_test {
namespace {

std::string hash_of(const std::vector<std::string>& pieces) {
    ContentHash hash;
    for (const std::string& piece : pieces)
        hash.add(piece);
    return hash.hex();
}

TEST(ContentHash, IsTheSha1OfThePiecesSha1) {
    EXPECT_EQ(hash_of({}), "da39a3ee5e6b4b0d3255bfef95601890afd80709");
    EXPECT_EQ(hash_of({"abc"}), "0d3ced9bec10a777aec23ccc353a8c08a633045e");
    EXPECT_EQ(hash_of({"ab", "c"}), "12e0faf47759b58357818872da46c47a5dd37cbb");
    EXPECT_EQ(hash_of({std::string(1000000, 'a')}), "0f82722174ca585cf84223e9da6af2c16b0db6ac");
}

TEST(WrittenFile, ReplacesTheOldOneAndLeavesNoOther) {
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "written-file";
    std::filesystem::remove_all(folder);
    std::filesystem::create_directory(folder);
    const std::string path = folder / "a";
    for (const Flush flush : {Flush::now, Flush::later})
        for (const std::string content : {"longer than the next", "short", ""}) {
            write_file(path, content, flush);
            EXPECT_EQ(read_file(path), content);
            EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
        }
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace gib::test::files_test
