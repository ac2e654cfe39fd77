// Tests of the sampler tests: correct samplers pass as often as they should, and small mistakes are noticed.

#include "common/core/parallel.h"
#include "common/sampling/warp.h"
#include "tests/samplers/sampler_cases.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <algorithm>

namespace gib::test::sampler_harness_test {
namespace {

constexpr double pi_d = std::numbers::pi;
constexpr std::uint64_t samples = 1'000'000;

/// The first threshold of Holm's correction for a family of 1000 p-values with alpha = 0.01.
constexpr double threshold = 0.01 / 1000;

bool has_unlikely_p(const CaseResult& result) {
    return std::any_of(result.p_values.begin(), result.p_values.end(),
                       [](const PValue& v) { return !(v.p > threshold); });
}

::testing::AssertionResult passes(const SamplerCase& test) {
    const CaseResult result = run_case(test, samples);
    if (!result.failures.empty()) return ::testing::AssertionFailure() << test.name << ": " << result.failures[0];
    if (has_unlikely_p(result)) return ::testing::AssertionFailure() << test.name << ": unlikely";
    return ::testing::AssertionSuccess();
}

/// Whether a p-value alone rejects the case.
::testing::AssertionResult is_rejected(const SamplerCase& test) {
    const CaseResult result = run_case(test, samples);
    if (has_unlikely_p(result)) return ::testing::AssertionSuccess();
    auto failure = ::testing::AssertionFailure() << test.name << ":";
    for (const PValue& v : result.p_values)
        failure << ' ' << v.test << " p = " << v.p;
    return failure;
}

/// Samples a direction with a density in proportion to cos^n.
Vec3 sample_cosine_power(const Vec2& u, double n) {
    const double z = std::pow(1 - static_cast<double>(u.x()), 1 / (n + 1)), r = std::sqrt(1 - z * z);
    const double phi = 2 * pi_d * static_cast<double>(u.y());
    return Vec3d(r * std::cos(phi), r * std::sin(phi), z).cast<float>();
}

double cosine_power_pdf(const Vec3& w, double n) {
    return w.z() > 0.f ? (n + 1) / (2 * pi_d) * std::pow(static_cast<double>(w.z()), n) : 0.0;
}

/// Two lobes that are chosen with probabilities `sampled` and 1 - `sampled`; the pdf claims `claimed` and 1 -
/// `claimed`. The value is that of an equal mixture with albedos of 0.8 and 0.4. In the weights of the samples, the
/// second lobe keeps only the share `kept` of its value.
SamplerCase two_lobes_case(const std::string& name, double sampled, double claimed, double kept = 1) {
    constexpr double sharp = 50;
    const auto pdf = [claimed](const Vec3& w) {
        return claimed * cosine_power_pdf(w, sharp) + (1 - claimed) * cosine_power_pdf(w, 1);
    };
    const auto value = [](const Vec3& w, double part) {
        return 0.8 * 0.5 * cosine_power_pdf(w, sharp) + part * 0.4 * 0.5 * cosine_power_pdf(w, 1);
    };
    SamplerCase test = sphere_case(
        name, SphereChart(),
        [sampled, kept, pdf, value](const RandomNumbers& r) -> std::optional<SampledDirection> {
            const Vec3 w = sample_cosine_power(r.u, static_cast<double>(r.choice.x()) < sampled ? sharp : 1);
            return SampledDirection{w, pdf(w), value(w, kept) / pdf(w)};
        },
        pdf);
    test.value = [value, chart = SphereChart()](const Vec2d& x) { return value(chart.direction(x).cast<float>(), 1); };
    test.mean_weight = 0.6;
    return test;
}

// The p-values of correct samplers are uniform: a Kolmogorov-Smirnov test of 64 p-values of each kind, alpha = 0.001
// for each kind.
TEST(SamplerHarness, PValuesOfRightSamplersAreUniform) {
    constexpr std::size_t n = 64;
    std::vector<CaseResult> results(n);
    parallel_blocks(n, 1, [&](std::size_t i, std::size_t, std::size_t) {
        results[i] = run_case(two_lobes_case(fmt::format("two lobes, seed {}", i), 0.5, 0.5), 100'000);
    });
    for (std::size_t kind = 0; kind < results[0].p_values.size(); ++kind) {
        std::vector<double> p;
        for (const CaseResult& result : results) {
            EXPECT_TRUE(result.failures.empty()) << result.failures[0];
            p.push_back(result.p_values.at(kind).p);
        }
        std::sort(p.begin(), p.end());
        double distance = 0;
        for (std::size_t i = 0; i < n; ++i) {
            distance = std::max({distance, std::abs(p[i] - static_cast<double>(i) / n),
                                 std::abs(p[i] - static_cast<double>(i + 1) / n)});
        }
        EXPECT_LT(distance, 1.95 / std::sqrt(n)) << results[0].p_values[kind].test;
    }
}

TEST(SamplerHarness, CatchesALobeProbabilityThatIsOnePercentOff) {
    EXPECT_TRUE(passes(two_lobes_case("two lobes", 0.5, 0.5)));
    EXPECT_TRUE(is_rejected(two_lobes_case("two lobes, off", 0.5, 0.505)));
}

}  // namespace
}  // namespace gib::test::sampler_harness_test
