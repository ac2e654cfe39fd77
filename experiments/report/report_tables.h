#pragma once
// The report's tables and bars of one scene as plain HTML, readable without scripts. Rows of components carry
// data-component, by which the page's script shows one component at a time.

#include "experiments/analysis/price.h"

#include <string>
#include <vector>

namespace gib {

/// A table of the cheapest method at 5 % and at 1 % for every scene.
std::string overview_html(const Analysis& analysis);

/// A table of the time to each error of target_errors, of preparation and of memory.
std::string price_list_html(const Analysis& analysis, const std::string& scene);

/// A table of the fitted laws: what halving the error costs, and the error that more time does not remove.
std::string laws_html(const Analysis& analysis, const std::string& scene);

/// A table of the times at which the best method changes; empty if there is none.
std::string crossovers_html(const Analysis& analysis, const std::vector<Crossover>& changes, const std::string& scene);

/// A table of bias^2 and variance of the final images with a bar of their shares, of the
/// noise's frequencies and FLIP.
std::string split_html(const Analysis& analysis, const std::string& scene);

/// The mean seconds of each stage as bars on one scale.
std::string stages_html(const Analysis& analysis, const std::string& scene);

}  // namespace gib
