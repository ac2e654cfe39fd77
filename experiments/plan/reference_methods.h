#pragma once
// The methods that make a reference.

#include "methods/method.h"

#include <string_view>
#include <vector>

namespace gib {

/// The name that stands for all unbiased methods together.
inline constexpr std::string_view auto_reference = "auto";

/// The methods that make a reference with this label. Throws InputError at `where` for an unknown method, for
/// parameters that do not fit it, and for `spp`.
std::vector<const MethodDescription*> reference_methods(const MethodLabel& label, const SourceLocation& where = {});

}  // namespace gib
