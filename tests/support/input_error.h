#pragma once
// The error message that wrong input causes, as a string to compare.

#include "common/core/error.h"

#include <string>

namespace gib::test {

/// The message of the InputError that `read` throws; "no error" if it throws none.
template <typename Read>
std::string input_error_of(const Read& read) {
    try {
        read();
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

/// The same from the first `file` on, without the folders before it.
template <typename Read>
std::string input_error_in(const std::string& file, const Read& read) {
    const std::string what = input_error_of(read);
    const std::size_t place = what.find(file);
    return place == std::string::npos ? what : what.substr(place);
}

}  // namespace gib::test
