// The view of a photon map: a disc for each photon, on the side where the photon arrived.
#include "methods/parts/photons/photon_walk.h"
#include "tests/support/scene_fixtures.h"

namespace gib::test::photon_view_test {
namespace {

LoadedScene floor_under_a_ceiling(const std::string& eye) {
    return Scene(element("sensor", "orthographic", to_world(look_at(eye, "0,0,0")), box_film(128)),
                 shape("rectangle", diffuse(0.8)),
                 shape("rectangle", to_world(scale(20), rotate('x', 180), translate(0, 0, 2)), diffuse(0.8)),
                 point_light(0, 0, 1, 1))
        .load();
}

// A photon lights up a disc of the given radius. If photons lie far apart, the lit share of a floor
// that fills the image is photons x pi r^2 over the floor's area. Each disc shows its photon's power
// over the mean power, which is 1 on average.
TEST(PhotonView, LightsUpADiscForEachPhoton) {
    const auto scene = floor_under_a_ceiling("0,0,1.9");
    const std::string label = "photon_view map=global photons=300 size=0.0003";
    const auto photons = trace_photons(*scene.scene, PhotonMapKind::global, 300, 1 << 30, 1).photons;
    std::size_t on_floor = 0;
    for (const Photon& photon : photons)
        on_floor += photon.surface_normal().z() > 0.5f;
    const float r = 0.0003f * scene.scene->diagonal();
    const Image lit = *render(scene, label, 64)[Component::indirect];
    std::size_t bright = 0;
    for (std::size_t i = 0; i < lit.pixels(); ++i)
        bright += lit.at(i)[0] > 0.f;
    EXPECT_GE(bright, on_floor / 2);
    EXPECT_LE(bright, on_floor * 12) << "a disc of " << r << " meets few pixels of 1/64";
    // Powers are nearly equal here, so the mean over the image is the lit share.
    const double expected = static_cast<double>(on_floor) * std::numbers::pi * static_cast<double>(r * r) / 4;
    EXPECT_NEAR(mean_of(lit).mean(), expected, 0.3 * expected);
}

// From above, only the dark side of the ceiling is seen; photons lie on its other side.
TEST(PhotonView, ShowsTheSideThatAPhotonArrivedAt) {
    const Image dark = *render(floor_under_a_ceiling("0,0,5"), "photon_view map=global photons=3000 size=0.003",
                               4)[Component::indirect];
    EXPECT_EQ(mean_of(dark).sum(), 0);
}

TEST(PhotonView, ShowsEachMapInItsComponent) {
    const auto fog = shipped_scene("fog.xml", {{}, std::pair{16, 16}});
    for (const auto& [map, component] :
         {std::pair{"global", Component::indirect}, {"caustic", Component::caustic}, {"volume", Component::volume}}) {
        const auto image = render(fog, std::string("photon_view photons=2000 size=0.01 map=") + map, 2);
        EXPECT_GT(mean_of(*image[component]).mean(), 0) << map;
        for (Component other : all_components)
            if (other != component && other != Component::emission) {
                EXPECT_FALSE(image[other]) << map;
            }
    }
}

TEST(PhotonView, IsLeftOutWhereMethodsAreCompared) {
    const auto names = names_of_comparable_methods();
    EXPECT_EQ(std::count(names.begin(), names.end(), "photon_view"), 0);
    EXPECT_EQ(std::count(names.begin(), names.end(), "photon_mapper"), 1);
    EXPECT_THROW(find_comparable_method("photon_view"), InputError);
    EXPECT_NO_THROW(find_method("photon_view"));
}

}  // namespace
}  // namespace gib::test::photon_view_test
