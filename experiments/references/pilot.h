#pragma once
// The pilot of a reference with several methods: it measures them and decides their shares (reference_methods.h has the
// theory).
//
// It makes few images of several passes each, rather than the reference's groups, because Sobol' points are better the
// more of them a pixel gets. Each of its rounds has twice the passes of the one before, and leaves out methods that
// the one before has shown to get no work. It ends after a few per cent of the predicted work of the reference.

#include "experiments/plan/experiment_file.h"
#include "experiments/references/reference_methods.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// The costs of the pilot, and the work that it foresees.
struct PilotCosts {
    double seconds = 0, work = 0;  ///< of the pilot
    double unit_work = 0;          ///< work of a unit of all groups of the reference
    double foreseen_work = 0;      ///< work up to the target; 0: unknown
};

class Pilot {
public:
    Pilot(const std::vector<ReferenceMethod>& methods, const ReferenceGoal& goal, const std::optional<double>& epsilon);

    /// The batches of the next round.
    std::vector<ReferenceBatch> next_batches() const;
    /// Makes the next round with `make` and decides the shares by it; `show` receives the name of the tried method.
    /// Returns false after the last round.
    bool add_round(const MakeBatch& make, const std::function<void(const std::string& method)>& show);

    const PilotCosts& costs() const { return costs_; }
    const std::vector<MethodShare>& shares() const { return shares_; }
    const DroppedSamples& dropped() const { return dropped_; }
    /// The groups of a method's last round.
    const std::vector<ComponentImages>& groups_of(std::size_t method) const { return pilots_[method].groups; }

private:
    void decide_shares();
    /// Whether enough of the reference's work is done to know the shares.
    bool is_enough() const;

    const ReferenceGoal& goal_;
    std::optional<double> epsilon_;
    std::vector<std::string> names_;
    std::vector<MethodPilot> pilots_;
    std::vector<bool> outdone_;
    std::uint32_t round_ = 0;
    PilotCosts costs_;
    std::vector<MethodShare> shares_;
    DroppedSamples dropped_;
};

}  // namespace gib
