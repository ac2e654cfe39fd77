#pragma once
// `gibench compare --z-test`: reports the verdicts of the statistical tests as text and as JSON.

#include "experiments/metrics/reference_image.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace gib {

/// A layer of the tested images and the same layer of the reference, of one size.
struct ComparedLayer {
    std::string name;         ///< `total` or a component's
    ReferenceLayer x;         ///< layer of the tested images; several replicates are its groups
    const ReferenceLayer* r;  ///< layer of the reference, finite
};

struct ZTestReport {
    bool accepted = false;
    std::string text;                            ///< lines; at the end the verdict, maybe with a note
    nlohmann::ordered_json json;                 ///< flat keys that begin with `z_`, for the total
    std::vector<nlohmann::ordered_json> layers;  ///< the numbers of each layer; may be empty
};

/// Runs gibench's own test. The first layer is the total. Values of `x` that are not finite are a reason to reject.
ZTestReport own_z_report(const std::vector<ComparedLayer>& layers);

/// Runs Mitsuba's test; the image at `variance_path` holds the variances of one sample. Throws InputError if the file
/// is missing, is not an image, has another size or holds values that are not finite or below 0.
ZTestReport mitsuba_z_report(const Image& x, const Image& reference, const std::string& variance_path,
                             std::uint32_t spp);

}  // namespace gib
