#pragma once
// A fuzz target feeds one reader with arbitrary bytes. The same functions run under libFuzzer (preset `fuzz`) and, in
// every other build, over the files of tests/fuzz/corpus (the tests FuzzCorpus.*).

#include "common/core/error.h"
#include "common/mesh_files/mesh_data.h"

#include <string>
#include <string_view>

namespace gib::fuzz {

/// Reads the input; the program of each target defines its own run_input(). The reader may refuse the input. Any
/// other exception, and any require() that fails on the result, is a finding.
void run_input(std::string_view input);

/// Calls `read` and ends an InputError, by which a reader refuses its input.
template <typename Read>
void unless_refused(const Read& read) {
    try {
        read();
    } catch (const InputError&) {
    }
}

/// Throws std::logic_error, which no reader throws on purpose, unless `holds`.
void require(bool holds, const std::string& what);

/// Requires what is true of every mesh that a reader returns: finite positions, as many normals and uv as vertices or
/// none, and indices in range; and, after the steps that follow reading, under a few transforms: normals of unit
/// length or zero, and finite areas.
void check_mesh(const MeshData& mesh);

/// A folder in memory, removed when the program ends.
class ScratchFolder {
public:
    ScratchFolder();
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    std::string operator/(const std::string& name) const { return path_ + "/" + name; }
    /// Replaces the file's content in place and without sync, because thousands of inputs are written per second.
    void write(const std::string& name, std::string_view content) const;
    void remove(const std::string& name) const;

private:
    std::string parent_, path_;
};

}  // namespace gib::fuzz
