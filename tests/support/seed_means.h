#pragma once
// The mean of an image over independent renders of it.

#include "tests/support/moments.h"
#include "tests/support/scene_fixtures.h"

#include <array>
#include <optional>

namespace gib::test {

/// Moments, by channel, of the mean of an image or of its component `only`, over `seeds`
/// renders of `passes` passes each.
inline std::array<Moments, 3> means_over_seeds(const LoadedScene& scene, std::uint32_t passes, int seeds,
                                               std::optional<Component> only = {}, const std::string& method = "path") {
    std::array<Moments, 3> moments;
    for (int seed = 1; seed <= seeds; ++seed) {
        const auto image = render(scene, method, passes, static_cast<std::uint64_t>(seed));
        const Colord mean = mean_of(only ? *image[*only] : image.total());
        for (std::size_t c = 0; c < 3; ++c)
            moments[c].add(mean[static_cast<int>(c)]);
    }
    return moments;
}

}  // namespace gib::test
