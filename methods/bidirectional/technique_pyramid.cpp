#include "methods/bidirectional/technique_pyramid.h"

#include <fmt/format.h>

namespace gib {

TechniquePyramid::TechniquePyramid(int width, int height, double unit) {
    const auto image = [&] { return FixedPointImage(width, height, unit); };
    layers_.try_emplace({0, 2}, Layers{image(), image()});
    for (int edges = 2; edges <= longest; ++edges)
        for (int s = 0; s <= edges; ++s)
            layers_.try_emplace({s, edges + 1 - s}, Layers{image(), image()});
}

void TechniquePyramid::add(int s, int t, std::size_t pixel, const Connection& path, double factor) {
    const auto found = layers_.find({s, t});
    if (found == layers_.end()) return;
    Colord light = Colord::Zero();
    for (const Color& part : path.light.parts)
        light += factor * part.cast<double>();
    const Color alone = light.cast<float>(), weighted = (double{path.weight} * light).cast<float>();
    if (!found->second.alone.holds(alone)) return;  // the film counts it
    found->second.alone.add(pixel, alone);
    found->second.weighted.add(pixel, weighted);
}

std::vector<std::pair<std::string, Image>> TechniquePyramid::images(double count) const {
    std::vector<std::pair<std::string, Image>> images;
    for (const auto& [technique, layers] : layers_) {
        const auto [s, t] = technique;
        const std::string name = fmt::format("{}k{}_s{}_t{}", technique_layer_prefix, s + t - 1, s, t);
        images.emplace_back(name, layers.weighted.mean(count));
        images.emplace_back(name + "_alone", layers.alone.mean(count));
    }
    return images;
}

}  // namespace gib
