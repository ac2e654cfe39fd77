#pragma once
// How noisy each method is for its work: noise.toml has a row for each idea whose loss would leave all means as they are.
// The head of that file defines the figure of a row and its range.

#include "methods/method.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gib::test {

struct NoiseRow {
    std::string name;   ///< of the test
    std::string label;  ///< method with its settings
    std::string scene;  ///< path of its file
    std::map<std::string, std::string> parameters;
    std::pair<int, int> resolution;      ///< width and height [pixels]
    std::optional<Component> component;  ///< the figure is that of this component; none: of the total
    std::uint32_t passes;
    std::uint64_t seeds;  ///< replicates of a look
    bool trimmed;         ///< the noisiest 0.2 % of the pixels are left out
    bool quick;           ///< belongs to the quick tests
    std::string idea;     ///< what would make the row noisier if it were lost
    double figure;        ///< as it should be
    double scatter;       ///< standard deviation of the figure's logarithm from look to look

    /// The least and the largest figure of a look that agrees.
    std::pair<double, double> range() const;
};

/// Throws InputError (`file:line:column: message`) if the file is wrong.
std::vector<NoiseRow> load_noise_table(const std::string& path);

/// One look at a row.
struct NoiseLook {
    double variance = 0;  ///< of the image, relative
    double rays = 0;      ///< for a pixel and a pass
    double figure() const { return variance * rays; }
};
/// The look by the row's number of seeds, from `first_seed` on.
NoiseLook look_at(const NoiseRow& row, std::uint64_t first_seed);

/// The relative variance of images of one truth: the mean over pixels and channels of s^2 / (m^2 + epsilon), where m and s^2 are the
/// mean and the variance over the images, and epsilon is the square of a tenth of the mean luminance of m.
double relative_variance(const std::vector<Image>& images, bool trimmed);

/// The probability with which a row fails if its figure is `factor` times what it should be. A row fails if two independent looks are
/// outside its range; the logarithm of a look's figure is taken to be normal.
double failure_probability(const NoiseRow& row, double factor);

}  // namespace gib::test
