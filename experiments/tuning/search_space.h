#pragma once
// The settings among which `gibench tune` searches: the parameters that vary, and labels with values of them.

#include "common/core/error.h"
#include "methods/parameters.h"

#include <string>
#include <vector>

namespace gib {

/// A parameter that varies: a number between two ends, or one of several words.
struct TuningAxis {
    std::string name;
    TuningSpan span = {0, 0};             ///< range of a number
    double least = 0, most = 0;           ///< the parameter's own range, which steps beyond the span may use
    bool is_whole = false;                ///< whether only whole numbers are valid
    std::vector<std::string> words = {};  ///< all values, if it is no number
    std::string initial = "";             ///< the default as text; may be empty
    /// The default lies outside of the declared span, as gather = 0, which turns gathering off.
    bool has_default_apart = false;

    /// The value at a share from 0 to 1 of the span, as text: numbers with two digits. A default apart from the span has
    /// the first quarter.
    std::string at(double share) const;
    /// `value` as text, within the parameter's range.
    std::string text_of(double value) const;
};

/// A request such as "photons=1e4..1e7" or "cache=on,off".
struct Variation {
    std::string parameter;
    double lower = 0, upper = 0;
    std::vector<std::string> words = {};  ///< values instead of a range; empty: there is a range
    SourceLocation where = {};            ///< place in an experiment file
};
/// Throws InputError at `where` for a text that is neither.
Variation parse_variation(const std::string& text, const SourceLocation& where = {});

/// The parameters that vary for a method: those with a declared span that `base` does not set, and those of
/// `variations` that the method has, whose ranges count instead of the declared ones. The span of a choice counts its
/// words from 0. Throws InputError for a range that the parameter does not have, and for a parameter that `base` sets.
std::vector<TuningAxis> tuning_axes(const MethodLabel& base, const std::vector<Variation>& variations);

/// The label with this value of a parameter, in place of one that it has, else at its end.
MethodLabel with_value(MethodLabel label, const std::string& parameter, const std::string& value);

/// `count` labels that cover the axes evenly (Owen-scrambled Sobol' points, sampler.h), after the method's defaults and
/// without duplicates. A value that the method refuses beside those of the axes before it is left out, as that of a
/// parameter of the cache where the cache is off.
std::vector<MethodLabel> candidates(const MethodLabel& base, const std::vector<TuningAxis>& axes, int count);

/// The labels in which one number, and those that follow it (TuningSpan), is half or twice as large, as far as its range
/// allows, and those with another word; values that the method then refuses are left out. A value that `label` lacks is the
/// default; a parameter without a default number has no neighbours there.
std::vector<MethodLabel> neighbours(const MethodLabel& label, const std::vector<TuningAxis>& axes);

/// `label` with the first change of each axis among `better`, which differ from it by one step each, the best first.
MethodLabel with_all_changes(const MethodLabel& label, const std::vector<MethodLabel>& better,
                             const std::vector<TuningAxis>& axes);

/// `to` with each number that differs from that of `from` changed by the same factor again, as far as its range allows.
MethodLabel with_change_repeated(const MethodLabel& from, const MethodLabel& to, const std::vector<TuningAxis>& axes);

/// The value of an axis that counts for this label: its own, else the default; empty if the method would refuse one.
std::string effective_value(const MethodLabel& label, const TuningAxis& axis);

}  // namespace gib
