#pragma once
// Renders one hard case by one method and judges whether its images have the radiance that theory gives.

#include "experiments/hard_cases/hard_case_file.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// The result of rendering one case by one method with several seeds.
struct HardCaseImages {
    std::string refusal;           ///< message of the error if scene or method was refused; the rest is then unused
    Effects missing;               ///< effects of the scene that the method leaves out; if any, nothing is rendered
    std::vector<double> means;     ///< of each seed's image, over pixels and channels [W/(sr m^2)]
    double smallest = 0;           ///< smallest mean over the channels of any pixel [W/(sr m^2)]
    double largest = 0;            ///< largest one
    std::uint64_t not_finite = 0;  ///< number of such image values and of dropped samples
    std::uint64_t negative = 0;    ///< number of such image values
    double seconds = 0;
};

/// Renders the case with seeds 1 to `seeds` on `threads` threads. An InputError is not thrown on; its message is
/// returned as `refusal`.
HardCaseImages render_hard_case(const HardCase& hard, const MethodLabel& method, int seeds, int threads);

nlohmann::json to_json(const HardCaseImages& images);
HardCaseImages images_from_json(const nlohmann::json& j);

enum class Verdict {
    holds,
    fails,
    unresolved,  ///< the noise hides whether it holds
    left_out,    ///< the method does not simulate an effect that the scene calls for
    not_judged,  ///< the file excludes the method and says why
};
std::string_view name_of(Verdict verdict);

struct HardCaseVerdict {
    Verdict verdict = Verdict::holds;
    std::optional<double> got;  ///< mean of the seeds' means [W/(sr m^2)]
    double half_width = 0;      ///< of the interval around `got`, which misses the true mean with probability `tail`
    std::string why;            ///< what is wrong, left out or refused; empty if a number holds
};

/// The reason for which the file excludes the method from this case; empty if it does not.
std::optional<std::string> exclusion(const HardCase& hard, const MethodLabel& method);

/// Judges a case. The means of the seeds' images scatter around the method's true mean with Student's t distribution,
/// however the pixels of one image are correlated. The interval of their mean misses the true mean with probability
/// `tail`, both sides together. The case holds if the interval contains the answer within its accuracy and has a half
/// width of at most `resolve` times the answer. With `at_most` and `at_least`, the interval has to end within
/// `resolve` of the bounds instead. No pixel may be negative or not finite, and with `black` every pixel has to be 0.
/// A method that leaves out effects is not tested; it fails unless `may_leave_out` has all of them.
HardCaseVerdict judge(const HardCase& hard, const HardCaseImages& images, double tail, double resolve,
                      Effects may_leave_out = {});

}  // namespace gib
