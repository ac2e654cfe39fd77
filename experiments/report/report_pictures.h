#pragma once
// The images inside the report: HDR data of every method and reference, within a budget of bytes.
//
// There is for each scene the reference, and for each method seed 1's final image by component, its frames
// (pictures.h), its map of FLIP and its bias (mean of the seeds against the reference). Pixels are half floats
// (pack_half()), stored in elements of their own that the page's script unpacks when it shows them.
//
// Packs images as text inside a page: half floats, deflated, in base64. report_page/blobs.js unpacks them.

#include "experiments/analysis/analysis.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
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

/// Base64 by RFC 4648, with padding.
std::string base64(std::span<const std::uint8_t> bytes);

struct PackedImage {
    int width = 0, height = 0, channels = 0;
    bool bytes = false;  ///< 8 bits a value instead of a half float
    int exponent = 0;    ///< a stored half is the value times 2^exponent
    std::string text;    ///< base64 of zlib's format
};

/// Packs height x width x channels values as half floats. Their relative precision is 2^-11 over 28 stops below the
/// largest value; NaN and infinity are kept. The bytes hold for each channel a plane of high bytes, each as its
/// difference to the left neighbour (to 0 in the first column) modulo 256, and after these for each channel the plane
/// of low bytes. Throws std::invalid_argument if the number of values is another one.
PackedImage pack_half(std::span<const float> values, int width, int height, int channels);

}  // namespace gib
