#pragma once
// Fills Mustache templates (kainjow's library).
//
// Files that the build embeds in the program: templates, styles and scripts of its pages, and the libraries these use.

#include <nlohmann/json_fwd.hpp>

#include <initializer_list>
#include <string>
#include <string_view>

namespace gib {

/// The template with the values in place; `escape` writes every text. Empty texts and null count as false.
std::string filled(std::string_view page, const nlohmann::json& values, std::string (*escape)(std::string_view));

/// Embedded scripts after one another, as the text of one <script> element.
std::string embedded_scripts(std::initializer_list<std::string_view> names);

/// The content of a file by its path below experiments/, such as "report_page/page.html", or of a library with its licence:
/// "chart.js", "three.js", "OrbitControls.js". Throws std::logic_error if there is none.
std::string_view embedded_file(std::string_view name);

}  // namespace gib
