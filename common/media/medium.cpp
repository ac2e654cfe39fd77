#include "common/media/medium.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

/// exp(-sigma t) by channel, also for an infinite t.
Color attenuation(const Color& sigma, float t) { return (sigma > 0.f).select((-sigma * t).exp(), Color::Ones()); }

/// The distance to the next event of a Poisson process of this rate [1/scene unit]. It takes two random numbers, for
/// 48 bits: with one of 24 bits the probability of an event within an optical depth of 1e-6 would be a multiple of
/// 2^-24 = 6e-8.
float free_flight(float rate, NumberStream& numbers) {
    if (!(rate > 0.f)) return infinity;
    const double high = numbers.next(), low = numbers.next();
    return static_cast<float>(-std::log1p(-(high + 0x1p-24 * low))) / rate;
}

}  // namespace

Medium::Medium(GridVolume extinction, float scale, GridVolume albedo, const PhaseFunction& phase)
    : extinction_(std::move(extinction)),
      albedo_(std::move(albedo)),
      scale_(scale),
      phase_(phase),
      majorant_(scale_ * extinction_.highest().maxCoeff()),
      scatters_(majorant_ > 0.f && albedo_.highest().maxCoeff() > 0.f) {}

Color Medium::scattering_at(const Vec3& p) const { return albedo_.at(p) * extinction_at(p); }

Color Medium::extinction_at(const Vec3& p) const { return (scale_ * extinction_.at(p)).min(majorant_); }

float Medium::mean_free_path_at(const Vec3& p) const {
    const float sigma_t = extinction_at(p).maxCoeff();
    return sigma_t > 0.f ? 1.f / sigma_t : infinity;
}

std::optional<float> Medium::sample_flight(const Vec3& from, const Vec3& w, float length, NumberStream& u,
                                           Color& throughput) const {
    if (!scatters_) {
        throughput *= transmittance(from, w, length, u);
        return std::nullopt;
    }
    float begin = 0.f, end = length;
    if (!extinction_.clip(from, w, begin, end)) return std::nullopt;
    return extinction_.constant() ? sample_constant(from, w, begin, end, u, throughput)
                                  : track_collisions(from, w, begin, end, u, throughput);
}

std::optional<float> Medium::sample_constant(const Vec3& from, const Vec3& w, float begin, float end, NumberStream& u,
                                             Color& throughput) const {
    const Color sigma = extinction_at(from);
    const float total = throughput.sum();
    if (!(total > 0.f)) return std::nullopt;
    const Color q = throughput / total;
    const float choice = u.next();
    int channel = choice < q[0] ? 0 : choice < q[0] + q[1] ? 1 : 2;
    while (q[channel] == 0.f)  // the rounded shares may sum to less than `choice`
        --channel;
    const float t = free_flight(sigma[channel], u);
    const auto mean = [&](const Color& density) { return (q * density).sum(); };
    if (t < end - begin) {
        const Color transmitted = attenuation(sigma, t);
        const Color scattered = albedo_.at(from + (begin + t) * w) * sigma * transmitted;
        throughput *= scattered / mean(sigma * transmitted);
        return begin + t;
    }
    const Color transmitted = attenuation(sigma, end - begin);
    throughput *= transmitted / mean(transmitted);
    return std::nullopt;
}

std::optional<float> Medium::track_collisions(const Vec3& from, const Vec3& w, float begin, float end, NumberStream& u,
                                              Color& throughput) const {
    // Distances are measured from the grid's edge: if a dense grid is far away, a flight is only an ulp of the
    // distance from the ray's origin.
    const Vec3 edge = from + begin * w;
    for (double way = 0;;) {  // float would stop growing over many short flights
        way += free_flight(majorant_, u);
        const auto t = static_cast<float>(way);
        if (!(t < end - begin)) return std::nullopt;
        const Vec3 p = edge + t * w;
        const Color sigma = extinction_at(p);
        const Color scattered = sigma * albedo_.at(p) / majorant_, passed = 1.f - sigma / majorant_;
        const float real = (throughput * scattered).mean(), null = (throughput * passed).mean();
        if (real + null == 0.f) {  // a throughput that is not finite goes on: the film counts it
            throughput.setZero();  // all is absorbed here
            return std::nullopt;
        }
        const float probability = real / (real + null);
        if (u.next() < probability) {
            throughput *= scattered / probability;
            return begin + t;
        }
        throughput *= passed / (1.f - probability);
    }
}

template <typename Passed>
Color Medium::track_ratio(const Vec3& from, const Vec3& w, float begin, float end, NumberStream& u,
                          Passed&& passed) const {
    Color transmitted = Color::Ones();
    const Vec3 edge = from + begin * w;
    // Once little light is left, Russian roulette ends the way through a dense medium.
    constexpr float little = 0.1f, survival = 0.5f;
    for (double way = 0;;) {
        way += free_flight(majorant_, u);
        const auto t = static_cast<float>(way);
        if (!(t < end - begin)) return transmitted;
        transmitted *= 1.f - extinction_at(edge + t * w) / majorant_;
        if (transmitted.maxCoeff() <= little) {
            if (!(transmitted.maxCoeff() > 0.f) || !(u.next() < survival)) transmitted.setZero();
            transmitted /= survival;
        }
        passed(begin + t, transmitted);
        if (!(transmitted.maxCoeff() > 0.f)) return transmitted;
    }
}

Color Medium::transmittance(const Vec3& from, const Vec3& w, float length, NumberStream& u) const {
    float begin = 0.f, end = length;
    if (!(majorant_ > 0.f) || !extinction_.clip(from, w, begin, end)) return Color::Ones();
    if (extinction_.constant()) return attenuation(extinction_at(from), end - begin);
    return track_ratio(from, w, begin, end, u, [](float, const Color&) {});
}

TransmittanceAlong Medium::transmittance_along(const Vec3& from, const Vec3& w, float length, NumberStream& u) const {
    TransmittanceAlong along;
    float begin = 0.f, end = length;
    if (!(majorant_ > 0.f) || !extinction_.clip(from, w, begin, end)) return along;
    along.begin_ = begin;
    along.end_ = end;
    if (extinction_.constant()) along.extinction_ = extinction_at(from);
    else
        track_ratio(from, w, begin, end, u,
                    [&](float t, const Color& transmitted) { along.steps_.emplace_back(t, transmitted); });
    return along;
}

Color TransmittanceAlong::at(float t) const {
    if (steps_.empty()) return attenuation(extinction_, std::clamp(t, begin_, end_) - begin_);
    const auto beyond = std::upper_bound(steps_.begin(), steps_.end(), t,
                                         [](float distance, const auto& step) { return distance < step.first; });
    return beyond == steps_.begin() ? Color(Color::Ones()) : std::prev(beyond)->second;
}

std::optional<Medium::Reach> Medium::sample_reach(const Vec3& from, const Vec3& w, float length, NumberStream& u,
                                                  Color& power) const {
    float begin = 0.f, end = length;
    const float total = power.sum();
    if (!(total > 0.f) || !extinction_.clip(from, w, begin, end)) return std::nullopt;
    const float choice = total * u.next();
    int channel = choice < power[0] ? 0 : choice < power[0] + power[1] ? 1 : 2;
    while (power[channel] == 0.f)  // the rounded sums may fall short of `choice`
        --channel;
    if (extinction_.constant()) {
        const Color sigma = extinction_at(from);
        // A channel without extinction is not scattered either; where the others have faded, the beam may end.
        constexpr float faded = 100.f;
        const float least = (sigma > 0.f).select(sigma, infinity).minCoeff();
        return Reach{begin, std::min({end, begin + free_flight(sigma[channel], u), begin + faded / least})};
    }
    if (!extinction_.grey()) {
        const float alone = total;  // power_c / q_c
        power.setZero();
        power[channel] = alone;
    }
    for (double way = 0;;) {
        way += free_flight(majorant_, u);
        const float t = begin + static_cast<float>(way);
        if (!(t < end)) return Reach{begin, end};
        if (u.next() * majorant_ < extinction_at(from + t * w)[channel]) return Reach{begin, t};
    }
}

Color Medium::power_along(const Color& power, float t) const {
    if (!extinction_.constant() || extinction_.grey()) return power;
    const Color transmitted = attenuation(extinction_at(Vec3::Zero()), t);
    return power * transmitted * (power.sum() / (power * transmitted).sum());
}

}  // namespace gib
