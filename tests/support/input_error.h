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

}  // namespace gib::test
