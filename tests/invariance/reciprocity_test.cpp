// Reciprocity: emitter and sensor are exchanged in random scenes of reciprocal materials.
//
// Two rectangles A and B, ideally diffuse, stand in a closed room without other lights. If A emits the radiance L
// from all of its points into all directions of its front side, the power that arrives on B is
//   P(A, B) = L * integral over x in A, y in B of G(x, y) dA dA,
// where G sums over all paths from x to y the products of f, cosines over squared distances, visibility, and
// transmittances and phase functions in media. A path and its reversal have the same product, because every f is
// symmetric, except for refractions, where f(i, o) / n_o^2 is (Veach 1997, section 5.2). Along a path, these factors
// cancel except for the indices at its ends. So P(A, B) / n_B^2 = P(B, A) / n_A^2, where n_A is the index of the
// sphere of glass around A, if there is one: a lamp in glass sends n^2 times less out than comes in from one outside.
// A reversed path is in the same component (x S+ y, x y, the rest) and has the same length, so the equation holds for
// each component alone and for any max_depth. B reflects its irradiance P / area evenly: the mean radiance of an
// image that shows B and nothing else is
//   Lo(B) = rho_B / pi * P(A, B) / area_B,
// without emission, since only A emits. Photons from A carry P(A, B) to B, the sum of the powers stored there.
//
// Path tracing carries radiance backwards and photons carry power forwards. P(A, B) by photons and P(B, A) by paths
// follow the same rays with different code (Transport), so that the comparison checks the adjoint, too.
// Density estimates and radiosity are left out, because their bias at A (a patch's boundary, the surfaces around it)
// is not that at B. Final gathering by paths has no bias except in the caustics, which come from photons.

#include "methods/parts/photons/photon_walk.h"
#include "tests/invariance/random_scenes.h"
#include "tests/support/image_samples.h"

#include <fmt/format.h>

namespace gib::reciprocity_test {
namespace {

using namespace test;

/// Whether both sides find the light in each seed. If one of them finds a small lamp in glass only by
/// chance, or not at all, its means are far from normal and a single component proves nothing. The sums of
/// all components are compared in any case.
bool both_find(const Moments& a, const Moments& b) { return a.zeros() + b.zeros() == 0; }

/// The probability of a false alarm of the table: half for single numbers, half for all scenes
/// together. The two sides have different distributions, whose means must be nearly normal for the
/// t-test: some 10^4 samples of a large lamp at least.
constexpr double alpha = 1e-3;
constexpr std::uint64_t scenes = 12, seeds = 16;
constexpr std::uint64_t photons = 4000;

double area_of_patch(const SceneShape& patch) {
    return 4 * patch.to_world.col(0).norm() * patch.to_world.col(1).norm();
}

/// The scene in which `from` emits radiance 1 and the camera sees `to` alone, from close above.
RandomScene shining(RandomScene scene, std::size_t from, std::size_t to) {
    scene.shapes[from].radiance = Colord::Ones();
    const Mat4d& patch = scene.shapes[to].to_world;
    SceneCamera& camera = scene.camera;
    camera.half_extent = Vec2d(patch.col(0).norm(), patch.col(1).norm());
    camera.to_world = patch;
    camera.to_world.col(0) = -patch.col(0).normalized();
    camera.to_world.col(1) = patch.col(1).normalized();
    camera.to_world.col(2) = -patch.col(2).normalized();
    camera.to_world.col(3) += 0x1p-12 * patch.col(2).normalized();
    camera.aperture = 0;
    return scene;
}

/// The power [W] that photons bring to a patch, by channel, over seeds. The room's middle is the scene's origin.
std::vector<Moments> power_of_photons(const LoadedScene& scene, const SceneShape& patch, std::uint64_t first_seed) {
    const Mat4d to_patch = patch.to_world.inverse();
    std::vector<Moments> moments(3);
    for (std::uint64_t seed = first_seed; seed < first_seed + seeds; ++seed) {
        Colord power = Colord::Zero();
        const auto walk = trace_photons(*scene.scene, PhotonMapKind::full, photons, scene.max_edges, seed);
        for (const Photon& photon : walk.photons) {
            const Vec3d p = (to_patch * photon.p.cast<double>().homogeneous()).head<3>();
            if (p.head<2>().cwiseAbs().maxCoeff() <= 1.001 && std::abs(p.z()) < 1e-4)
                power += walk.unit * photon.power().cast<double>();
        }
        for (std::size_t c = 0; c < 3; ++c)
            moments[c].add(power[static_cast<int>(c)]);
    }
    return moments;
}

/// One scene with light from the first patch to the second (forward), and with light from the second to the first.
class BothWays {
public:
    BothWays(const RandomScene& scene, const TemporaryFolder& folder)
        : first_(scene.shapes.size() - 2),
          second_(first_ + 1),
          scene_(scene),
          forward_(scene_of(scene_file(shining(scene, first_, second_), folder))),
          backward_(scene_of(scene_file(shining(scene, second_, first_), folder))) {}

    const LoadedScene& forward() const { return forward_; }
    const LoadedScene& backward() const { return backward_; }
    const SceneShape& first() const { return scene_.shapes[first_]; }
    const SceneShape& second() const { return scene_.shapes[second_]; }
    /// P(second, first) / P(first, second).
    double ratio() const { return scene_.index_around_patch * scene_.index_around_patch; }
    /// [m^2] P over the mean radiance of an image of the first (second) patch.
    double power_per_radiance(bool first) const {
        const SceneShape& patch = first ? this->first() : second();
        const double rho = scene_.materials[static_cast<std::size_t>(patch.material)].color[0];
        return std::numbers::pi * area_of_patch(patch) / rho;
    }

private:
    std::size_t first_, second_;
    RandomScene scene_;
    LoadedScene forward_, backward_;
};

struct ReciprocalMethod {
    std::string name, label;
    std::uint32_t passes;
    std::vector<std::size_t> numbers;  ///< the numbers of a picture that have no bias
};
const std::vector<ReciprocalMethod>& methods() {
    static const std::vector<ReciprocalMethod> all = {
        {"path", "path", 32, {0, 1, 2, 4, 5, 6, 7}},
        {"gather", "photon_mapper photons=500 gather=1 source=paths", 16, {4, 6}},  // direct, indirect
    };
    return all;
}

class Reciprocity : public testing::TestWithParam<ReciprocalMethod> {};

std::string described(const Moments& m, double scale = 1) {
    return fmt::format("{:.5g} +- {:.2g}", scale * m.mean(), scale * m.standard_error());
}

TEST_P(Reciprocity, EmitterAndSensorCanBeExchanged) {
    const auto& [name, label, passes, numbers] = GetParam();
    const bool follows_photons = name == "path";
    const double least = 0.5 * alpha / static_cast<double>(scenes * (7 + 2 + 6));
    const TemporaryFolder folder;
    std::vector<double> probabilities;
    std::size_t compared = 0;
    for (std::uint64_t seed = 0; probabilities.size() < scenes; ++seed) {
        SCOPED_TRACE("scene " + std::to_string(seed));
        const BothWays ways(random_scene(seed, SceneMood::reciprocal), folder);
        const gib::Scene& scene = *ways.forward().scene;
        if (!follows_photons && (scene.has_media() || scene.has_dispersion())) continue;  // no final gathering
        const auto there = replicates(ways.forward(), label, passes, 1000 * seed + 1, seeds),
                   back = replicates(ways.backward(), label, passes, 1000 * seed + 501, seeds);
        const double to_second = ways.power_per_radiance(false), to_first = ways.power_per_radiance(true);
        const double expected_ratio = to_first / to_second / ways.ratio();  // ratio of radiances
        for (const std::size_t i : numbers) {
            if (i >= 3 && !both_find(there[i], back[i])) continue;
            ++compared;
            EXPECT_GT(welch_probability(there[i], back[i], expected_ratio), least)
                << "number " << i << ": " << described(there[i], to_second) << ", back "
                << described(back[i], to_first);
        }
        EXPECT_EQ(there[3].mean() + back[3].mean(), 0) << "emission is seen";
        probabilities.push_back(welch_probability(there[numbers[0]], back[numbers[0]], expected_ratio));
        if (!follows_photons) continue;
        const auto power_there = power_of_photons(ways.forward(), ways.second(), 1000 * seed + 1),
                   power_back = power_of_photons(ways.backward(), ways.first(), 1000 * seed + 501);
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_GT(welch_probability(power_there[c], there[c], to_second), least)
                << "channel " << c << ": " << described(power_there[c]) << ", paths " << described(there[c], to_second);
            EXPECT_GT(welch_probability(power_back[c], back[c], to_first), least)
                << "channel " << c << ": " << described(power_back[c]) << ", paths " << described(back[c], to_first);
        }
        if (std::getenv("GIB_PROPERTY_PRINT"))
            std::printf("scene %2d (n^2 = %.4g): paths %s, back %s; photons %s, back %s\n", static_cast<int>(seed),
                        ways.ratio(), described(there[1], to_second).c_str(), described(back[1], to_first).c_str(),
                        described(power_there[1]).c_str(), described(power_back[1]).c_str());
    }
    EXPECT_GE(compared, scenes * numbers.size() / 2);
    const double together = fisher_probability(probabilities);
    EXPECT_GT(together, 0.25 * alpha);
    if (std::getenv("GIB_PROPERTY_PRINT")) std::printf("Reciprocity %s p = %.3g\n", name.c_str(), together);
}

INSTANTIATE_TEST_SUITE_P(Random, Reciprocity, testing::ValuesIn(methods()),
                         [](const auto& method) { return method.param.name; });

}  // namespace
}  // namespace gib::reciprocity_test
