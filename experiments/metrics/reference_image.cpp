#include "experiments/metrics/reference_image.h"

#include "common/core/error.h"
#include "common/images/image_digest.h"
#include "common/reader/scene_file.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <sstream>

namespace gib {

namespace {

constexpr const char* digest_key = "digest";
/// The digest of what is needed to add samples to the reference later: the pixels and these metadata. `not_finite`
/// exists only if it is not 0, `methods` only if there are several, `work` not in older files.
std::string digest_of(const LayeredImage& file) {
    std::vector<std::string> keys = {"reference_key", "passes", "rounds", "seconds", "unresolved"};
    for (const char* optional : {"not_finite", "makers", "work"})
        if (file.metadata.count(optional) > 0) keys.emplace_back(optional);
    return image_digest(file, keys);
}

constexpr const char* unresolved_key = "unresolved";  // its value lists names of components, separated by ';'

std::string joined(const std::string& name, const std::string& what) { return name.empty() ? what : name + "_" + what; }

std::string group_name(const std::string& name, std::size_t group) {
    return joined(name, fmt::format("group{:02}", group));
}

std::optional<ReferenceLayer> take_layer(const LayeredImage& file, const std::string& name) {
    const Image* mean = file.find(name);
    if (!mean) return std::nullopt;
    ReferenceLayer layer{.mean = *mean, .standard_error = std::nullopt, .groups = {}};
    if (const Image* error = file.find(joined(name, "stderr"))) layer.standard_error = *error;
    while (const Image* group = file.find(group_name(name, layer.groups.size())))
        layer.groups.push_back(*group);
    if (!name.ends_with(bias_layer_suffix))
        if (auto bias = take_layer(file, joined(name, std::string(bias_layer_suffix))))
            layer.bias.push_back(std::move(*bias));
    return layer;
}

void put_layer(LayeredImage& file, const std::string& name, const ReferenceLayer& layer, bool with_groups) {
    file.layers.emplace_back(name, layer.mean);
    if (layer.standard_error) file.layers.emplace_back(joined(name, "stderr"), *layer.standard_error);
    for (const ReferenceLayer& bias : layer.bias)
        put_layer(file, joined(name, std::string(bias_layer_suffix)), bias, with_groups);
    if (!with_groups) return;
    for (std::size_t g = 0; g < layer.groups.size(); ++g)
        file.layers.emplace_back(group_name(name, g), layer.groups[g]);
}

}  // namespace

Reference read_reference(const std::string& path) {
    const LayeredImage file = read_image(path);
    if (const auto digest = file.metadata.find(digest_key);
        digest != file.metadata.end() && digest->second != digest_of(file))
        throw InputError({path, 0, 0}, "its content is not what its digest says: the file is damaged or was edited");
    return reference_in(file, path);
}

void write_reference(const std::string& path, const Reference& reference) {
    LayeredImage file = layers_of(reference, true);
    file.metadata[digest_key] = digest_of(file);
    write_exr(path, file);
}

bool is_verified(const Reference& reference) { return reference.metadata.count(digest_key) > 0; }

Reference reference_in(const LayeredImage& file, const std::string& path) {
    auto total = take_layer(file, "");
    if (!total) {
        std::string names;
        for (const auto& layer : file.layers)
            names += (names.empty() ? "" : ", ") + layer.first;
        throw InputError({path, 0, 0}, "no channels R,G,B; the image has the layers " + names);
    }
    Reference reference;
    reference.total = std::move(*total);
    for (Component c : all_components)
        reference.components[static_cast<std::size_t>(index_of(c))] = take_layer(file, std::string(name_of(c)));
    reference.metadata = file.metadata;
    if (const auto names = file.metadata.find(unresolved_key); names != file.metadata.end())
        reference.unresolved = components_named(names->second);
    return reference;
}

LayeredImage layers_of(const Reference& reference, bool with_groups) {
    LayeredImage file;
    file.metadata = reference.metadata;
    put_layer(file, "", reference.total, with_groups);
    for (Component c : all_components)
        if (const auto& layer = reference[c]) put_layer(file, std::string(name_of(c)), *layer, with_groups);
    const std::string unresolved = names_of(reference.unresolved);
    if (unresolved.empty()) file.metadata.erase(unresolved_key);
    else file.metadata[unresolved_key] = unresolved;
    return file;
}

std::string names_of(const std::vector<Component>& components) {
    std::string names;
    for (Component c : components)
        names += (names.empty() ? "" : ";") + std::string(name_of(c));
    return names;
}

std::vector<Component> components_named(const std::string& names) {
    std::vector<Component> found;
    std::istringstream list(names);
    for (std::string name; std::getline(list, name, ';');)
        if (const auto c = component_named(name)) found.push_back(*c);
    return found;
}

bool is_black(const Image& image) {
    return std::ranges::all_of(image.rgb, [](float v) { return v == 0; });
}

Image mean_image(std::span<const Image> images) {
    Image mean(images.front().width, images.front().height);
    for (std::size_t i = 0; i < mean.rgb.size(); ++i) {
        double sum = 0;
        for (const Image& image : images)
            sum += double{image.rgb[i]};
        mean.rgb[i] = static_cast<float>(sum / static_cast<double>(images.size()));
    }
    return mean;
}

std::string attribute_in(const std::map<std::string, std::string>& metadata, const std::string& key) {
    const auto found = metadata.find(key);
    return found == metadata.end() ? "" : found->second;
}

namespace {

constexpr const char *content_attribute = "scene_hash", *view_attribute = "view_hash";

}  // namespace

std::map<std::string, std::string> scene_attributes(const LoadedScene& scene) {
    return {{"scene", scene.name}, {content_attribute, scene.content_hash}, {view_attribute, scene.view_hash}};
}

bool show_different_scenes(const std::map<std::string, std::string>& a, const std::map<std::string, std::string>& b) {
    bool differ = false;
    for (const char* key : {content_attribute, view_attribute}) {
        const std::string in_a = attribute_in(a, key), in_b = attribute_in(b, key);
        if (in_a.empty() || in_b.empty()) continue;
        if (in_a == in_b) return false;
        differ = true;
    }
    return differ;
}

ReferenceLayer layer_of_groups(std::vector<Image> groups) {
    ReferenceLayer layer{};
    layer.mean = Image(groups[0].width, groups[0].height);
    if (groups.size() > 1) layer.standard_error = layer.mean;
    const double count = static_cast<double>(groups.size());
    for (std::size_t i = 0; i < layer.mean.rgb.size(); ++i) {
        double sum = 0, scatter = 0;
        for (const Image& group : groups)
            sum += double{group.rgb[i]};
        const double mean = sum / count;
        layer.mean.rgb[i] = static_cast<float>(mean);
        if (!layer.standard_error) continue;
        for (const Image& group : groups)
            scatter += sqr(double{group.rgb[i]} - mean);
        layer.standard_error->rgb[i] = static_cast<float>(std::sqrt(scatter / (count - 1) / count));
    }
    layer.groups = std::move(groups);
    return layer;
}

std::size_t ReferenceLayer::non_finite_values() const {
    std::size_t count = 0;
    for (const Image& group : groups)
        count += group.non_finite_values();
    if (count > 0) return count;
    return mean.non_finite_values() + (standard_error ? standard_error->non_finite_values() : 0);
}

double ReferenceLayer::squared_bias(std::size_t i) const {
    if (bias.empty()) return 0;
    const double b{bias[0].mean.rgb[i]}, error = bias[0].standard_error ? double{bias[0].standard_error->rgb[i]} : 0;
    return sqr(b) - sqr(error);
}

double dominance_of_one_group(const std::vector<Image>& groups) {
    if (groups.empty()) return 0;
    double all = 0, largest = 0;
    for (std::size_t i = 0; i < groups.front().rgb.size(); ++i) {
        double mean = 0;
        for (const Image& group : groups)
            mean += double{group.rgb[i]} / static_cast<double>(groups.size());
        double top = 0;
        for (const Image& group : groups) {
            const double deviation = sqr(double{group.rgb[i]} - mean);
            all += deviation;
            top = std::max(top, deviation);
        }
        largest += top;
    }
    return all > 0 ? largest / all : 0;
}

}  // namespace gib
