#include "experiments/filter/checkpoint_filter.h"

#include "methods/parts/transport/first_surface.h"

#include <algorithm>
#include <cstdlib>

namespace gib {

namespace {

/// Camera rays of a pixel's features, which cost little beside as many paths.
constexpr std::uint32_t feature_passes = 16;

}  // namespace

void CheckpointFilter::prepare(StageTimes& stages) {
    if (request_.non_local_means || request_.features)
        features_ = first_surface_features(scene_, seed_, feature_passes, stages);
}

void CheckpointFilter::keep(std::uint32_t passes, const ComponentImages& image) {
    if (!request_.non_local_means && !request_.variance) return;
    kept_.insert_or_assign(passes, image);
    // The first quarter of any later number of passes ends after an eighth of those so far.
    std::erase_if(kept_, [&](const auto& entry) { return entry.first < passes / 8; });
}

ComponentImages CheckpointFilter::mean(std::uint32_t begin, std::uint32_t end) const {
    ComponentImages mean = kept_.at(end);
    mean.bias = {};
    mean.techniques.clear();
    if (begin == 0) return mean;
    const ComponentImages& before = kept_.at(begin);
    const double passes = end - begin;
    for (const Component c : all_components)
        if (mean[c])
            for (std::size_t i = 0; i < mean[c]->rgb.size(); ++i)
                mean[c]->rgb[i] =
                    static_cast<float>((end * double{mean[c]->rgb[i]} - begin * double{before[c]->rgb[i]}) / passes);
    return mean;
}

std::uint32_t CheckpointFilter::middle(std::uint32_t begin, std::uint32_t end) const {
    const auto from_middle = [&](const auto& entry) { return std::abs(2 * std::int64_t{entry.first} - begin - end); };
    return std::min_element(kept_.upper_bound(begin), kept_.lower_bound(end),
                            [&](const auto& a, const auto& b) { return from_middle(a) < from_middle(b); })
        ->first;
}

HalfImage CheckpointFilter::half(std::uint32_t begin, std::uint32_t end) const {
    const std::uint32_t m = middle(begin, end);
    return {.mean = mean(begin, end),
            .variance = variance_of_mean(mean(begin, m).total(), m - begin, mean(m, end).total(), end - m),
            .passes = static_cast<double>(end - begin)};
}

ComponentImages CheckpointFilter::filtered(std::uint32_t passes, const ComponentImages& image) const {
    if (!request_.non_local_means) return image;
    const std::uint32_t m = middle(0, passes);
    return non_local_means({half(0, m), half(m, passes)}, &*features_);
}

std::vector<std::pair<std::string, Image>> CheckpointFilter::layers(std::uint32_t passes) const {
    std::vector<std::pair<std::string, Image>> layers;
    if (request_.features) {
        FeatureImages mean = mean_of(*features_);
        layers.emplace_back("albedo", std::move(mean.albedo));
        layers.emplace_back("normal", std::move(mean.normal));
        layers.emplace_back("depth", std::move(mean.depth));
    }
    if (request_.variance && passes >= least_passes()) layers.emplace_back("variance", half(0, passes).variance);
    return layers;
}

}  // namespace gib
