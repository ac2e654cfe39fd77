#include "experiments/references/pilot.h"

#include "common/core/math.h"

#include <utility>

namespace gib {

namespace {

/// The pilot ends after this share of the reference's work, and after so many rounds.
constexpr double pilot_share = 0.03;
/// A time limit beside a target ends the pilot after this share of the limit. Where that is before the pilot's share of
/// the work, the target would take more than three times the limit.
constexpr double pilot_share_of_limit = 0.1;
constexpr std::uint32_t most_rounds = 10, pilot_groups = 4, first_passes = 4;
/// The pilot's batches are numbered from here.
constexpr std::uint32_t first_batch = 0x80000000;

}  // namespace

Pilot::Pilot(const std::vector<ReferenceMethod>& methods, const ReferenceGoal& goal,
             const std::optional<double>& epsilon)
    : goal_(goal), epsilon_(epsilon), pilots_(methods.size()), outdone_(methods.size(), false) {
    for (std::size_t m = 0; m < methods.size(); ++m) {
        names_.push_back(methods[m].name());
        pilots_[m].unresolved = methods[m].unresolved();
    }
}

std::vector<ReferenceBatch> Pilot::next_batches() const {
    std::vector<ReferenceBatch> batches;
    for (std::uint32_t m = 0; m < pilots_.size(); ++m)
        for (std::uint32_t g = 0; g < pilot_groups && !outdone_[m]; ++g)
            batches.push_back({m, first_batch + round_ * pilot_groups + g, first_passes << round_, 0});
    return batches;
}

bool Pilot::add_round(const MakeBatch& make, const std::function<void(const std::string& method)>& show) {
    const std::vector<ReferenceBatch> wanted = next_batches();
    for (std::size_t m = 0; m < pilots_.size(); ++m) {
        if (outdone_[m]) continue;
        MethodPilot& pilot = pilots_[m];
        if (round_ == 1) {
            pilot.first_groups = std::move(pilot.groups);
            pilot.first_passes = pilot.passes;
        }
        pilot.groups.clear();
        pilot.passes = first_passes << round_;
        pilot.work = 0;
    }
    for (const ReferenceBatch& batch : wanted) {
        show(names_[batch.method]);
        MadeBatch made = make(batch);
        MethodPilot& pilot = pilots_[batch.method];
        pilot.groups.push_back(std::move(made.images));
        pilot.work += made.work;
        costs_.work += made.work;
        costs_.seconds += made.seconds;
        dropped_.add(made.dropped);
    }
    decide_shares();
    return !is_enough() && ++round_ < most_rounds;
}

void Pilot::decide_shares() {
    const auto plan_for = [&](double work) { return plan_of_least_variance(names_, pilots_, epsilon_, work); };
    const ReferencePlan plan = plan_for(goal_.target    ? plan_for(0).error2_work / sqr(*goal_.target)
                                        : goal_.seconds ? costs_.work / costs_.seconds * *goal_.seconds
                                                        : 0);
    shares_ = plan.shares;
    for (std::size_t m = 0; m < pilots_.size(); ++m)
        outdone_[m] = outdone_[m] || plan.outdone[m];
    costs_.unit_work = reference_groups * plan.unit_work;
    if (goal_.target) costs_.foreseen_work = plan.error2_work / sqr(*goal_.target);
}

bool Pilot::is_enough() const {
    if (goal_.target && costs_.work > pilot_share * costs_.foreseen_work) return true;
    return goal_.seconds && costs_.seconds > (goal_.target ? pilot_share_of_limit : pilot_share) * *goal_.seconds;
}

}  // namespace gib
