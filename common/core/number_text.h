#pragma once
// Reads numbers that are written as text, alike in every locale.

#include <charconv>
#include <optional>
#include <string_view>

namespace gib {

/// The number that the whole text stands for; nothing if the text is anything else or out of T's range.
template <typename T>
std::optional<T> number_from(std::string_view text) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace gib
