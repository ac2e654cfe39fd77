#include "experiments/references/store.h"

#include "common/core/error.h"
#include "common/core/files.h"
#include "common/core/memory_limit.h"
#include "common/core/number_text.h"
#include "common/core/reject.h"
#include "common/images/image_digest.h"
#include "common/images/image_file.h"
#include "common/sampling/sampler.h"
#include "experiments/metrics/few_hits.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

namespace gib {

namespace {

template <typename Number>
Number number_in(const std::map<std::string, std::string>& metadata, const std::string& key, const std::string& path) {
    const auto value = number_from<Number>(attribute_in(metadata, key));
    if (!value) reject({path}, "not a reference of gibench: its attribute '{}' is missing or no number", key);
    return *value;
}

/// Moves the mean by this share of the way to the batch.
void move_towards(std::optional<Image>& mean, const std::optional<Image>& batch, double share) {
    if (mean.has_value() != batch.has_value()) throw RunError("the batches of a reference have different components");
    if (!mean) return;
    for (std::size_t i = 0; i < mean->rgb.size(); ++i) {
        const auto old = double{mean->rgb[i]};
        mean->rgb[i] = static_cast<float>(old + (double{batch->rgb[i]} - old) * share);
    }
}

/// The layer of one image of every group, with its bias if there is one. `image` and `bias` return an optional image.
template <typename ImageOf, typename BiasOf>
ReferenceLayer layer_of(const std::vector<ComponentImages>& groups, const ImageOf& image, const BiasOf& bias) {
    std::vector<Image> images, biases;
    for (const ComponentImages& group : groups) {
        images.push_back(image(group));
        if (auto of_group = bias(group)) biases.push_back(std::move(*of_group));
    }
    ReferenceLayer layer = layer_of_groups(std::move(images));
    if (!biases.empty()) layer.bias.push_back(layer_of_groups(std::move(biases)));
    return layer;
}

namespace fs = std::filesystem;

const std::vector<std::string> digest_keys = {"work", "seconds", "not_finite", "first_not_finite"};
constexpr const char* digest_key = "digest";

/// Whether all values are finite and, of a standard error, not negative.
bool is_sound(const ReferenceLayer& layer) {
    if (layer.mean.non_finite_values() > 0) return false;
    if (!layer.standard_error) return true;
    const auto& values = layer.standard_error->rgb;
    return layer.standard_error->non_finite_values() == 0 &&
           std::ranges::none_of(values, [](float v) { return v < 0; });
}

}  // namespace

void ReferenceGroups::add_round(const std::vector<ComponentImages>& batches, std::uint64_t batch_units) {
    ++rounds;
    const double share = static_cast<double>(batch_units) / static_cast<double>(units + batch_units);
    units += batch_units;
    if (groups_.empty()) {
        groups_ = batches;
        return;
    }
    for (std::size_t g = 0; g < groups_.size(); ++g)
        for (std::size_t c = 0; c < component_count; ++c) {
            move_towards(groups_[g].parts[c], batches[g].parts[c], share);
            move_towards(groups_[g].bias[c], batches[g].bias[c], share);
        }
}

Reference ReferenceGroups::reference() const {
    Reference reference;
    reference.total = layer_of(
        groups_, [](const auto& group) { return group.total(); }, [](const auto& group) { return group.total_bias(); });
    for (std::size_t c = 0; c < component_count; ++c)
        if (groups_.front().parts[c])
            reference.components[c] = layer_of(
                groups_, [c](const auto& group) { return *group.parts[c]; },
                [c](const auto& group) { return group.bias[c]; });
    return reference;
}

ReferenceGroups ReferenceGroups::read(const std::string& path, const std::string& key, int width, int height) {
    const Reference file = read_reference(path);
    if (attribute_in(file.metadata, "reference_key") != key)
        throw InputError({path}, "it is not the reference of this scene and method");
    if (!is_verified(file)) throw InputError({path}, "it has no digest, so damage to it would not be seen");
    if (file.total.mean.width != width || file.total.mean.height != height)
        throw InputError({path}, "its size is not the scene's");
    ReferenceGroups groups;
    groups.rounds = number_in<std::uint32_t>(file.metadata, "rounds", path);
    groups.units = number_in<std::uint64_t>(file.metadata, "passes", path);
    groups.seconds = number_in<double>(file.metadata, "seconds", path);
    if (file.metadata.count("work") > 0) groups.work = number_in<double>(file.metadata, "work", path);
    if (file.metadata.count("not_finite") > 0) {
        groups.dropped.count = number_in<std::uint64_t>(file.metadata, "not_finite", path);
        groups.dropped.first = attribute_in(file.metadata, "first_not_finite");
    }
    groups.groups_.resize(reference_groups);
    for (auto& group : groups.groups_) {
        group.width = width;
        group.height = height;
    }
    for (std::size_t c = 0; c < component_count; ++c) {
        const auto& layer = file.components[c];
        if (!layer) continue;
        for (std::size_t g = 0; g < reference_groups; ++g) {
            groups.groups_[g].parts[c] = layer->groups.at(g);
            for (const ReferenceLayer& bias : layer->bias)
                groups.groups_[g].bias[c] = bias.groups.at(g);
        }
    }
    return groups;
}

std::string BatchFolder::file_of(const ReferenceBatch& batch) const {
    return fmt::format("{}/maker{}-batch{}-passes{}-after{}.exr", path_, batch.method, batch.number, batch.passes,
                       batch.passes_before);
}

bool BatchFolder::has(const ReferenceBatch& batch) const {
    std::error_code ignored;
    return fs::exists(file_of(batch), ignored);
}

std::optional<MadeBatch> BatchFolder::read(const ReferenceBatch& batch) const {
    if (!has(batch)) return std::nullopt;
    try {
        const LayeredImage file = read_image(file_of(batch));
        if (attribute_in(file.metadata, digest_key) != image_digest(file, digest_keys)) return std::nullopt;
        return MadeBatch{.images = components_in(file),
                         .dropped = {number_in<std::uint64_t>(file.metadata, "not_finite", path_),
                                     attribute_in(file.metadata, "first_not_finite")},
                         .work = number_in<double>(file.metadata, "work", path_),
                         .seconds = number_in<double>(file.metadata, "seconds", path_)};
    } catch (const std::exception&) {  // any exception, because a damaged file can contain anything
        return std::nullopt;
    }
}

void BatchFolder::write(const ReferenceBatch& batch, const MadeBatch& made) const {
    fs::create_directories(path_);
    LayeredImage file = layers_of(made.images);
    file.metadata = {{"work", fmt::format("{}", made.work)},
                     {"seconds", fmt::format("{}", made.seconds)},
                     {"not_finite", fmt::format("{}", made.dropped.count)},
                     {"first_not_finite", made.dropped.count > 0 ? made.dropped.first : "none"}};
    file.metadata[digest_key] = image_digest(file, digest_keys);
    write_exr(file_of(batch), file);
}

void BatchFolder::remove(const ReferenceBatch& batch) const {
    std::error_code ignored;
    fs::remove(file_of(batch), ignored);
}

void BatchFolder::remove_all() const {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

std::uint64_t batch_seed(const std::string& key, std::uint32_t batch, std::uint32_t method) {
    const std::uint64_t base = std::stoull(key.substr(0, 16), nullptr, 16);
    return 0x8000000000000000ull | combine_keys(base, std::uint64_t{method} << 32 | batch);
}

Reference read_reference_of(const std::string& path, int width, int height,
                            const std::map<std::string, std::string>& scene) {
    Reference reference = read_reference(path);
    const Image& mean = reference.total.mean;
    if (mean.width != width || mean.height != height)
        reject({path}, "the reference has {} x {} pixels, the scene has {} x {}", mean.width, mean.height, width,
               height);
    if (show_different_scenes(reference.metadata, scene))
        throw InputError({path}, "the reference is that of another scene, or of another version of this one");
    return reference;
}

namespace {

/// The mean of the replicates, with the components that all of them have; their scatter is its standard error.
Reference reference_of_replicates(std::vector<Reference> replicates) {
    if (replicates.size() == 1) return std::move(replicates.front());
    Reference reference;
    reference.metadata = replicates.front().metadata;
    reference.unresolved = replicates.front().unresolved;
    std::vector<Image> totals;
    for (const Reference& r : replicates)
        totals.push_back(r.total.mean);
    reference.total = layer_of_groups(std::move(totals));
    for (std::size_t c = 0; c < component_count; ++c) {
        std::vector<Image> images;
        for (const Reference& r : replicates)
            if (r.components[c]) images.push_back(r.components[c]->mean);
        if (images.size() == replicates.size()) reference.components[c] = layer_of_groups(std::move(images));
    }
    return reference;
}

}  // namespace

GivenReference given_reference(const std::vector<std::string>& paths, int width, int height,
                               const std::map<std::string, std::string>& scene) {
    const std::string& path = paths.front();
    std::vector<Reference> replicates;
    for (const std::string& one : paths)
        replicates.push_back(read_reference_of(one, width, height, scene));
    for (std::size_t i = 1; i < paths.size(); ++i)
        if (replicates[i].total.mean.rgb == replicates[0].total.mean.rgb)
            throw InputError({paths[i]}, "the image is that of '" + path + "': replicates need seeds of their own");
    GivenReference given{.reference = reference_of_replicates(std::move(replicates)), .identity = "", .notes = {}};
    Reference& reference = given.reference;
    bool sound = is_sound(reference.total);
    for (const auto& component : reference.components)
        sound = sound && (!component || is_sound(*component));
    if (!sound) throw InputError({path}, "the reference has values that are not finite, or a negative standard error");
    if (is_black(reference.total.mean))
        throw InputError({path}, "the reference is black, and no error is a share of it");
    // Other attributes are those of the file's own format.
    std::map<std::string, std::string> kept;
    for (const char* key : {"scene", "scene_hash", "view_hash", "method", "passes", "rounds", "seconds", "makers",
                            "not_finite", "brightest_light"})
        if (const auto value = reference.metadata.find(key); value != reference.metadata.end()) kept.insert(*value);
    ContentHash hash;
    hash.add("reference image 1");
    for (const std::string& one : paths)
        hash.add(read_file(one));
    kept["reference_key"] = hash.hex();
    kept.try_emplace("passes", "0");
    reference.metadata = std::move(kept);
    given.identity = hash.hex() + ":" + reference.metadata["passes"];
    if (!reference.total.standard_error && reference.total.groups.empty())
        given.notes = {"the reference has no standard error: how much of each error is its own is unknown"};
    std::ranges::move(notes_of_few_hits(reference), std::back_inserter(given.notes));
    return given;
}

void require_memory_for_reference(int width, int height) {
    const double whole = reference_groups + 2;
    const double layers = (reference_groups + 4 * whole) * (component_count + 1);
    require_memory(3.0 * sizeof(float) * width * height * layers,
                   fmt::format("a reference of {} x {} pixels", width, height));
}

}  // namespace gib
