// Transformations of random scenes that leave every rounding as it was: the images of every method agree bit for bit.
//
// - Scale and light units by powers of two: all lengths (all lights) are multiplied exactly, and so is every sum,
//   product, quotient and root of them. Comparisons of lengths with lengths, densities of random choices and angles
//   stay the same. Only a constant length or power in the code, or a product outside float's range, changes an image.
//   If lengths are multiplied by s, densities of area, squared distances and Embree's determinants change
//   by s^2 to s^3, which stays in range for s = 2^20.
// - Translation: positions are dyadic (random_scenes.h), so that moving them is exact. So is the recentring of the
//   scene, because the middle of its bounds is dyadic, too.
// - Order of shapes: the hit of a ray does not depend on the numbers of shapes unless two are hit at the same
//   distance. Materials and media go with the shapes, and lights keep their numbers. Radiosity numbers its patches by
//   shapes and sums over them in that order: it is equal only up to rounding and to the residual of its solver, 1e-4
//   of the light that is reflected first.

#include "tests/invariance/scene_transforms.h"
#include "tests/support/methods_under_test.h"

namespace gib::exact_invariance_test {
namespace {

using namespace test;

struct ExactMethod : MethodUnderTest {
    int scenes = 8;
};
const std::vector<ExactMethod>& exact_methods() {
    static const std::vector<ExactMethod> methods = [] {
        std::vector<ExactMethod> all;
        for (const auto& some : {methods_under_test(Work::tiny), look_up_variants(Work::tiny)})
            for (const MethodUnderTest& method : some)
                all.push_back({method});
        for (const MethodUnderTest& method : pilot_variants())
            all.push_back({method, 2});
        return all;
    }();
    return methods;
}

struct ExactInvariance {
    std::string name;
    std::function<RandomScene(const RandomScene&, std::uint64_t)> transform;
    double factor = 1;              ///< the image is multiplied by this
    std::string_view without = {};  ///< a pass; for methods that run it, it does not hold exactly
};

ExactInvariance scale_by(const std::string& name, double s) {
    return {name, [s](const RandomScene& scene, std::uint64_t) { return scaled(scene, s); }};
}
ExactInvariance units_by(const std::string& name, double factor) {
    return {name, [factor](const RandomScene& scene, std::uint64_t) { return brightened(scene, factor); }, factor};
}

const std::vector<ExactInvariance>& exact_invariances() {
    static const std::vector<ExactInvariance> invariances = {
        scale_by("ScaleByTwoToThe20", 0x1p20),
        scale_by("ScaleByTwoToTheMinus20", 0x1p-20),
        scale_by("ScaleByHalf", 0.5),
        units_by("LightTimesTwoToThe30", 0x1p30),
        units_by("LightTimesTwoToTheMinus30", 0x1p-30),
        {"Translation",
         [](const RandomScene& scene, std::uint64_t seed) {
             Dice dice(seed);
             const auto far = [&] { return 0x1p-20 * std::round(dice.between(-0x1p36, 0x1p36)); };
             return moved(scene, {far(), far(), far()});
         }},
        {"OrderOfShapes",
         [](const RandomScene& scene, std::uint64_t seed) {
             Dice dice(seed);
             return with_shapes_shuffled(scene, dice);
         },
         1, "patches and links"},
    };
    return invariances;
}

using Case = std::pair<const ExactInvariance*, const ExactMethod*>;

std::vector<Case> exact_cases() {
    std::vector<Case> cases;
    for (const ExactInvariance& invariance : exact_invariances())
        for (const ExactMethod& method : exact_methods())
            if (!method.runs(invariance.without)) cases.emplace_back(&invariance, &method);
    return cases;
}

class ExactInvariances : public testing::TestWithParam<Case> {};

TEST_P(ExactInvariances, HoldBitForBit) {
    const auto& [invariance, method] = GetParam();
    const TemporaryFolder folder;
    int judged = 0, bright = 0;
    for (std::uint64_t seed = 0; judged < method->scenes; ++seed) {
        SCOPED_TRACE("scene " + std::to_string(seed));
        const RandomScene description = random_scene(seed, seed % 3 == 0 ? SceneMood::polygons : SceneMood::any);
        const LoadedScene before = scene_of(scene_file(description, folder));
        if (!method->simulates_all_of(*before.scene)) continue;
        const LoadedScene after = scene_of(scene_file(invariance->transform(description, seed), folder));
        const Image a = render(before, method->label, 2, seed, 1).total();
        const Image b = render(after, method->label, 2, seed, 1).total();
        double largest = 0, sum = 0;
        int different = 0;
        for (std::size_t i = 0; i < a.rgb.size(); ++i) {
            const double expected = invariance->factor * static_cast<double>(a.rgb[i]),
                         other = static_cast<double>(b.rgb[i]);
            sum += expected;
            if (expected == other) continue;
            ++different;
            largest = std::max(largest, std::abs(expected - other) / std::max(expected, other));
        }
        EXPECT_EQ(different, 0) << "of " << a.rgb.size() << " numbers, by up to " << largest;
        ++judged;
        bright += sum > 0;
    }
    EXPECT_GE(bright, method->scenes * 3 / 4);
}

INSTANTIATE_TEST_SUITE_P(Random, ExactInvariances, testing::ValuesIn(exact_cases()),
                         [](const auto& pair) { return pair.param.first->name + "_" + pair.param.second->name; });

}  // namespace
}  // namespace gib::exact_invariance_test
