#include "common/images/non_local_means.h"

#include "common/core/math.h"
#include "common/core/parallel.h"
#include "common/images/mirrored_planes.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace gib {

namespace {

constexpr int feature_channels = 7;  // three of albedo and of normal, one of depth
constexpr int depth_channel = 6;
constexpr std::size_t rows_per_block = 16;

/// The data that decide the weights of one half: its colors and their variances.
struct Colors {
    MirroredPlanes value, variance;
};

Colors colors_of(const HalfImage& half, int margin, int variance_radius) {
    const MirroredPlanes black(half.mean.width, half.mean.height, margin, 3);
    Colors colors{black, black};
    const Image total = half.mean.total();
    MirroredPlanes raw = black;
    for (std::size_t c = 0; c < 3; ++c) {
        colors.value.fill(c, total, static_cast<int>(c));
        raw.fill(c, half.variance, static_cast<int>(c));
        colors.variance.fill(c, [&](int x, int y) { return raw.mean_around(c, x, y, variance_radius); });
    }
    return colors;
}

/// The features of both halves together, with what (4) needs of them.
struct Features {
    MirroredPlanes value, variance, tolerance, slope;

    Features(const std::array<FeatureImages, 2>& halves, int margin, float tau)
        : value(halves[0].depth.width, halves[0].depth.height, margin, feature_channels),
          variance(value),
          tolerance(value),
          slope(value) {
        std::array<MirroredPlanes, 2> half = {value, value};
        float farthest = 0;
        for (const FeatureImages& images : halves)
            farthest = std::max(farthest, *std::max_element(images.depth.rgb.begin(), images.depth.rgb.end()));
        for (std::size_t h : {0, 1})
            for (int c = 0; c < feature_channels; ++c) {
                const Image& image = c < 3 ? halves[h].albedo : c < 6 ? halves[h].normal : halves[h].depth;
                const bool is_scaled = c == depth_channel && farthest > 0;
                half[h].fill(static_cast<std::size_t>(c), image, c % 3, is_scaled ? 1.f / farthest : 1.f);
            }
        for (std::size_t c = 0; c < value.count(); ++c) {
            value.fill(c, [&](int x, int y) { return 0.5f * (half[0].row(c, y)[x] + half[1].row(c, y)[x]); });
            slope.fill(c, [&](int x, int y) { return 0.25f * sqr(half[0].row(c, y)[x] - half[1].row(c, y)[x]); });
            variance.fill(c, [&](int x, int y) { return slope.mean_around(c, x, y, 1); });
            tolerance.fill(c, [&](int x, int y) { return std::max(tau, variance.row(c, y)[x]); });
            slope.fill(c, [&](int x, int y) {
                return sqr(0.5f * (value.row(c, y)[x + 1] - value.row(c, y)[x - 1])) +
                       sqr(0.5f * (value.row(c, y + 1)[x] - value.row(c, y - 1)[x]));
            });
        }
    }
};

/// A part of an image for which the sums of (6) are built up, offset by offset.
class FilteredRows {
public:
    FilteredRows(const std::array<Colors, 2>& colors, const Features* features,
                 const std::array<MirroredPlanes, 2>& sources, const NonLocalMeansSettings& settings, float epsilon,
                 int first, int last)
        : colors_(colors),
          features_(features),
          sources_(sources),
          settings_(settings),
          epsilon_(epsilon),
          first_(first),
          rows_(last - first),
          width_(sources[0].width()),
          wide_(width_ + 2 * settings.patch_radius),
          distances_(size(wide_, rows_ + 2 * settings.patch_radius)),
          columns_(size(wide_, 1)),
          weights_(size(width_, 1)),
          features_apart_(size(width_, rows_)) {
        for (std::size_t h : {0, 1})
            sums_[h].assign(sources[h].count() + 1, std::vector<float>(size(width_, rows_)));
    }

    void run() {
        const int r = settings_.search_radius;
        for (int dy = -r; dy <= r; ++dy)
            for (int dx = -r; dx <= r; ++dx) {
                if (features_) compare_features(dx, dy);
                for (std::size_t h : {0, 1}) {
                    compare_colors(colors_[h], dx, dy);
                    add(1 - h, dx, dy);
                }
            }
    }
    /// The filtered value of a half's plane.
    float value(std::size_t half, std::size_t plane, int x, int y) const {
        const std::size_t at = size(width_, y - first_) + static_cast<std::size_t>(x);
        return sums_[half][plane][at] / sums_[half].back()[at];
    }

private:
    static std::size_t size(int width, int height) {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    }

    /// D^2 of (2), summed over the channels, in the rows and around them.
    void compare_colors(const Colors& colors, int dx, int dy) {
        const int f = settings_.patch_radius;
        const float k2 = sqr(settings_.k), epsilon = epsilon_;
        for (int y = -f; y < rows_ + f; ++y) {
            float* const distance = distances_.data() + size(wide_, y + f);
            for (std::size_t c = 0; c < 3; ++c) {
                const float* const p = colors.value.row(c, first_ + y) - f;
                const float* const q = colors.value.row(c, first_ + y + dy) + dx - f;
                const float* const vp = colors.variance.row(c, first_ + y) - f;
                const float* const vq = colors.variance.row(c, first_ + y + dy) + dx - f;
                for (int x = 0; x < wide_; ++x) {
                    const float apart = p[x] - q[x], rest = apart * apart - (vp[x] + std::min(vp[x], vq[x]));
                    const float d2 = rest / (epsilon + k2 * (vp[x] + vq[x]));
                    distance[x] = c == 0 ? d2 : distance[x] + d2;
                }
            }
        }
    }

    /// d_f^2 of (4).
    void compare_features(int dx, int dy) {
        const float scale = 1.f / sqr(settings_.k_feature);
        for (int y = 0; y < rows_; ++y) {
            float* const apart = features_apart_.data() + size(width_, y);
            for (std::size_t c = 0; c < feature_channels; ++c) {
                const float* const p = features_->value.row(c, first_ + y);
                const float* const q = features_->value.row(c, first_ + y + dy) + dx;
                const float* const vp = features_->variance.row(c, first_ + y);
                const float* const vq = features_->variance.row(c, first_ + y + dy) + dx;
                const float* const tolerance = features_->tolerance.row(c, first_ + y);
                const float* const slope = features_->slope.row(c, first_ + y);
                const float steps2 = c == depth_channel ? static_cast<float>(dx * dx + dy * dy) : 1.f;
                for (int x = 0; x < width_; ++x) {
                    const float d = p[x] - q[x], rest = d * d - (vp[x] + std::min(vp[x], vq[x]));
                    const float d2 = scale * rest / std::max(tolerance[x], steps2 * slope[x]);
                    apart[x] = c == 0 ? d2 : std::max(apart[x], d2);
                }
            }
        }
    }

    /// Adds w B(q) and w of (6) for the weights by (3) and (5).
    void add(std::size_t half, int dx, int dy) {
        const int side = 2 * settings_.patch_radius + 1;
        const float share = 1.f / static_cast<float>(3 * side * side);
        float *const columns = columns_.data(), *const weights = weights_.data();
        for (int y = 0; y < rows_; ++y) {
            std::fill(columns_.begin(), columns_.end(), 0.f);
            for (int j = 0; j < side; ++j) {
                const float* const distance = distances_.data() + size(wide_, y + j);
                for (int x = 0; x < wide_; ++x)
                    columns[x] += distance[x];
            }
            std::fill(weights_.begin(), weights_.end(), 0.f);
            for (int i = 0; i < side; ++i)
                for (int x = 0; x < width_; ++x)
                    weights[x] += columns[x + i];
            const float* const apart = features_apart_.data() + size(width_, y);
            for (int x = 0; x < width_; ++x)
                weights[x] = decay(std::max(share * weights[x], apart[x]));
            float* const sum_of_weights = sums_[half].back().data() + size(width_, y);
            for (int x = 0; x < width_; ++x)
                sum_of_weights[x] += weights[x];
            for (std::size_t plane = 0; plane < sources_[half].count(); ++plane) {
                const float* const source = sources_[half].row(plane, first_ + y + dy) + dx;
                float* const sum = sums_[half][plane].data() + size(width_, y);
                for (int x = 0; x < width_; ++x)
                    sum[x] += weights[x] * source[x];
            }
        }
    }
    /// exp(-x), or 1 for x below 0.
    static float decay(float x) {
        const float base = std::max(0.f, 1.f - std::max(0.f, x) / 16.f);
        return sqr(sqr(sqr(sqr(base))));
    }

    const std::array<Colors, 2>& colors_;
    const Features* features_;
    const std::array<MirroredPlanes, 2>& sources_;
    const NonLocalMeansSettings& settings_;
    float epsilon_;
    int first_, rows_, width_, wide_;
    std::vector<float> distances_, columns_, weights_, features_apart_;
    std::array<std::vector<std::vector<float>>, 2> sums_;  ///< by half; the last plane holds the sums of weights
};

/// The components in which a half has light.
std::vector<Component> lit_components(const std::array<HalfImage, 2>& halves) {
    std::vector<Component> lit;
    for (const Component c : all_components)
        if (std::any_of(halves.begin(), halves.end(), [&](const HalfImage& half) {
                const auto& image = half.mean[c];
                return image && std::any_of(image->rgb.begin(), image->rgb.end(), [](float v) { return v != 0; });
            }))
            lit.push_back(c);
    return lit;
}

double mean_of(const Image& image) {
    double sum = 0;
    for (const float v : image.rgb)
        sum += v;
    return sum / static_cast<double>(image.rgb.size());
}

}  // namespace

Image variance_of_mean(const Image& x, double n_x, const Image& y, double n_y) {
    Image variance = x;
    const auto factor = static_cast<float>(n_x * n_y / sqr(n_x + n_y));
    for (std::size_t i = 0; i < variance.rgb.size(); ++i)
        variance.rgb[i] = factor * sqr(x.rgb[i] - y.rgb[i]);
    return variance;
}

ComponentImages non_local_means(const std::array<HalfImage, 2>& halves, const std::array<FeatureImages, 2>* features,
                                const NonLocalMeansSettings& settings) {
    const auto [width, height] = std::pair(halves[0].mean.width, halves[0].mean.height);
    const int margin = settings.search_radius + std::max(settings.patch_radius, settings.variance_radius);
    const std::array<Colors, 2> colors = {colors_of(halves[0], margin, settings.variance_radius),
                                          colors_of(halves[1], margin, settings.variance_radius)};
    const std::optional<Features> of_surfaces =
        features ? std::optional<Features>(std::in_place, *features, margin, settings.tolerance) : std::nullopt;
    const std::vector<Component> lit = lit_components(halves);
    const MirroredPlanes black(width, height, margin, 3 * lit.size());
    std::array<MirroredPlanes, 2> sources = {black, black};
    for (std::size_t h : {0, 1})
        for (std::size_t i = 0; i < 3 * lit.size(); ++i)
            sources[h].fill(i, *halves[h].mean[lit[i / 3]], static_cast<int>(i % 3));
    // Differences far below the image's light, such as those of rounding, are no differences.
    const auto epsilon = static_cast<float>(1e-10 * sqr(mean_of(halves[0].mean.total())) + 1e-30);

    ComponentImages filtered;
    filtered.width = width;
    filtered.height = height;
    for (const Component c : all_components)
        if (halves[0].mean[c]) filtered[c] = Image(width, height);
    const double all = halves[0].passes + halves[1].passes;
    const std::array<float, 2> share = {static_cast<float>(halves[0].passes / all),
                                        static_cast<float>(halves[1].passes / all)};
    parallel_blocks(
        static_cast<std::size_t>(height), rows_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
            const auto [first, last] = std::pair(static_cast<int>(begin), static_cast<int>(end));
            FilteredRows rows(colors, of_surfaces ? &*of_surfaces : nullptr, sources, settings, epsilon, first, last);
            rows.run();
            for (std::size_t i = 0; i < 3 * lit.size(); ++i)
                for (int y = first; y < last; ++y)
                    for (int x = 0; x < width; ++x)
                        filtered[lit[i / 3]]->rgb[static_cast<std::size_t>(3 * (y * width + x)) + i % 3] =
                            share[0] * rows.value(0, i, x, y) + share[1] * rows.value(1, i, x, y);
        });
    return filtered;
}

}  // namespace gib
