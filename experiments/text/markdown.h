#pragma once
// Makes pieces of Markdown.

#include <string>
#include <string_view>

namespace gib {

/// A user's text as part of one line of Markdown, also in tables: "|", which would end a field, is escaped, and a
/// line break, which would end the row, becomes a space.
std::string markdown_text(std::string_view text);

}  // namespace gib
