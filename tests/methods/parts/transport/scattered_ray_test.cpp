// Scattered rays at surfaces whose shading normal leans away from the geometric normal, and the eye path's walk through
// smooth interfaces, which follows both ways at the first two.

#include "methods/parts/transport/scattered_ray.h"

#include "common/materials/fresnel.h"
#include "common/sampling/warp.h"
#include "tests/support/scene_fixtures.h"

namespace gib::test::scattered_ray_test {
namespace {

/// A surface of these normals.
SurfaceHit surface_of(const Vec3& ng, const Vec3& ns, const Bsdf& bsdf) {
    SurfaceGeometry geometry{};
    geometry.p = Vec3::Zero();
    geometry.ng = ng;
    geometry.ns = ns;
    geometry.uv = Vec2::Zero();
    SurfaceHit hit(geometry);
    hit.shading = Frame(ns);
    hit.bsdf = &bsdf;
    return hit;
}

struct Leaning {
    SurfaceHit hit;
    Vec3 wo;
};

/// A surface whose normals are up to 75 degrees apart, and a direction `wo` that lies on the same side of both.
Leaning leaning(std::uint64_t i, const Bsdf& bsdf) {
    const Sampler u(PointSet::independent, 1, i, 0);
    const Vec3 ng = square_to_sphere(u.get_2d(0));
    const auto [tangent, lean] = std::pair(Frame(ng).s, 1.3f * u.get_2d(2).x());
    const Vec3 ns = (std::cos(lean) * ng + std::sin(lean) * tangent).normalized();
    for (std::uint32_t d = 4;; d += 2) {
        const Vec3 wo = square_to_sphere(u.get_2d(d));
        if (ns.dot(wo) * ng.dot(wo) > 0.f) return {surface_of(ng, ns, bsdf), wo};
    }
}

constexpr float rounding = 1e-5f;  // rounding error of a sine near 1

// For any normals, reflected light stays on its side of the surface, refracted light crosses it, and no light is
// lost: the weights are R and (1 - R) times the square of the relative index.
TEST(ScatteredRay, OfSmoothInterfacesKeepsToTheSidesOfTheSurface) {
    for (const float eta : {1.5f, 1 / 1.5f}) {
        const Bsdf glass(Dielectric{eta});
        int bent = 0;
        for (std::uint64_t i = 0; i < 20000; ++i) {
            const auto [hit, wo] = leaning(i, glass);
            const Vec3 wo_local = hit.shading.to_local(wo);
            float sum = 0;
            const auto check = [&](const ScatteredRay& ray) {
                EXPECT_NEAR(ray.wi.norm(), 1.f, rounding);
                const bool passes = ray.wi.dot(hit.ng) * wo.dot(hit.ng) < 0.f;
                EXPECT_EQ(passes, ray.eta != 1.f);
                if (!is_about_interpolated(hit, wo)) ++bent;
                sum += ray.weight.x() * ray.pdf_w * sqr(ray.eta);
            };
            for (const float u_lobe : {0.f, 1.f - unit_roundoff}) {
                const auto ray = sample_scattering(hit, wo_local, Vec2(u_lobe, 0.f), Vec2::Zero(), Transport::radiance);
                ASSERT_TRUE(ray);
                check(*ray);
                if (ray->pdf_w == 1.f) break;  // total reflection
            }
            EXPECT_NEAR(sum, 1.f, rounding);
            const auto both = both_ways(hit, wo_local);
            if (!both) continue;
            EXPECT_NEAR((*both)[0].weight.x() * sqr((*both)[0].eta) + (*both)[1].weight.x() * sqr((*both)[1].eta), 1.f,
                        rounding);
        }
        EXPECT_GT(bent, 1000) << "the case that is tested";
    }
}

// A part of the hemisphere about the shading normal lies behind the surface;
// a diffuse surface scatters nothing there.
TEST(ScatteredRay, OfDiffuseSurfacesLosesWhatWouldGoBehindThem) {
    const Bsdf white(Diffuse{Color::Ones()}, Diffuse{Color::Ones()});
    int lost = 0;
    for (std::uint64_t i = 0; i < 20000; ++i) {
        const auto [hit, wo] = leaning(i, white);
        const Sampler u(PointSet::independent, 2, i, 0);
        const auto ray =
            sample_scattering(hit, hit.shading.to_local(wo), u.get_2d(0), u.get_2d(2), Transport::radiance);
        if (!ray) {
            ++lost;
            continue;
        }
        EXPECT_GT(ray->wi.dot(hit.ng) * wo.dot(hit.ng), 0.f);
        EXPECT_NEAR(ray->weight.x(), 1.f, rounding);
    }
    // The share of a cosine-weighted hemisphere that is behind a plane at an angle a is (1 - cos a) / 2; `share` is
    // its mean for a uniform up to 1.3. The bound is five standard deviations.
    const double share = 0.5 * (1 - std::sin(1.3) / 1.3);
    EXPECT_NEAR(lost / 20000.0, share, 5 * std::sqrt(share * (1 - share) / 20000));
}

constexpr float r = 0.04f;                      ///< reflectance of a face of glass of index 1.5 at normal incidence
constexpr float reflectance = 2 * r / (1 + r);  ///< reflectance of two faces, with all reflections between them
constexpr float front = 26, back = 1;           ///< radiance of the lamps
constexpr float expected = reflectance * front + (1 - reflectance) * back;

/// A camera between two lamps looks straight at glass: it sees one lamp through the glass, and
/// the lamp behind the camera by reflection.
LoadedScene pane_between_lamps(const std::string& type, const std::string& glass_type) {
    const auto lamp = [](double z, double turn, double radiance) {
        return shape("rectangle", to_world(scale(3), rotate('y', turn), translate(0, 0, z)), area_light(radiance));
    };
    return Scene(camera(2, box_film(8)), lamp(-5, 0, double{front}), lamp(9, 180, double{back}),
                 shape(type, to_world(rotate('y', 180), translate(0, 0, 4)),
                       bsdf(glass_type, number("int_ior", 1.5), number("ext_ior", 1))))
        .load();
}

// If one way were chosen for each path, every sample would show one lamp or the other, never their sum.
TEST(SpecularWalk, FollowsBothWaysOnFromASmoothInterface) {
    const auto scene = pane_between_lamps("rectangle", "thindielectric");
    const Image image = *render(scene, "photon_mapper photons=0", 1)[Component::emission];
    for (std::size_t i = 0; i < image.pixels(); ++i)
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(image.at(i)[c], expected, 1e-4f * expected) << "pixel " << i;
}

// The two faces of a plate, seen straight on, are the first two interfaces of a path, so both are followed both ways.
// Only light that the second face sends back is left to chance at the first face: with probability 1 - r it comes
// from the lamp of radiance `front`.
TEST(SpecularWalk, BothFacesOfAPlateAreFollowedBothWays) {
    const auto scene = pane_between_lamps("cube", "dielectric");
    const Image once = *render(scene, "photon_mapper photons=0", 1)[Component::emission];
    const float followed = r * front + sqr(1 - r) * back, sent_back = (1 - r) * r;
    for (std::size_t i = 0; i < once.pixels(); ++i) {
        EXPECT_GT(once.at(i)[0], (followed + sent_back * back) * (1 - 1e-4f)) << "pixel " << i;
        EXPECT_LT(once.at(i)[0], (followed + sent_back * front) * (1 + 1e-4f)) << "pixel " << i;
    }
    // A sample's deviation is at most sent_back (front - back) sqrt(r (1 - r)). The bound is 5 standard errors for 64
    // pixels of 64 samples each.
    const Image mean = *render(scene, "photon_mapper photons=0", 64)[Component::emission];
    const double deviation = double{sent_back * (front - back)} * std::sqrt(double{r * (1 - r)});
    EXPECT_NEAR(mean_of(mean)[0], double{expected}, 5 * deviation / 64);
}

}  // namespace
}  // namespace gib::test::scattered_ray_test
