// The rows of noise.toml as tests, the power of the table, and closed forms of its figure.
//
// GIB_NOISE_SEED=N begins the looks at seed N instead of 1. GIB_NOISE_LOOKS=N takes N looks at each row, and prints the figure and the
// scatter that belong into the table.

#include "tests/noise/noise_table.h"

#include "common/sampling/sampler.h"
#include "tests/support/moments.h"
#include "tests/support/source_path.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ostream>
#include <set>

namespace gib::test {

void PrintTo(const NoiseRow& row, std::ostream* out) { *out << row.label; }

namespace noise_test {
namespace {

const std::vector<NoiseRow>& noise_table() {
    static const std::vector<NoiseRow> rows = load_noise_table(source_path("tests/noise/noise.toml"));
    return rows;
}

std::vector<NoiseRow> rows_of(bool quick) {
    std::vector<NoiseRow> rows = noise_table();
    std::erase_if(rows, [quick](const NoiseRow& row) { return row.quick != quick; });
    return rows;
}

std::uint64_t number_of(const char* variable, std::uint64_t otherwise) {
    const char* text = std::getenv(variable);
    return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

/// Prints the mean of the logarithms of the figures of many looks, and their standard deviation.
void calibrate(const NoiseRow& row, std::uint64_t first_seed, std::uint64_t looks) {
    Moments logarithms;
    NoiseLook last;
    std::string deviations;
    for (std::uint64_t look = 0; look < looks; ++look) {
        last = look_at(row, first_seed + look * row.seeds);
        logarithms.add(std::log(last.figure()));
        deviations += fmt::format(" {:.3f}", std::log(last.figure() / row.figure));
    }
    fmt::print("{}: rays {:.4g} figure = {:.4g} scatter = {:.3f}\n  logarithms over the table's:{}\n", row.name,
               last.rays, std::exp(logarithms.mean()),
               logarithms.standard_error() * std::sqrt(static_cast<double>(logarithms.count())), deviations);
}

void expect_noise(const NoiseRow& row) {
    const std::uint64_t first_seed = number_of("GIB_NOISE_SEED", 1);
    if (const std::uint64_t looks = number_of("GIB_NOISE_LOOKS", 0)) return calibrate(row, first_seed, looks);
    const auto [least, most] = row.range();
    const auto agrees = [&](const NoiseLook& look) { return look.figure() >= least && look.figure() <= most; };
    const NoiseLook first = look_at(row, first_seed);
    fmt::print("{}: {:.4g} of {:.4g} to {:.4g}\n", row.name, first.figure(), least, most);
    if (agrees(first)) return;
    const NoiseLook second = look_at(row, first_seed + row.seeds);
    EXPECT_TRUE(agrees(second)) << row.label << ": variance times rays is " << first.figure() << " and "
                                << second.figure() << ", " << second.figure() / row.figure << " of what it should be ("
                                << least << " to " << most << "); variance " << second.variance << ", rays "
                                << second.rays << ". " << row.idea;
}

std::string name_of(const testing::TestParamInfo<NoiseRow>& info) { return info.param.name; }

class NoiseTable : public testing::TestWithParam<NoiseRow> {};
INSTANTIATE_TEST_SUITE_P(Shipped, NoiseTable, testing::ValuesIn(rows_of(false)), name_of);
TEST_P(NoiseTable, VarianceTimesWorkIsInItsRange) { expect_noise(GetParam()); }

class QuickNoiseTable : public testing::TestWithParam<NoiseRow> {};
INSTANTIATE_TEST_SUITE_P(Shipped, QuickNoiseTable, testing::ValuesIn(rows_of(true)), name_of);
TEST_P(QuickNoiseTable, VarianceTimesWorkIsInItsRange) { expect_noise(GetParam()); }

// If all figures are right, the whole table passes with a probability of 99.9 %; if one is larger by 1.3, its row fails with 99 %.
TEST(NoisePower, IsWhatTheTableClaims) {
    double false_alarms = 0;
    for (const NoiseRow& row : noise_table()) {
        false_alarms += failure_probability(row, 1);
        EXPECT_GE(failure_probability(row, 1.3), 0.99) << row.name;
    }
    EXPECT_LE(false_alarms, 0.001);
}

// A method without a row is named, so that who adds one sees what is missing.
TEST(NoiseRows, NameMethodsWithoutOne) {
    std::set<std::string> measured;
    for (const NoiseRow& row : noise_table())
        measured.insert(MethodLabel::parse(row.label).name);
    for (const std::string& name : names_of_comparable_methods())
        if (!measured.contains(name)) fmt::print("unmeasured: {} has no row in tests/noise/noise.toml\n", name);
    for (const std::string& name : measured)
        EXPECT_NO_THROW(find_comparable_method(name)) << name;
}

/// Images of independent numbers: the standard deviation of pixel i is `scatter(i)` times its mean, `mean(i)`.
template <typename Mean, typename Scatter>
std::vector<Image> random_images(int edge, std::uint64_t count, Mean&& mean, Scatter&& scatter) {
    std::vector<Image> images(count, Image(edge, edge));
    for (std::uint64_t seed = 0; seed < count; ++seed)
        for (std::size_t i = 0; i < images[seed].rgb.size(); ++i) {
            // Uniform in [-sqrt(3), sqrt(3)]: variance 1.
            const double u = double{Sampler(PointSet::independent, seed, i, 0).get_1d(0)};
            images[seed].rgb[i] = static_cast<float>(mean(i / 3) * (1 + scatter(i / 3) * std::sqrt(3.) * (2 * u - 1)));
        }
    return images;
}

// Half of the pixels have the mean 1, half 0.01, so that m = 0.505 and epsilon = 0.0505^2. A pixel of mean 1 and relative deviation
// 0.2 adds 0.04 / (1 + epsilon), one of mean 0.01 adds 0.04e-4 / (1e-4 + epsilon). 64 images of 1024 pixels have a standard error of
// about sqrt((1.8 - 1 + 2 / 63) / (64 * 1536)) = 0.3 % (the kurtosis of uniform numbers is 1.8); 4 of these are allowed, and 1 / 64
// of the mean's variance in its square.
TEST(NoiseFigure, IsTheMeanRelativeVariance) {
    const auto images = random_images(
        32, 64, [](std::size_t i) { return i % 2 == 0 ? 1 : 0.01; }, [](std::size_t) { return 0.2; });
    const double epsilon = 0.0505 * 0.0505;
    const double expected = (0.04 / (1 + epsilon) + 0.04e-4 / (1e-4 + epsilon)) / 2;
    EXPECT_NEAR(relative_variance(images, false), expected, 0.013 * expected);
}

// One pixel of 1024 with a relative variance of 100 hides that of all others; without the noisiest three it does not.
TEST(NoiseFigure, LeavesOutTheNoisiestPixelsIfTrimmed) {
    const auto images = random_images(
        32, 64, [](std::size_t) { return 1; }, [](std::size_t i) { return i == 77 ? 10 : 0.1; });
    EXPECT_GT(relative_variance(images, false), 0.05);
    EXPECT_NEAR(relative_variance(images, true), 0.01, 0.0003);
}

}  // namespace
}  // namespace noise_test
}  // namespace gib::test
