#include "common/sampling/warp.h"

namespace gib {

namespace {

/// (sin h - h cos h) / h. Its terms cancel for small h, for which a series is used.
double sine_moment(double h) {
    const double h2 = h * h;
    if (h < 0.02) return h2 * (1.0 / 3 - h2 * (1.0 / 30 - h2 / 840));
    return std::sin(h) / h - std::cos(h);
}

}  // namespace

double PolarRamp::integral() const {
    // With theta = m + t, where m is the middle and t lies in [-h, h], the integrand is (f_m + g t)
    // (sin m cos t + cos m sin t). Only its even terms in t contribute.
    const double h = 0.5 * (theta1 - theta0), m = 0.5 * (theta0 + theta1);
    if (!(h > 0)) return 0;
    return (f0 + f1) * std::sin(m) * std::sin(h) + (f1 - f0) * std::cos(m) * sine_moment(h);
}

double PolarRamp::sample(double u) const {
    const double width = theta1 - theta0, target = u * integral();
    const auto f = [&](double theta) { return f0 + (f1 - f0) * ((theta - theta0) / width); };
    double low = theta0, high = theta1;
    double theta = theta0 + width * sample_linear(u, f0 * std::sin(theta0), f1 * std::sin(theta1));
    // Newton's method. A step that leaves the bracket, as may happen near the poles, where the density starts at 0,
    // is replaced by bisection.
    for (int i = 0; i < 60; ++i) {
        const double excess =
            PolarRamp{.theta0 = theta0, .theta1 = theta, .f0 = f0, .f1 = f(theta)}.integral() - target;
        (excess > 0 ? high : low) = theta;
        const double density = f(theta) * std::sin(theta);
        double next = density == 0 ? low : theta - excess / density;
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (std::abs(next - theta) <= 1e-12 * width) return next;
        theta = next;
    }
    return theta;
}

DiscreteDistribution::DiscreteDistribution(const std::vector<double>& weights) {
    for (double w : weights)
        total_ += w;
    if (!(total_ > 0)) return;
    // Random numbers are multiples of 2^-24, so that an interval between two of them would never be chosen, whatever
    // its width. The ends are therefore rounded to such multiples.
    std::vector<float> ends;
    ends.reserve(weights.size());
    double sum = 0;
    for (double w : weights) {
        sum += w;
        ends.push_back(static_cast<float>(std::ldexp(std::round(std::ldexp(sum / total_, 24)), -24)));
    }
    // Rounding must neither leave a gap at the end that no item owns nor give it to an item of weight zero.
    for (std::size_t i = weights.size(); i-- > 0;) {
        ends[i] = 1.f;
        if (weights[i] > 0) break;
    }
    // An item's probability is the length of its rounded interval, because this is what is sampled.
    items_.reserve(weights.size());
    float begin = 0.f;
    for (float end : ends) {
        const float probability = end - begin;
        items_.push_back({begin, probability, probability > 0.f ? 1.f / probability : 0.f});
        begin = end;
    }
}

}  // namespace gib
