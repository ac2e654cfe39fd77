#pragma once
// A method's parameters, declared once: parsing, help, labels and reference keys all read the declaration.

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

struct Parameter {
    enum class Kind { number, integer, choice, text };
    std::string name;
    Kind kind;
    std::string default_value;  ///< as text; empty: stated in `sentence`
    std::string unit;
    double lower = 0, upper = std::numeric_limits<double>::infinity();  ///< inclusive, of numbers
    std::vector<std::string>
        choices;  ///< all values of a choice; of a number, words that stand beside numbers ("auto")
    std::string sentence;
};

/// A method as it is named in tables and on the command line: "photon_mapper photons=1e6 k=50". A name and key=value
/// pairs, only those given, in the order given, numbers as typed.
struct MethodLabel {
    std::string name;
    std::vector<std::pair<std::string, std::string>> values;

    /// Throws InputError at `where` for anything that is not of the form.
    static MethodLabel parse(std::string_view text, const SourceLocation& where = {});
    std::string text() const;
};

/// The values given for a method, checked against its declarations.
class ParameterValues {
public:
    /// Throws InputError at `where`: an unknown key (lists the known ones), a key given twice, a value of the wrong
    /// kind or out of range (says the range).
    ParameterValues(const std::vector<Parameter>& declared, const MethodLabel& label, const SourceLocation& where = {});

    bool given(std::string_view name) const;
    /// The value given, else the default. Integers may be typed as 1e6.
    double number(std::string_view name) const;
    std::int64_t integer(std::string_view name) const;
    std::string choice(std::string_view name) const;
    /// Of a text: empty unless given.
    std::string text(std::string_view name) const;
    /// Empty if the value is one of the words that stand beside numbers.
    std::optional<double> number_unless_word(std::string_view name) const;

private:
    std::vector<Parameter> declared_;
    std::vector<std::pair<std::string, std::string>> values_;
};

// Declarations of the common kinds.

/// A whole number from 0.
Parameter count_parameter(std::string name, std::string initial, std::string unit, std::string meaning);
/// A number from 0 to `most`.
Parameter fraction_parameter(std::string name, std::string initial, std::string unit, double most, std::string meaning);
/// The first of the choices is the default.
Parameter choice_parameter(std::string name, std::vector<std::string> choices, std::string meaning);

/// The choices of an enumeration, by its names in order.
template <std::size_t n>
std::vector<std::string> strings(const std::array<std::string_view, n>& names) {
    return {names.begin(), names.end()};
}
/// The one that was chosen among them.
template <typename Choice, std::size_t n>
Choice chosen(const std::array<std::string_view, n>& names, const std::string& name) {
    return static_cast<Choice>(std::find(names.begin(), names.end(), name) - names.begin());
}

}  // namespace gib
