#include "tests/samplers/sampled_density.h"

#include "tests/samplers/cell_partition.h"
#include "tests/samplers/chi_square.h"
#include "tests/support/moments.h"

#include <fmt/format.h>
#include <algorithm>
#include <stdexcept>

namespace gib::test {

RandomNumbers::RandomNumbers(unsigned corner) {
    const auto end = [corner](int bit) { return (corner >> bit & 1u) ? 1.f - unit_roundoff : 0.f; };
    choice = {end(0), end(1)};
    u = {end(2), end(3)};
    v = {end(4), end(5)};
}

SphereChart::SphereChart(const Vec3d& axis) {
    const Vec3d n = axis.normalized();
    const Vec3d s = n.unitOrthogonal();
    to_local_ << s.transpose(), n.cross(s).transpose(), n.transpose();
}

Vec2d SphereChart::point(const Vec3d& w) const {
    const Vec3d local = (to_local_ * w).normalized();
    const double sin2 = sqr(local.x()) + sqr(local.y());
    // 1 - |cos| = sin^2 / (1 + |cos|)
    const double versine = sin2 / (1 + std::abs(local.z()));
    return {local.z() >= 0 ? versine : 2 - versine, std::atan2(local.y(), local.x())};
}

Vec3d SphereChart::direction(const Vec2d& point) const {
    const double v = point.x();
    const double sin_theta = std::sqrt(std::max(v * (2 - v), 0.0));
    const Vec3d local(sin_theta * std::cos(point.y()), sin_theta * std::sin(point.y()), 1 - v);
    return to_local_.transpose() * local;
}

Domain SphereChart::domain(const std::vector<double>& breaks) {
    Domain d{{0, 1, 2}, {-std::numbers::pi, std::numbers::pi}};
    d.x_breaks.insert(d.x_breaks.end(), breaks.begin(), breaks.end());
    std::sort(d.x_breaks.begin(), d.x_breaks.end());
    return d;
}

SamplerCase sphere_case(std::string name, const SphereChart& chart,
                        std::function<std::optional<SampledDirection>(const RandomNumbers&)> sample,
                        const std::function<double(const Vec3&)>& pdf) {
    SamplerCase test;
    test.name = std::move(name);
    test.domain = SphereChart::domain();
    test.sample = [chart, sample = std::move(sample), pdf](const RandomNumbers& numbers) -> std::optional<Sampled> {
        const auto s = sample(numbers);
        if (!s) return std::nullopt;
        return Sampled{chart.point(s->w.cast<double>()), s->pdf, s->delta ? s->pdf : pdf(s->w), s->weight, s->delta};
    };
    test.pdf = [chart, pdf](const Vec2d& point) { return pdf(chart.direction(point).cast<float>()); };
    return test;
}

SamplerCase plane_case(std::string name, Domain domain, std::function<Vec2(const RandomNumbers&)> sample,
                       const PlaneFunction& pdf) {
    SamplerCase test;
    test.name = std::move(name);
    test.domain = std::move(domain);
    test.sample = [sample = std::move(sample), pdf](const RandomNumbers& numbers) {
        const Vec2d point = sample(numbers).cast<double>();
        return Sampled{point, pdf(point), pdf(point)};
    };
    test.pdf = pdf;
    return test;
}

namespace {

constexpr int fine_levels = 10, coarse_levels = 4;

/// Samples that say where the partition is fine. A feature that holds less than a box's share of them moves no count by a
/// noticeable part of its standard deviation.
std::uint64_t pilot_samples(std::uint64_t samples) { return samples < 500'000 ? 1 << 16 : 1 << 17; }

/// The FNV-1a hash of the name.
std::uint64_t seed_of(const std::string& name) {
    std::uint64_t hash = 0xcbf29ce484222325ull;
    for (char c : name)
        hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
    return hash;
}

/// The random numbers of sample `i`. The pilot sample has another pixel index, so that its
/// numbers are independent of those.
RandomNumbers numbers_of(std::uint64_t seed, bool pilot, std::uint64_t i) {
    return RandomNumbers(Sampler(PointSet::independent, seed, pilot ? 1 : 0, static_cast<std::uint32_t>(i)));
}

class CaseRun {
public:
    CaseRun(const SamplerCase& test, std::uint64_t samples)
        : test_(test),
          seed_(seed_of(test.name)),
          samples_(samples),
          partition_(test.domain, pilot(), fine_levels,
                     std::max<std::size_t>(32, pilot_samples(samples) / (samples / 32))) {
        result_.name = test.name;
    }

    CaseResult run() {
        try_corners();
        draw();
        check_samples();
        try {
            integrate_density();
            test_counts();
            test_weights();
        } catch (const std::domain_error& e) {
            fail("the density or the value is {}", e.what());
        }
        return std::move(result_);
    }

private:
    template <typename... Args>
    void fail(fmt::format_string<Args...> format, Args&&... args) {
        result_.failures.push_back(fmt::format(format, std::forward<Args>(args)...));
    }

    std::vector<Vec2d> pilot() const {
        std::vector<Vec2d> points;
        for (std::uint64_t i = 0; i < pilot_samples(samples_); ++i) {
            const auto s = test_.sample(numbers_of(seed_, true, i));
            if (s && !s->delta && s->point.allFinite()) points.push_back(s->point);
        }
        return points;
    }

    static bool positive(double x) { return std::isfinite(x) && x > 0; }

    /// Tries the ends of the random numbers' ranges, where rounding is worst.
    void try_corners() {
        for (unsigned corner = 0; corner < 64; ++corner) {
            const auto s = test_.sample(RandomNumbers(corner));
            if (!s) continue;
            if (!positive(s->pdf)) fail("pdf {} for random numbers at corner {}", s->pdf, corner);
            if (!std::isfinite(s->weight)) fail("weight {} for random numbers at corner {}", s->weight, corner);
            if (!s->point.allFinite()) fail("a point that is not finite for random numbers at corner {}", corner);
        }
    }

    void draw() {
        counts_.assign(partition_.cells(), 0);
        const Rectangle bounds = test_.domain.bounds();
        for (std::uint64_t i = 0; i < samples_; ++i) {
            const auto s = test_.sample(numbers_of(seed_, false, i));
            if (!s) {
                ++lost_;
                continue;
            }
            if (!positive(s->pdf) || !std::isfinite(s->weight) || !s->point.allFinite()) {
                if (bad_++ == 0) bad_example_ = fmt::format("sample {}: pdf {}, weight {}", i, s->pdf, s->weight);
                continue;
            }
            if (s->delta) {
                delta_weights_.add(s->weight);
                continue;
            }
            weights_.add(s->weight);
            if (!(std::abs(s->pdf_again - s->pdf) <= limits::pdf_mismatch * s->pdf) && mismatches_++ == 0)
                mismatch_example_ = fmt::format("sample {} at ({}, {}): {} sampled, {} evaluated", i, s->point.x(),
                                                s->point.y(), s->pdf, s->pdf_again);
            const bool inside =
                (s->point.array() >= bounds.lower.array()).all() && (s->point.array() <= bounds.upper.array()).all();
            if (!inside) ++outside_;
            ++counts_[partition_.cell_of(s->point)];
        }
    }

    void check_samples() {
        const auto n = static_cast<double>(samples_);
        if (bad_ > 0)
            fail("{} samples whose pdf is not positive or whose weight is not finite; {}", bad_, bad_example_);
        if (static_cast<double>(mismatches_) > limits::mismatch_share * n)
            fail("{} samples whose two densities differ; {}", mismatches_, mismatch_example_);
        if (outside_ > 0) fail("{} samples outside the domain", outside_);
        if (test_.total == 1.0 && static_cast<double>(lost_) > limits::lost_share * n)
            fail("{} samples given up, though the density integrates to 1", lost_);
    }

    /// The integral of f over a cell, so precise that the error of an expected count is a small part of the count's
    /// standard deviation (limits::quadrature_error).
    Integral integrate_cell(const PlaneFunction& f, std::size_t cell) {
        constexpr std::size_t most = 4'000'000;
        const auto n = static_cast<double>(samples_);
        const Integral integral = integrate(
            f, partition_.boxes(cell),
            [n](double p) { return limits::quadrature_error * std::sqrt(std::max(p * n, 5.0)) / n; }, most);
        if (!integral.converged)
            fail("the integral over cell {} is {} +- {}, not precise enough", cell, integral.value, integral.error);
        return integral;
    }

    void integrate_density() {
        double variance = 0;
        for (std::size_t cell = 0; cell < partition_.cells(); ++cell) {
            const Integral integral = integrate_cell(test_.pdf, cell);
            probability_.push_back(integral.value);
            integral_ += integral.value;
            variance += sqr(integral.error);
        }
        const double error = std::sqrt(variance);
        const double expected = test_.total.value_or(std::min(integral_, 1.0));
        if (!(std::abs(integral_ - expected) <= limits::integral))
            fail("the density integrates to {:.5f} instead of {:.5f}", integral_, expected);
        if (!(error <= limits::integral / 2)) fail("the density's integral is uncertain by {}", error);
    }

    void test_counts() {
        const auto n = static_cast<double>(samples_);
        const double remainder = std::max(0.0, 1 - test_.total.value_or(integral_));
        const Cell rest{static_cast<double>(lost_ + delta_weights_.count() + bad_), n * remainder};
        for (int levels : {fine_levels, coarse_levels}) {
            const int shift = std::max(0, partition_.levels() - levels);
            std::vector<Cell> cells(partition_.cells() >> shift, Cell{0, 0});
            for (std::size_t i = 0; i < counts_.size(); ++i) {
                cells[i >> shift].observed += static_cast<double>(counts_[i]);
                cells[i >> shift].expected += n * probability_[i];
            }
            cells.push_back(rest);
            const PearsonTest test = pearson_test(cells);
            result_.p_values.push_back({fmt::format("{} cells", 1 << levels), test.p_value});
        }
    }

    void test_weights() {
        double mean = weights_.mean_of(samples_), variance = sqr(weights_.standard_error_of(samples_));
        if (test_.value) {
            double integral = 0, integral_variance = 0;
            for (std::size_t cell = 0; cell < partition_.cells(); ++cell) {
                const Integral part = integrate_cell(test_.value, cell);
                integral += part.value;
                integral_variance += sqr(part.error);
            }
            // Rounding to float dominates where the weights hardly vary.
            constexpr double rounding = 1e-5;
            const double deviation = std::sqrt(variance + integral_variance + sqr(rounding * integral));
            const double z = deviation > 0 ? (mean - integral) / deviation : 0;
            result_.p_values.push_back({"mean weight", normal_two_sided_tail(z)});
            mean = integral;
            variance = integral_variance;
        }
        mean += delta_weights_.mean_of(samples_);
        const double error = std::sqrt(variance + sqr(delta_weights_.standard_error_of(samples_)));
        if (test_.mean_weight && !(std::abs(mean - *test_.mean_weight) <= limits::mean_weight + 3 * error))
            fail("the mean weight is {:.5f} +- {:.5f} instead of {:.5f}", mean, error, *test_.mean_weight);
        if (!(mean <= test_.largest_mean_weight + limits::mean_weight + 3 * error))
            fail("the mean weight is {:.5f} +- {:.5f}, more than {}", mean, error, test_.largest_mean_weight);
    }

    const SamplerCase& test_;
    std::uint64_t seed_, samples_;
    CellPartition partition_;
    CaseResult result_;
    std::vector<std::uint64_t> counts_;
    std::vector<double> probability_;
    double integral_ = 0;  ///< of the density
    std::uint64_t lost_ = 0, bad_ = 0, mismatches_ = 0, outside_ = 0;
    Moments weights_, delta_weights_;  ///< the samples of the other kind count as zero
    std::string bad_example_, mismatch_example_;
};

}  // namespace

CaseResult run_case(const SamplerCase& test, std::uint64_t samples) { return CaseRun(test, samples).run(); }

}  // namespace gib::test
