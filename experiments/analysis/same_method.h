#pragma once
// Labels that differ in `spp` alone are one method that stops earlier or later: their runs make the same images on the
// way. Comparisons of methods see the longest run of each, with the passes at which the others stopped.

#include "experiments/analysis/table_row.h"

#include <string>

namespace gib {

/// A label without its `spp`: "photon_mapper photons=1e5" of "photon_mapper photons=1e5 spp=16".
std::string label_without_spp(const std::string& label);

/// The analysis with one label for each method and scene: of labels that differ in `spp` alone the one with the most
/// complete seeds, and among these the one with the most passes. The others leave `cells`, `rows` and `looks`; the
/// passes at which they stopped are in `stops`. ResultIndex::methods keeps all labels.
Analysis one_label_a_method(const Analysis& analysis);

}  // namespace gib
