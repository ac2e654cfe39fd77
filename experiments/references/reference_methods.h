#pragma once
// The methods that make a reference together, and how their images are combined.
//
// The reference methods of `auto` are the unbiased methods with MethodDescription::makes_references. A pilot measures
// for each method m and component c the variance of one pass, times the work of a pass: V_cm. The variance is relative as
// the reference's error and averaged over the image. Work is the number of rays and of camera samples, times
// MethodDescription::ray_cost: unlike time, it is the same on
// every machine. Wrong work costs time, but no bias. If method m gets the share t_m of the work, the combination of the
// images of c with weights in proportion to t_m / V_cm has the least variance, 1 / sum over m of (t_m / V_cm). The
// shares t_m minimize the sum of these variances over the components. If that gains little over the best method, the
// best method does nine tenths of the work. A second method always gets a tenth, for the comparison of both
// (agreement.h). A method with a weight below a tenth has none in a component: its images gain little, and may lack
// rare bright hits. Weights and shares are fixed before the images are made, so the combination is unbiased.
//
// Sobol' points make the variance of a pass smaller the more passes a batch has, and a short pilot has few of them.
// Where it has fallen from the pilot's first round to its last beyond doubt, it is extrapolated by the same power of
// their number.
//
// For a method that leaves out paths, a consistent method may add the light that only merging finds
// (MethodDescription::remainder). Both count as one reference method, METHOD+OTHER, whose images carry an estimate of
// their bias. Costs count variance alone; the bias is part of the reference's error.
//
// A method that seldom samples a class of bright paths shows no variance until it has found the first of them.
// Therefore light that it lacks in the pilot, compared with another method, counts as variance: light of mean L that
// none of n samples has found has a variance of at least n L^2 a sample. That is only a bound: a method that lacks
// light significantly takes no part in the component, if another method lacks none.

#include "common/reader/scene_file.h"
#include "experiments/metrics/reference_image.h"
#include "experiments/plan/experiment_file.h"
#include "experiments/references/store.h"
#include "methods/method.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// A method that makes a reference, alone or with others.
class ReferenceMethod {
public:
    /// `values` are those of the reference's label. `takes_remainder`: another method adds the light that only
    /// merging finds, if the scene has such light and a method can.
    ReferenceMethod(const MethodDescription& method, const MethodLabel& label, const LoadedScene& scene,
                    bool takes_remainder);

    const std::string& name() const { return name_; }
    /// The components that it samples incompletely.
    const std::vector<Component>& unresolved() const { return unresolved_; }
    bool makes_remainder() const { return remainder_ != nullptr; }

    /// Makes `passes` passes, calling before_pass() before each. Consistent methods go on where `passes_before` others
    /// have stopped.
    MadeBatch make(std::uint64_t seed, std::uint32_t passes, std::uint64_t passes_before,
                   const std::function<void()>& before_pass) const;

private:
    MadeBatch make(const MethodDescription& method, const MethodLabel& label, std::uint64_t seed, std::uint32_t passes,
                   std::uint64_t passes_before, const std::function<void()>& before_pass) const;

    const LoadedScene& scene_;
    const MethodDescription& method_;
    MethodLabel label_, remainder_label_;
    const MethodDescription* remainder_ = nullptr;  ///< the method for light that only merging finds; null: none
    std::string name_;
    std::vector<Component> unresolved_;
};

/// The part of one method in a unit of work, the least that a group of a reference is made of: some passes of each of its
/// methods, one pass if it has one method.
struct MethodShare {
    std::string method;
    std::uint32_t passes = 1;
    std::array<double, component_count> weights{};  ///< image weights by component; they sum to 1 over the methods

    double& weight(Component c) { return weights[static_cast<std::size_t>(index_of(c))]; }
};

/// Measured in a pilot.
struct MethodPilot {
    std::vector<ComponentImages> groups;             ///< the mean of each group's passes
    std::uint32_t passes = 0;                        ///< number of passes in each group
    std::vector<ComponentImages> first_groups = {};  ///< of the first round; empty: there was no other round
    std::uint32_t first_passes = 0;
    double work = 0;                    ///< work of all groups (MadeBatch::work)
    std::vector<Component> unresolved;  ///< components that the method samples incompletely
};

struct ReferencePlan {
    std::vector<MethodShare> shares;  ///< in the order of the methods; 0 passes: takes no part
    double error2_work = 0;           ///< the predicted squared relative error times the work that it takes
    double unit_work = 0;             ///< work of one unit
    /// By method: whether a longer pilot can leave it out, because it would get no work even at half of its cost in the
    /// pilot. At least two remain.
    std::vector<bool> outdone;
};
/// The plan of least variance. The pilots have the same components. `epsilon` is that of the error [radiance^2]; none:
/// the default (epsilon.h), of the light that the pilots have found. `work` is that of the whole reference, as far as
/// it is known.
ReferencePlan plan_of_least_variance(const std::vector<std::string>& methods, const std::vector<MethodPilot>& pilots,
                                     const std::optional<double>& epsilon, double work = 0);

/// Takes a component from the method `lesser`: the others make it, or `greater` if none of them did. Those that make it
/// get at least as many passes as `lesser`, because all rounds begin again.
void leave_to_others(std::vector<MethodShare>& shares, Component c, std::size_t lesser, std::size_t greater);

/// As text, for a reference's metadata, and back; empty if the text is none.
std::string text_of(const std::vector<MethodShare>& shares);
std::vector<MethodShare> shares_in(const std::string& text);

/// The passes of all methods in so many units.
std::uint64_t passes_in(const std::vector<MethodShare>& shares, std::uint64_t units);

/// The images of a unit, and their bias: the weighted sum over its methods.
ComponentImages combined(const std::vector<MethodShare>& shares, const std::vector<ComponentImages>& images);

}  // namespace gib
