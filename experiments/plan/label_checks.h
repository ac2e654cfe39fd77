#pragma once
// Which labels take a filter, and which make a reference.

#include "methods/method.h"

#include <string>
#include <string_view>
#include <vector>

namespace gib {

inline constexpr std::string_view no_filter = "none";
inline constexpr std::string_view non_local_means_filter = "nlm";

/// The filter of a label; empty if there is none.
std::string filter_of(const MethodLabel& label);
/// Throws InputError at `where` if the label's `spp` is less than a filter takes apart.
void require_passes(const MethodLabel& label, int least, const SourceLocation& where);
/// Throws InputError at `where` if the label has a filter that is not gibench's own, or fewer passes than that takes.
void require_own_filter(const MethodLabel& label, const SourceLocation& where = {});

/// The name of all reference methods together.
inline constexpr std::string_view auto_reference = "auto";

/// The methods that make a reference with this label. Throws InputError at `where` for an unknown method, for
/// parameters that do not fit it, and for `spp`.
std::vector<const MethodDescription*> reference_methods(const MethodLabel& label, const SourceLocation& where = {});

}  // namespace gib
