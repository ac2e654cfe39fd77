#pragma once
// The size of the pilot of a reference with several makers.

#include <cstdint>

namespace gib {

/// The pilot of a reference with several makers takes this share of the work, and has at most so many rounds. It makes
/// few images of several passes each, rather than the reference's groups, because Sobol' points are better the more of
/// them a pixel gets.
inline constexpr double pilot_share = 0.03;
/// A time limit beside a target ends the pilot after this share of the limit. Where that is before the pilot's share of the
/// work, the target would take more than three times the limit.
inline constexpr double pilot_share_of_limit = 0.1;
inline constexpr std::uint32_t most_pilot_rounds = 10, pilot_groups = 4, first_pilot_passes = 4;
/// The pilot's batches are numbered from here.
inline constexpr std::uint32_t first_pilot_batch = 0x80000000;

}  // namespace gib
