#include "experiments/measuring/contradiction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

/// Significance level of one component of one method. An experiment has up to a hundred of them.
constexpr double contradiction_alpha = 1e-4;

bool contains(const std::vector<Component>& list, Component c) { return std::ranges::find(list, c) != list.end(); }

}  // namespace

std::optional<BlockTest> significant_difference(const ReferenceLayer& x, const ReferenceLayer& r, double alpha,
                                                Differing differing, int edge) {
    LayerZTest layer = z_test(x, r, r.mean, edge);
    for (auto& tests : layer.tests)
        for (BlockTest& test : tests)
            if (differing == Differing::brighter && test.deviation < 0) test.p = 1;
    const ZTestVerdict verdict = verdict_of({{"", std::move(layer)}}, {.alpha = alpha});
    if (!verdict.differs) return std::nullopt;
    return std::ranges::min_element(verdict.scales,
                                    [](const auto& one, const auto& two) { return one.adjusted_p < two.adjusted_p; })
        ->largest;
}

std::string text_of(const BlockTest& difference) {
    return fmt::format("pixels x {} to {}, y {} to {}: {:.3g} {}, {:.1f} standard errors", difference.x,
                       difference.x + difference.width - 1, difference.y, difference.y + difference.height - 1,
                       std::abs(difference.deviation), difference.deviation < 0 ? "less" : "more",
                       std::abs(difference.t));
}

std::string Contradiction::text() const {
    return fmt::format("light of {}, which the reference lacks{}", name_of(component),
                       is_black ? " altogether" : " (" + text_of(where) + ")");
}

std::vector<Contradiction> contradictions(const Reference& reference, const std::vector<ComponentImages>& replicates,
                                          const std::vector<Component>& unbiased_for) {
    std::vector<Contradiction> found;
    for (Component c : all_components) {
        const auto& layer = reference[c];
        std::vector<Image> images;
        for (const ComponentImages& image : replicates)
            if (image[c]) images.push_back(*image[c]);
        if (!layer || images.empty() || contains(reference.unresolved, c)) continue;
        if (is_black(layer->mean)) {
            const auto is_lit = [](const Image& image) { return !is_black(image); };
            if (std::ranges::any_of(images, is_lit)) found.push_back({c, true, {}});
            continue;
        }
        const auto is_finite = [](const Image& image) { return image.non_finite_values() == 0; };
        if (images.size() < 2 || !contains(unbiased_for, c) || !std::ranges::all_of(images, is_finite)) continue;
        if (const auto where = significant_difference(layer_of_groups(std::move(images)), *layer, contradiction_alpha,
                                                      Differing::brighter))
            found.push_back({c, false, *where});
    }
    return found;
}

}  // namespace gib
