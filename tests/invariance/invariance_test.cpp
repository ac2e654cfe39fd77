// Transformations of random scenes after which images are other random numbers of the same distribution. Independent
// seeds of both sides are compared by t-tests of means.
//
// Unbiased methods of the registry are held to all transformations, also if they leave out paths: these are the same on
// both sides. Methods that estimate their bias are, too, within the difference of the two biases. Other biased methods are
// held to translations, quarter turns and other orders, which keep the shapes, their sizes and the lights, and turn the
// scene's box with the scene. Radii and sizes of patches are given in diagonals of the scene's box, which a rotation
// changes; each is set so that its length stays.
//
// Ways to look photons up are held to the transformations under which their images keep their distribution:
// - A density estimate over all photons within a fixed radius (k=all) has the mean of the true light, blurred by the
//   kernel. The number of photons, and which light sent them with what power, does not matter.
// - With k nearest photons the radius, and with it the bias, follows the photons' density. The density stays if
//   lights are chosen alike and send photons alike: under quarter turns (the box turns with the scene, and so does
//   the ball around it on which lights at infinity are sampled), in another order, and with triangles split, provided
//   that there is no projection map, whose bins follow the frames of lights. General rotations change that ball, and
//   splitting a light changes the choice among lights (a tenth goes to all alike), so k nearest photons are left out
//   there. Precomputed irradiance lies at photons, so the same holds for it.
// - The area that a density estimate divides by depends on the surface around a point
//   (methods/parts/density/surface_disc.h). Randomly turned rays find this area, so it depends on geometry, not on
//   how the geometry is cut into triangles.
// - Radiosity's patches follow the shapes' own parameters: split triangles have patches of their own, so that the
//   refinement error of the mesh changes, which has no bound below the error itself.
// - The irradiance cache is left out: its gradients are differences between strata of a hemisphere whose azimuth
//   follows an arbitrary frame, and so does their error. exact_invariance_test.cpp compares it bit for bit.

#include "methods/parts/vertices/light_paths.h"
#include "tests/invariance/scene_transforms.h"
#include "tests/support/image_samples.h"
#include "tests/support/methods_under_test.h"

namespace gib::invariance_test {
namespace {

using namespace test;

/// The probability of a false alarm of the whole table: half for single numbers (Bonferroni), half for each pair of a
/// method and an invariance over all scenes (Fisher, Bonferroni).
constexpr double alpha = 1e-3;
constexpr std::uint64_t most_scenes = 24, seeds = 8;

enum class Change { general_rotation, quarter_turn, translation, lights_order, lights_split, triangles_split };

struct Invariance {
    std::string name;
    Change change;
};
const std::vector<Invariance>& invariances() {
    static const std::vector<Invariance> all = {
        {"Rotation", Change::general_rotation}, {"QuarterTurns", Change::quarter_turn},
        {"Translation", Change::translation},   {"OrderOfLights", Change::lights_order},
        {"SplitLights", Change::lights_split},  {"SplitTriangles", Change::triangles_split},
    };
    return all;
}

RandomScene changed(const RandomScene& scene, Change change, std::uint64_t seed) {
    Dice dice(seed + 1000);
    switch (change) {
        case Change::general_rotation:
            return rotated(scene, random_rotation(dice));
        case Change::quarter_turn: {
            Eigen::Matrix3d turns = Eigen::Matrix3d::Identity();
            for (int i = 0; i < 3; ++i) {
                const Vec3d axis = Vec3d::Unit(dice.below(3));
                turns =
                    (Eigen::AngleAxisd(0.5 * std::numbers::pi * (1 + dice.below(3)), axis).toRotationMatrix() * turns)
                        .array()
                        .round()
                        .matrix()
                        .eval();
            }
            return rotated(scene, turns);
        }
        case Change::translation:
            return moved(scene, {dice.between(-1e4, 1e4), dice.between(-1e4, 1e4), dice.between(-1e4, 1e4)});
        case Change::lights_order:
            return with_lights_shuffled(scene, dice);
        case Change::lights_split:
            return with_lights_split(scene, dice);
        case Change::triangles_split:
            return with_triangles_split(scene);
    }
    return scene;
}

/// Whether the scene has anything that the transformation changes.
bool changes(const RandomScene& scene, Change change) {
    const auto any_shape = [&](const auto& condition) {
        return std::any_of(scene.shapes.begin(), scene.shapes.end(), condition);
    };
    const auto lamps = std::count_if(scene.shapes.begin(), scene.shapes.end(), std::mem_fn(&SceneShape::emits));
    if (change == Change::triangles_split)
        return any_shape([](const SceneShape& s) { return s.kind == SceneShape::Kind::mesh && !s.mesh.smooth; });
    if (change == Change::lights_order) return static_cast<std::size_t>(lamps) + scene.lights.size() > 1;
    if (change != Change::lights_split) return true;
    return std::any_of(scene.lights.begin(), scene.lights.end(),
                       [](const SceneLight& light) { return light.kind != SceneLight::Kind::sky; }) ||
           any_shape([](const SceneShape& s) { return s.emits() && s.kind == SceneShape::Kind::rectangle; });
}

/// The property of a scene that a transformation must preserve for a method to be compared.
enum class Needs { nothing, same_photons, same_patches };

struct ComparedMethod : MethodUnderTest {
    Needs needs;
    std::uint32_t passes = 4;
    std::uint64_t scenes = 6;  ///< up to most_scenes

    /// The label with lengths [scene units] as in a scene of the diagonal `original`.
    std::string label_for(double original, double diagonal) const {
        MethodLabel set = MethodLabel::parse(label);
        for (auto& [key, value] : set.values)
            for (const Parameter& parameter : description->parameters)
                if (parameter.name == key && parameter.unit == "scene diagonals")
                    value = fmt::to_string(std::stod(value) * original / diagonal);
        return set.text();
    }
    bool can_be_compared(Change change) const {
        if (needs == Needs::nothing || change == Change::translation) return true;
        if (change == Change::general_rotation || change == Change::lights_split) return false;
        return needs == Needs::same_photons || change != Change::triangles_split;
    }
};

const std::vector<ComparedMethod>& compared_methods() {
    static const std::vector<ComparedMethod> methods = [] {
        std::vector<ComparedMethod> all;
        for (const MethodUnderTest& method : methods_under_test(Work::tiny)) {
            const bool unbiased = method.description->unbiased, joins = method.runs(step_connections);
            all.push_back({method, unbiased || method.estimates_bias() ? Needs::nothing : Needs::same_patches,
                           unbiased ? 16u : 4u, unbiased && !joins && method.samples_pixels() ? most_scenes : 6});
        }
        const std::string radii = " k=all radius=0.05 caustic_radius=0.03 volume_radius=0.05",
                          nearest = " k=10 projection=off", map = "photon_mapper photons=500";
        const auto add = [&](const std::string& name, const std::string& settings, Needs needs,
                             std::uint32_t passes = 4) {
            all.push_back({method_under_test(name, map + settings), needs, passes});
        };
        add("photons_all", radii + " kernel=cone", Needs::nothing);
        add("photons", nearest, Needs::same_photons);
        add("gather_all", radii + " gather=2 source=photons", Needs::nothing, 2);
        add("gather", nearest + " gather=4", Needs::same_photons);
        add("shadows", radii + " shadow_photons=500", Needs::nothing);
        return all;
    }();
    return methods;
}

using Case = std::pair<const Invariance*, const ComparedMethod*>;
std::vector<Case> cases() {
    std::vector<Case> all;
    for (const Invariance& invariance : invariances())
        for (const ComparedMethod& method : compared_methods())
            if (method.can_be_compared(invariance.change)) all.emplace_back(&invariance, &method);
    return all;
}

class Invariances : public testing::TestWithParam<Case> {};

TEST_P(Invariances, HoldInDistribution) {
    const auto& [invariance, method] = GetParam();
    const auto pairs = static_cast<double>(cases().size());
    const double least = 0.5 * alpha / (pairs * most_scenes * numbers_of_a_picture);
    const TemporaryFolder folder;
    std::vector<double> probabilities;
    Dice dice(static_cast<std::uint64_t>(invariance->change));
    for (std::uint64_t seed = 100; probabilities.size() < method->scenes; ++seed) {
        SCOPED_TRACE("scene " + std::to_string(seed));
        const bool plain = !(method->description->simulates == Effects::all()) || seed % 4 == 0;
        const RandomScene description = random_scene(seed, plain ? SceneMood::polygons : SceneMood::any);
        if (!changes(description, invariance->change)) continue;
        const LoadedScene before = scene_of(scene_file(description, folder));
        const auto diagonal = static_cast<double>(before.scene->diagonal());
        const std::string label = method->label_for(diagonal, diagonal);
        if (!method->simulates_all_of(*before.scene)) continue;
        const LoadedScene after = scene_of(scene_file(changed(description, invariance->change, seed), folder));
        const std::string other = method->label_for(diagonal, static_cast<double>(after.scene->diagonal()));
        const auto a = replicates(before, label, method->passes, dice.bits(), seeds);
        const auto b = replicates(after, other, method->passes, dice.bits(), seeds);
        const auto probability = [&](std::size_t i) {
            return welch_probability(a[i], b[i], 1, std::abs(a[i].bias.mean() - b[i].bias.mean()));
        };
        for (std::size_t i = 0; i < a.size(); ++i)
            EXPECT_GT(probability(i), least) << "number " << i << ": " << a[i].mean() << " +- " << a[i].standard_error()
                                             << ", then " << b[i].mean() << " +- " << b[i].standard_error();
        probabilities.push_back(probability(1));  // the green channel
    }
    const double together = fisher_probability(probabilities);
    RecordProperty("probability", std::to_string(together));
    EXPECT_GT(together, 0.5 * alpha / pairs);
    if (std::getenv("GIB_PROPERTY_PRINT"))
        std::printf("%-16s %-12s p = %.3g\n", invariance->name.c_str(), method->name.c_str(), together);
}

INSTANTIATE_TEST_SUITE_P(Random, Invariances, testing::ValuesIn(cases()),
                         [](const auto& pair) { return pair.param.first->name + "_" + pair.param.second->name; });

}  // namespace
}  // namespace gib::invariance_test
