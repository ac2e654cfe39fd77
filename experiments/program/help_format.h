#pragma once
// Help that fits a terminal of 80 columns.

#include <memory>
#include <string>

namespace CLI {
class Formatter;
}

namespace gib {

/// The text in lines of at most `width` characters, broken at spaces; a line that begins with spaces goes on below them. Words
/// that are longer stand alone.
std::string wrapped(const std::string& text, std::size_t width);

/// For CLI::App::formatter().
std::shared_ptr<CLI::Formatter> narrow_help();

}  // namespace gib
