#pragma once
// Evidence that a reference lacks light: an unbiased method finds more of it than the noise of both explains. Less light is no
// evidence, because a method that has not met rare bright paths yet is too dark and seems to have no noise.

#include "experiments/metrics/z_statistic.h"

#include "common/images/image.h"

#include <optional>
#include <string>
#include <vector>

namespace gib {

enum class Differing { either_way, brighter };

/// The most significant difference of x from r, among blocks of `edge` and 8 `edge` pixels and the whole, or, with `brighter`,
/// among those where x is brighter; empty if none is significant. If x and r are equal but for noise, there is one with a
/// probability of `alpha` at most.
std::optional<BlockTest> significant_difference(const ReferenceLayer& x, const ReferenceLayer& r, double alpha,
                                                Differing differing, int edge = z_block_edge);

/// Place and size of a difference, such as "pixels x 0 to 7, y 8 to 15: 0.1 more, 5.3 standard errors".
std::string text_of(const BlockTest& difference);

struct Contradiction {
    Component component;
    bool is_black = false;  ///< the reference's component is black, and images of the method have light in it
    BlockTest where;        ///< the region, if not black; the deviation is that of the method

    /// Such as "light of caustic, which the reference lacks (pixels ...)".
    std::string text() const;
};

/// The components of a reference that images of a method contradict: every one that is black there and lit in an image; and every
/// one of `unbiased_for`, for which the method is unbiased, where it is brighter beyond doubt. Components that the reference does not
/// resolve anyway are left out. The second kind needs two replicates.
std::vector<Contradiction> contradictions(const Reference& reference, const std::vector<ComponentImages>& replicates,
                                          const std::vector<Component>& unbiased_for);

}  // namespace gib
