// Guided light: more of it comes where the camera looks, its powers there are about equal, and no mean changes, whatever the
// guide has learned.
#include "methods/parts/guiding/light_guide.h"

#include "methods/parts/photons/photon_walk.h"
#include "tests/support/lit_rooms.h"
#include "tests/support/same_means.h"

#include <gtest/gtest.h>

namespace gib::test::light_guide_test {
namespace {

using namespace lit_rooms;

constexpr LightUse photons = {64, false}, all_light = {64, true};

/// A closed hall of 16 x 5 x 16 under a lamp, a block in one corner, and a camera that looks at it.
std::string hall_xml(const std::string& look) {
    const std::string grey = bsdf("twosided", one_sided("0.6, 0.6, 0.6"));
    const std::string film =
        element("film", "hdrfilm", integer("width", 32), integer("height", 32), element("rfilter", "box"));
    std::string xml = element("sensor", "perspective", number("fov", 50), to_world(look), film);
    xml += shape("cube", to_world(scale(8, 2.5, 8), translate(0, 2.5, 0)), grey);
    xml += shape("rectangle", to_world(rotate('x', 90), translate(0, 4.99, 0)), area_light(20));
    return scene_xml(xml + shape("cube", to_world(scale(0.4), translate(-6.2, 0.4, -6.2)), grey));
}
const std::string at_the_corner = look_at("-4, 1.6, -4", "-6.4, 0.4, -6.4"), elsewhere = look_at("5, 2, 5", "7, 4, 7");

/// Whether a photon lies where the first camera looks: in the corner, below its height.
bool is_seen(const Photon& photon) { return photon.p.x() < -5 && photon.p.z() < -5 && photon.p.y() < 1; }

std::shared_ptr<const LightPolicy> guide_of(const gib::Scene& scene, const LightUse& use) {
    Plan plan;
    add_importons(plan, Guiding::on, "");
    StageTimes stages;
    std::uint64_t rays = 0;
    return LightPolicy::find(scene, Guiding::on, use, plan, 1, stages, rays);
}

PhotonWalkResult walk_of(const gib::Scene& scene, PhotonMapKind kind, std::uint64_t count, std::uint64_t seed,
                         const LightPolicy* guide) {
    return trace_photons(scene, kind, count, 64, seed, nullptr, nullptr, nullptr, guide);
}

TEST(LightGuide, SendsPhotonsWhereTheCameraLooks) {
    const LoadedScene scene = scene_of(hall_xml(at_the_corner));
    const auto guide = guide_of(*scene.scene, photons);
    const auto seen_of = [&](const LightPolicy* by) {
        std::vector<float> powers;
        for (const Photon& photon : walk_of(*scene.scene, PhotonMapKind::global, 200000, 3, by).photons)
            if (is_seen(photon)) powers.push_back(photon.power().maxCoeff());
        std::sort(powers.begin(), powers.end());
        return powers;
    };
    const std::vector<float> guided = seen_of(guide.get()), unguided = seen_of(nullptr);
    EXPECT_GT(guided.size(), 8 * unguided.size());
    // Their powers are about equal: 99 % are below ten times the median. None can have more than 1.5 times an ordinary start, of
    // five times the mean power with four maps, that was scattered by an albedo of 0.6 where the field leaves the direction out,
    // 1 / (1 - a) = 4.
    EXPECT_LT(guided[guided.size() * 99 / 100], 10 * guided[guided.size() / 2]);
    EXPECT_LE(guided.back(), 1.5f * 5 * 0.6f * 4 * unguided.back());
}

/// Expects equal mean powers in the eight parts of the scene's box, with two guides, over seeds. Student's t of 30 degrees of
/// freedom exceeds 5.2 with a probability of 1.3e-5.
void expect_same_photons(const gib::Scene& scene, PhotonMapKind kind, const LightPolicy* guide,
                         const std::string& what) {
    constexpr std::uint64_t seeds = 16;
    std::array<std::array<Moments, 8>, 2> powers;
    for (const bool guided : {false, true})
        for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
            std::array<double, 8> sums{};
            const PhotonWalkResult walk = walk_of(scene, kind, 4000, seed, guided ? guide : nullptr);
            for (const Photon& photon : walk.photons) {
                const Vec3 from_center = photon.p - scene.bounds().center();
                const std::size_t part =
                    (from_center.x() > 0 ? 1 : 0) + (from_center.y() > 0 ? 2 : 0) + (from_center.z() > 0 ? 4 : 0);
                sums[part] += double{photon.power().mean()} * walk.unit;
            }
            for (std::size_t part = 0; part < 8; ++part)
                powers[guided][part].add(sums[part]);
        }
    for (std::size_t part = 0; part < 8; ++part) {
        const Moments &a = powers[0][part], &b = powers[1][part];
        EXPECT_LE(std::abs(a.mean() - b.mean()),
                  5.2 * std::hypot(a.standard_error(), b.standard_error()) + 1e-7 * a.mean())
            << what << ", part " << part << ": " << b.mean() << " instead of " << a.mean();
    }
}

TEST(LightGuide, KeepsTheMeansOfPhotons) {
    const std::string glass = shape("sphere", center(0.6, -0.6, 0.3), radius(0.3), glass_ball);
    for (const std::string& light : {lamp, shining_ball, lit_rooms::point, spot, sun, sky})
        for (const std::string& more : {glass, fog}) {
            const LoadedScene scene = scene_of(room_xml({.light = light, .more = more, .ball = plastic_ball}));
            const auto guide = guide_of(*scene.scene, photons);
            for (const PhotonMapKind kind :
                 {PhotonMapKind::global, PhotonMapKind::caustic, PhotonMapKind::full, PhotonMapKind::media})
                expect_same_photons(*scene.scene, kind, guide.get(), light + more);
        }
}

// The guide is that of a camera that looks at the opposite corner.
TEST(LightGuide, KeepsTheMeansIfItIsWrong) {
    const LoadedScene scene = scene_of(hall_xml(at_the_corner)), other = scene_of(hall_xml(elsewhere));
    const auto guide = guide_of(*other.scene, photons);
    expect_same_photons(*scene.scene, PhotonMapKind::global, guide.get(), "hall");
}

TEST(LightGuide, KeepsTheMeansOfLightPaths) {
    for (const std::string& light : {lamp, lit_rooms::point, spot, sun, sky}) {
        const std::string xml = room_xml({.light = light, .more = fog, .glossy_wall = "", .ball = diffuse_ball});
        expect_same_means(xml, {"light_tracer guide=off", "light_tracer guide=on"});
    }
}

TEST(LightGuide, IsTheSameForAnyNumberOfThreads) {
    const LoadedScene scene = scene_of(hall_xml(at_the_corner));
    for (const std::string label : {"progressive_photon_mapper guide=on", "light_tracer guide=on"}) {
        const ComponentImages one = render(scene, label, 2, 1, 1), three = render(scene, label, 2, 1, 3);
        for (Component c : all_components)
            if (one[c]) {
                EXPECT_EQ(one[c]->rgb, three[c]->rgb) << label << ' ' << name_of(c);
            }
    }
}

// Where nearly all photons are seen, nothing is guided, and no image changes.
TEST(GuideChoice, LeavesTheGuideOutWhereLightIsSeen) {
    const LoadedScene scene = scene_of(room_xml({.light = lamp, .glossy_wall = "", .ball = diffuse_ball}));
    StageTimes stages;
    std::uint64_t rays = 0;
    Plan plan;
    add_importons(plan, Guiding::automatic, "");
    EXPECT_EQ(LightPolicy::find(*scene.scene, Guiding::automatic, all_light, plan, 1, stages, rays), nullptr);
    const LoadedScene hall = scene_of(hall_xml(at_the_corner));
    EXPECT_NE(LightPolicy::find(*hall.scene, Guiding::automatic, all_light, plan, 1, stages, rays), nullptr);
}

}  // namespace
}  // namespace gib::test::light_guide_test
