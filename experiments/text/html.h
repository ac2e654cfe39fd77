#pragma once
// Makes pieces of HTML.

#include <string>
#include <string_view>

namespace gib {

/// Escapes text for HTML, inside elements and attributes.
std::string html_escape(std::string_view text);

/// HTML of a sentence in Markdown: `names` between backquotes become <code>.
std::string sentence_html(std::string_view text);

/// JSON for a <script> element: every "<" is escaped, because it could end the element.
std::string script_safe_json(std::string json);
/// JavaScript for a <script> element: "</script" becomes "<\/script", which means the same in strings. It
/// may stand only there.
std::string script_safe_code(std::string_view code);

}  // namespace gib
