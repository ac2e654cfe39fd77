#include "common/sampling/warp.h"

namespace gib {

namespace {

/// (sin h - h cos h) / h, whose terms cancel for small h.
double sine_moment(double h) {
    const double h2 = h * h;
    if (h < 0.02) return h2 * (1.0 / 3 - h2 * (1.0 / 30 - h2 / 840));
    return std::sin(h) / h - std::cos(h);
}

}  // namespace

double PolarRamp::integral() const {
    // Around the middle m, with theta = m + t and t in [-h, h], only the even terms of
    // (f_m + g t) (sin m cos t + cos m sin t) remain.
    const double h = 0.5 * (theta1 - theta0), m = 0.5 * (theta0 + theta1);
    if (!(h > 0)) return 0;
    return (f0 + f1) * std::sin(m) * std::sin(h) + (f1 - f0) * std::cos(m) * sine_moment(h);
}

double PolarRamp::sample(double u) const {
    const double width = theta1 - theta0, target = u * integral();
    const auto f = [&](double theta) { return f0 + (f1 - f0) * ((theta - theta0) / width); };
    double low = theta0, high = theta1;
    double theta = theta0 + width * sample_linear(u, f0 * std::sin(theta0), f1 * std::sin(theta1));
    // Newton's steps, bisection where one leaves the bracket: at the poles the density starts at 0.
    for (int i = 0; i < 60; ++i) {
        const double excess = PolarRamp{theta0, theta, f0, f(theta)}.integral() - target;
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
    // Between random numbers, which are multiples of 2^-24, an interval has no chance, whatever its width.
    std::vector<float> ends;
    ends.reserve(weights.size());
    double sum = 0;
    for (double w : weights) {
        sum += w;
        ends.push_back(static_cast<float>(std::ldexp(std::round(std::ldexp(sum / total_, 24)), -24)));
    }
    // Rounding must not leave a gap at the end that no item owns, nor give it to an item of weight zero.
    for (std::size_t i = weights.size(); i-- > 0;) {
        ends[i] = 1.f;
        if (weights[i] > 0) break;
    }
    // The probability is that of the rounded interval, which is what is sampled.
    items_.reserve(weights.size());
    float begin = 0.f;
    for (float end : ends) {
        const float probability = end - begin;
        items_.push_back({begin, probability, probability > 0.f ? 1.f / probability : 0.f});
        begin = end;
    }
}

}  // namespace gib
