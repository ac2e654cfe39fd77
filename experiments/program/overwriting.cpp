#include "experiments/program/overwriting.h"

#include "common/core/reject.h"
#include "common/images/image_file.h"

#include <map>

namespace gib {

namespace {

using Attributes = std::map<std::string, std::string>;

/// The value of an attribute, "unknown" if the file does not have it.
std::string attribute(const Attributes& attributes, const std::string& key) {
    const auto found = attributes.find(key);
    return found == attributes.end() ? "unknown" : found->second;
}

}  // namespace

void require_no_reference(const std::string& path) {
    const auto image = exr_attributes(path);
    if (image && image->count("reference_key") > 0)
        reject({path}, "this is a reference (of '{}' by '{}'), which `render` does not replace; give another -o",
               attribute(*image, "scene"), attribute(*image, "method"));
}

void require_own_reference(const std::string& path, const std::string& key) {
    const auto image = exr_attributes(path);
    if (!image) return;
    const auto replace = "give another -o, or --replace";
    if (image->count("reference_key") == 0)
        reject({path}, "this is an image, but no reference, and would be lost; {}", replace);
    if (attribute(*image, "reference_key") != key)
        reject(
            {path},
            "this is the reference of another scene, scene file, method or seed ('{}' by '{}'), and would be lost; {}",
            attribute(*image, "scene"), attribute(*image, "method"), replace);
}

}  // namespace gib
