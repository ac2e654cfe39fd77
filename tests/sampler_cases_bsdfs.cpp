// The materials.

#include "tests/sampler_cases.h"

#include "tests/scene_text.h"

#include <fmt/format.h>

namespace gib::test {

namespace {

Bsdf bsdf_of(const std::string& xml) {
    const LoadedScene scene = load("<shape type='rectangle'>" + xml + "</shape>");
    const MaterialPoint point{
        {0.25f, 0.25f}, Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitY(), frame_along(Vec3::UnitZ(), Vec3::UnitX())};
    return scene.scene->material_of_shape(0).at(point);
}

double mean(const Color& c) { return c.cast<double>().mean(); }

/// The share of light that goes each way: radiance is scaled by the squared ratio of the indices where it is refracted.
double loss_free_scale(const LocalBsdf& bsdf, const Vec3& wo, const Vec3& wi) {
    return sqr(bsdf.index(wi) / bsdf.index(wo));
}

SamplerCase bsdf_case(const BsdfModel& model, double theta) {
    const LocalBsdf bsdf(model);
    const Vec3 wo = direction_at(theta, 40);
    SamplerCase test = sphere_case(
        fmt::format("bsdf: {} at {} degrees", model.name, theta), SphereChart(),
        [bsdf, wo](const RandomNumbers& r) -> std::optional<SampledDirection> {
            const auto s = bsdf.sample(wo, r, Transport::radiance);
            if (!s) return std::nullopt;
            const double weight = mean(s->f) * std::abs(static_cast<double>(s->wi.z())) / static_cast<double>(s->pdf_w);
            return SampledDirection{s->wi, static_cast<double>(s->pdf_w), weight * loss_free_scale(bsdf, wo, s->wi),
                                    s->delta};
        },
        [bsdf, wo](const Vec3& wi) { return bsdf.pdf(wo, wi); });
    const SphereChart chart;
    test.value = [bsdf, wo, chart](const Vec2d& point) {
        const Vec3 wi = chart.direction(point).cast<float>();
        return mean(bsdf.f(wo, wi)) * std::abs(static_cast<double>(wi.z())) * loss_free_scale(bsdf, wo, wi);
    };
    test.total = std::nullopt;  // delta lobes, and directions that end up below the surface
    test.mean_weight = model.albedo;
    test.largest_mean_weight = 1;
    return test;
}

}  // namespace

Vec3 direction_at(double theta, double phi) {
    const double t = theta * std::numbers::pi / 180, p = phi * std::numbers::pi / 180;
    return Vec3d(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)).cast<float>();
}

LocalBsdf::LocalBsdf(const BsdfModel& model) : bsdf_(bsdf_of(model.xml)), eta_(model.eta) {}

std::optional<BsdfSample> LocalBsdf::sample(const Vec3& wo, const RandomNumbers& r, Transport transport) const {
    return bsdf_.sample_local(wo, r.choice, r.u, transport);
}

double LocalBsdf::pdf(const Vec3& wo, const Vec3& wi) const { return static_cast<double>(bsdf_.pdf_w_local(wo, wi)); }

Color LocalBsdf::f(const Vec3& wo, const Vec3& wi) const { return bsdf_.f_local(wo, wi).sum(); }

std::vector<BsdfModel> bsdf_models() {
    return {
        {"diffuse", "<bsdf type='diffuse'><rgb name='reflectance' value='0.2, 0.5, 0.8'/></bsdf>", 1, 0.5},
        {"white diffuse", "<bsdf type='diffuse'><rgb name='reflectance' value='1'/></bsdf>", 1, 1.0},
        {"two-sided diffuse",
         "<bsdf type='twosided'><bsdf type='diffuse'><rgb name='reflectance' value='0.75'/></bsdf></bsdf>", 1, 0.75,
         true},
        {"dielectric",
         "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>", 1.5,
         1.0, true},
        {"mirror", "<bsdf type='conductor'><string name='material' value='none'/></bsdf>", 1, 1.0},
    };
}

std::vector<SamplerCase> bsdf_cases() {
    std::vector<SamplerCase> cases;
    for (const BsdfModel& model : bsdf_models()) {
        for (double theta : {0.0, 30.0, 60.0, 80.0, 89.0}) {
            cases.push_back(bsdf_case(model, theta));
            if (model.from_below) cases.push_back(bsdf_case(model, 180 - theta));
        }
    }
    return cases;
}

}  // namespace gib::test
