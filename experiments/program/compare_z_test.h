#pragma once
// `gibench compare --z-test`: the verdicts of the statistical tests as text and as JSON.

#include "experiments/metrics/reference_image.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace gib {

/// One layer of the test and of the reference, of one size.
struct ComparedLayer {
    std::string name;         ///< `total` or a component's
    ReferenceLayer x;         ///< with its replicates as groups, if there are several
    const ReferenceLayer* r;  ///< finite
};

struct ZTestReport {
    bool accepted = false;
    std::string text;                            ///< lines, the last one the verdict
    nlohmann::ordered_json json;                 ///< flat keys that begin with `z_`, for the total
    std::vector<nlohmann::ordered_json> layers;  ///< the same for each layer's own numbers; may be empty
};

/// Our own test. The first layer is the total. Values of `x` that are not finite are a reason to reject.
ZTestReport own_z_report(const std::vector<ComparedLayer>& layers);

/// Mitsuba's test; `variance_path`: the variances of one sample. Throws InputError if the file is missing, is no image,
/// has another size, or values that are not finite or below 0.
ZTestReport mitsuba_z_report(const Image& x, const Image& reference, const std::string& variance_path,
                             std::uint32_t spp);

}  // namespace gib
