#pragma once
// The message of wrong input.

#include "common/core/error.h"

#include <string>

namespace gib::test {

/// What the InputError says that `read` throws; "no error" if it throws none.
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
