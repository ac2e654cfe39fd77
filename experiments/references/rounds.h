#pragma once
// The rounds of a reference: each adds one batch of equal length to every group. Knows the error so far, and by it how
// many units come next (schedule.h) and whether the goal is met.

#include "experiments/references/pilot.h"
#include "experiments/references/schedule.h"

#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace gib {

/// The error of a reference so far, relative.
struct ReferenceError {
    double square = 0, scatter = 0;  ///< the squared error, and the standard error of this estimate
    double plain = 0;                ///< the error with the image itself in the denominator

    /// The error, so many standard errors of its square above the estimate.
    double up_to(double standard_errors) const { return std::sqrt(square + standard_errors * scatter); }
    double value() const { return std::sqrt(square); }
};

/// The images of a round by method and group, for tests of whether the methods agree.
using RoundImages = std::vector<std::vector<ComponentImages>>;

class Rounds {
public:
    Rounds(const std::vector<ReferenceMethod>& methods, const ReferenceGoal& goal, std::optional<double> epsilon);

    ReferenceGroups groups;
    std::vector<MethodShare> shares;  ///< by method; all equal until a pilot has decided
    PilotCosts pilot;                 ///< of a pilot of this session

    /// Estimates the reference and its error from the groups.
    void estimate();
    const Reference& reference() const { return reference_; }
    /// The epsilon of the error [radiance^2].
    double epsilon() const { return used_epsilon_; }
    const ReferenceError& error() const { return error_; }

    bool reaches_target() const { return schedule_.reaches_target(state(), shares); }
    /// Whether the time limit has passed.
    bool is_late() const { return goal_.seconds && groups.seconds >= *goal_.seconds; }
    std::vector<ReferenceBatch> next_batches() const { return schedule_.next_batches(state(), shares); }
    std::vector<ReferenceBatch> batches_ahead() const { return schedule_.batches_ahead(state(), shares); }
    double work_left() const { return schedule_.work_left(state(), shares); }
    /// The number of units of each group in the next round.
    std::uint32_t next_units() const { return schedule_.next_units(state(), shares); }
    /// The share of the reference that is done while a round is made, and the seconds that are left; infinite: unknown.
    std::pair<double, double> progress(double units_of_round) const;

    /// Makes the next round with `make`; an interrupted one does not count. `show` receives the units of the round
    /// that are done. Returns the images by method if there are several methods.
    RoundImages add(const MakeBatch& make, const std::function<void(double units)>& show);
    /// Gives up all rounds. The next ones have new seeds.
    void restart();

private:
    ReferenceState state() const;

    const ReferenceGoal& goal_;
    std::optional<double> epsilon_;  ///< as it is given
    ReferenceSchedule schedule_;
    Reference reference_;
    double used_epsilon_ = 0;
    ReferenceError error_;
};

}  // namespace gib
