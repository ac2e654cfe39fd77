#pragma once
// The hard cases: scenes at the ends of their ranges, whose mean radiance is known from theory. hard-cases.toml lists
// them and explains its keys.

#include "common/core/math.h"
#include "tests/support/methods_under_test.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace gib::test {

/// How the mean radiance of an image has to relate to the expected one. `refused`: the scene must give an error;
/// `not_above`: at_most, but the interval around the mean may be wide.
enum class Relation { equal, at_most, not_above, black, refused };

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
    bool seldom;           ///< whether paths from the lights alone seldom reach what the camera sees
    std::vector<std::string> variants;  ///< of look_up_variants(), which are tested, too; `all` stands for all of them
    std::map<std::string, std::uint32_t>
        passes_with;                             ///< pass of a plan -> instead of `passes` for methods that run it
    std::map<std::string, std::string> without;  ///< pass of a plan -> why methods that run it are not tested

    std::uint32_t passes_of(const MethodUnderTest& method) const;
    bool is_for(const MethodUnderTest& method) const;
    /// Whether the variant is tested: one that is named always, as one of `all` where its method would be.
    bool is_for_variant(const MethodUnderTest& variant) const;
};

struct HardCases {
    double alpha, resolve;
    std::vector<HardCase> cases;
};

/// Throws InputError (`file:line:column: message`) if the file is wrong.
HardCases load_hard_cases(const std::string& path);

/// The case as the method is held to it. What is black stays black without some of the light, but not without the medium
/// that absorbs it. Unbiased methods that leave out paths are at least not too bright. So are paths from the lights alone
/// where they seldom reach what the camera sees, and on glossy surfaces, which they seldom leave towards the camera. Empty
/// if the method cannot be held to the answer, as it leaves out effects.
std::optional<HardCase> case_for(const HardCase& hard, const MethodUnderTest& method, const Plan& plan);

/// The scene of a case, which is kept until that of another case is asked for. Throws InputError if it is refused.
const LoadedScene& scene_of(const HardCase& hard);

/// The result of rendering one case by one method with several seeds.
struct HardCaseImages {
    std::string refusal;           ///< message of the error if scene or method was refused; the rest is then unused
    std::vector<double> means;     ///< mean of each seed's image, over pixels and channels [W/(sr m^2)]
    double smallest = infinity;    ///< smallest mean over the channels of any pixel [W/(sr m^2)]
    double largest = -infinity;    ///< largest one
    std::uint64_t not_finite = 0;  ///< number of such image values and of dropped samples
    std::uint64_t negative = 0;    ///< number of such image values
};

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

/// Renders and judges a case as case_for() gives it. Methods of paths from the lights alone are noisier than others. If
/// the case does not hold for them, four times as many passes are tried, and so on, up to 64 times as many. A wrong
/// verdict is not more probable for that, since the last attempt would have to fail, too.
Verdict render_and_judge(const HardCase& hard, const MethodUnderTest& method, double tail, double resolve);

}  // namespace gib::test
