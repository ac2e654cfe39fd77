#pragma once
// The doubts about a reference: methods that lack light, components that no method samples or that a pilot contradicts,
// and noise of uncertain size.

#include "experiments/references/agreement.h"
#include "experiments/references/pilot.h"
#include "experiments/references/reference_methods.h"
#include "experiments/references/rounds.h"

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace gib {

class Verdicts {
public:
    explicit Verdicts(const std::vector<ReferenceMethod>& methods);

    /// The components that the reference lacks or in which it is contradicted.
    const std::vector<Component>& unresolved() const { return unresolved_; }

    /// Goes on from the tests of an earlier session (MethodAgreement::read()). `unresolved`: the stored reference's
    /// components, used if the pilots' images are lost; null: it has none.
    void read(const std::string& file, const std::string& state, const std::string* unresolved);
    void write(const std::string& file, const std::string& state) const { agreement_.write(file, state); }
    void keep_pilot(const Pilot& pilot);
    /// Keeps the images of a round that had so many units in each group.
    void keep_round(const RoundImages& images, const std::vector<MethodShare>& shares, std::uint32_t units);

    /// If two methods disagree about a component, the one with less light is removed from it: returns true, and
    /// `shares` have changed. The reference has to begin again with new seeds, so that weights do not depend on the
    /// images that they weigh.
    bool leaves_out_lacking(std::vector<MethodShare>& shares);
    /// Removes the components about which a pilot and the finished reference disagree. Returns whether there are any.
    bool compare_with_pilots(const Rounds& rounds);

    /// The remarks on the finished reference, made by a label whose first method is `method`.
    std::vector<std::string> warnings(const Rounds& rounds, const MethodLabel& label,
                                      const MethodDescription& method) const;

private:
    const std::vector<ReferenceMethod>& methods_;
    std::vector<Component> unresolved_;
    MethodAgreement agreement_;
    std::vector<std::string> lacking_;                   ///< disagreements of methods or pilots
    std::set<std::pair<std::size_t, Component>> lacks_;  ///< components in which methods lack light
};

}  // namespace gib
