// Bias and variance of a method from its replicates, and their intervals.
//
// Notation: n replicates x_i; a reference R = r + h with noise h, whose m groups are G_g; D = pixels x 3;
// <a, b> = sum(a b) / D. Everything below needs only the inner products of the x_i - R and the G_g - R, which take
// one pass over the images.
//
// bias2 is the two-sample U-statistic mean_{i != j} <x_i - R, x_j - R> - mean(stderr^2). Leaving out i = j is
// equivalent to subtracting the sampling variance s^2 / n. The variance of bias2, by Hoeffding's decomposition, is
// the sum of
//     4/n Var<b, e_i>  +  2/(n(n-1)) Var<e_i, e_j>      b the bias, e_i the noise of a replicate
//   + 4/m Var<b, h_g>  +  2/(m(m-1)) Var<h_g, h_h>      h_g the noise of a group of the reference
//   + 4/(nm) Var<e_i, h_g>
// The delete-one jackknife counts the terms of second order twice or more (Efron and Stein 1981), and these are the
// only terms when the bias is near zero. So both orders are estimated, without assuming a distribution of the noise.
// The inner products of different images form a diallel table (Griffing 1956, method 4): its main effects give the
// first order, its residuals the second. The variances from the seeds and from the groups are combined by
// half_width(). Intervals of squares (mse, variance) also allow for values too rare to be seen (unseen_terms).
#include "experiments/metrics/statistics.h"

#include "common/core/float_traps.h"
#include "common/core/parallel.h"
#include "common/core/reject.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace gib {

namespace {

/// The estimate of a positive statistic. The interval is symmetric in the logarithm, so that it stays positive and
/// follows the skewness of a variance from few replicates. Its upper end is raised by `unseen`.
Estimate positive_estimate(double value, const std::vector<VarianceTerm>& terms, double unseen) {
    if (value == 0) return {0, Interval{0, 0}};
    const double half = half_width(terms, interval_tail) / value;
    if (!std::isfinite(value) || !std::isfinite(half)) return {value, std::nullopt};
    return {value, Interval{value * std::exp(-half), value * std::exp(half) + unseen}};
}

Estimate square_root(const Estimate& e) {
    if (!e.interval) return {std::sqrt(e.value), std::nullopt};
    return {std::sqrt(e.value), Interval{std::sqrt(e.interval->lo), std::sqrt(e.interval->hi)}};
}

/// A small table of inner products.
using Table = Eigen::ArrayXXd;

/// The mean of a table, a row or a column. Eigen's own reductions are not used, because they make GCC 12 warn about
/// its AVX-512 headers.
double mean_of(const Eigen::Ref<const Table, 0, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>& values) {
    double sum = 0;
    for (Eigen::Index j = 0; j < values.cols(); ++j)
        for (Eigen::Index i = 0; i < values.rows(); ++i)
            sum += values(i, j);
    return sum / static_cast<double>(values.size());
}

/// A U-statistic of order two: the mean of a symmetric table of k_ij over pairs of different images. Its variance is
/// 4/n s1^2 + 2/(n(n-1)) s2^2, with s1^2 the variance of the table's main effects and s2^2 that of its residuals.
struct PairMean {
    double value = 0;
    std::vector<double> effects;  ///< main effects, unbiased, by Griffing's method 4
    double effects_square = 0;    ///< mean square, expectation (n-2) s1^2 + s2^2, n - 1 degrees of freedom
    double residual_square = 0;   ///< mean square, expectation s2^2, n(n-3)/2 degrees of freedom; from 4 images on
};

PairMean pair_mean(const Table& k) {
    PairMean result;
    const Eigen::Index count = k.rows();
    const auto n = static_cast<double>(count);
    for (Eigen::Index i = 0; i < count; ++i)
        for (Eigen::Index j = 0; j < i; ++j)
            result.value += 2 * k(i, j) / (n * (n - 1));
    if (count < 3) return result;
    for (Eigen::Index i = 0; i < count; ++i) {
        double sum = 0;
        for (Eigen::Index j = 0; j < count; ++j)
            sum += i == j ? 0 : k(i, j) - result.value;
        result.effects.push_back(sum / (n - 2));
        result.effects_square += (n - 2) * sqr(result.effects.back()) / (n - 1);
    }
    if (count < 4) return result;
    for (Eigen::Index i = 0; i < count; ++i)
        for (Eigen::Index j = 0; j < i; ++j)
            result.residual_square += sqr(k(i, j) - result.value - result.effects[static_cast<std::size_t>(i)] -
                                          result.effects[static_cast<std::size_t>(j)]) /
                                      (n * (n - 3) / 2);
    return result;
}

/// The variance by the delete-one jackknife. Its expectation is 4/n s1^2 + 4/(n(n-2)) s2^2, in which the term of
/// second order is more than twice the true one.
VarianceTerm pair_jackknife(const PairMean& pairs, double n) {
    return {4 / (n * (n - 2)) * pairs.effects_square, n - 1};
}

/// The variance of a pair mean of two or three images. Their table has no residuals, so its diagonal is used too. The
/// variance of the linearised statistic, 4/(n(n-1)) sum_i (mean_j k_ij - mean)^2, is exact for two images if the sums
/// of their noise are normal (many pixels); for three it has 1.33 times the term of second order. If few pixels carry
/// the noise, the diagonal scatters more than normal sums would, and the variance becomes too large.
VarianceTerm linearised(const Table& k) {
    const auto n = static_cast<double>(k.rows());
    double sum = 0;
    for (Eigen::Index i = 0; i < k.rows(); ++i)
        sum += sqr(mean_of(k.row(i)) - mean_of(k));
    return {4 / (n * (n - 1)) * sum, n - 1};
}

/// The variance of a pair mean whose first order may vanish. Subtracting 2/((n-1)(n-2))
/// residual_square from the jackknife would make it unbiased, but 95 % intervals from this
/// difference of two noisy squares cover only 91 % where both orders matter. So half of that is
/// subtracted, and the result is at least the variance that all squares together give if there is
/// no first order. For n >= 4, intervals cover 93 to 98 % at every ratio of the two orders.
VarianceTerm pair_variance(const Table& k) {
    const auto n = static_cast<double>(k.rows());
    const PairMean pairs = pair_mean(k);
    if (k.rows() < 4) {
        const VarianceTerm with_diagonal = linearised(k);
        // The jackknife needs no diagonal, but for three images it has four times the term of second order.
        if (k.rows() < 3 || with_diagonal.variance <= pair_jackknife(pairs, n).variance) return with_diagonal;
        return pair_jackknife(pairs, n);
    }
    const double residual_degrees = n * (n - 3) / 2;
    const double pooled =
        ((n - 1) * pairs.effects_square + residual_degrees * pairs.residual_square) / (n - 1 + residual_degrees);
    const double least = 2 / (n * (n - 1)) * pooled;
    const double half_corrected = pair_jackknife(pairs, n).variance - pairs.residual_square / ((n - 1) * (n - 2));
    if (half_corrected > least) return {half_corrected, n - 1 + residual_degrees * sqr(least / half_corrected)};
    return {least, n - 1 + residual_degrees};
}

/// The weights of errors: 1 / (r_total^2 + epsilon) for relative errors, 1 without `r_total`.
struct Weights {
    const Image* r_total = nullptr;
    double epsilon = 0;
    double operator()(std::size_t i) const { return r_total ? 1 / (sqr(double{r_total->rgb[i]}) + epsilon) : 1; }
};

/// The weighted inner products <a_i - R, a_j - R>, where the a_i are the replicates and, after them, the groups of
/// the reference. The sums are taken in blocks of fixed size in a fixed order, so that the result does not depend on
/// the number of threads.
Table inner_products(const std::vector<const Image*>& images, const Image& origin, const Weights& weights) {
    constexpr std::size_t block = 65536;
    const auto count = static_cast<Eigen::Index>(images.size());
    const std::size_t size = origin.rgb.size();
    std::vector<Table> sums((size + block - 1) / block);
    parallel_blocks(size, block, [&](std::size_t begin, std::size_t end, std::size_t b) {
        Table& sum = sums[b];
        sum = Table::Zero(count, count);
        Eigen::ArrayXd differences(count);
        for (std::size_t i = begin; i < end; ++i) {
            const double w = weights(i), zero = double{origin.rgb[i]};
            for (Eigen::Index k = 0; k < count; ++k)
                differences[k] = static_cast<double>(images[static_cast<std::size_t>(k)]->rgb[i]) - zero;
            // The lower triangle is added column by column. These operations are element-wise, so that they vectorise
            // without reordering a sum.
            for (Eigen::Index k = 0; k < count; ++k)
                sum.col(k).tail(count - k) += (w * differences[k]) * differences.tail(count - k);
        }
    });
    Table total = Table::Zero(count, count);
    for (const auto& part : sums)
        total += part / static_cast<double>(size);
    for (Eigen::Index k = 0; k < count; ++k)
        for (Eigen::Index j = 0; j < k; ++j)
            total(j, k) = total(k, j);
    return total;
}

/// The part of the variance that comes from a reference with a standard error but no groups. The errors of its pixels
/// are taken as independent, which holds for a path tracer with a box filter.
struct PlainReference {
    double variance = 0;        ///< weighted mean of stderr^2
    double bias2_variance = 0;  ///< (4 <d^2, stderr^2> + 2 <stderr^2, stderr^2>) / D with d = mean of x - R
    double squared_bias = 0;    ///< weighted mean of its squared bias
};

PlainReference plain_reference(const std::vector<Image>& replicates, const ReferenceLayer& reference,
                               const Weights& weights) {
    PlainReference result;
    result.squared_bias = reference.mean_squared_bias(weights);
    if (!reference.standard_error) return result;
    const auto size = static_cast<double>(reference.mean.rgb.size());
    for (std::size_t i = 0; i < reference.mean.rgb.size(); ++i) {
        double mean = 0;
        for (const Image& x : replicates)
            mean += double{x.rgb[i]};
        const double d = mean / static_cast<double>(replicates.size()) - double{reference.mean.rgb[i]};
        const double w = weights(i), variance = w * sqr(double{reference.standard_error->rgb[i]});
        result.variance += variance / size;
        result.bias2_variance += (4 * w * sqr(d) + 2 * variance) * variance / sqr(size);
    }
    return result;
}

/// A mean of squares may be larger because of values that are too rare for any replicate to show, which the scatter of
/// the replicates do not determine: up to this many times the largest square of a pixel. A value that does not occur in
/// a sample occurs less than -log(0.025) = 3.69 times in a sample of this size on average, with a confidence of 97.5 %
/// (Hanley and Lippman-Hand 1983 for 95 %: the rule of three). In a Pareto tail of index a, the squares beyond the
/// largest one that was seen exceed it a / (a - 1) times on average. The index is taken as 2, the heaviest tail whose
/// squares have a variance.
constexpr double unseen_terms = 3.69 * 2;

/// unseen_terms times the largest excess of one pixel of one replicate over the pixel's mean, for two kinds of squares.
struct Unseen {
    double mse = 0;       ///< excess of (x - R)^2
    double variance = 0;  ///< excess of (x - mean of the replicates)^2
};

Unseen unseen_squares(const std::vector<Image>& replicates, const Image& origin, const Weights& weights) {
    const auto n = static_cast<double>(replicates.size());
    Unseen largest;
    if (n < 2) return largest;
    std::vector<double> from_origin(replicates.size()), from_mean(replicates.size());
    for (std::size_t pixel = 0; pixel < origin.pixels(); ++pixel) {
        std::ranges::fill(from_origin, 0.0);
        std::ranges::fill(from_mean, 0.0);
        for (std::size_t i = 3 * pixel; i < 3 * pixel + 3; ++i) {
            double mean = 0;
            for (const Image& x : replicates)
                mean += double{x.rgb[i]} / n;
            for (std::size_t k = 0; k < replicates.size(); ++k) {
                const auto value = static_cast<double>(replicates[k].rgb[i]);
                from_origin[k] += weights(i) * sqr(value - double{origin.rgb[i]});
                from_mean[k] += weights(i) * sqr(value - mean);
            }
        }
        const auto excess = [n](const std::vector<double>& squares) {
            return *std::ranges::max_element(squares) - std::accumulate(squares.begin(), squares.end(), 0.0) / n;
        };
        largest.mse = std::max(largest.mse, excess(from_origin));
        largest.variance = std::max(largest.variance, excess(from_mean));
    }
    // A square s in one replicate alone exceeds the mean over the replicates by s (n - 1) / n. Around the mean of the
    // replicates, it leaves squares of s (n - 1)^2 / n^2 and s / n^2, whose excess is s (n - 1) (n - 2) / n^2.
    const double share = unseen_terms / (n * static_cast<double>(origin.rgb.size()));
    return {share * n / (n - 1) * largest.mse, n < 3 ? 0 : share * n * n / ((n - 1) * (n - 2)) * largest.variance};
}

/// The inner products for one choice of weights, from which all estimates are made.
struct Moments {
    Table seeds;                 ///< n x n, <x_i - R, x_j - R>
    Table groups;                ///< m x m, <mean x - G_g, mean x - G_h>; empty without groups
    double shared_variance = 0;  ///< 4/(nm) Var<e_i, h_g>, which the scatter of seeds and that of groups both contain
    std::vector<double> pulls;   ///< <mean x - R, G_g - R>
    PlainReference reference;
    Unseen unseen;
};

/// The mean square of the interactions in an n x m table, which
/// remain after the means of its rows and columns are subtracted.
double interaction_square(const Table& table) {
    Eigen::ArrayXd rows(table.rows()), columns(table.cols());
    for (Eigen::Index i = 0; i < table.rows(); ++i)
        rows[i] = mean_of(table.row(i));
    for (Eigen::Index j = 0; j < table.cols(); ++j)
        columns[j] = mean_of(table.col(j));
    const double mean = mean_of(table);
    double sum = 0;
    for (Eigen::Index i = 0; i < table.rows(); ++i)
        for (Eigen::Index j = 0; j < table.cols(); ++j)
            sum += sqr(table(i, j) - rows[i] - columns[j] + mean);
    return sum / static_cast<double>((table.rows() - 1) * (table.cols() - 1));
}

Moments moments(const std::vector<Image>& replicates, const ReferenceLayer& reference, const Weights& weights) {
    std::vector<const Image*> images;
    for (const Image& x : replicates)
        images.push_back(&x);
    const auto n = static_cast<Eigen::Index>(replicates.size());
    const auto m = reference.groups.size() < 2 ? 0 : static_cast<Eigen::Index>(reference.groups.size());
    for (Eigen::Index g = 0; g < m; ++g)
        images.push_back(&reference.groups[static_cast<std::size_t>(g)]);
    const Table all = inner_products(images, reference.mean, weights);

    Moments result;
    result.seeds = all.topLeftCorner(n, n);
    result.reference = plain_reference(replicates, reference, weights);
    result.unseen = unseen_squares(replicates, reference.mean, weights);
    if (m == 0) return result;
    const Table cross = all.topRightCorner(n, m), scatter = all.bottomRightCorner(m, m);
    result.groups = scatter + mean_of(result.seeds);
    double trace = 0;
    for (Eigen::Index g = 0; g < m; ++g) {
        result.pulls.push_back(mean_of(cross.col(g)));
        result.groups.row(g) -= result.pulls.back();
        result.groups.col(g) -= result.pulls.back();
        trace += scatter(g, g);
    }
    const auto groups = static_cast<double>(m);
    if (!reference.standard_error) result.reference.variance = trace / (groups * (groups - 1));
    if (n > 1) result.shared_variance = 4 * interaction_square(cross) / (static_cast<double>(n) * groups);
    return result;
}

/// The variance that the reference adds to bias2 and to mse,
/// without the part that the scatter of the seeds already contains.
VarianceTerm reference_term(const Moments& of) {
    // Without groups there is no scatter from which degrees of freedom could come; they count as infinite.
    if (of.groups.rows() == 0) return {of.reference.bias2_variance, std::numeric_limits<double>::infinity()};
    VarianceTerm term = pair_variance(of.groups);
    term.variance = std::max(0.0, term.variance - of.shared_variance);
    return term;
}

/// The interval of a squared bias x^2 against a reference whose own squared bias is b^2, of unknown sign: the value has
/// been (x - b)^2, which differs from x^2 by 2 |x b| + b^2 at most.
Estimate widened(Estimate bias2, double squared_bias) {
    if (!bias2.interval || !(squared_bias > 0)) return bias2;
    const double reach = 2 * std::sqrt(std::max(bias2.interval->hi, 0.0) * squared_bias) + squared_bias;
    bias2.interval->lo -= reach;
    bias2.interval->hi += reach;
    return bias2;
}

Estimate bias2_of(const Moments& of, double value) {
    return widened(estimate(value, {pair_variance(of.seeds), reference_term(of)}), of.reference.squared_bias);
}

/// The variance V of one replicate: the mean of k_ij = |x_i - x_j|^2 / 2 over pairs. Its term of first order vanishes
/// where all seeds deviate from their mean by the same distance, as two halves of alike seeds do; the jackknife then
/// gives no variance. So the variance is at least that of normal noise with covariance S, 2 T / (n - 1) with T =
/// tr(S^2), which falls with the number of independent pixels tr(S)^2 / tr(S^2). All squares of the table together
/// estimate T, for normal noise without bias (Srivastava 2005, "Some tests concerning the covariance matrix in high
/// dimensional data"), with (n - 2)(n + 1) / 2 degrees of freedom. If all pixels move together, T is V^2 (n - 1) / (n +
/// 1) for any seeds, and V itself has n - 1 degrees of freedom;
/// `share` is T relative to that, between 0 and 1. With that share the whole image also counts as one pixel whose largest value
/// may be unseen (unseen_terms). In simulations with 3 to 8 seeds, 95 % intervals cover 93 % or more for 1 to 3000
/// independent pixels of normal, uniform, two-valued, t (3, 5 degrees), lognormal and Poisson noise, and 92 % of one
/// exponential value.
Estimate variance_of(const Moments& of) {
    const Table& seeds = of.seeds;
    Table halves = -seeds;
    halves.colwise() += 0.5 * seeds.matrix().diagonal().array();
    halves.rowwise() += 0.5 * seeds.matrix().diagonal().array().transpose();
    const PairMean pairs = pair_mean(halves);
    // Two replicates form one pair, which has no scatter for an interval.
    if (seeds.rows() < 3) return {pairs.value, std::nullopt};
    if (pairs.value == 0) return {0, Interval{0, 0}};
    const auto n = static_cast<double>(seeds.rows());
    const double residual_degrees = n * (n - 3) / 2;
    const double trace_square = (2 * (n - 1) / n * pairs.effects_square + residual_degrees * pairs.residual_square) /
                                (n - 1 + residual_degrees);
    const double share = std::min(1.0, trace_square * (n + 1) / (sqr(pairs.value) * (n - 1)));
    const VarianceTerm least{2 * trace_square / (n - 1), n - 1 + residual_degrees * (1 - share)};
    const VarianceTerm scatter = pair_jackknife(pairs, n);
    const double unseen_image = share * unseen_terms * 2 / (n - 1) * *std::ranges::max_element(pairs.effects);
    return positive_estimate(pairs.value, {scatter.variance > least.variance ? scatter : least},
                             of.unseen.variance + unseen_image);
}

/// The mean squared error over the replicates. The interval belongs to the plain formula, whose expectation contains
/// the reference's variance.
Estimate mse_of(const Moments& of) {
    const auto n = static_cast<double>(of.seeds.rows());
    const Eigen::ArrayXd each = of.seeds.matrix().diagonal();
    const double value = mean_of(each);
    if (of.seeds.rows() < 2) return {value, std::nullopt};
    double scatter = 0;
    for (double error2 : each)
        scatter += sqr(error2 - value);
    return positive_estimate(value, {{scatter / (n * (n - 1)), n - 1}, reference_term(of)}, of.unseen.mse);
}

bool all_finite(const std::vector<Image>& images) {
    return std::ranges::all_of(images, [](const Image& x) { return x.non_finite_values() == 0; });
}

void require_same_size(const Image& image, const Image& reference) {
    if (!image.same_size(reference) || image.rgb.size() != reference.rgb.size())
        reject({}, "an image of {} x {} pixels cannot be compared with a reference of {} x {}", image.width,
               image.height, reference.width, reference.height);
}

struct TrueError {
    double rel_mse, rel_bias2;
};

/// Both errors against the truth. bias2 is the mean over pairs of different replicates, which is the squared difference
/// of their mean less the sampling variance s^2 / n.
TrueError true_error(const std::vector<Image>& replicates, const NoisyTruth& truth) {
    const auto n = static_cast<double>(replicates.size());
    double rel_mse = 0;
    for (const Image& x : replicates)
        rel_mse += truth.squared_difference(x) / n;
    const Image mean = mean_image(replicates);
    if (replicates.size() < 2) return {rel_mse, std::numeric_limits<double>::quiet_NaN()};
    const double sampling = truth.weighted_mean([&](std::size_t i) {
        double scatter = 0;
        for (const Image& x : replicates)
            scatter += sqr(double{x.rgb[i]} - double{mean.rgb[i]});
        return scatter / (n * (n - 1));
    });
    return {rel_mse, truth.squared_difference(mean) - sampling};
}

}  // namespace

Estimate estimate(double value, const std::vector<VarianceTerm>& terms) {
    const double half = half_width(terms, interval_tail);
    if (!std::isfinite(value) || !std::isfinite(half)) return {value, std::nullopt};
    return {value, Interval{value - half, value + half}};
}

Estimate jackknife(double value, const std::vector<double>& without, double tail) {
    const auto n = static_cast<double>(without.size());
    double mean = 0, scatter = 0;
    for (const double v : without)
        mean += v / n;
    for (const double v : without)
        scatter += sqr(v - mean);
    const double half = student_t_two_sided(tail, n - 1) * std::sqrt((n - 1) / n * scatter);
    return {value, Interval{value - half, value + half}};
}

ImageError image_error(const Image& x, const ReferenceLayer& reference, const Denominators& denominators,
                       const NoisyTruth& truth) {
    require_same_size(x, reference.mean);
    require_same_size(denominators.plain(), reference.mean);
    const Weights relative{&denominators.plain(), denominators.epsilon()};
    double mse = 0, rel_mse = 0, variance = 0;
    for (std::size_t i = 0; i < x.rgb.size(); ++i) {
        const double w = relative(i);
        const double error2 = sqr(double{x.rgb[i]} - double{reference.mean.rgb[i]});
        mse += error2;
        rel_mse += w * error2;
        if (reference.standard_error) variance += sqr(double{reference.standard_error->rgb[i]});
    }
    const auto size = static_cast<double>(x.rgb.size());
    return {.mse = mse / size,
            .rel_mse = rel_mse / size,
            .mse_corrected = (mse - variance) / size - reference.mean_squared_bias([](std::size_t) { return 1.0; }),
            .rel_mse_corrected = truth.squared_difference(x)};
}

ImageError image_error(const Image& x, const ReferenceLayer& reference, const Denominators& denominators) {
    require_same_size(denominators.plain(), reference.mean);
    return image_error(x, reference, denominators, NoisyTruth(reference, denominators));
}

ReplicateStatistics replicate_statistics(const std::vector<Image>& replicates, const ReferenceLayer& reference,
                                         const Denominators& denominators) {
    // Images with values that are not finite may give statistics that are not finite; this is not an error.
    const FloatTrapsPaused paused(float_traps_built && !all_finite(replicates));
    const Moments plain = moments(replicates, reference, {});
    const Moments relative = moments(replicates, reference, {&denominators.plain(), denominators.epsilon()});
    const TrueError truth = true_error(replicates, NoisyTruth(reference, denominators));
    ReplicateStatistics result{};
    result.seeds = static_cast<int>(replicates.size());
    result.mse = mse_of(plain);
    result.rmse = square_root(result.mse);
    result.rel_mse = mse_of(relative);
    // The difference is negative where the reference's own variance exceeds the error; then there is no root.
    const double corrected = result.mse.value - plain.reference.variance - plain.reference.squared_bias;
    result.rmse_corrected = corrected < 0 ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(corrected);
    result.rel_mse_corrected = truth.rel_mse;
    for (const double pull : relative.pulls)
        if (truth.rel_mse > 0) result.pulls.push_back(-2 * pull / truth.rel_mse);
    if (replicates.size() > 1) {
        result.bias2 = bias2_of(plain, pair_mean(plain.seeds).value - plain.reference.variance);
        result.variance = variance_of(plain);
        // The interval comes from the weights of all groups: they change its width by no more than its own uncertainty.
        const Moments smooth = moments(replicates, reference, {&denominators.smooth(), denominators.epsilon()});
        result.rel_bias2 = bias2_of(smooth, truth.rel_bias2);
    }
    return result;
}

double noise_floor_of(const ReferenceLayer& reference, const Denominators& denominators) {
    const Moments noise = moments({reference.mean}, reference, {&denominators.smooth(), denominators.epsilon()});
    // Only the term of second order counts: an exact image has no bias whose product with the noise of the reference
    // could scatter.
    const auto m = static_cast<double>(noise.groups.rows());
    const double variance =
        m < 4 ? noise.reference.bias2_variance : 2 / (m * (m - 1)) * pair_mean(noise.groups).residual_square;
    return student_t_two_sided(interval_tail, std::numeric_limits<double>::infinity()) * std::sqrt(variance) +
           noise.reference.squared_bias;
}

}  // namespace gib
