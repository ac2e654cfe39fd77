#include "experiments/references/schedule.h"

#include "common/core/math.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace gib {

namespace {

/// The work of a round is at most this much, 5 to 10 s on two cores, or this share of all passes so far: a longer one
/// would overshoot targets and time limits, and Ctrl-C would lose too much work.
constexpr double longest_round = 1e8, longest_share = 1.0 / 8;
/// No target counts as met before each group has this many passes. While rare bright paths are still missing, the
/// estimated error is too small; stopping at its first small value would favour exactly those moments.
constexpr std::uint32_t fewest_passes = 8;
constexpr int most_rounds_ahead = 16;
/// The first round takes this share of the work that the pilot foresees, and of the time limit. Sobol' points are the
/// better the more of them a batch has.
constexpr double first_share = 1.0 / 3;

/// The number of units in which some method makes fewest_passes.
std::uint64_t fewest_units(const std::vector<MethodShare>& shares) {
    std::uint32_t most = 1;
    for (const MethodShare& share : shares)
        most = std::max(most, share.passes);
    return (fewest_passes + most - 1) / most;
}

}  // namespace

bool ReferenceSchedule::reaches_target(const ReferenceState& state, const std::vector<MethodShare>& shares) const {
    return goal_.target && state.error <= *goal_.target && state.units >= fewest_units(shares);
}

double ReferenceSchedule::units_needed(const ReferenceState& state, const std::vector<MethodShare>& shares) const {
    const double ratio = state.error / *goal_.target;
    const auto done = static_cast<double>(state.units);
    return std::max({1.0, done * (ratio * ratio - 1), static_cast<double>(fewest_units(shares)) - done});
}

std::uint32_t ReferenceSchedule::first_units(const ReferenceState& state) const {
    if (!(state.foreseen_work > 0 && state.unit_work > 0)) return 1;
    double work = std::min(first_share * state.foreseen_work, longest_round);
    if (goal_.seconds && state.pilot_seconds > 0)
        work = std::min(work, first_share * (*goal_.seconds - state.seconds) * state.pilot_work / state.pilot_seconds);
    // Sobol' points are best in numbers that are powers of two.
    return std::bit_floor(static_cast<std::uint32_t>(std::clamp(work / state.unit_work, 1.0, 1e9)));
}

std::uint32_t ReferenceSchedule::next_units(const ReferenceState& state, const std::vector<MethodShare>& shares) const {
    if (state.units == 0) return first_units(state);
    const auto done = static_cast<double>(state.units);
    double units = done;
    if (state.work > 0) units = std::min(units, std::max(longest_round / (state.work / done), longest_share * done));
    if (goal_.target) units = std::min(units, 1.05 * units_needed(state, shares));
    // A limit of time acts only where it comes into sight.
    if (const double of_rounds = state.seconds - state.pilot_seconds; goal_.seconds && of_rounds > 0)
        units = std::min(units, (*goal_.seconds - state.seconds) / (of_rounds / done));
    return static_cast<std::uint32_t>(std::clamp(std::ceil(units), 1.0, 1e9));
}

std::vector<ReferenceBatch> ReferenceSchedule::next_batches(const ReferenceState& state,
                                                            const std::vector<MethodShare>& shares) const {
    const std::uint32_t units = next_units(state, shares);
    std::vector<ReferenceBatch> batches;
    for (std::uint32_t g = 0; g < reference_groups; ++g)
        for (std::uint32_t m = 0; m < shares.size(); ++m)
            if (const std::uint32_t share = shares[m].passes; share > 0)
                batches.push_back({m, state.rounds * reference_groups + g, units * share, state.units * share});
    return batches;
}

std::vector<ReferenceBatch> ReferenceSchedule::batches_ahead(ReferenceState state,
                                                             const std::vector<MethodShare>& shares) const {
    const bool first = state.units == 0;
    if (first) state.error = infinity;
    std::vector<ReferenceBatch> batches;
    for (int ahead = 0; ahead < most_rounds_ahead; ++ahead) {
        for (const ReferenceBatch& batch : next_batches(state, shares))
            batches.push_back(batch);
        const auto before = static_cast<double>(state.units), units = before + next_units(state, shares);
        state.error *= first ? 1 : std::sqrt(before / units);
        if (before > 0) {
            state.work *= units / before;
            state.seconds += (state.seconds - state.pilot_seconds) * (units / before - 1);
        }
        state.units = static_cast<std::uint64_t>(units);
        ++state.rounds;
        const bool late = goal_.seconds && state.seconds >= *goal_.seconds;
        if (late || (state.units >= fewest_units(shares) && (first || !goal_.target)) || reaches_target(state, shares))
            break;
    }
    return batches;
}

double ReferenceSchedule::work_left(const ReferenceState& state, const std::vector<MethodShare>& shares) const {
    if (state.units == 0) return state.pilot_work > 0 ? std::max(state.pilot_work, state.foreseen_work) : infinity;
    double share = infinity;  // work left, as a multiple of the work so far
    if (goal_.target) share = units_needed(state, shares) / static_cast<double>(state.units);
    if (goal_.seconds) share = std::min(share, std::max(0.0, *goal_.seconds / std::max(state.seconds, 1e-9) - 1));
    return state.work > 0 ? share * state.work : infinity;
}

}  // namespace gib
