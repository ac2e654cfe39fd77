#include "common/images/image_digest.h"

#include "common/core/files.h"

#include <algorithm>

namespace gib {

std::string image_digest(const LayeredImage& image, const std::vector<std::string>& keys) {
    std::vector<const std::pair<std::string, Image>*> layers;
    for (const auto& layer : image.layers)
        layers.push_back(&layer);
    std::sort(layers.begin(), layers.end(), [](const auto* a, const auto* b) { return a->first < b->first; });
    ContentHash hash;
    for (const auto* layer : layers) {
        const auto& [name, pixels] = *layer;
        hash.add(name + ":" + std::to_string(pixels.width) + ":" + std::to_string(pixels.height));
        hash.add({reinterpret_cast<const char*>(pixels.rgb.data()), pixels.rgb.size() * sizeof(float)});
    }
    for (const auto& key : keys) {
        const auto value = image.metadata.find(key);
        hash.add(key + (value == image.metadata.end() ? "" : "=" + value->second));
    }
    return hash.hex();
}

}  // namespace gib
