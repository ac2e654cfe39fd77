// Written files, and the hash of content against hashes that Python's hashlib has computed.

#include "common/core/descriptor.h"
#include "common/core/error.h"
#include "tests/support/scene_text.h"

#include <fcntl.h>
#include <gtest/gtest.h>

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

TEST(ContentHash, PiecesDoNotRunIntoEachOther) { EXPECT_NE(hash_of({"ab", "c"}), hash_of({"a", "bc"})); }

std::ptrdiff_t entries_of(const TemporaryFolder& folder) {
    return std::distance(std::filesystem::directory_iterator(folder / ""), {});
}

TEST(WrittenFile, ReplacesTheOldOneAndLeavesNoOther) {
    const TemporaryFolder folder;
    for (const Flush flush : {Flush::now, Flush::later})
        for (const std::string& content :
             {std::string("longer than the next"), std::string("t\0o", 3), std::string()}) {
            write_file(folder / "a", content, flush);
            EXPECT_EQ(read_file(folder / "a"), content);
            EXPECT_EQ(entries_of(folder), 1);
        }
}

// Lengths on both sides of the pieces that go to the system, and a change at the front, as in an EXR file's table of offsets.
TEST(WrittenFile, HoldsWhatWasWrittenPieceByPiece) {
    const TemporaryFolder folder;
    std::string expected;
    write_file(folder / "a", [&](FileContent& file) {
        char letter = 'a';
        for (const std::size_t length : {1u, 200'000u, 100'000u, 0u, 262'144u, 262'145u, 7u}) {
            const std::string piece(length, letter++);
            EXPECT_EQ(file.position(), expected.size());
            file.write(piece);
            expected += piece;
        }
        file.seek(3);
        file.write("table");
        EXPECT_EQ(file.position(), 8u);
        expected.replace(3, 5, "table");
    });
    EXPECT_TRUE(read_file(folder / "a") == expected);
}

// OpenEXR writes the table of offsets in a destructor, which swallows exceptions.
TEST(WrittenFile, AFailureIsThrownAgainAtTheEnd) {
    const Descriptor full(::open("/dev/full", O_WRONLY));
    ASSERT_GE(full.get(), 0);
    FileContent content(full.get(), "full");
    EXPECT_THROW(content.write(std::string(300'000, 'x')), RunError);
    EXPECT_THROW(content.flush(), RunError);
}

TEST(Files, AreWrittenWholeOrNotAtAll) {
    const TemporaryFolder folder;
    EXPECT_THROW(write_file(folder / "missing/a", "x"), RunError);
    std::filesystem::create_directories(folder / "taken/full");
    EXPECT_THROW(write_file(folder / "taken", "x"), RunError);
    EXPECT_THROW(read_file(folder / "taken"), InputError);
    EXPECT_THROW(read_file(folder / "b"), InputError);
    EXPECT_EQ(entries_of(folder), 1) << "a temporary file was left behind";
}

}  // namespace
}  // namespace gib::test::files_test
