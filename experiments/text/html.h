#pragma once
// Makes pieces of HTML and of Markdown.

#include <string>
#include <string_view>

namespace gib {

/// Escapes text for HTML, inside elements and attributes.
std::string html_escape(std::string_view text);

/// HTML of a sentence in Markdown: `names` between backquotes become <code>.
std::string sentence_html(std::string_view text);

/// JSON for a <script> element: every "<" is escaped, because it could end the element.
std::string script_safe_json(const std::string& json);
/// JavaScript for a <script> element: "</script" becomes "<\/script", which means the same in strings. It
/// may stand only there.
std::string script_safe_code(std::string_view code);

/// A user's text as part of one line of Markdown, also in tables: "|", which would end a field, is escaped, and a
/// line break, which would end the row, becomes a space.
std::string markdown_text(std::string_view text);

}  // namespace gib
