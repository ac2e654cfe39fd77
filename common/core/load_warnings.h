#pragma once
// Warnings of a scene that was loaded, but not quite as its file says.

#include "common/core/error.h"

#include <string>
#include <vector>

namespace gib {

/// The warnings in the order of their causes. A message comes once, with the place of its first cause.
class LoadWarnings {
public:
    void add(const SourceLocation& where, const std::string& message) {
        for (const std::string& known : texts_)
            if (known == message) return;
        texts_.push_back(message);
        located_.push_back(format_location(where, message));
    }
    /// Each as `file:line:column: message`.
    const std::vector<std::string>& messages() const { return located_; }

private:
    std::vector<std::string> texts_, located_;
};

}  // namespace gib
