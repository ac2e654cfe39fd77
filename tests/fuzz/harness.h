#pragma once
// What a fuzz target is: one reader, fed with any bytes. The same functions run under libFuzzer (preset `fuzz`) and, in
// every other build, over the files of tests/fuzz/corpus (the tests FuzzCorpus.*).

#include "common/core/error.h"
#include "common/mesh_files/mesh_data.h"

#include <string>
#include <string_view>

namespace gib::fuzz {

/// Each target's program has its own. Reads the input, which may be refused; whatever else is thrown, and whatever
/// require() finds in what was read, is a finding.
void run_input(std::string_view input);

/// Runs it. InputError is a refusal and ends here.
template <typename Read>
void unless_refused(const Read& read) {
    try {
        read();
    } catch (const InputError&) {
    }
}

/// Throws std::logic_error, which no reader throws on purpose.
void require(bool holds, const std::string& what);

/// What every mesh must be that a reader returns: finite, with as many normals and uv as vertices or none, indices in
/// range; and after the steps that follow a file's reading under a few transforms: normals unit or zero, areas finite.
void check_mesh(const MeshData& mesh);

/// A folder in memory, removed when the program ends.
class ScratchFolder {
public:
    ScratchFolder();
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    std::string operator/(const std::string& name) const { return path_ + "/" + name; }
    /// Replaces the file's content in place: no sync, thousands of inputs a second are written.
    void write(const std::string& name, std::string_view content) const;
    void remove(const std::string& name) const;

private:
    std::string parent_, path_;
};

}  // namespace gib::fuzz
