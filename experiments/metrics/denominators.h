#pragma once
// The denominators r^2 + epsilon of relative errors against a noisy reference, and estimates that the noise of the
// reference does not bias. denominators.cpp has the derivation.

#include "common/core/math.h"
#include "experiments/metrics/reference_image.h"
#include "experiments/metrics/student_t.h"

#include <vector>

namespace gib {

/// The images r in r^2 + epsilon, for every layer of a reference.
class Denominators {
public:
    /// From the reference's total. Without groups or a standard error, r is the image itself.
    Denominators(const ReferenceLayer& total, double epsilon);
    /// r is known exactly.
    Denominators(const Image& r, double epsilon) : epsilon_(epsilon), plain_(r), smooth_(r) {}

    double epsilon() const { return epsilon_; }
    /// The total itself: r of the plain formula.
    const Image& plain() const { return plain_; }
    /// The total with its noise smoothed.
    const Image& smooth() const { return smooth_; }
    /// 1 / (smooth^2 + epsilon) of value i.
    double weight(std::size_t i) const { return weight(smooth_, i); }

    /// Unbiased estimate of the mean over values of v / (r^2 + epsilon), where v is the variance of the layer's mean.
    /// Its own variance comes from the scatter of the groups; it is NaN without groups.
    SampleMean variance_of(const ReferenceLayer& layer) const;

private:
    friend class NoisyTruth;
    static constexpr std::size_t folds = 4;
    class Pairs;

    double weight(const Image& r, std::size_t i) const { return 1 / (sqr(double{r.rgb[i]}) + epsilon_); }
    /// Whether pairs of this layer's groups can be weighed by the other groups.
    bool crosses(const ReferenceLayer& layer) const { return groups_ > 0 && layer.groups.size() == groups_; }

    double epsilon_;
    std::size_t groups_ = 0;
    Image plain_, smooth_;
    std::vector<Image> without_;  ///< smoothed, without the groups of two folds: 0 1, 0 2, 1 2, 0 3, 1 3, 2 3
};

/// A layer of a reference as the truth with noise, from which images differ. Both arguments have to outlive it.
class NoisyTruth {
public:
    NoisyTruth(const ReferenceLayer& layer, const Denominators& denominators);

    /// Unbiased estimate of the mean over values of (x - truth)^2 / (r^2 + epsilon): the reference's noise and bias are
    /// subtracted. May be negative.
    double squared_difference(const Image& x) const;
    /// The mean over values of v / (r^2 + epsilon), where variance(i) is v of value i.
    template <typename Variance>
    double weighted_mean(const Variance& variance) const {
        double sum = 0;
        for (std::size_t i = 0; i < square_.size(); ++i)
            sum += square_[i] * variance(i);
        return sum / static_cast<double>(square_.size());
    }

private:
    const ReferenceLayer& layer_;
    std::vector<double> square_,
        linear_;           ///< by value: an image that lies d above the layer's mean differs from the truth by
    double constant_ = 0;  ///< mean(square d^2 + linear d) + constant
};

/// sqrt(mean of (v + bias^2) / (r^2 + epsilon)), with the variance v and the bias of the layer's mean; 0 without a
/// standard error and a bias.
double relative_standard_error(const ReferenceLayer& layer, const Denominators& denominators);
/// The part of it that is bias: sqrt(mean of bias^2 / (r^2 + epsilon)).
double relative_bias(const ReferenceLayer& layer, const Denominators& denominators);

}  // namespace gib
