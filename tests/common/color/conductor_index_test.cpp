// Tests of conductors' indices of refraction by the name of the material.

#include "common/color/conductor_index.h"

#include "common/color/cie.h"
#include "common/core/error.h"
#include "tests/support/scene_text.h"

#include <gmock/gmock.h>

namespace gib::test::conductor_index_test {
namespace {

using ::testing::StartsWith;

// Palik's measurements of copper (Handbook of Optical Constants of Solids, 1985) give the same index as the preset
// that was made from them.
TEST(ConductorIndex, IsTheMeanOfItsSpectrum) {
    const SampledSpectrum palik{
        {344.389008, 364.647003, 387.437988, 413.266998, 442.785980, 476.846008, 516.583008, 539.044006, 563.545044,
         590.381042, 619.900024, 652.526001, 670.162048, 688.778015, 708.456970, 729.294006, 826.533020},
        {1.31, 1.27, 1.18, 1.18, 1.17, 1.15, 1.12, 1.04, 0.826, 0.468, 0.272, 0.214, 0.215, 0.213, 0.214, 0.223, 0.26}};
    const Colord eta = rgb_of_spectrum(palik, Illuminant::none);
    EXPECT_LT((conductor_index("Cu_palik")->eta - eta.cast<float>()).abs().maxCoeff(), 1e-6f);
}

TEST(ConductorIndex, EveryNameHasOne) {
    const auto names = conductor_names();
    EXPECT_EQ(names.size(), 71u);
    for (const auto name : names) {
        const auto index = conductor_index(name);
        ASSERT_TRUE(index) << name;
        EXPECT_TRUE((index->eta >= 0.f).all() && (index->k >= 0.f).all()) << name;
    }
    for (const char* name : {"", "au", "none", "Unobtainium"})
        EXPECT_FALSE(conductor_index(name)) << name;
    EXPECT_TRUE((conductor_index("Hg")->k == conductor_index("Hg_palik")->k).all());
    load(shape("sphere", bsdf("conductor", text("material", "Au"))));
}

TEST(ConductorIndex, WrongMaterialsAreErrors) {
    const auto error_of = [](const std::string& body) -> std::string {
        try {
            load(shape("sphere", bsdf("conductor", "\n", body)));
        } catch (const InputError& e) {
            return e.what();
        }
        return "no error";
    };
    EXPECT_THAT(
        error_of(text("material", "gold")),
        StartsWith("test.xml:3:25: there is no material 'gold'; known are: none, a-C, Ag, Al, AlAs, AlAs_palik"));
    EXPECT_THAT(error_of(text("material", "Au") + rgb("k", 1)),
                StartsWith("test.xml:3:25: give either 'material' or 'eta' and 'k'"));
    EXPECT_THAT(error_of("<spectrum name='eta' value='400:-1 500:1'/>"),
                StartsWith("test.xml:3:22: 'eta' must not be negative: -1"));
}

}  // namespace
}  // namespace gib::test::conductor_index_test
