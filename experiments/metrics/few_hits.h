#pragma once
// Where a reference rests on few hits. If N hits of equal height, in N of m groups, make a pixel, then its squared mean
// is N (m - 1) / (m - N) squared standard errors: 5 for 4 of 16, 6.8 for 5. Where rare bright paths carry the light,
// most pixels lack them: they are too dark, and their standard errors, which come from dim hits alone, are too small.
// Only images of other methods show the missing light.

#include "experiments/metrics/reference_image.h"

#include <string>
#include <vector>

namespace gib {

/// A pixel with fewer hits has an unreliable standard error: the 95 % interval of a Poisson mean is 1.6 to 11.7 for 5
/// hits and 0 to 3.7 for none (Garwood 1936).
inline constexpr int few_hits = 5;

/// Whether mean^2 <= 6 standard_error^2, summed over the pixel's channels: fewer hits made it. False without a standard
/// error.
bool rests_on_few_hits(const ReferenceLayer& layer, std::size_t pixel);

/// A sentence for every component whose light rests on few hits in at least 2 % of the pixels. (At the edges of shadows
/// fewer pixels do, in references of every scene.)
std::vector<std::string> notes_of_few_hits(const Reference& reference);

/// The light that the reference may have missed [W/(sr m^2)]: by how much the mean of the images is brighter, where the
/// reference rests on few hits and the difference exceeds two of its standard errors. It may be a bias of the images as
/// well. 0 everywhere for fewer than two images.
Image light_missed_by(const ReferenceLayer& reference, const std::vector<Image>& images);

}  // namespace gib
