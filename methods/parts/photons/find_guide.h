#pragma once
// Whether light is guided, which a pilot tells (methods/parts/guiding/light_guide.h).

#include "methods/method.h"
#include "methods/parts/guiding/light_guide.h"

#include <memory>

namespace gib {

inline constexpr std::string_view step_importons = "importons";

enum class Guiding { automatic, on, off };
/// The parameter `guide`, with its default.
Parameter guide_parameter(Guiding unless_given = Guiding::automatic);
Guiding guiding_of(const ParameterValues& values);
/// Adds the step, which is skipped where `why_not` is not empty.
void add_importons(Plan& plan, Guiding guiding, std::string why_not);

/// The guide, if the plan runs importons and either guiding is on or a pilot shows that most light is never used. Adds the
/// rays traced to `rays`.
std::shared_ptr<const LightGuide> find_guide(const Scene& scene, Guiding guiding, const LightUse& use, const Plan& plan,
                                             std::uint64_t seed, StageTimes& stages, std::uint64_t& rays);

/// The fact whether a guide was found.
inline std::pair<std::string, std::string> guide_fact(bool is_guided) { return {"guided", is_guided ? "yes" : "no"}; }

}  // namespace gib
