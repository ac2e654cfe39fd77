#pragma once
// `gibench compare --z-test`: reports the verdict of the statistical test as text and as JSON.

#include "experiments/metrics/reference_image.h"

#include <nlohmann/json.hpp>

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

/// Runs the test. The first layer is the total. Values of `x` that are not finite are a reason to reject.
ZTestReport z_report(const std::vector<ComparedLayer>& layers);

}  // namespace gib
