#include "experiments/program/option_texts.h"

#include "common/core/number_text.h"
#include "common/core/reject.h"

namespace gib {

std::map<std::string, std::string> assignments(const std::vector<std::string>& texts) {
    std::map<std::string, std::string> values;
    for (const auto& text : texts) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos || equals == 0) reject({}, "--set needs NAME=VALUE, not '{}'", text);
        if (!values.emplace(text.substr(0, equals), text.substr(equals + 1)).second)
            reject({}, "--set gives '{}' twice", text.substr(0, equals));
    }
    return values;
}

std::pair<int, int> resolution_in(const std::string& text) {
    const std::size_t x = text.find('x');
    const auto size_of = [&](const std::string& part) {
        const auto size = number_from<int>(part);
        return size && *size >= 1 && *size <= most_pixels_across ? *size : 0;
    };
    const int width = size_of(text.substr(0, x)), height = x == std::string::npos ? 0 : size_of(text.substr(x + 1));
    if (width == 0 || height == 0)
        reject({}, "--resolution needs WIDTHxHEIGHT, such as 640x480, two numbers from 1 to {}, not '{}'",
               most_pixels_across, text);
    return {width, height};
}

RunShare share_in(const std::string& text) {
    const std::size_t slash = text.find('/');
    const auto index = number_from<std::size_t>(text.substr(0, slash));
    const auto count = slash == std::string::npos ? std::nullopt : number_from<std::size_t>(text.substr(slash + 1));
    if (!index || !count || *index >= *count)
        reject({}, "--share needs I/N with I from 0 to N - 1, such as 0/4, not '{}'", text);
    return {*index, *count};
}

}  // namespace gib
