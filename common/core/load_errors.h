#pragma once
// Errors of a scene that do not keep the rest of its file from being read, so that one message has them all.

#include "common/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace gib {

class LoadErrors {
public:
    /// An error that is found again at its place, as in a bsdf that several shapes refer to, counts once.
    void add(const SourceLocation& where, const std::string& message) {
        const auto is_known = [&](const Error& e) {
            return place_of(e) == std::tie(where.file, where.line, where.column);
        };
        if (std::none_of(errors_.begin(), errors_.end(), is_known)) errors_.push_back({where, message});
    }

    /// Forgets the errors, if there are any, and throws one InputError of them: a line for each in the order of the file, up to
    /// twenty, and then `last`, the error with which reading has stopped.
    void reject(const std::string& last = {}) {
        if (errors_.empty()) return;
        std::vector<Error> errors = std::exchange(errors_, {});
        std::stable_sort(errors.begin(), errors.end(),
                         [](const Error& a, const Error& b) { return place_of(a) < place_of(b); });
        constexpr std::size_t most_lines = 20;
        std::string text;
        for (std::size_t i = 0; i < std::min(errors.size(), most_lines); ++i)
            text += (i == 0 ? "" : "\n") + format_location(errors[i].where, errors[i].message);
        if (errors.size() > most_lines) text += fmt::format("\nand {} more", errors.size() - most_lines);
        throw InputError(last.empty() ? text : text + "\n" + last);
    }

private:
    struct Error {
        SourceLocation where;
        std::string message;
    };
    static std::tuple<const std::string&, const int&, const int&> place_of(const Error& error) {
        return std::tie(error.where.file, error.where.line, error.where.column);
    }

    std::vector<Error> errors_;
};

}  // namespace gib
