#pragma once
// The parameters of a method, each declared once: parsing, help texts, labels and reference
// keys all read the declaration.

#include "common/core/error.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gib {

/// The values among which a search for the cheapest settings looks (`gibench tune`), in the parameter's unit. Both ends
/// lie in the parameter's range.
struct TuningSpan {
    double lower, upper;
    bool is_logarithmic = true;  ///< whether steps are factors, else differences
};

/// The declaration of one parameter.
struct Parameter {
    enum class Kind { number, integer, choice, text };
    std::string name;
    Kind kind;
    std::string default_value;  ///< as text; empty if `sentence` states the default
    std::string unit;
    double lower = 0, upper = std::numeric_limits<double>::infinity();  ///< range of a number, inclusive
    /// All values of a choice; or the words that a number may be replaced by ("auto").
    std::vector<std::string> choices = {};
    std::string sentence;
    /// Set if the number trades time for accuracy.
    std::optional<TuningSpan> tuning = {};
};

/// The values that a parameter may have, as text.
std::string range_of(const Parameter& parameter);

/// The name of a method with its settings, as in tables and on the command line: "photon_mapper photons=1e6 k=50". It
/// holds only the pairs key=value that were given, in the order given, with numbers as typed.
struct MethodLabel {
    std::string name;
    std::vector<std::pair<std::string, std::string>> values;

    /// Throws InputError at `where` if the text is not a name followed by pairs key=value.
    static MethodLabel parse(std::string_view text, const SourceLocation& where = {});
    std::string text() const;
};

/// The values given for a method, checked against its declarations.
class ParameterValues {
public:
    /// Throws InputError at `where` for an unknown key (the message lists the known ones), for a key given twice, and
    /// for a value of the wrong kind or out of range (the message states the range).
    ParameterValues(const std::vector<Parameter>& declared, const MethodLabel& label, const SourceLocation& where = {});

    bool given(std::string_view name) const;
    /// The value given, else the default. An integer may be typed as 1e6. number() and integer() need a
    /// value that is no word.
    double number(std::string_view name) const;
    std::int64_t integer(std::string_view name) const;
    std::string choice(std::string_view name) const;
    /// The value as text; if none was given, the declared default, which is empty for parameters of the kind `text`.
    std::string text(std::string_view name) const;
    /// The number, or empty if the value is one of the words that may replace a number.
    std::optional<double> number_unless_word(std::string_view name) const;
    /// Throws InputError if one of `names` is given although `setting`, such as "gather=0", leaves it without effect.
    void refuse(const std::vector<std::string>& names, std::string_view setting) const;

private:
    std::vector<Parameter> declared_;
    std::vector<std::pair<std::string, std::string>> values_;
};

// Declarations of the common kinds; `meaning` is the parameter's sentence.

/// Declares a number from `lower` to `upper`.
Parameter number_parameter(std::string name, std::string initial, std::string unit, double lower, double upper,
                           std::string meaning);
/// Declares a whole number from `lower` to `upper`; `words` may replace it.
Parameter integer_parameter(std::string name, std::string initial, std::string unit, double lower, double upper,
                            std::string meaning, std::vector<std::string> words = {});
/// Declares a whole number from 0 to 4e9.
Parameter count_parameter(std::string name, std::string initial, std::string unit, std::string meaning);
/// Declares a choice, whose default is the first of the choices.
Parameter choice_parameter(std::string name, std::vector<std::string> choices, std::string meaning);

/// The same declaration with the values that are worth a search.
Parameter tuned(Parameter parameter, const TuningSpan& span);

/// The names of an enumeration's values as the choices of a parameter.
template <std::size_t n>
std::vector<std::string> strings(const std::array<std::string_view, n>& names) {
    return {names.begin(), names.end()};
}
/// The names of the parameters of a list.
std::vector<std::string> names_of(const std::vector<Parameter>& parameters);
/// The value of the enumeration whose name was chosen; `names` stand in the order of the values.
template <typename Choice, std::size_t n>
Choice chosen(const std::array<std::string_view, n>& names, const std::string& name) {
    return static_cast<Choice>(std::find(names.begin(), names.end(), name) - names.begin());
}

}  // namespace gib
