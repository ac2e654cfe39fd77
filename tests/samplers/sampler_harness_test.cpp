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

::testing::AssertionResult fails_with(const SamplerCase& test, const std::string& message) {
    const CaseResult result = run_case(test, samples);
    for (const std::string& f : result.failures)
        if (f.find(message) != std::string::npos) return ::testing::AssertionSuccess();
    auto failure = ::testing::AssertionFailure() << test.name << " did not fail with '" << message << "':";
    for (const std::string& f : result.failures)
        failure << "\n  " << f;
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

SamplerCase cosine_power_case(const std::string& name, double sampled, double claimed) {
    const auto pdf = [claimed](const Vec3& w) { return cosine_power_pdf(w, claimed); };
    return sphere_case(
        name, SphereChart(),
        [sampled, pdf](const RandomNumbers& r) -> std::optional<SampledDirection> {
            const Vec3 w = sample_cosine_power(r.u, sampled);
            return SampledDirection{w, pdf(w)};
        },
        pdf);
}

/// A lobe of any width: the von Mises-Fisher distribution around a mirror direction. Samples below the horizon are
/// given up. `claimed` is the concentration that the pdf uses.
SamplerCase narrow_lobe_case(const std::string& name, double theta, double concentration, double claimed) {
    const SphereChart lobe(direction_at(theta, 220).cast<double>());
    const auto pdf = [lobe, claimed](const Vec3& w) {
        if (w.z() <= 0.f) return 0.0;
        const double versine = lobe.point(w.cast<double>()).x();
        return claimed / (2 * pi_d * -std::expm1(-2 * claimed)) * std::exp(-claimed * versine);
    };
    SamplerCase test = sphere_case(
        name, SphereChart(),
        [lobe, concentration, pdf](const RandomNumbers& r) -> std::optional<SampledDirection> {
            const double u = static_cast<double>(r.u.x());
            const double versine = -std::log1p(u * std::expm1(-2 * concentration)) / concentration;
            const double phi = 2 * pi_d * static_cast<double>(r.u.y());
            const Vec3 w = lobe.direction({versine, phi}).cast<float>();
            if (w.z() <= 0.f) return std::nullopt;
            return SampledDirection{w, pdf(w)};
        },
        pdf);
    test.total = std::nullopt;
    return test;
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

/// Reflection about a half vector h with a density in proportion to cos^`exponent`. Without `with_jacobian`, the pdf
/// lacks the Jacobian 1 / (4 wo . h) of Walter et al. 2007, equation 14.
SamplerCase half_vector_case(const std::string& name, bool with_jacobian) {
    constexpr double exponent = 20;
    const Vec3 wo = direction_at(50, 40);
    const auto pdf = [wo, with_jacobian](const Vec3& wi) {
        if (wi.z() <= 0.f) return 0.0;
        const Vec3 h = (wo + wi).normalized();
        // A constant in place of the Jacobian keeps the integral of the pdf about right, as
        // a careless normalisation would.
        const double jacobian = with_jacobian ? 1 / (4 * static_cast<double>(wo.dot(h))) : 1 / (4 * 0.64);
        return cosine_power_pdf(h, exponent) * jacobian;
    };
    SamplerCase test = sphere_case(
        name, SphereChart(),
        [wo, pdf](const RandomNumbers& r) -> std::optional<SampledDirection> {
            const Vec3 h = sample_cosine_power(r.u, exponent);
            const Vec3 wi = 2 * wo.dot(h) * h - wo;
            if (wo.dot(h) <= 0.f || wi.z() <= 0.f) return std::nullopt;
            return SampledDirection{wi, pdf(wi)};
        },
        pdf);
    test.total = std::nullopt;
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

TEST(SamplerHarness, AcceptsLobesOfAnyWidthAtGrazingAngles) {
    for (double theta : {0.0, 60.0, 89.0})
        for (double concentration : {1e2, 1e4, 1e6})
            EXPECT_TRUE(passes(narrow_lobe_case(fmt::format("lobe {} at {}", concentration, theta), theta,
                                                concentration, concentration)));
}

TEST(SamplerHarness, CatchesAnExponentThatIsTwoPercentOff) {
    EXPECT_TRUE(passes(cosine_power_case("cosine", 1, 1)));
    EXPECT_TRUE(is_rejected(cosine_power_case("cosine, off", 1, 1.02)));
    EXPECT_TRUE(is_rejected(cosine_power_case("sharp cosine, off", 100, 102)));
    for (double theta : {0.0, 89.0})
        EXPECT_TRUE(is_rejected(narrow_lobe_case(fmt::format("narrow, off, {}", theta), theta, 1e5, 1.02e5)));
}

TEST(SamplerHarness, CatchesALobeProbabilityThatIsOnePercentOff) {
    EXPECT_TRUE(passes(two_lobes_case("two lobes", 0.5, 0.5)));
    EXPECT_TRUE(is_rejected(two_lobes_case("two lobes, off", 0.5, 0.505)));
}

TEST(SamplerHarness, CatchesOnePercentOfEnergyLostInOneLobe) {
    EXPECT_TRUE(is_rejected(two_lobes_case("two lobes, one too dark", 0.5, 0.5, 0.99)));
    // If the value loses the energy as well, only the known albedo shows it.
    SamplerCase test = two_lobes_case("two lobes, both too dark", 0.5, 0.5);
    test.mean_weight = 0.6 + 0.5 * 0.4 * 0.01;
    EXPECT_TRUE(fails_with(test, "the mean weight is 0.6000"));
    test.mean_weight = std::nullopt;
    test.largest_mean_weight = 0.595;
    EXPECT_TRUE(fails_with(test, "more than 0.595"));
}

TEST(SamplerHarness, CatchesAMissingJacobian) {
    EXPECT_TRUE(passes(half_vector_case("half vector", true)));
    EXPECT_TRUE(is_rejected(half_vector_case("half vector, no Jacobian", false)));
}

TEST(SamplerHarness, CatchesADensityThatIntegratesToTheWrongNumber) {
    SamplerCase test = cosine_power_case("too bright", 1, 1);
    const auto right = test.pdf;
    test.pdf = [right](const Vec2d& x) { return 1.002 * right(x); };
    EXPECT_TRUE(fails_with(test, "integrates to 1.002"));
    // The density claims 0.4 % more where no sample ever falls.
    test.pdf = [right](const Vec2d& x) { return right(x) + (x.x() > 1.9 ? 0.04 / (2 * pi_d) : 0.0); };
    EXPECT_TRUE(fails_with(test, "integrates to 1.00"));
}

TEST(SamplerHarness, CatchesSamplesWithoutDensityWeightOrPlace) {
    const SamplerCase right = cosine_power_case("cosine", 1, 1);
    const auto spoil = [&right](const std::function<void(Sampled&)>& how) {
        SamplerCase test = right;
        test.sample = [how, good = right.sample](const RandomNumbers& r) {
            auto s = good(r);
            if (r.v.x() < 1e-4f) how(*s);
            return s;
        };
        return test;
    };
    EXPECT_TRUE(fails_with(spoil([](Sampled& s) { s.pdf = 0; }), "pdf is not positive"));
    EXPECT_TRUE(fails_with(spoil([](Sampled& s) { s.weight = std::nan(""); }), "weight is not finite"));
    EXPECT_TRUE(fails_with(spoil([](Sampled& s) { s.pdf *= 1.01; }), "two densities differ"));
    EXPECT_TRUE(fails_with(spoil([](Sampled& s) { s.point.x() = 2.5; }), "outside the domain"));
    SamplerCase test = right;
    test.sample = [good = right.sample](const RandomNumbers& r) {
        return r.v.x() < 1e-4f ? std::optional<Sampled>() : good(r);
    };
    EXPECT_TRUE(fails_with(test, "given up"));
    test.pdf = [](const Vec2d& x) { return x.x() > 1.5 ? infinity : 0.5; };
    EXPECT_TRUE(fails_with(test, "not finite at"));
}

}  // namespace
}  // namespace gib::test::sampler_harness_test
