// Helmholtz reciprocity (Veach 1997, sections 3.7.5 and 6.3): light that goes from plate A over an object to plate B is as
// much as goes from B to A. The two plates are alike; one of them emits, and the camera, close before the other, sees
// it whole.

#include "tests/support/moments.h"
#include "tests/support/scene_fixtures.h"

#include <gtest/gtest.h>

namespace gib::reciprocity_test {
namespace {

using test::Moments;

struct Plate {
    std::string to_world;  ///< transform of a square from -1 to 1, which shines along +z
};
const Plate a{"<scale value='0.5'/><rotate y='1' angle='90'/><translate x='-1.5' y='0.4'/>"};
const Plate b{"<scale value='0.5'/><rotate x='1' angle='20'/><translate z='-1.4' y='0.3'/>"};

/// The object between the plates: a tilted sheet and a ball behind it, of one material.
LoadedScene scene_of(const std::string& bsdf, const Plate& lamp, const Plate& seen) {
    const std::string reflects = "<bsdf type='diffuse'><rgb name='reflectance' value='0.5'/></bsdf>";
    const auto plate = [&](const Plate& at, const std::string& emitter) {
        return "<shape type='rectangle'><transform name='to_world'>" + at.to_world + "</transform>" + reflects +
               emitter + "</shape>";
    };
    // The camera looks along -z of the plate, from just in front of it; its own film spans -1 to 1.
    return test::scene_of(
        "<scene version='3.0.0'><sensor type='orthographic'><transform name='to_world'><scale x='-1' z='-1'/>"
        "<translate z='0.002'/>" +
        seen.to_world + "</transform>" + test::box_film(4) + "</sensor>" +
        plate(lamp, "<emitter type='area'><rgb name='radiance' value='10'/></emitter>") + plate(seen, "") +
        "<shape type='rectangle'><transform name='to_world'><scale value='0.8'/><rotate y='1' "
        "angle='-140'/></transform>" +
        bsdf +
        "</shape><shape type='sphere'><point name='center' x='0.6' y='0.1' z='1'/><float name='radius' value='0.5'/>" +
        bsdf + "</shape></scene>");
}

Moments radiance(const LoadedScene& scene, const std::string& method) {
    Moments moments;
    for (std::uint64_t seed = 1; seed <= 16; ++seed)
        moments.add(test::mean_of(test::render(scene, method, 1024, seed).total())[1]);
    return moments;
}

struct NamedBsdf {
    const char* name;
    const char* xml;
};
void PrintTo(const NamedBsdf& bsdf, std::ostream* out) { *out << bsdf.name; }

class Reciprocity : public testing::TestWithParam<NamedBsdf> {};

TEST_P(Reciprocity, HoldsForLampAndSensor) {
    const std::string bsdf = GetParam().xml;
    const LoadedScene from_a = scene_of(bsdf, a, b), from_b = scene_of(bsdf, b, a);
    for (const std::string method : {"bidirectional", "path"}) {
        const Moments there = radiance(from_a, method), back = radiance(from_b, method);
        ASSERT_GT(there.mean(), 0);
        // A chance of 1e-4 for each method and material by Student's t of 30 degrees of freedom.
        EXPECT_NEAR(there.mean(), back.mean(), 4.5 * std::hypot(there.standard_error(), back.standard_error()))
            << method;
    }
}

INSTANTIATE_TEST_SUITE_P(
    Materials, Reciprocity,
    testing::Values(NamedBsdf{"diffuse", "<bsdf type='twosided'><bsdf type='diffuse'/></bsdf>"},
                    NamedBsdf{"roughconductor",
                              "<bsdf type='twosided'><bsdf type='roughconductor'>"
                              "<float name='alpha' value='0.2'/></bsdf></bsdf>"},
                    NamedBsdf{"conductor", "<bsdf type='twosided'><bsdf type='conductor'/></bsdf>"},
                    NamedBsdf{"dielectric", "<bsdf type='dielectric'/>"},
                    NamedBsdf{"thindielectric", "<bsdf type='thindielectric'/>"},
                    NamedBsdf{"roughdielectric",
                              "<bsdf type='roughdielectric'><float name='alpha' value='0.3'/></bsdf>"},
                    NamedBsdf{"plastic", "<bsdf type='twosided'><bsdf type='plastic'/></bsdf>"},
                    NamedBsdf{"roughplastic",
                              "<bsdf type='twosided'><bsdf type='roughplastic'>"
                              "<float name='alpha' value='0.2'/></bsdf></bsdf>"},
                    NamedBsdf{"phong",
                              "<bsdf type='twosided'><bsdf type='phong'><float name='exponent' value='20'/>"
                              "</bsdf></bsdf>"},
                    NamedBsdf{"mask",
                              "<bsdf type='mask'><float name='opacity' value='0.6'/><bsdf type='twosided'>"
                              "<bsdf type='diffuse'/></bsdf></bsdf>"}),
    [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace gib::reciprocity_test
