#pragma once
// References that were made elsewhere: an image of any renderer, with or without a standard error.

#include "experiments/metrics/reference_image.h"

#include <string>
#include <vector>

namespace gib {

struct GivenReference {
    Reference reference;
    std::string identity;            ///< as stored_reference_identity() returns it once the reference is written
    std::vector<std::string> notes;  ///< remarks that tables have to make about it
};

/// Reads an image as the reference of a scene of this size and content (LoadedScene::content_hash). Without a standard error
/// (layer `stderr`, or groups) its noise floor is unknown, which a note says. Throws InputError if the image is missing or
/// damaged, has another size or values that are not finite, or says that it is the reference of another scene.
GivenReference given_reference(const std::string& path, int width, int height, const std::string& content_hash);

}  // namespace gib
