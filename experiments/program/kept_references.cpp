#include "experiments/program/kept_references.h"

#include "common/core/reject.h"
#include "common/images/image_file.h"
#include "experiments/metrics/reference_image.h"

namespace gib {

void require_no_reference(const std::string& path) {
    const auto image = exr_attributes(path);
    if (image && !attribute_in(*image, "reference_key").empty())
        reject({path}, "this is a reference (of '{}' by '{}'), which `render` does not replace; give another -o",
               attribute_in(*image, "scene"), attribute_in(*image, "method"));
}

void require_own_reference(const std::string& path, const std::string& key) {
    const auto image = exr_attributes(path);
    if (!image) return;
    const auto replace = "give another -o, or --replace";
    if (attribute_in(*image, "reference_key").empty())
        reject({path}, "this is an image, but no reference, and would be lost; {}", replace);
    if (attribute_in(*image, "reference_key") != key)
        reject(
            {path},
            "this is the reference of another scene, scene file, method or seed ('{}' by '{}'), and would be lost; {}",
            attribute_in(*image, "scene"), attribute_in(*image, "method"), replace);
}

}  // namespace gib
