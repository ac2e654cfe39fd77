#pragma once
// The names of methods in tables and figures. A label has all settings, most of which are equal in all rows; it stays the
// key of cells, files and table.csv.

#include "experiments/analysis/table_row.h"

#include <map>
#include <string>

namespace gib {

/// A name for each label of a row. It begins with the `label` of the experiment file, else with the method's name, and has
/// those settings that differ among the labels that begin alike, without an `spp` that no run has reached, and their filter: "photon map,
/// photons=1e5", "photon_mapper photons=1e5". Labels whose names would be equal keep all of their settings.
std::map<std::string, std::string> short_names(const Analysis& analysis);

/// The analysis with short names in place of labels, wherever a method is named. Analysis::label_of() has the labels.
Analysis with_short_names(Analysis analysis);

}  // namespace gib
