#pragma once
// Light that one side has not met by chance: the images (`unmet`) or the reference (`missed`). Where all replicates of a method are black though the reference shows light, they have no
// scatter that tells a rare path, which would be noise, from one that the method lacks, which is bias. Where the reference rests
// on few hits and the replicates are brighter, they may be biased, or the reference may have missed light (few_hits.h). Both
// are allowed for: statements hold only if they hold as well with the other side's light there.

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

/// Widens the intervals of all errors, of bias^2 and of the difference in energy of a row, which are those of `images`, until
/// they hold those against a reference that also has the light `missed` (light_missed_by()). Sets missed_shift, and
/// adds the squared relative error of `missed` to the row's noise floor. The energy neither agrees nor differs unless it does in
/// both cases.
void allow_for_missed_light(TableRow& row, const std::vector<Image>& images, const Image& missed,
                            const ReferenceLayer& reference, const Denominators& denominators);

}  // namespace gib
