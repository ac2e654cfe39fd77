#pragma once
// Files that the build embeds in the program: templates, styles and scripts of its pages, and the libraries these use.

#include <string_view>

namespace gib {

/// The content of a file by its path below experiments/, such as "report_page/page.html", or of a library with its licence:
/// "chart.js", "three.js", "OrbitControls.js". Throws std::logic_error if there is none.
std::string_view embedded_file(std::string_view name);

}  // namespace gib
