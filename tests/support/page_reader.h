#pragma once
// Readers of the program's pages: elements with data, and bytes as text.

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

namespace gib::test {

/// The content of the <script> with this id.
inline std::string element_of_page(const std::string& page, const std::string& id) {
    const std::size_t at = page.find("id=\"" + id + "\">");
    EXPECT_NE(at, std::string::npos) << id;
    const std::size_t begin = page.find('>', at) + 1;
    return page.substr(begin, page.find("</script>", begin) - begin);
}

inline std::vector<std::uint8_t> bytes_of_base64(const std::string& text) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::vector<std::uint8_t> bytes;
    unsigned bits = 0;
    int count = 0;
    for (const char c : text) {
        if (c == '=') break;
        bits = (bits << 6) | static_cast<unsigned>(digits.find(c));
        if ((count += 6) < 8) continue;
        count -= 8;
        bytes.push_back(static_cast<std::uint8_t>((bits >> count) & 255u));
    }
    return bytes;
}

}  // namespace gib::test
