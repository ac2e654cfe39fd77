#pragma once
// The settings among which `gibench tune` searches: the parameters that vary, and their values as numbers.

#include "common/core/error.h"
#include "methods/parameters.h"

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gib {

/// A parameter that varies: a number between two ends, or one of several words.
struct TuningAxis {
    std::string name;
    TuningSpan span = {0, 0};             ///< range of a number
    bool is_whole = false;                ///< whether only whole numbers are valid
    std::vector<std::string> words = {};  ///< all values, if it is no number; a value is then the place of its word
    std::optional<double> initial = {};   ///< the default; none: it is no value of this axis
    /// The default lies outside of the declared span, as gather = 0, which turns gathering off.
    bool has_default_apart = false;

    /// The value at a share from 0 to 1 of the span. A default apart from the span has the first quarter.
    double at(double share) const;
    /// The nearest number of two digits.
    double rounded(double value) const;
    std::string text(double value) const;
};

/// A request such as "photons=1e4..1e7" or "cache=on,off".
struct Variation {
    std::string parameter;
    double lower = 0, upper = 0;
    std::vector<std::string> words = {};  ///< values instead of a range; empty: there is a range
    SourceLocation where = {};            ///< place in an experiment file
    /// The name by which a message calls what asks for it.
    const char* source() const { return where.file.empty() ? "--vary" : "vary"; }
};
/// Throws InputError at `where` for a text that is neither.
Variation parse_variation(const std::string& text, const SourceLocation& where = {});

/// The parameters that vary for a method: those with a declared span that `base` does not set, and those of
/// `variations` that the method has, whose ranges count instead of the declared ones. The span of a choice counts its
/// words from 0. Throws InputError for a range that the parameter does not have, and for a parameter that `base` sets.
std::vector<TuningAxis> tuning_axes(const MethodLabel& base, const std::vector<Variation>& variations);

/// A value for each axis. Empty: the default, or a parameter without effect beside the axes before it.
using Setting = std::vector<std::optional<double>>;

/// The settings of one method.
class SearchSpace {
public:
    SearchSpace(MethodLabel base, std::vector<TuningAxis> axes) : base_(std::move(base)), axes_(std::move(axes)) {}

    const MethodLabel& base() const { return base_; }
    const std::vector<TuningAxis>& axes() const { return axes_; }
    Setting defaults() const { return Setting(axes_.size()); }
    /// The label of a setting, with the values that are not the default.
    MethodLabel label(const Setting& setting) const;
    /// The value of an axis that counts: the setting's, else the default; none if the method would refuse one.
    std::optional<double> effective(const Setting& setting, std::size_t axis) const;

    /// The defaults, and `count` settings that cover the axes evenly (Owen-scrambled Sobol' points, sampler.h), without
    /// duplicates.
    std::vector<Setting> cover(int count) const;

private:
    /// The setting with none for the default and for values that the method refuses.
    Setting normal(Setting setting) const;

    MethodLabel base_;
    std::vector<TuningAxis> axes_;
};

/// The label with this value of a parameter, in place of one that it has, else at its end.
MethodLabel with_value(MethodLabel label, const std::string& parameter, const std::string& value);

}  // namespace gib
