#pragma once
// Pictures of a cell, and the colours in which the report shows them.
//
// Frames are intermediate images of a cell, kept for the report's slider through time. They belong to seed 1 and hold
// the compared total (judgement.h) after 1, 2, 4, 8, ... passes.
//
// The FLIP of a complete cell is kept beside its image. It is measured once, after all cells are timed, and its time is
// never charged.

#include "common/images/image.h"
#include "experiments/metrics/flip.h"
#include "experiments/results/result_folder.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace gib {

/// The factor that brings the image's mean luminance to a middle tone; 1 if the mean is 0 or not finite.
float exposure_for(const Image& image);

/// The steps of a colour scale in sRGB, from the smallest to the largest value, with
/// linear interpolation between them.
using ColorScale = std::span<const Color>;
/// The colour of a scale at `t`, which is clamped to [0, 1].
Color scale_color(ColorScale steps, float t);
/// Black, violet, red, orange, pale yellow in steps of equal lightness, so that lighter means a larger error.
ColorScale error_colors();
/// Every 17th of the 256 colours of `magma` (Smith and van der Walt, matplotlib); interpolation is within
/// 0.01 of the rest.
ColorScale magma_colors();
/// Blue (too dark), nearly white (no bias), red (too bright).
ColorScale bias_colors();

/// A map of FLIP in the colours of `magma`, as in the papers on FLIP. The values are linear, so that the sRGB curve
/// of a PNG gives the colours of the scale.
Image flip_image(const FlipMap& map);
/// The inverse of flip_image() for a PNG that read_image() has read, the same in all channels. Each value is the
/// nearest of 256.
Image flip_values(const Image& picture);

/// The largest width and height of a frame [pixels]; larger films are reduced by a whole factor.
inline constexpr int frame_size = 512;

/// The smallest whole factor that reduces a film to at most `largest` pixels a side.
int reduction_for(int width, int height, int largest);
/// The image of the means of blocks of factor x factor pixels; blocks at the right and lower edge may be smaller.
Image reduced(const Image& image, int factor);

/// Whether an image is kept as a frame: of seed 1, after a power of two of passes. The last image is not kept as one,
/// because it is stored anyway.
bool keeps_frame(std::uint64_t seed, std::uint32_t passes, std::uint32_t last_passes);

/// Writes a frame, with values rounded to half floats to halve the file (values that a half cannot hold are kept).
/// Frames are written before the cell's record, so that those of a complete cell are complete.
void write_frame(const ResultFolder& folder, const std::string& cell_name, std::uint32_t passes, const Image& total);
/// Reads a frame. Empty if there is no file, or if it is damaged; `damage`, if given, then receives a message.
std::optional<Image> read_frame(const ResultFolder& folder, const std::string& cell_name, std::uint32_t passes,
                                std::string* damage = nullptr);
/// Whether there is a file of that frame, damaged or not.
bool has_frame(const ResultFolder& folder, const std::string& cell_name, std::uint32_t passes);
/// Deletes the frames of a cell before the cell is measured again.
void forget_frames(const ResultFolder& folder, const std::string& cell_name);

/// HDR-FLIP of a cell's final image against the reference, mean over the pixels. Empty if either image has values
/// that are not finite. The first call stores the value as flip.json and the map as flip_map() in the cell's folder.
/// Later calls return it, and measure again if either file is damaged or belongs to other images. Throws InputError
/// if sizes differ.
std::optional<double> cell_flip(const ResultFolder& folder, const std::string& cell_name, const Image& total,
                                const Image& r_total);

/// Deletes the stored FLIP of a cell before the cell is measured again.
void forget_flip(const ResultFolder& folder, const std::string& cell_name);

}  // namespace gib
