#pragma once
// One hard case by one method: its images, and whether they are the answer.

#include "experiments/hard_cases/hard_case_file.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// What came of a case, seed by seed.
struct HardCaseImages {
    std::string refusal;        ///< the message if the scene or the method was refused; then there is nothing else
    Effects missing;            ///< that the scene calls for and the method leaves out; then there is nothing else
    std::vector<double> means;  ///< [W/(sr m^2)] of each seed's image, over pixels and channels
    double smallest = 0;        ///< of all pixels' means over the channels
    double largest = 0;
    std::uint64_t not_finite = 0;  ///< values of images, and samples that were dropped
    std::uint64_t negative = 0;    ///< values of images
    double seconds = 0;
};

/// Renders the case with seeds 1 to `seeds`.
HardCaseImages render_hard_case(const HardCase& hard, const MethodLabel& method, int seeds, int threads);

nlohmann::json to_json(const HardCaseImages& images);
HardCaseImages images_from_json(const nlohmann::json& j);

enum class Verdict {
    holds,
    fails,
    unresolved,  ///< the noise hides whether it holds
    left_out,    ///< the method does not simulate what the scene calls for
    not_judged,  ///< the file says why
};
std::string_view name_of(Verdict verdict);

struct HardCaseVerdict {
    Verdict verdict = Verdict::holds;
    std::optional<double> got;  ///< mean of the seeds' means
    double half_width = 0;      ///< of the interval around it that misses the true mean with probability `tail`
    std::string why;            ///< where it does not hold: what is wrong
};

/// Why the file excludes the method from this case, if it does.
std::optional<std::string> exclusion(const HardCase& hard, const MethodLabel& method);

/// The seeds' means scatter around the method's true mean with Student's t distribution, whatever is correlated within
/// one image. What is tested: that the interval (leaving out `tail`, both sides together) holds the answer within its
/// accuracy, and that its half width is at most `resolve` of the answer (for `at_most` and `at_least`, that it ends at
/// most that far outside of them); that no pixel is negative or not finite; for `black`, that every pixel is 0. Nothing
/// is tested where the method leaves out effects, and fails if these are not all among `may_leave_out`.
HardCaseVerdict judge(const HardCase& hard, const HardCaseImages& images, double tail, double resolve,
                      Effects may_leave_out = {});

}  // namespace gib
