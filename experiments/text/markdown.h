#pragma once
// Pieces of Markdown.

#include <string>
#include <string_view>

namespace gib {

/// Names and sentences of a user for one line of Markdown, in tables too: a "|" would end a cell, a line break the row.
std::string markdown_text(std::string_view text);

}  // namespace gib
