#pragma once
// The names of methods in tables and figures, and which labels are one method. A label has all settings, most of which
// are equal in all rows; it stays the key of cells, files and table.csv.

#include "experiments/analysis/table_row.h"

#include <map>
#include <string>

namespace gib {

/// A name for each label of a row. It is the `label` of the experiment file with those settings that vary within that
/// [[method]]:
/// "photon map", "photon map, photons=1e5". Without one it is the method's name with those settings that differ among the labels
/// of the method, and its filter: "photon_mapper photons=1e5". An `spp` that no run has reached is left out. Labels
/// whose names would be equal keep all of their settings.
std::map<std::string, std::string> short_names(const Analysis& analysis);

/// The analysis with short names in place of labels, wherever a method is named. Analysis::label_of() has the labels.
Analysis with_short_names(Analysis analysis);

/// A label without its `spp`: "photon_mapper photons=1e5" of "photon_mapper photons=1e5 spp=16".
std::string label_without_spp(const std::string& label);

/// The analysis with one label for each method and scene: of labels that differ in `spp` alone the one with the most
/// complete seeds, and among these the one with the most passes. The others leave `cells`, `rows` and `looks`; the
/// passes at which they stopped are in `stops`. ResultIndex::methods keeps all labels.
Analysis one_label_a_method(const Analysis& analysis);

}  // namespace gib
