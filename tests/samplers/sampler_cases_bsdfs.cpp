// The materials.

#include "tests/samplers/sampler_cases.h"

#include "tests/support/scene_text.h"

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
double loss_free_scale(const LocalBsdf& bsdf, const Vec3& wo, const Vec3& wi, Transport transport) {
    return transport == Transport::radiance ? sqr(bsdf.index(wi) / bsdf.index(wo)) : 1.0;
}

SamplerCase bsdf_case(const BsdfModel& model, double theta, Transport transport = Transport::radiance) {
    const LocalBsdf bsdf(model);
    const Vec3 wo = direction_at(theta, 40);
    const bool power = transport == Transport::power;
    SamplerCase test = sphere_case(
        fmt::format("bsdf: {} at {} degrees{}", model.name, theta, power ? ", power" : ""), SphereChart(),
        [bsdf, wo, transport](const RandomNumbers& r) -> std::optional<SampledDirection> {
            const auto s = bsdf.sample(wo, r, transport);
            if (!s) return std::nullopt;
            const double weight = mean(s->f) * std::abs(static_cast<double>(s->wi.z())) / static_cast<double>(s->pdf_w);
            return SampledDirection{s->wi, static_cast<double>(s->pdf_w),
                                    weight * loss_free_scale(bsdf, wo, s->wi, transport), s->delta};
        },
        [bsdf, wo, transport](const Vec3& wi) { return bsdf.pdf(wo, wi, transport); });
    const SphereChart chart;
    test.value = [bsdf, wo, chart, transport](const Vec2d& point) {
        const Vec3 wi = chart.direction(point).cast<float>();
        return mean(bsdf.f(wo, wi, transport)) * std::abs(static_cast<double>(wi.z())) *
               loss_free_scale(bsdf, wo, wi, transport);
    };
    test.total = std::nullopt;  // delta lobes, and directions that end up below the surface
    test.mean_weight = model.albedo;
    if (!power) test.largest_mean_weight = 1;
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

double LocalBsdf::pdf(const Vec3& wo, const Vec3& wi, Transport transport) const {
    return static_cast<double>(bsdf_.pdf_w_local(wo, wi, Lobes::all, transport));
}

Color LocalBsdf::f(const Vec3& wo, const Vec3& wi, Transport transport) const {
    return bsdf_.f_local(wo, wi, transport).sum();
}

namespace {

std::string number(const std::string& name, double value) {
    return fmt::format("<float name='{}' value='{}'/>", name, value);
}

std::string bsdf(const std::string& type, const std::string& parameters) {
    return "<bsdf type='" + type + "'>" + parameters + "</bsdf>";
}

std::string reflectance(const std::string& rgb) { return "<rgb name='reflectance' value='" + rgb + "'/>"; }

std::string microfacets(const std::string& distribution, double alpha) {
    return "<string name='distribution' value='" + distribution + "'/>" + number("alpha", alpha);
}

const std::string mirror_index = "<string name='material' value='none'/>";
const std::string glass_index = number("int_ior", 1.5) + number("ext_ior", 1);

std::vector<BsdfModel> smooth_models() {
    return {
        {"diffuse", bsdf("diffuse", reflectance("0.2, 0.5, 0.8")), 1, 0.5},
        {"white diffuse", bsdf("diffuse", reflectance("1")), 1, 1.0},
        {"two-sided diffuse", bsdf("twosided", bsdf("diffuse", reflectance("0.75"))), 1, 0.75, true},
        {"dielectric", bsdf("dielectric", glass_index), 1.5, 1.0, true},
        {"thindielectric", bsdf("thindielectric", glass_index), 1, 1.0, true},
        {"mirror", bsdf("conductor", mirror_index), 1, 1.0},
    };
}

std::vector<BsdfModel> rough_models() {
    std::vector<BsdfModel> models;
    for (const std::string distribution : {"beckmann", "ggx"}) {
        for (double alpha : {0.01, 0.1, 0.5, 1.0}) {
            const std::string name = fmt::format("{} alpha={}", distribution, alpha);
            const std::string facets = microfacets(distribution, alpha);
            models.push_back({"roughconductor " + name, bsdf("roughconductor", mirror_index + facets)});
            if (alpha < 1)
                models.push_back(
                    {"roughdielectric " + name, bsdf("roughdielectric", glass_index + facets), 1.5, {}, true});
        }
        const std::string stretched = "<string name='distribution' value='" + distribution + "'/>" +
                                      number("alpha_u", 0.05) + number("alpha_v", 0.4);
        models.push_back({"roughconductor " + distribution + " stretched",
                          bsdf("twosided", bsdf("roughconductor", number("eta", 0.2) + number("k", 3.9) + stretched)),
                          1,
                          {},
                          true});
        models.push_back({"roughdielectric " + distribution + " stretched",
                          bsdf("roughdielectric", glass_index + stretched),
                          1.5,
                          {},
                          true});
    }
    return models;
}

std::vector<BsdfModel> layered_models() {
    const std::string nonlinear = "<boolean name='nonlinear' value='true'/>";
    const std::string white = "<rgb name='diffuse_reflectance' value='1'/>";
    std::vector<BsdfModel> models = {
        {"plastic", bsdf("plastic", glass_index)},
        {"white plastic", bsdf("plastic", glass_index + white), 1, 1.0},
        {"white plastic nonlinear", bsdf("plastic", glass_index + white + nonlinear), 1, 1.0},
    };
    for (const std::string distribution : {"beckmann", "ggx"})
        for (double alpha : {0.02, 0.3})
            models.push_back({fmt::format("roughplastic {} alpha={}", distribution, alpha),
                              bsdf("roughplastic", glass_index + microfacets(distribution, alpha) + white)});
    for (double exponent : {1.0, 30.0, 3000.0})
        models.push_back({fmt::format("phong {}", exponent), bsdf("phong", number("exponent", exponent))});
    return models;
}

std::vector<BsdfModel> mixed_models() {
    const std::string diffuse = bsdf("diffuse", reflectance("0.5"));
    const std::string rough = bsdf("roughconductor", mirror_index + microfacets("ggx", 0.05));
    return {
        {"blend of diffuse and glossy", bsdf("blendbsdf", number("weight", 0.3) + diffuse + rough)},
        {"mask", bsdf("mask", number("opacity", 0.3) + bsdf("twosided", rough)), 1, {}, true},
        {"blend of diffuse and mirror",
         bsdf("blendbsdf", number("weight", 0.3) + diffuse + bsdf("conductor", mirror_index)), 1, 0.65},
        {"blend of diffuse and glass",
         bsdf("blendbsdf",
              number("weight", 0.5) + diffuse + bsdf("roughdielectric", glass_index + microfacets("ggx", 0.2))),
         1.5,
         {},
         true},
    };
}

}  // namespace

std::vector<BsdfModel> bsdf_models() {
    std::vector<BsdfModel> models = smooth_models();
    for (auto make : {rough_models, layered_models, mixed_models})
        for (BsdfModel& model : make())
            models.push_back(std::move(model));
    return models;
}

// Seen from 33 degrees on towards the azimuth of bsdf_case, the steep normals show their back.
std::vector<BsdfModel> perturbed_models() {
    const std::string white = bsdf("diffuse", reflectance("1"));
    const std::string glossy = bsdf("roughconductor", mirror_index + microfacets("ggx", 0.3));
    const std::string plain =
        "<boolean name='flip_invalid_normals' value='false'/><boolean name='use_shadowing_function' value='false'/>";
    const auto map = [](const std::string& normal, const std::string& inside) {
        return bsdf("normalmap", "<rgb name='normalmap' value='" + normal + "'/>" + inside);
    };
    const std::string mild = "0.64 0.55 0.97", steep = "0.12 0.31 0.77";
    return {
        {"normalmap as it is", map(mild, plain + white)},
        {"normalmap", map(steep, white)},
        {"normalmap of diffuse and glossy", map(steep, bsdf("blendbsdf", number("weight", 0.5) + white + glossy))},
        {"normalmap of glass",
         map(mild, bsdf("roughdielectric", glass_index + microfacets("ggx", 0.3))),
         1.5,
         {},
         true},
        {"normalmap in a normalmap", map(mild, map(steep, white))},
        {"two-sided normalmap", bsdf("twosided", map(steep, glossy)), 1, {}, true},
    };
}

std::vector<SamplerCase> bsdf_cases() {
    std::vector<SamplerCase> cases;
    for (const BsdfModel& model : perturbed_models()) {
        for (double theta : {10.0, 70.0}) {
            for (Transport transport : {Transport::radiance, Transport::power}) {
                cases.push_back(bsdf_case(model, theta, transport));
                if (model.from_below) cases.push_back(bsdf_case(model, 180 - theta, transport));
            }
        }
    }
    for (const BsdfModel& model : bsdf_models()) {
        for (double theta : {0.0, 30.0, 60.0, 80.0, 89.0}) {
            cases.push_back(bsdf_case(model, theta));
            if (model.from_below) cases.push_back(bsdf_case(model, 180 - theta));
        }
    }
    return cases;
}

}  // namespace gib::test
