// The two directions of transport are adjoint at every surface: for any functions g and h of direction,
//   integral of |wo.ng| g(wo) Lo(wo) dwo = integral of |wi.ng| h(wi) P(wi) dwi,
// where Lo is the radiance that the surface sends towards wo when h arrives from all sides, and P is the mean of g over
// the directions in which a photon from wi leaves, times its weight (Veach 1997, chapters 4 and 5). Both sides are
// estimated by samples of sample_scattering(), the left one of radiance, the right one of power.

#include "common/sampling/warp.h"
#include "methods/parts/transport/scattered_ray.h"
#include "tests/samplers/sampler_cases.h"
#include "tests/support/moments.h"

#include <gtest/gtest.h>

namespace gib::adjoint_test {
namespace {

/// The hit of a ray that comes from w, as Scene::surface_hit() makes it.
SurfaceHit seen_from(const Vec3& w, const Vec3& ng, const Vec3& interpolated, const Bsdf& bsdf) {
    SurfaceGeometry geometry{};
    geometry.p = Vec3::Zero();
    geometry.ng = ng;
    geometry.ns = interpolated;
    geometry.uv = Vec2::Zero();
    SurfaceHit hit(geometry);
    if (!hit.normals_agree_about(w)) {
        hit.delta_only = true;
        hit.ns = hit.ns.dot(ng) > 0.f ? ng : Vec3(-ng);
    }
    hit.shading = Frame(hit.ns);
    hit.bsdf = &bsdf;
    return hit;
}

/// One side of the equation: directions `from` are chosen evenly, and the surface leads them on.
test::Moments mean_of_transport(const Vec3& ng, const Vec3& interpolated, const Bsdf& bsdf, Transport transport,
                                const Vec3& from_slope, const Vec3& to_slope) {
    constexpr std::uint64_t samples = 1 << 16;
    test::Moments moments;
    for (std::uint64_t i = 0; i < samples; ++i) {
        const Sampler u(PointSet::independent, static_cast<std::uint64_t>(transport), i, 0);
        const Vec3 from = square_to_sphere(u.get_2d(0));
        const SurfaceHit hit = seen_from(from, ng, interpolated, bsdf);
        const auto next = sample_scattering(hit, hit.shading.to_local(from), u.get_2d(1), u.get_2d(2), transport);
        const float arriving = std::abs(from.dot(ng)) * std::exp(from_slope.dot(from));
        moments.add(next ? static_cast<double>(arriving * next->weight.sum() * std::exp(to_slope.dot(next->wi))) : 0.0);
    }
    return moments;
}

// The probability of a false alarm is 1e-3 for the whole table, split evenly (Bonferroni).
TEST(AdjointTransport, HoldsForAnyModelAndNormals) {
    std::vector<test::BsdfModel> models = test::bsdf_models();
    for (test::BsdfModel& model : test::perturbed_models())
        models.push_back(std::move(model));
    constexpr std::array leans = {0.0, 10.0, 30.0, 50.0, 75.0};  // degrees between the normals
    const double alpha = 1e-3 / static_cast<double>(models.size() * leans.size());
    const Vec3 g(0.9f, -0.6f, 0.7f), h(-0.5f, 1.1f, 0.3f), ng(0.f, 0.f, 1.f);
    for (const test::BsdfModel& model : models) {
        const test::LocalBsdf local(model);
        for (const double lean : leans) {
            const Vec3 interpolated = test::direction_at(lean, 40);
            const auto radiance = mean_of_transport(ng, interpolated, local.bsdf(), Transport::radiance, g, h);
            const auto power = mean_of_transport(ng, interpolated, local.bsdf(), Transport::power, h, g);
            const double error = std::hypot(radiance.standard_error(), power.standard_error());
            const double z = std::abs(radiance.mean() - power.mean()) / std::max(error, 1e-12);
            EXPECT_GT(std::erfc(z / std::sqrt(2.0)), alpha)
                << model.name << " at " << lean << " degrees: " << radiance.mean() << " by radiance, " << power.mean()
                << " by power, +- " << error;
        }
    }
}

}  // namespace
}  // namespace gib::adjoint_test
