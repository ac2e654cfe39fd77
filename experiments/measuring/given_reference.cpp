#include "experiments/measuring/given_reference.h"

#include "common/core/files.h"
#include "common/core/reject.h"

#include <algorithm>

namespace gib {

namespace {

/// Whether all values are finite and, of a standard error, not negative.
bool is_sound(const ReferenceLayer& layer) {
    if (layer.mean.non_finite_values() > 0) return false;
    if (!layer.standard_error) return true;
    const auto& values = layer.standard_error->rgb;
    return layer.standard_error->non_finite_values() == 0 &&
           std::ranges::none_of(values, [](float v) { return v < 0; });
}

}  // namespace

GivenReference given_reference(const std::string& path, int width, int height, const std::string& content_hash) {
    GivenReference given{.reference = read_reference(path), .identity = "", .notes = {}};
    Reference& reference = given.reference;
    const Image& mean = reference.total.mean;
    if (mean.width != width || mean.height != height)
        reject({path}, "the reference has {} x {} pixels, the scene has {} x {}", mean.width, mean.height, width,
               height);
    bool sound = is_sound(reference.total);
    for (const auto& component : reference.components)
        sound = sound && (!component || is_sound(*component));
    if (!sound) throw InputError({path}, "the reference has values that are not finite, or a negative standard error");
    if (is_black(mean)) throw InputError({path}, "the reference is black, and no error is a share of it");
    if (const auto scene = reference.metadata.find("scene_hash");
        scene != reference.metadata.end() && scene->second != content_hash)
        throw InputError({path}, "the reference is that of another scene, or of another version of this one");

    // Other attributes are those of the file's own format.
    std::map<std::string, std::string> kept;
    for (const char* key : {"scene", "scene_hash", "method", "passes", "rounds", "seconds", "makers", "not_finite"})
        if (const auto value = reference.metadata.find(key); value != reference.metadata.end()) kept.insert(*value);
    ContentHash hash;
    hash.add("reference image 1");
    hash.add(read_file(path));
    kept["reference_key"] = hash.hex();
    kept.try_emplace("passes", "0");
    reference.metadata = std::move(kept);
    given.identity = hash.hex() + ":" + reference.metadata["passes"];
    if (!reference.total.standard_error && reference.total.groups.empty())
        given.notes = {"the reference has no standard error: how much of each error is its own is unknown"};
    return given;
}

}  // namespace gib
