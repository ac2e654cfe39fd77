// Light that no seed has met: neither a bias nor a difference in energy follows from it.
#include "experiments/analysis/unsampled_light.h"

#include "experiments/analysis/row_fields.h"
#include "tests/support/constant_image.h"
#include "tests/support/table_fixtures.h"

#include <gtest/gtest.h>
#include <random>

namespace gib::test::unsampled_light_test {
namespace {

constexpr std::size_t lamp = 100;  ///< the first channel of the pixel of the lamp

/// A component of 1 with a lamp of 60, in one pixel of 256, that a seed meets if `meets` says so; noise of 1 %; `scale` is the
/// method's own error of brightness.
std::vector<Image> images(const std::vector<bool>& meets, float scale = 1) {
    std::mt19937 random(7);
    std::normal_distribution<float> noise(0.f, 0.01f);
    std::vector<Image> all;
    for (const bool met : meets) {
        Image& x = all.emplace_back(16, 16);
        for (float& value : x.rgb)
            value = scale * (1 + noise(random));
        for (std::size_t k = 0; k < 3; ++k)
            x.rgb[lamp + k] = met ? 60.f * scale : 0.f;
    }
    return all;
}

TableRow judged(const std::vector<Image>& x) {
    ReferenceLayer reference{images({true}).front(), {}, {}};
    for (float& value : reference.mean.rgb)
        if (value < 2) value = 1;
    const Denominators denominators(reference.mean, 1e-4);
    TableRow row = row_of("photon_mapper");
    row.statistics = replicate_statistics(x, reference, denominators);
    row.balance = energy_balance(x, reference, reference.mean);
    allow_for_unsampled_light(row, x, unsampled_light(x, reference.mean), reference, denominators);
    return row;
}

TEST(UnsampledLight, IsNeitherBiasNorADifferenceInEnergy) {
    const TableRow row = judged(images({false, false, false}));
    EXPECT_LT(row.balance->excess.value, -0.15) << "a fifth of the energy";
    EXPECT_TRUE(row.has_verdict(BalanceVerdict::inconclusive));
    EXPECT_GT(row.balance->excess.interval->hi, 0);
    EXPECT_EQ(bias_share_field(row).state, State::below) << "none, or nearly all of the relative error";
}

TEST(UnsampledLight, HidesNoDifferenceElsewhere) {
    const TableRow bright = judged(images({false, false, false}, 1.5f));
    EXPECT_TRUE(bright.has_verdict(BalanceVerdict::differs)) << "by 20 % without the lamp, by 40 % with it";
    EXPECT_EQ(bias_share_field(bright).state, State::measured);
    const TableRow right = judged(images({true, true, true}));
    EXPECT_TRUE(right.has_verdict(BalanceVerdict::agrees));
}

}  // namespace
}  // namespace gib::test::unsampled_light_test
