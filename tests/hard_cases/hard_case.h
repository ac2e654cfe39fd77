#pragma once
// The hard cases: scenes at the ends of their ranges, whose mean radiance is known from theory. hard-cases.toml lists
// them and explains its keys.

#include "common/core/math.h"
#include "common/scene/effects.h"
#include "methods/parameters.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gib::test {

/// How the mean radiance of an image has to relate to the expected one. `refused`: the scene must give an error.
enum class Relation { equal, at_most, black, refused };

struct HardCase {
    std::string name;   ///< with the swept parameters: `glass eta=3`
    std::string scene;  ///< path of its file
    std::map<std::string, std::string> parameters;
    Relation relation = Relation::equal;
    double expected = 0;   ///< [W/(sr m^2)] mean over pixels and channels
    double at_least = 0;   ///< lower bound beside `at_most` [W/(sr m^2)]; 0: none
    double accuracy = 0;   ///< relative, of `expected`: error of its formula and of the renderer's rounding
    std::string refusal;   ///< text that the message of a refusal has to contain
    std::string reason;    ///< why that is the answer
    std::uint32_t passes;  ///< samples a pixel
    int seeds;             ///< seeds 1 to this are rendered
    bool every_pixel;      ///< whether the answer holds for each pixel
    std::map<std::string, std::string> without;  ///< part of a label -> why such methods are not tested
};

struct HardCases {
    double alpha, resolve;
    std::map<std::string, std::string> methods;  ///< name in the tests -> label
    std::map<std::string, Effects> leaves_out;   ///< part of a label -> what such methods may leave out
    std::vector<HardCase> cases;

    /// The probability with which each verdict may be wrong, so that at least one of all verdicts is wrong with
    /// probability at most `alpha` (Bonferroni).
    double tail() const { return alpha / static_cast<double>(cases.size() * methods.size()); }
};

/// Throws InputError (`file:line:column: message`) if the file is wrong.
HardCases load_hard_cases(const std::string& path);

/// The value whose key is a part of the label.
template <typename Value>
std::optional<Value> value_for(const std::map<std::string, Value>& by_part, const std::string& label) {
    for (const auto& [part, value] : by_part)
        if (label.find(part) != std::string::npos) return value;
    return std::nullopt;
}

/// The result of rendering one case by one method with several seeds.
struct HardCaseImages {
    std::string refusal;           ///< message of the error if scene or method was refused; the rest is then unused
    Effects missing;               ///< effects that the method leaves out; nothing is rendered if is_left_out()
    std::vector<double> means;     ///< mean of each seed's image, over pixels and channels [W/(sr m^2)]
    double smallest = infinity;    ///< smallest mean over the channels of any pixel [W/(sr m^2)]
    double largest = -infinity;    ///< largest one
    std::uint64_t not_finite = 0;  ///< number of such image values and of dropped samples
    std::uint64_t negative = 0;    ///< number of such image values
};
/// Whether a method without these effects cannot be held to the answer. What is black stays black without some of the
/// light, but not without the medium that absorbs it.
inline bool is_left_out(const HardCase& hard, Effects missing) {
    return !missing.empty() && (hard.relation != Relation::black || missing.has(Effect::participating_media));
}
HardCaseImages render(const HardCase& hard, const std::string& label);

struct Verdict {
    std::string problem;    ///< reason why the case fails; empty if it holds
    double got = 0;         ///< mean of the seeds' means [W/(sr m^2)]
    double half_width = 0;  ///< half the interval around `got`, which misses the true mean with probability `tail`
};

/// Judges a case. The means of the seeds' images scatter around the method's true mean with Student's t distribution,
/// however the pixels of one image are correlated. The interval of their mean misses the true mean with probability
/// `tail`, both sides together. The case holds if the interval contains the answer within its accuracy and has a half
/// width of at most `resolve` times the answer. With `at_most` and `at_least`, the interval has to end within
/// `resolve` of the bounds instead. No pixel may be negative or not finite, and with `black` every pixel has to be 0.
Verdict judge(const HardCase& hard, const HardCaseImages& images, double tail, double resolve);

}  // namespace gib::test
