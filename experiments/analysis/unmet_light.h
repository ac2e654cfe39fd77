#pragma once
// Light that no replicate of a method has met, though the reference shows it: where all are black, they have no scatter that
// tells a rare path, which would be noise, from one that the method lacks, which is bias. So both are allowed for: statements
// hold only if they hold as well with the reference's light there.

#include "experiments/analysis/table_row.h"

namespace gib {

/// The light of `reference` in those pixels and channels in which every one of the images is 0; 0 elsewhere.
Image unmet_light(const std::vector<Image>& images, const Image& reference);

/// Sets TableRow::unmet, and widens the intervals of bias^2 and of the difference in energy of a row, which are those of `images`,
/// until they hold those of images that also have the light `unmet`. The energy neither agrees nor differs unless it does in both
/// cases. It differs only by more than `unmet`: what a single seed has met is about as much as what none has (Good 1953, "The
/// population frequencies of species and the estimation of population parameters"), and is as little known. Returns the mean energy of `unmet` [W/(sr m^2)].
double allow_for_unmet_light(TableRow& row, const std::vector<Image>& images, const Image& unmet,
                             const ReferenceLayer& reference, const Denominators& denominators);

}  // namespace gib
