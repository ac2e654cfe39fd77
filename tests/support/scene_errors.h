#pragma once
// The errors that wrong scene files cause, and tables of them.

#include "tests/support/input_error.h"
#include "tests/support/scene_builder.h"
#include "tests/support/scene_text.h"

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace gib::test {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// The error of a scene with a sensor on line 1 and `body` from line 2; "no error" if it has none.
inline std::string scene_error(const std::string& body, const std::string& path = "t.xml",
                               const SceneLoadOptions& options = {}) {
    return input_error_of([&] { parse_scene(scene_with(body), path, options); });
}

/// Wrong content, the place of its error (line:column, or "" for any), and a part of the message.
struct ExpectedError {
    std::string content, place, message;
};

/// Expects the errors that `error_of` returns for the content of each row, in this file.
template <typename ErrorOf>
void expect_errors(const std::vector<ExpectedError>& rows, const ErrorOf& error_of, const std::string& file = "t.xml") {
    for (const auto& [content, place, message] : rows) {
        const std::string error = error_of(content);
        if (!place.empty()) {
            EXPECT_THAT(error, StartsWith(file + ":" + place + ": ")) << content;
        }
        EXPECT_THAT(error, HasSubstr(message)) << content;
    }
}
/// The same for bodies of scenes, which begin on line 2.
inline void expect_errors(const std::vector<ExpectedError>& rows) {
    expect_errors(rows, [](const std::string& body) { return scene_error(body); });
}

}  // namespace gib::test
