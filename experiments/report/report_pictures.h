#pragma once
// The images inside the report: HDR data of every method and reference, within a budget of bytes.
//
// There is for each scene the reference, and for each method seed 1's final image by component, its frames
// (frames.h), its map of FLIP and its bias (mean of the seeds against the reference). Pixels are half floats
// (image_pack.h), stored in elements of their own that the page's script unpacks when it shows them.

#include "experiments/analysis/analysis.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace gib {

/// Limits for the bytes that the images take in a page, as text.
struct PictureBudget {
    std::size_t final_images = 36'000'000;  ///< beyond it, all images are reduced by a further factor of two
    std::size_t all = 40'000'000;           ///< beyond it, fewer frames are kept
};

struct ReportPictures {
    nlohmann::json scenes;            ///< by name: where the script finds the images of the scene
    std::string elements;             ///< HTML that holds the images
    std::string note;                 ///< sentences about what the budget leaves out; may be empty
    std::vector<std::string> damage;  ///< messages about frames that cannot be read and are left out
};

/// Packs the images of a result folder. Throws InputError if one that is not a frame cannot be read.
ReportPictures report_pictures(const Analysis& analysis, const ResultFolder& folder, const PictureBudget& budget = {});

}  // namespace gib
