// The eye path's walk through smooth interfaces, of which the first two are followed both ways.
#include "tests/support/scene_fixtures.h"

#include "common/materials/fresnel.h"

namespace gib::specular_walk_test {
namespace {

using test::scene_of;

constexpr float r = 0.04f;                      ///< reflectance of a face of glass of index 1.5 at normal incidence
constexpr float reflectance = 2 * r / (1 + r);  ///< reflectance of two faces, with all reflections between them
constexpr float front = 26, back = 1;           ///< radiance of the lamps
constexpr float expected = reflectance * front + (1 - reflectance) * back;

/// A camera between two lamps looks straight at glass: it sees one lamp through the glass, and
/// the lamp behind the camera by reflection.
LoadedScene pane_between_lamps(const std::string& shape, const std::string& glass) {
    const auto lamp = [](double z, double turn, double radiance) {
        return "<shape type='rectangle'><transform name='to_world'><scale value='3'/><rotate y='1' angle='" +
               std::to_string(turn) + "'/><translate z='" + std::to_string(z) +
               "'/></transform><emitter type='area'><rgb name='radiance' value='" + std::to_string(radiance) +
               "'/></emitter></shape>";
    };
    return scene_of(test::scene_xml("<sensor type='perspective'><float name='fov' value='2'/>" + test::box_film(8) +
                                    "</sensor>" + lamp(-5, 0, double{front}) + lamp(9, 180, double{back}) +
                                    "<shape type='" + shape +
                                    "'><transform name='to_world'><rotate y='1' angle='180'/>"
                                    "<translate z='4'/></transform>" +
                                    glass + "</shape>"));
}

// If one way were chosen for each path, every sample would show one lamp or the other, never their sum.
TEST(SpecularWalk, FollowsBothWaysOnFromASmoothInterface) {
    const auto scene = pane_between_lamps(
        "rectangle",
        "<bsdf type='thindielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>");
    const Image image = *test::render(scene, "photon_mapper photons=0", 1)[Component::emission];
    for (std::size_t i = 0; i < image.pixels(); ++i)
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(image.at(i)[c], expected, 1e-4f * expected) << "pixel " << i;
}

// The two faces of a plate, seen straight on, are the first two interfaces of a path, so both are followed both ways.
// Only light that the second face sends back is left to chance at the first face: with probability 1 - r it comes
// from the lamp of radiance `front`.
TEST(SpecularWalk, BothFacesOfAPlateAreFollowedBothWays) {
    const auto scene = pane_between_lamps(
        "cube", "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>");
    const Image once = *test::render(scene, "photon_mapper photons=0", 1)[Component::emission];
    const float followed = r * front + sqr(1 - r) * back, sent_back = (1 - r) * r;
    for (std::size_t i = 0; i < once.pixels(); ++i) {
        EXPECT_GT(once.at(i)[0], (followed + sent_back * back) * (1 - 1e-4f)) << "pixel " << i;
        EXPECT_LT(once.at(i)[0], (followed + sent_back * front) * (1 + 1e-4f)) << "pixel " << i;
    }
    // A sample's deviation is at most sent_back (front - back) sqrt(r (1 - r)). The bound is 5 standard errors for 64
    // pixels of 64 samples each.
    const Image mean = *test::render(scene, "photon_mapper photons=0", 64)[Component::emission];
    const double deviation = double{sent_back * (front - back)} * std::sqrt(double{r * (1 - r)});
    EXPECT_NEAR(test::mean_of(mean)[0], double{expected}, 5 * deviation / 64);
}

}  // namespace
}  // namespace gib::specular_walk_test
