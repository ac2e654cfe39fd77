#pragma once
// Light that one side lacks, perhaps by chance. Unsampled light: lit in the reference, black in all replicates. Its
// cause may be noise, a rare path, or bias, a path that the method lacks. Missed light: the reference rests on few hits
// and the replicates are brighter (few_hits.h); the reference or the method may be wrong. Intervals are widened to hold
// both cases.

#include "experiments/analysis/table_row.h"

namespace gib {

/// The light of `reference` in those pixels and channels in which every one of the images is 0; 0 elsewhere.
Image unsampled_light(const std::vector<Image>& images, const Image& reference);

/// Computes bias^2 and the energy balance of a row with and without the light `unsampled` in the images; the intervals
/// are widened to hold both results. The balance agrees or differs only if it does in both cases, and differs only by
/// more than `unsampled`: light that a single seed has found is about as much as light that none has (Good 1953, "The
/// population frequencies of species and the estimation of population parameters"). Sets TableRow::unsampled. Returns
/// the mean energy of `unsampled` [W/(sr m^2)].
double allow_for_unsampled_light(TableRow& row, const std::vector<Image>& images, const Image& unsampled,
                                 const ReferenceLayer& reference, const Denominators& denominators);

/// Computes errors, bias^2 and the energy balance of a row with and without the light `missed` (light_missed_by()) in
/// the reference; the intervals are widened to hold both results. The balance agrees or differs only if it does in both
/// cases. Sets missed_shift, and adds the squared relative error of `missed` to the row's noise floor.
void allow_for_missed_light(TableRow& row, const std::vector<Image>& images, const Image& missed,
                            const ReferenceLayer& reference, const Denominators& denominators);

}  // namespace gib
