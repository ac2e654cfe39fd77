#pragma once
// The parameter `filter` of every method: `nlm`, which gibench has (common/images/non_local_means.h), or the name of a command of an
// experiment file (filter_commands.h).

#include "methods/method.h"

#include <string>
#include <string_view>

namespace gib {

inline constexpr std::string_view no_filter = "none";
inline constexpr std::string_view non_local_means_filter = "nlm";

/// The filter of a label; empty if there is none.
std::string filter_of(const MethodLabel& label);
/// Throws InputError at `where` if the label's `spp` is less than a filter takes apart.
void require_passes(const MethodLabel& label, int least, const SourceLocation& where);
/// Throws InputError at `where` if the label has a filter that is not gibench's own, or fewer passes than that takes.
void require_own_filter(const MethodLabel& label, const SourceLocation& where = {});

}  // namespace gib
