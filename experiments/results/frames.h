#pragma once
// Frames: images of a cell on its way, kept for the report's slider through time. They belong to seed 1 and hold the
// judged total after 1, 2, 4, 8, ... passes.

#include "common/images/image.h"
#include "experiments/results/result_folder.h"

#include <cstdint>
#include <optional>
#include <string>

namespace gib {

/// No side of a frame has more pixels; larger films are reduced by a whole factor.
inline constexpr int frame_size = 512;

/// The least whole factor that brings a film to at most `largest` pixels a side.
int reduction_for(int width, int height, int largest);
/// Means of blocks of factor x factor pixels; those at the right and lower edge may be smaller.
Image reduced(const Image& image, int factor);

/// Seed 1 after a power of two of passes, but for the last image, which is stored anyway.
bool keeps_frame(std::uint64_t seed, std::uint32_t passes, std::uint32_t last_passes);

/// Values are rounded to half floats (those that a half cannot hold stay as they are), which halves the file. Written
/// before the cell's record, so that a complete cell's frames are whole.
void write_frame(const ResultFolder& folder, const std::string& cell_name, std::uint32_t passes, const Image& total);
/// Empty if the cell was measured before frames were kept, or if the file is damaged: `damage`, if given, then says so.
std::optional<Image> read_frame(const ResultFolder& folder, const std::string& cell_name, std::uint32_t passes,
                                std::string* damage = nullptr);
/// Before a cell is done again.
void forget_frames(const ResultFolder& folder, const std::string& cell_name);

}  // namespace gib
