#include "experiments/references/verdicts.h"

#include "experiments/metrics/denominators.h"
#include "experiments/metrics/few_hits.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

namespace gib {

namespace {

/// If one group carries more than this share of the scatter, the standard error is unreliable; Gaussian noise gives
/// about 0.27 (dominance_of_one_group()).
constexpr double heavy_tail_share = 0.5;
/// Noise is skewed if the plain formula of the standard error, with the image's own noise in the denominator, differs
/// from the one that is free of it by this factor.
constexpr double skewed_by = 1.25;

/// Remarks on the standard error of a reference.
std::vector<std::string> warnings_of_noise(const Rounds& rounds) {
    std::vector<std::string> warnings;
    const ReferenceError& error = rounds.error();
    const double skew = error.plain > 0 ? error.value() / error.plain : 1;
    if (skew > skewed_by || skew < 1 / skewed_by)
        warnings.push_back(
            fmt::format("the reference's noise is skewed: its error is {:.3g} %, up to {:.3g} %; with its own noise in "
                        "the denominator "
                        "it would be {:.3g} %",
                        100 * error.value(), 100 * error.up_to(2), 100 * error.plain));
    const double share = dominance_of_one_group(rounds.reference().total.groups);
    if (share > heavy_tail_share)
        warnings.push_back(
            fmt::format("heavy tails: one group of {} carries {:.0f} % of the reference's scatter; its standard "
                        "error is uncertain",
                        reference_groups, 100 * share));
    return warnings;
}

}  // namespace

Verdicts::Verdicts(const std::vector<ReferenceMethod>& methods)
    : methods_(methods), unresolved_(all_components.begin(), all_components.end()), agreement_(methods.size()) {
    for (const ReferenceMethod& method : methods)
        std::erase_if(unresolved_, [&](Component c) { return !contains(method.unresolved(), c); });
}

void Verdicts::read(const std::string& file, const std::string& state, const std::string* unresolved) {
    agreement_.read(file, state);
    if (unresolved && !agreement_.has_pilots()) unresolved_ = components_named(*unresolved);
}

void Verdicts::keep_pilot(const Pilot& pilot) {
    for (std::size_t m = 0; m < methods_.size(); ++m)
        agreement_.set_pilot(m, pilot.groups_of(m));
}

void Verdicts::keep_round(const RoundImages& images, const std::vector<MethodShare>& shares, std::uint32_t units) {
    for (std::size_t m = 0; m < methods_.size(); ++m)
        if (!images[m].empty()) agreement_.add(m, images[m], units * shares[m].passes);
}

bool Verdicts::leaves_out_lacking(std::vector<MethodShare>& shares) {
    const auto samples = [&](std::size_t m, Component c) {
        return !contains(methods_[m].unresolved(), c) && !lacks_.count({m, c});
    };
    const std::vector<Disagreement> all = agreement_.between_methods(samples);
    const auto found = std::ranges::find_if(
        all, [&](const Disagreement& one) { return shares[one.lesser()].weight(one.component) > 0; });
    if (found == all.end()) return false;
    const Component c = found->component;
    lacks_.emplace(found->lesser(), c);
    leave_to_others(shares, c, found->lesser(), found->greater());
    lacking_.push_back(fmt::format("'{}' lacks light of {} that '{}' has found: {}; it was not used for that light",
                                   shares[found->lesser()].method, name_of(c), shares[found->greater()].method,
                                   text_of(found->where)));
    agreement_.restart();
    return true;
}

bool Verdicts::compare_with_pilots(const Rounds& rounds) {
    const auto all = agreement_.with_pilots(rounds.groups.groups());
    for (const Disagreement& found : all) {
        if (!contains(unresolved_, found.component)) unresolved_.push_back(found.component);
        lacking_.push_back(fmt::format("'{}' has found light of {} that the reference lacks: {}; no verdict on it",
                                       rounds.shares[found.a].method, name_of(found.component), text_of(found.where)));
    }
    return !all.empty();
}

std::vector<std::string> Verdicts::warnings(const Rounds& rounds, const MethodLabel& label,
                                            const MethodDescription& method) const {
    std::vector<std::string> all = lacking_;
    std::ranges::move(notes_of_few_hits(rounds.reference()), std::back_inserter(all));
    std::vector<std::string_view> names;
    for (Component c : unresolved_)
        names.push_back(name_of(c));
    if (!names.empty())
        all.push_back(fmt::format("not sampled by '{}': {}; no verdict on it", label.text(), fmt::join(names, ", ")));
    const ReferenceLayer& total = rounds.reference().total;
    const double bias = total.bias.empty() ? 0 : relative_bias(total, {total, rounds.epsilon()});
    if (bias > 0)
        all.push_back(
            fmt::format("merging has biased the reference by an estimated {:.2g} %, which its error and all intervals "
                        "include",
                        100 * bias));
    else if (total.bias.empty() && !method.unbiased)
        all.push_back(fmt::format("the reference's method '{}' is biased: its standard error does not hold the bias",
                                  label.text()));
    if (const DroppedSamples& dropped = rounds.groups.dropped; dropped.count > 0)
        all.push_back(fmt::format("{} samples of the reference were not finite and were dropped; first: {}",
                                  dropped.count, dropped.first));
    std::ranges::move(warnings_of_noise(rounds), std::back_inserter(all));
    return all;
}

}  // namespace gib
