// Notation: a reference R = mean of m groups G_g = truth + h_g; e an image's difference from the truth; w = 1 / (r^2 +
// epsilon).
//
// E (x - R)^2 / (R^2 + epsilon) less stderr^2 / (R^2 + epsilon) is not e^2 w where the noise is skewed. Where rare
// bright paths carry the light, a pixel that has not met them yet is too dark AND has too small a standard error; and
// both are divided by its own R, which is largest where a bright path was met. References of a true error of 10 % seem
// to have one of 5 %, and the errors of images move by as much.
//
// Cross-fitting (Chernozhukov et al. 2018, "Double/debiased machine learning", section 3) removes the dependence. The
// groups form four folds; a pair of groups g, h is weighed by w_gh, whose r comes from the folds that hold neither. As
// groups are independent,
//     E mean over g != h of w_gh (x - G_g)(x - G_h)  =  e^2 E w              (NoisyTruth)
//     E sum over g < h of w_gh (G_g - G_h)^2 / (m^2 (m - 1))  =  Var R E w   (variance_of)
// whatever the distribution of the noise. Two groups of one fold take the mean of the three weights that leave it out.
//
// The remaining bias is that of E w, which exceeds 1 / (truth^2 + epsilon) because 1 / r^2 is convex: by 3 Var r / r^2
// to the second order, and by a factor of r^2 / epsilon in pixels that no path has reached. So r is smoothed by the
// local linear filter of least mean square error (Lee 1980): in windows of 7 x 7 pixels with the mean mu, the scatter
// S^2 and the mean variance of the noise v,
//     r <- r + lambda (mu - r),    lambda = min(1, 2 v / S^2).
// Twice the variance makes windows without a picture of their own, where S^2 scatters around v, entirely flat. With the
// noise, lambda vanishes, and with it the difference from the plain formula. v is pooled over the window, so that
// pixels that were not hit borrow it. A pixel that surely differs from the one in the middle, by three standard
// deviations and more than fourfold, is no part of its window (the idea of Lee's sigma filter, 1983): a lamp in view
// would make S^2 so large that nothing is smoothed around it, where references of a true error of 6 % claimed 8.4 %.
// Simulated with 64 x 64 pixels, edges, textures, lamps and noise that comes in hits, from 0.05 to 4 a pixel and of
// equal or exponential height, the estimated error of a reference is 1.00 to 1.18 times the true one (plain formula:
// 0.1 to 1.1; cross-fitting without a filter: 1.0 to 27).
#include "experiments/metrics/denominators.h"

#include "common/core/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace gib {

namespace {

constexpr int filter_reach = 3;          ///< [pixels] to each side
constexpr double noise_threshold = 2;    ///< lambda = 1 up to S^2 = this many v
constexpr double surely_different = 3;   ///< [standard deviations of the difference]
constexpr double most_ratio = 4;         ///< of values that are alike, however sure they are
constexpr std::size_t rows_at_once = 8;  ///< rows of a parallel task

/// Values of `width` x `height` x 3 with the variances of their noise.
struct NoisyValues {
    std::vector<double> r, variance;
    int width, height;

    /// Whether value j belongs to the picture around value i.
    bool is_alike(std::size_t i, std::size_t j) const {
        return sqr(r[j] - r[i]) <= sqr(surely_different) * (variance[i] + variance[j]) ||
               std::max(r[i], r[j]) <= most_ratio * std::min(r[i], r[j]);
    }
    /// Value i at (x, y), filtered.
    double smoothed(std::size_t i, int x, int y) const {
        double count = 0, sum = 0, squares = 0, noise = 0;
        for (int v = std::max(0, y - filter_reach); v <= std::min(height - 1, y + filter_reach); ++v)
            for (int u = std::max(0, x - filter_reach); u <= std::min(width - 1, x + filter_reach); ++u) {
                const std::size_t j = i + 3 * static_cast<std::size_t>((v - y) * width + (u - x));
                if (!is_alike(i, j)) continue;
                count += 1;
                sum += r[j] - r[i];
                squares += sqr(r[j] - r[i]);
                noise += noise_threshold * variance[j];
            }
        const double scatter = squares / count - sqr(sum / count);
        const double lambda = noise <= 0 ? 0 : scatter > noise / count ? noise / count / scatter : 1;
        return r[i] + lambda * sum / count;
    }
};

Image smoothed(const NoisyValues& values) {
    Image image(values.width, values.height);
    const auto columns = static_cast<std::size_t>(values.width);
    parallel_blocks(
        static_cast<std::size_t>(values.height), rows_at_once, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t i = 3 * columns * begin; i < 3 * columns * end; ++i)
                image.rgb[i] = static_cast<float>(
                    values.smoothed(i, static_cast<int>(i / 3 % columns), static_cast<int>(i / 3 / columns)));
        });
    return image;
}

/// The mean of the groups for which `is_in(g)`, filtered by the scatter of these groups.
template <typename IsIn>
Image smoothed_mean(const std::vector<Image>& groups, const IsIn& is_in) {
    const std::size_t size = groups.front().rgb.size();
    NoisyValues values{std::vector<double>(size), std::vector<double>(size), groups.front().width,
                       groups.front().height};
    double n = 0;
    for (std::size_t g = 0; g < groups.size(); ++g)
        n += is_in(g) ? 1 : 0;
    for (std::size_t i = 0; i < size; ++i) {
        for (std::size_t g = 0; g < groups.size(); ++g)
            if (is_in(g)) values.r[i] += double{groups[g].rgb[i]} / n;
        for (std::size_t g = 0; g < groups.size(); ++g)
            if (is_in(g)) values.variance[i] += sqr(double{groups[g].rgb[i]} - values.r[i]) / (n * (n - 1));
    }
    return smoothed(values);
}

}  // namespace

/// The weights of pairs of groups of one value, and the groups' differences from the layer's mean.
class Denominators::Pairs {
public:
    Pairs(const Denominators& of, const ReferenceLayer& layer)
        : of_(of), layer_(layer), count_(static_cast<double>(layer.groups.size())), differences_(layer.groups.size()) {}

    void set(std::size_t i) {
        for (std::size_t l = 0; l < folds; ++l)
            for (std::size_t k = 0; k < l; ++k)
                weights_[k][l] = weights_[l][k] = of_.weight(of_.without_[l * (l - 1) / 2 + k], i);
        for (std::size_t k = 0; k < folds; ++k) {
            weights_[k][k] = 0;
            sums_[k] = squares_[k] = counts_[k] = 0;
            for (std::size_t l = 0; l < folds; ++l)
                if (l != k) weights_[k][k] += weights_[k][l] / (folds - 1);
        }
        for (std::size_t g = 0; g < differences_.size(); ++g) {
            const double d = differences_[g] = double{layer_.mean.rgb[i]} - double{layer_.groups[g].rgb[i]};
            sums_[g % folds] += d;
            squares_[g % folds] += d * d;
            counts_[g % folds] += 1;
        }
    }
    /// The mean over pairs g != h of w_gh (d + d_g) (d + d_h) is square d^2 + linear d + constant.
    struct Polynomial {
        double square = 0, linear = 0, constant = 0;
    };
    Polynomial product() const {
        Polynomial p;
        const double pairs = count_ * (count_ - 1);
        for (std::size_t k = 0; k < folds; ++k) {
            double others = -weights_[k][k];  // the weights of one group of the fold with all others
            for (std::size_t l = 0; l < folds; ++l) {
                others += weights_[k][l] * counts_[l];
                p.constant += weights_[k][l] * sums_[k] * sums_[l] / pairs;
            }
            p.constant -= weights_[k][k] * squares_[k] / pairs;
            p.linear += 2 * others * sums_[k] / pairs;
            p.square += others * counts_[k] / pairs;
        }
        return p;
    }
    /// The part of group g in the sum over pairs g < h of w_gh (d_g - d_h)^2 / (m^2 (m - 1)): half of its pairs.
    double variance(std::size_t g) const {
        double sum = 0;
        const double d = differences_[g];
        for (std::size_t l = 0; l < folds; ++l)
            sum += weights_[g % folds][l] * (counts_[l] * d * d - 2 * d * sums_[l] + squares_[l]);
        return sum / (2 * count_ * count_ * (count_ - 1));
    }

private:
    const Denominators& of_;
    const ReferenceLayer& layer_;
    double count_;
    std::vector<double> differences_;
    std::array<std::array<double, folds>, folds> weights_;
    std::array<double, folds> sums_, squares_, counts_;
};

Denominators::Denominators(const ReferenceLayer& total, double epsilon) : Denominators(total.mean, epsilon) {
    // An error against what is not finite is no number; filtering would spread it.
    if (total.non_finite_values() > 0 || plain_.rgb.empty()) return;
    if (total.groups.size() < folds) {
        if (!total.standard_error) return;
        NoisyValues values{{plain_.rgb.begin(), plain_.rgb.end()}, {}, plain_.width, plain_.height};
        for (const float error : total.standard_error->rgb)
            values.variance.push_back(sqr(double{error}));
        smooth_ = smoothed(values);
        return;
    }
    groups_ = total.groups.size();
    smooth_ = smoothed_mean(total.groups, [](std::size_t) { return true; });
    for (std::size_t l = 0; l < folds; ++l)
        for (std::size_t k = 0; k < l; ++k)
            without_.push_back(
                smoothed_mean(total.groups, [&](std::size_t g) { return g % folds != k && g % folds != l; }));
}

SampleMean Denominators::variance_of(const ReferenceLayer& layer) const {
    const auto size = static_cast<double>(layer.mean.rgb.size());
    SampleMean result{0, {std::numeric_limits<double>::quiet_NaN(), 0}};
    if (!crosses(layer)) {
        for (std::size_t i = 0; layer.standard_error && i < layer.mean.rgb.size(); ++i)
            result.value += weight(i) * sqr(double{layer.standard_error->rgb[i]}) / size;
        return result;
    }
    Pairs pairs(*this, layer);
    std::vector<double> parts(layer.groups.size());
    for (std::size_t i = 0; i < layer.mean.rgb.size(); ++i) {
        pairs.set(i);
        for (std::size_t g = 0; g < parts.size(); ++g)
            parts[g] += pairs.variance(g) / size;
    }
    // The variance of a U-statistic of order two is 4 times that of the mean over the groups of each group's own pairs
    // (Hoeffding 1948).
    const SampleMean mean = sample_mean(parts);
    const auto m = static_cast<double>(parts.size());
    return {m * mean.value, {4 * m * m * mean.variance.variance, m - 1}};
}

NoisyTruth::NoisyTruth(const ReferenceLayer& layer, const Denominators& denominators) : layer_(layer) {
    const auto size = static_cast<double>(layer.mean.rgb.size());
    const bool crosses = denominators.crosses(layer);
    Denominators::Pairs pairs(denominators, layer);
    for (std::size_t i = 0; i < layer.mean.rgb.size(); ++i) {
        Denominators::Pairs::Polynomial p{.square = denominators.weight(i)};
        if (crosses) {
            pairs.set(i);
            p = pairs.product();
        } else if (layer.standard_error) {
            p.constant = -p.square * sqr(double{layer.standard_error->rgb[i]});
        }
        square_.push_back(p.square);
        linear_.push_back(p.linear);
        constant_ += p.constant / size;
    }
    constant_ -= layer.mean_squared_bias([&](std::size_t i) { return denominators.weight(i); });
}

double NoisyTruth::squared_difference(const Image& x) const {
    double sum = 0;
    for (std::size_t i = 0; i < square_.size(); ++i) {
        const double d = double{x.rgb[i]} - double{layer_.mean.rgb[i]};
        sum += (square_[i] * d + linear_[i]) * d;
    }
    return sum / static_cast<double>(square_.size()) + constant_;
}

double relative_standard_error(const ReferenceLayer& layer, const Denominators& denominators) {
    if (layer.mean.rgb.empty()) return 0;
    return std::sqrt(denominators.variance_of(layer).value + sqr(relative_bias(layer, denominators)));
}

double relative_bias(const ReferenceLayer& layer, const Denominators& denominators) {
    return std::sqrt(layer.mean_squared_bias([&](std::size_t i) { return denominators.weight(i); }));
}

}  // namespace gib
