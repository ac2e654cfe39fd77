#pragma once
// Reads lines of numbers from a file in memory; errors name the line and column of the wrong text. Nothing is
// allocated and no stream is used, because meshes have millions of lines.

#include "common/core/error.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace gib {

/// Whether a backslash at the end of a line makes the line end a blank.
enum class Backslash { plain, joins_lines };

/// A position in `text`. `text` and `file`, the file's name for error messages, must outlive the cursor.
class TextCursor {
public:
    TextCursor(std::string_view text, const std::string& file, Backslash backslash = Backslash::plain)
        : begin_(text.data()),
          at_(begin_),
          end_(begin_ + text.size()),
          line_begin_(begin_),
          joins_(backslash == Backslash::joins_lines),
          file_(file) {}

    bool at_end() const { return at_ == end_; }
    bool at_line_end() const { return at_ == end_ || *at_ == '\n'; }
    char peek() const { return at_ == end_ ? '\0' : *at_; }
    /// Whether a space, a tab, a carriage return or a line end after a backslash comes next.
    bool at_blank() const {
        return peek() == ' ' || peek() == '\t' || peek() == '\r' || (joins_ && peek() == '\\' && at_join());
    }
    std::size_t offset() const { return static_cast<std::size_t>(at_ - begin_); }
    std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - at_); }
    SourceLocation location() const { return location_of(at_); }
    /// Remembers this place for an error message about what is read next from the same line.
    void mark() { mark_ = at_; }
    SourceLocation marked() const { return location_of(mark_); }

    void advance() { ++at_; }
    /// Skips spaces, tabs, carriage returns and line ends after a backslash.
    void skip_blanks();
    /// Skips white space including line ends.
    void skip_space();
    /// Moves to the start of the next line.
    void next_line();
    /// Skips blanks and reads the characters up to the next white space; empty at the end of a line.
    std::string_view word();

    // These skip blanks and then read a number from the same line. They throw InputError at the place of anything
    // else. An integer may be followed by a slash, as in the faces of OBJ files.
    double number();
    std::int64_t integer();

    // These mark the place of the number. They throw InputError, which names `what`, if it is not finite or, where it
    // is returned as float, too large.
    double finite_number(const char* what);
    float float_number(const char* what);

    /// Throws InputError at the end of the file.
    void require_more() const;
    /// Moves to the start of the next line. Throws InputError if anything but blanks is left on this one.
    void end_line();

private:
    SourceLocation location_of(const char* place) const {
        return {file_, line_, static_cast<int>(place - line_begin_) + 1};
    }
    /// Whether nothing but the line end follows the backslash here.
    bool at_join() const;
    bool at_word_end() const;
    [[noreturn]] void fail_number(const char* expected);

    const char *begin_, *at_, *end_, *line_begin_, *mark_ = begin_;
    int line_ = 1;
    bool joins_;
    const std::string& file_;
};

}  // namespace gib
