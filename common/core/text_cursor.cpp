#include "common/core/text_cursor.h"

#include "common/core/reject.h"

#include <charconv>
#include <cmath>
#include <cstring>
#include <utility>

namespace gib {

bool TextCursor::at_join() const {
    const char* next = at_ + 1;
    if (next != end_ && *next == '\r') ++next;
    return next != end_ && *next == '\n';
}

bool TextCursor::at_word_end() const { return at_line_end() || at_blank(); }

void TextCursor::fail_number(const char* expected) {
    const SourceLocation where = location();
    const std::string_view found = word();
    if (found.empty()) reject(where, "{} is missing", expected);
    reject(where, "bad number '{}': expected {}", found, expected);
}

void TextCursor::skip_blanks() {
    while (at_blank()) {
        if (*at_ == '\\') next_line();
        else ++at_;
    }
}

void TextCursor::skip_space() {
    for (skip_blanks(); at_ != end_ && *at_ == '\n'; skip_blanks())
        next_line();
}

void TextCursor::next_line() {
    const void* newline = at_ == end_ ? nullptr : std::memchr(at_, '\n', bytes_left());
    at_ = newline ? static_cast<const char*>(newline) + 1 : end_;
    if (newline) {
        ++line_;
        line_begin_ = at_;
    }
}

std::string_view TextCursor::word() {
    skip_blanks();
    const char* first = at_;
    while (!at_word_end())
        ++at_;
    return {first, static_cast<std::size_t>(at_ - first)};
}

double TextCursor::number() {
    skip_blanks();
    const char* first = at_ != end_ && *at_ == '+' ? at_ + 1 : at_;
    double value = 0;
    const auto [next, error] = std::from_chars(first, end_, value);
    const char* start = std::exchange(at_, next);
    if (error == std::errc() && at_word_end()) return value;
    at_ = start;
    fail_number("a number");
}

std::int64_t TextCursor::integer() {
    skip_blanks();
    std::int64_t value = 0;
    const auto [next, error] = std::from_chars(at_, end_, value);
    const char* start = std::exchange(at_, next);
    if (error == std::errc() && (at_word_end() || *at_ == '/')) return value;
    at_ = start;
    fail_number("an integer");
}

double TextCursor::finite_number(const char* what) {
    skip_blanks();
    mark();
    const double value = number();
    if (!std::isfinite(value)) reject(marked(), "{} is not finite", what);
    return value;
}

float TextCursor::float_number(const char* what) {
    const double value = finite_number(what);
    if (!std::isfinite(static_cast<float>(value))) reject(marked(), "{} is too large: {:g}", what, value);
    return static_cast<float>(value);
}

void TextCursor::require_more() const {
    if (at_end()) throw InputError(location(), "truncated: the file ends before its data");
}

void TextCursor::end_line() {
    skip_blanks();
    if (!at_line_end()) throw InputError(location(), "too many words in the line");
    next_line();
}

}  // namespace gib
