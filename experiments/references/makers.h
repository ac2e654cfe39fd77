#pragma once
// The methods that make a reference together, and how their images are combined.
//
// A reference of `auto` takes every unbiased method as a maker. A pilot measures for each maker m and component c the
// variance of one pass, relative as the reference's error is and averaged over the image, times the work of a pass:
// V_cm. Work is the number of rays and of camera samples, times MethodDescription::ray_cost, rather than a time, so that
// it is the same in every run on every machine. It need tell the time of a pass only roughly: shares that are off cost
// time and no bias. If maker m gets the share t_m of the work, the combination of its images of c with weights in
// proportion to t_m / V_cm has the least variance, 1 / sum over m of (t_m / V_cm). The shares t_m make the sum over components of
// these variances as small as possible. If that gains little over the best maker, this one does nine tenths of the work. A second
// one always gets a tenth, so that there is something to compare with (agreement.h). Where a maker would weigh less than
// a tenth, it makes none of a component: little is gained by its images, and their rare bright hits might be missing. Weights and shares are fixed before
// the images that they weigh are made, so the combination is unbiased.
//
// Sobol' points make the variance of a pass smaller the more passes a batch has, and a short pilot has few of them. Where it has
// fallen from the pilot's first round to its last beyond doubt, it is taken to fall on by the same power of their number.
//
// Where a maker leaves out paths, a consistent method may make its remainder (MethodDescription::remainder), even if another maker
// needs none: the costs count variance alone, and the bias stands in the reference's error. Both are one maker then, named METHOD+OTHER, whose images carry an estimate of their bias.
//
// A maker that seldom samples a class of bright paths shows no variance until it has found the first of them. Therefore
// the light that it lacks in the pilot, compared with another maker, counts as its variance too: light of mean L that no
// sample of n has found has a variance of at least n L^2 a sample. That is only a bound: a maker that lacks light beyond doubt
// takes no part in the component, if there is another maker that lacks none.

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

/// One maker of a reference.
class ReferenceMaker {
public:
    /// `values` are those of the reference's label. `takes_remainder`: the method's remainder is made too, if the
    /// scene has one and some method can.
    ReferenceMaker(const MethodDescription& method, const MethodLabel& label, const LoadedScene& scene,
                   bool takes_remainder);

    const std::string& name() const { return name_; }
    /// The components some paths of which it leaves out.
    const std::vector<Component>& unresolved() const { return unresolved_; }
    bool makes_remainder() const { return remainder_ != nullptr; }

    /// Makes `passes` passes, calling before_pass() before each. Consistent methods go on where `passes_before` others have
    /// stopped.
    MadeBatch make(std::uint64_t seed, std::uint32_t passes, std::uint64_t passes_before,
                   const std::function<void()>& before_pass) const;

private:
    MadeBatch make(const MethodDescription& method, const MethodLabel& label, std::uint64_t seed, std::uint32_t passes,
                   std::uint64_t passes_before, const std::function<void()>& before_pass) const;

    const LoadedScene& scene_;
    const MethodDescription& method_;
    MethodLabel label_, remainder_label_;
    const MethodDescription* remainder_ = nullptr;  ///< the method that makes the remainder; null: none does
    std::string name_;
    std::vector<Component> unresolved_;
};

/// The part of one maker in each unit of a reference's work.
struct MakerShare {
    std::string method;
    std::uint32_t passes = 1;
    std::array<double, component_count> weights{};  ///< image weights by component; they sum to 1 over the makers

    double& weight(Component c) { return weights[static_cast<std::size_t>(index_of(c))]; }
};

/// Measured in a pilot.
struct MakerPilot {
    std::vector<ComponentImages> groups;             ///< the mean of each group's passes
    std::uint32_t passes = 0;                        ///< number of passes in each group
    std::vector<ComponentImages> first_groups = {};  ///< those of the first round; empty: there was no other round
    std::uint32_t first_passes = 0;
    double work = 0;                    ///< work of all groups (MadeBatch::work)
    std::vector<Component> unresolved;  ///< components that the maker cannot sample
};

struct MakerPlan {
    std::vector<MakerShare> shares;  ///< in the order of the makers; those of 0 passes take no part
    double error2_work = 0;          ///< the predicted squared relative error times the work that it takes
    double unit_work = 0;            ///< work of one unit
    /// By maker: whether a longer pilot can leave it out, because it would get no work even if it cost half of what the pilot
    /// shows. At least two are left.
    std::vector<bool> outdone;
};
/// The plan of least variance. The pilots have the same components. `epsilon` is that of the error [radiance^2]; none:
/// the default (epsilon.h), of the light that the pilots have found. `work` is that of the whole reference, as far as it is known.
MakerPlan plan_of_least_variance(const std::vector<std::string>& methods, const std::vector<MakerPilot>& pilots,
                                 const std::optional<double>& epsilon, double work = 0);

/// Takes a component from the maker `lesser`: the others make it, or `greater` if none of them did.
void leave_to_others(std::vector<MakerShare>& shares, Component c, std::size_t lesser, std::size_t greater);

/// As text, for a reference's metadata, and back; empty if the text is none.
std::string text_of(const std::vector<MakerShare>& shares);
std::vector<MakerShare> shares_in(const std::string& text);

/// The passes of all makers in so many units.
std::uint64_t passes_in(const std::vector<MakerShare>& shares, std::uint64_t units);

/// The images of a unit, and their bias: the weighted sum over its makers.
ComponentImages combined(const std::vector<MakerShare>& shares, const std::vector<ComponentImages>& images);

}  // namespace gib
