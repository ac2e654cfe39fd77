#pragma once
// How many units of work the rounds of a reference have, and what is left to do. Where a target ends the reference, these
// numbers follow from its error and from counts of rays alone, never from time, so that they are the same on every
// machine.

#include "experiments/plan/experiment_file.h"
#include "experiments/references/reference_methods.h"
#include "experiments/references/store.h"

#include <cstdint>
#include <vector>

namespace gib {

/// The state of a reference between two rounds.
struct ReferenceState {
    std::uint32_t rounds = 0;
    std::uint64_t units = 0;  ///< in each group, of work as MethodShare has it
    double error = 0;         ///< relative standard error that is to fall to the target; unknown before the first round
    double work = 0;          ///< work of all rounds (MadeBatch::work); 0: unknown
    double seconds = 0;       ///< time of all rounds and the pilot
    double pilot_seconds = 0;  ///< time of the pilot
    double pilot_work = 0;     ///< work of the pilot; 0: there was none
    double unit_work = 0;      ///< work of one unit of all groups, by the pilot
    double foreseen_work = 0;  ///< work up to the target, by the pilot; 0: unknown
};

class ReferenceSchedule {
public:
    explicit ReferenceSchedule(const ReferenceGoal& goal) : goal_(goal) {}

    /// Whether the target is reached. No target counts as reached before each group has a few passes.
    bool reaches_target(const ReferenceState& state, const std::vector<MethodShare>& shares) const;
    /// The number of units that the target still needs; there must be one. The error falls with the square root of their
    /// number.
    double units_needed(const ReferenceState& state, const std::vector<MethodShare>& shares) const;
    /// The units of the next round.
    std::uint32_t next_units(const ReferenceState& state, const std::vector<MethodShare>& shares) const;
    /// The batches of the next round, by groups.
    std::vector<ReferenceBatch> next_batches(const ReferenceState& state, const std::vector<MethodShare>& shares) const;
    /// The batches of all rounds up to the goal, as far as they can be foreseen, of 16 rounds at most.
    std::vector<ReferenceBatch> batches_ahead(ReferenceState state, const std::vector<MethodShare>& shares) const;
    /// The work up to the goal, or, before the first round, of the first few rounds; infinite if it is unknown.
    double work_left(const ReferenceState& state, const std::vector<MethodShare>& shares) const;

private:
    /// The units of the first round.
    std::uint32_t first_units(const ReferenceState& state) const;

    const ReferenceGoal& goal_;
};

}  // namespace gib
