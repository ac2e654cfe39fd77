#include "experiments/references/rounds.h"

#include "common/core/math.h"
#include "experiments/metrics/denominators.h"
#include "experiments/metrics/epsilon.h"

#include <algorithm>
#include <utility>

namespace gib {

namespace {

/// A reference ends when its squared error is so many of its own standard errors below the target.
constexpr double stopping_margin = 1;

}  // namespace

Rounds::Rounds(const std::vector<ReferenceMethod>& methods, const ReferenceGoal& goal, std::optional<double> epsilon)
    : goal_(goal), epsilon_(epsilon), schedule_(goal) {
    for (const ReferenceMethod& method : methods) {
        shares.push_back({method.name(), 1, {}});
        shares.back().weights.fill(1);
    }
}

void Rounds::estimate() {
    reference_ = groups.reference();
    used_epsilon_ = epsilon_of(epsilon_, reference_.total.mean);
    const ReferenceLayer& total = reference_.total;
    const Denominators denominators(total, used_epsilon_);
    const SampleMean variance = denominators.variance_of(total);
    error_ = {.square = variance.value + sqr(relative_bias(total, denominators)),
              .scatter = std::sqrt(variance.variance.variance),
              .plain = relative_standard_error(total, Denominators(total.mean, used_epsilon_))};
}

ReferenceState Rounds::state() const {
    return {.rounds = groups.rounds,
            .units = groups.units,
            .error = error_.up_to(stopping_margin),
            .work = groups.work,
            .seconds = groups.seconds,
            .pilot_seconds = pilot.seconds,
            .pilot_work = pilot.work,
            .unit_work = pilot.unit_work,
            .foreseen_work = pilot.foreseen_work};
}

std::pair<double, double> Rounds::progress(double units_of_round) const {
    const double done = static_cast<double>(groups.units) + units_of_round, seconds = groups.seconds;
    double fraction = 0, left = infinity;
    if (goal_.target && groups.units > 0) {
        const double all = static_cast<double>(groups.units) + schedule_.units_needed(state(), shares);
        fraction = done / all;
        left = seconds * (all - done) / static_cast<double>(groups.units);
    }
    if (goal_.seconds && left > *goal_.seconds - seconds) {
        left = std::max(0.0, *goal_.seconds - seconds);
        fraction = seconds / (seconds + left + 1e-9);
    }
    return {fraction, left};
}

RoundImages Rounds::add(const MakeBatch& make, const std::function<void(double units)>& show) {
    const std::uint32_t units = next_units();
    const bool is_shared = shares.size() > 1;
    RoundImages by_method(shares.size());
    DroppedSamples dropped = groups.dropped;
    double seconds = 0, work = 0;
    std::vector<ComponentImages> round, group(shares.size());  // images of one group, by method
    const std::vector<ReferenceBatch> all = next_batches();
    for (std::size_t i = 0; i < all.size(); ++i) {
        show(static_cast<double>(i) / static_cast<double>(all.size()) * units);
        MadeBatch batch = make(all[i]);
        group[all[i].method] = std::move(batch.images);
        dropped.add(batch.dropped);
        seconds += batch.seconds;
        work += batch.work;
        if (i + 1 < all.size() && all[i + 1].number == all[i].number) continue;
        round.push_back(is_shared ? combined(shares, group) : group.front());
        for (std::size_t m = 0; is_shared && m < shares.size(); ++m)
            if (shares[m].passes > 0) by_method[m].push_back(std::move(group[m]));
    }
    groups.add_round(round, units);
    groups.dropped = dropped;
    groups.seconds += seconds;
    groups.work += work;
    return by_method;
}

void Rounds::restart() {
    pilot.work += groups.work;
    groups.restart();
    pilot.seconds = groups.seconds;
}

}  // namespace gib
