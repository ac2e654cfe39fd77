#pragma once
// The differences that a person sees between two images side by side: brightness, orientation, and files that cannot
// hold radiance.

#include "experiments/metrics/denominators.h"
#include "experiments/metrics/reference_image.h"

#include <string>
#include <vector>

namespace gib {

/// The factor by which an image is brighter than the reference, where dark parts count as much as bright ones.
struct Brightness {
    double factor = 1;
    double deviation = 0;  ///< its standard deviation, from the scatter of blocks of 8 x 8 pixels
    /// Whether it differs from 1 by more than noise, and by more than 1 %.
    bool differs() const;
};
Brightness brightness(const Image& image, const Image& reference, double epsilon);

/// Whether the values of an image are those of a display: without the sRGB curve, which may have been applied to
/// multiples of the radiance and clipped at 1, it is four times as like to the reference.
bool has_srgb_curve(const Image& image, const Image& reference);

/// "1.20 times too bright; scaled, 4.02 % are left, within the reference's noise of 4.3 %", and whether the mean of the images
/// is black, has the sRGB curve, or fits better upside down, mirrored or with red and blue swapped.
std::string comparison_sentence(const std::vector<Image>& images, const ReferenceLayer& reference,
                                const Denominators& denominators);

/// The reasons why an image cannot be compared well: 8 bits a channel, clipped values, no colour beside another that
/// has some. Empty if nothing is wrong.
std::string doubts_about_image(const Image& image, const Image& other);

/// The difference in colours: blue where the image is darker than the reference, red where it is brighter by as much as
/// the reference's own value.
Image difference_image(const Image& image, const Image& reference, double epsilon);

}  // namespace gib
