#pragma once
// Makes pieces of HTML and of Markdown, and fills the templates of pages (Mustache, kainjow's library) with what the
// build embeds in the program: templates, styles and scripts, and the libraries these use.

#include <nlohmann/json_fwd.hpp>

#include <initializer_list>
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

/// The template with the values in place; `escape` writes every text. Empty texts and null count as false.
std::string filled(std::string_view page, const nlohmann::json& values, std::string (*escape)(std::string_view));

/// Embedded scripts after one another, as the text of one <script> element.
std::string embedded_scripts(std::initializer_list<std::string_view> names);

/// The content of a file by its path below experiments/, such as "report_page/page.html", or of a library with its
/// licence:
/// "chart.js", "three.js", "OrbitControls.js". Throws std::logic_error if there is none.
std::string_view embedded_file(std::string_view name);

}  // namespace gib
