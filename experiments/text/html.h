#pragma once
// Pieces of HTML.

#include "experiments/metrics/statistics.h"

#include <optional>
#include <string>
#include <string_view>

namespace gib {

/// Text for HTML, inside elements and attributes.
std::string html_escape(std::string_view text);

/// A sentence as tables.h's texts have it: `names` between backquotes become <code>.
std::string sentence_html(std::string_view text);

/// JSON for a <script> element: no "<" that could end it.
std::string script_safe_json(std::string json);
/// JavaScript for a <script> element: "</script" may only stand in strings, where "<\/script" is the same.
std::string script_safe_code(std::string_view code);

/// A value with its interval below it.
std::string with_interval_html(const Estimate& estimate, std::string (*text)(double));

/// The colour of method `index` as CSS; ten are told apart, then they repeat.
std::string method_color(std::size_t index);
/// A small square of that colour and the label.
std::string method_html(std::size_t index, const std::string& label);

}  // namespace gib
