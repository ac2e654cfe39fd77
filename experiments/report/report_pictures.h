#pragma once
// The images inside the report: HDR data of every method and reference, within a budget of bytes.
//
// Each scene has the reference and, of each method, seed 1's final image by component, its frames on the way, its map
// of FLIP and its bias (mean of the seeds against the reference). Pixels are half floats (image_pack.h), stored in
// elements of their own that the page's script unpacks when it shows them.

#include "experiments/analysis/analysis.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace gib {

/// Bytes of images in a page, as text.
struct PictureBudget {
    std::size_t final_images = 36'000'000;  ///< else all are reduced by a further factor of two
    std::size_t all = 40'000'000;           ///< else fewer frames are kept
};

struct ReportPictures {
    nlohmann::json scenes;            ///< by scene's name; what the script needs to find its images
    std::string elements;             ///< HTML
    std::string note;                 ///< what was left out for the budget's sake, as sentences; may be empty
    std::vector<std::string> damage;  ///< images on the way that cannot be read and are left out
};

/// Throws InputError if an image of the folder cannot be read.
ReportPictures report_pictures(const Analysis& analysis, const ResultFolder& folder, const PictureBudget& budget = {});

}  // namespace gib
