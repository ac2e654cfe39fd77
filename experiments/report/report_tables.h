#pragma once
// The report's tables and bars of one scene as plain HTML, readable without scripts. Rows of components carry
// data-component, by which the page's script shows one component at a time.

#include "experiments/analysis/price.h"

#include <string>
#include <vector>

namespace gib {

/// The cheapest methods at 5 % and 1 % of every scene, at one glance.
std::string overview_html(const Analysis& analysis);

/// Time to each error of target_errors, preparation, memory.
std::string price_list_html(const Analysis& analysis, const std::string& scene);

/// The fitted laws: what halving the error costs, and the error that more time does not remove.
std::string laws_html(const Analysis& analysis, const std::string& scene);

/// When the best method changes; empty with one method.
std::string crossovers_html(const Analysis& analysis, const std::vector<Crossover>& changes, const std::string& scene);

/// bias^2 and variance of the final images with a bar of their shares; FLIP, where the noise lies.
std::string split_html(const Analysis& analysis, const std::string& scene);

/// The mean seconds of each stage as bars on one scale.
std::string stages_html(const Analysis& analysis, const std::string& scene);

}  // namespace gib
