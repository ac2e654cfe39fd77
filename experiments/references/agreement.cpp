#include "experiments/references/agreement.h"

#include "common/core/error.h"
#include "common/images/image_digest.h"
#include "common/images/image_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

namespace gib {

namespace {

constexpr double agreement_alpha = 0.001;  ///< significance level of all tests together

ReferenceLayer component_layer(const std::vector<ComponentImages>& groups, Component c) {
    std::vector<Image> images;
    for (const ComponentImages& group : groups)
        images.push_back(*group[c]);
    return layer_of_groups(std::move(images));
}

std::vector<ComponentImages> means_of(const std::vector<ComponentImages>& groups) {
    std::vector<ComponentImages> means;
    for (const ComponentImages& group : groups)
        means.push_back(block_means(group));
    return means;
}

const std::vector<std::string> digested = {"state", "pixels", "passes"};

std::string layer_name(const char* kind, std::size_t method, std::size_t group, Component c) {
    return fmt::format("maker{}_{}{:02}_{}", method, kind, group, name_of(c));
}

/// The groups of one kind and method, each with the components that the file has.
std::vector<ComponentImages> groups_in(const LayeredImage& file, const char* kind, std::size_t method) {
    std::vector<ComponentImages> groups;
    for (bool goes_on = true; goes_on;) {
        ComponentImages group;
        goes_on = false;
        for (Component c : all_components)
            if (const Image* image = file.find(layer_name(kind, method, groups.size(), c))) {
                group[c] = *image;
                group.width = image->width;
                group.height = image->height;
                goes_on = true;
            }
        if (goes_on) groups.push_back(std::move(group));
    }
    return groups;
}

/// Significance level of one component of one method. An experiment has up to a hundred of them.
constexpr double contradiction_alpha = 1e-4;

}  // namespace

Image block_means(const Image& image) {
    const Grid grid = Grid::with_edge(image.width, image.height, agreement_edge);
    Image means(grid.columns.count, grid.rows.count);
    for (std::size_t b = 0; b < grid.size(); ++b) {
        Colord sum = Colord::Zero();
        double pixels = 0;
        grid.for_each_in(b, [&](int x, int y) {
            sum += image
                       .at(static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                           static_cast<std::size_t>(x))
                       .cast<double>();
            ++pixels;
        });
        means.set(b, (sum / pixels).cast<float>());
    }
    return means;
}

ComponentImages block_means(const ComponentImages& images) {
    ComponentImages means;
    for (Component c : all_components) {
        if (!images[c]) continue;
        means[c] = block_means(*images[c]);
        means.width = means[c]->width;
        means.height = means[c]->height;
    }
    return means;
}

std::optional<BlockTest> disagreement(const std::vector<ComponentImages>& a, const std::vector<ComponentImages>& b,
                                      Component c, double alpha, Differing differing) {
    return significant_difference(component_layer(a, c), component_layer(b, c), alpha, differing, 1);
}

void MethodAgreement::set_pilot(std::size_t method, const std::vector<ComponentImages>& groups) {
    pixels_ = Grid::with_edge(groups.front().width, groups.front().height, agreement_edge);
    pilots_[method] = means_of(groups);
}

void MethodAgreement::restart() {
    for (std::size_t m = 0; m < groups_.size(); ++m) {
        groups_[m].clear();
        passes_[m] = 0;
    }
}

void MethodAgreement::write(const std::string& path, const std::string& state) const {
    LayeredImage file;
    file.metadata = {{"state", state},
                     {"pixels", fmt::format("{} {}", pixels_.columns.size, pixels_.rows.size)},
                     {"passes", fmt::format("{}", fmt::join(passes_, " "))}};
    for (const auto& [kind, methods] : {std::pair("pilot", &pilots_), std::pair("group", &groups_)})
        for (std::size_t m = 0; m < methods->size(); ++m)
            for (std::size_t g = 0; g < (*methods)[m].size(); ++g)
                for (Component c : all_components)
                    if (const auto& image = (*methods)[m][g][c])
                        file.layers.emplace_back(layer_name(kind, m, g, c), *image);
    if (file.layers.empty()) return;
    file.metadata["digest"] = image_digest(file, digested);
    write_exr(path, file);
}

void MethodAgreement::read(const std::string& path, const std::string& state) {
    if (!std::filesystem::exists(path)) return;
    try {
        LayeredImage file = read_image(path);
        if (file.metadata["digest"] != image_digest(file, digested) || file.metadata["state"] != state) return;
        std::istringstream passes(file.metadata["passes"]), pixels(file.metadata["pixels"]);
        int width = 0, height = 0;
        pixels >> width >> height;
        pixels_ = Grid::with_edge(width, height, agreement_edge);
        for (std::size_t m = 0; m < passes_.size(); ++m) {
            passes >> passes_[m];
            for (const auto& [kind, methods] : {std::pair("pilot", &pilots_), std::pair("group", &groups_)})
                (*methods)[m] = groups_in(file, kind, m);
        }
    } catch (const InputError&) {
        // A damaged file counts as missing.
    }
}

void MethodAgreement::add(std::size_t method, const std::vector<ComponentImages>& groups, std::uint32_t passes) {
    pixels_ = Grid::with_edge(groups.front().width, groups.front().height, agreement_edge);
    const double share = passes / static_cast<double>(passes_[method] + passes);
    passes_[method] += passes;
    auto& kept = groups_[method];
    if (kept.empty()) kept.resize(groups.size());
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const ComponentImages means = block_means(groups[g]);
        for (Component c : all_components) {
            if (!means[c]) continue;
            if (!kept[g][c]) kept[g][c] = Image(means.width, means.height);
            for (std::size_t i = 0; i < means[c]->rgb.size(); ++i) {
                float& mean = kept[g][c]->rgb[i];
                mean += static_cast<float>((double{means[c]->rgb[i]} - double{mean}) * share);
            }
        }
    }
}

std::vector<Disagreement> MethodAgreement::tested(std::vector<Disagreement> pairs,
                                                  const std::vector<ComponentImages>* reference) const {
    const std::vector<ComponentImages> means = reference ? means_of(*reference) : std::vector<ComponentImages>();
    const double alpha = agreement_alpha / static_cast<double>(std::max<std::size_t>(1, pairs.size()));
    std::vector<Disagreement> found;
    for (Disagreement& pair : pairs) {
        const auto block =
            reference ? disagreement(pilots_[pair.a], means, pair.component, alpha, Differing::brighter)
                      : disagreement(groups_[pair.a], groups_[pair.b], pair.component, alpha, Differing::either_way);
        if (!block) continue;
        pair.where = *block;
        pair.where.x = pixels_.columns.begin(block->x);
        pair.where.y = pixels_.rows.begin(block->y);
        pair.where.width = pixels_.columns.begin(block->x + block->width) - pair.where.x;
        pair.where.height = pixels_.rows.begin(block->y + block->height) - pair.where.y;
        found.push_back(pair);
    }
    return found;
}

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
