// The test cases of the materials' samplers.

#include "tests/samplers/sampler_cases.h"

#include "common/scene/scene.h"
#include "tests/support/scene_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace gib::test {

namespace {

Bsdf bsdf_of(const std::string& xml) {
    const LoadedScene scene = load(shape("rectangle", xml));
    const MaterialPoint point{
        {0.25f, 0.25f}, Vec3::UnitZ(), Vec3::UnitX(), Vec3::UnitY(), frame_along(Vec3::UnitZ(), Vec3::UnitX())};
    return scene.scene->material_of_shape(0).at(point);
}

/// The factor that makes the mean weight of a loss-free material 1: it cancels the scaling of refracted radiance by
/// the squared ratio of the indices. Power is not scaled.
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

std::string microfacets(const std::string& distribution, double alpha) {
    return text("distribution", distribution) + number("alpha", alpha);
}

const std::string mirror_index = text("material", "none");
const std::string glass_index = number("int_ior", 1.5) + number("ext_ior", 1);

const std::vector<std::string> distributions = {"beckmann", "ggx"};

std::string stretched(const std::string& distribution) {
    return text("distribution", distribution) + number("alpha_u", 0.05) + number("alpha_v", 0.4);
}

/// The models to be tested, by the scattering model that they contain.
struct ModelsOf {
    using Models = std::vector<BsdfModel>;

    Models operator()(std::type_identity<Diffuse>) const {
        return {
            {"diffuse", one_sided("0.2, 0.5, 0.8"), 1, 0.5},
            {"white diffuse", one_sided("1"), 1, 1.0},
            {"two-sided diffuse", bsdf("twosided", one_sided("0.75")), 1, 0.75, true},
        };
    }
    Models operator()(std::type_identity<Dielectric>) const {
        return {{"dielectric", bsdf("dielectric", glass_index), 1.5, 1.0, true}};
    }
    Models operator()(std::type_identity<ThinDielectric>) const {
        return {{"thindielectric", bsdf("thindielectric", glass_index), 1, {}, true}};
    }
    Models operator()(std::type_identity<Conductor>) const {
        return {{"mirror", bsdf("conductor", mirror_index), 1, 1.0}};
    }
    Models operator()(std::type_identity<RoughConductor>) const {
        Models models;
        for (const std::string& distribution : distributions) {
            for (double alpha : {0.01, 0.1, 0.5, 1.0})
                models.push_back({fmt::format("roughconductor {} alpha={}", distribution, alpha),
                                  bsdf("roughconductor", mirror_index + microfacets(distribution, alpha))});
            const std::string metal = number("eta", 0.2) + number("k", 3.9) + stretched(distribution);
            models.push_back({"roughconductor " + distribution + " stretched",
                              bsdf("twosided", bsdf("roughconductor", metal)),
                              1,
                              {},
                              true});
        }
        return models;
    }
    Models operator()(std::type_identity<RoughDielectric>) const {
        Models models;
        const auto add = [&](const std::string& name, const std::string& facets) {
            models.push_back({"roughdielectric " + name, bsdf("roughdielectric", glass_index + facets), 1.5, {}, true});
        };
        for (const std::string& distribution : distributions) {
            for (double alpha : {0.01, 0.1, 0.5})
                add(fmt::format("{} alpha={}", distribution, alpha), microfacets(distribution, alpha));
            add(distribution + " stretched", stretched(distribution));
        }
        return models;
    }
    Models operator()(std::type_identity<Plastic>) const {
        const std::string nonlinear = flag("nonlinear");
        return {
            {"plastic", bsdf("plastic", glass_index)},
            {"white plastic", bsdf("plastic", glass_index + white), 1, 1.0},
            {"white plastic nonlinear", bsdf("plastic", glass_index + white + nonlinear), 1, 1.0},
        };
    }
    Models operator()(std::type_identity<RoughPlastic>) const {
        Models models;
        for (const std::string& distribution : distributions)
            for (double alpha : {0.02, 0.3})
                models.push_back({fmt::format("roughplastic {} alpha={}", distribution, alpha),
                                  bsdf("roughplastic", glass_index + microfacets(distribution, alpha) + white)});
        return models;
    }
    Models operator()(std::type_identity<Phong>) const {
        Models models;
        for (double exponent : {1.0, 30.0, 3000.0})
            models.push_back({fmt::format("phong {}", exponent), bsdf("phong", number("exponent", exponent))});
        return models;
    }
    Models operator()(std::type_identity<RoughDiffuse>) const {
        Models models;
        for (double alpha : {0.0, 0.2, 0.7, 3.0})
            models.push_back({fmt::format("roughdiffuse {}", alpha),
                              bsdf("roughdiffuse", rgb("reflectance", "0.2, 0.5, 0.8") + number("alpha", alpha))});
        models[0].albedo = 0.5;
        models.push_back({"fast roughdiffuse",
                          bsdf("twosided", bsdf("roughdiffuse", number("alpha", 0.5) + flag("use_fast_approx"))),
                          1,
                          {},
                          true});
        return models;
    }
    Models operator()(std::type_identity<Ward>) const {
        // At grazing angles ward-duer reflects several times its reflectance.
        const std::string dark = rgb("specular_reflectance", 0.1) + rgb("diffuse_reflectance", 0.3);
        Models models;
        for (const std::string variant : {"balanced", "ward", "ward-duer"})
            for (double alpha : {0.02, 0.3})
                models.push_back({fmt::format("{} {}", variant, alpha),
                                  bsdf("ward", text("variant", variant) + number("alpha_u", alpha) +
                                                   number("alpha_v", 0.15) + dark)});
        return models;
    }
    Models operator()(std::type_identity<Principled>) const {
        const std::string amber = rgb("base_color", "0.6, 0.4, 0.1"), glass = number("eta", 1.5);
        return {
            {"principled", bsdf("principled", "")},
            {"principled metal",
             bsdf("principled", amber + number("metallic", 1) + number("roughness", 0.4) + number("anisotropic", 0.8))},
            {"principled of many lobes",
             bsdf("principled", amber + number("sheen", 0.3) + number("sheen_tint", 0.5) + number("flatness", 0.4) +
                                    number("spec_tint", 0.5) + number("clearcoat", 0.7) +
                                    number("clearcoat_gloss", 0.4) + number("metallic", 0.3))},
            {"principled glass", bsdf("principled", amber + glass + number("spec_trans", 1)), 1.5, {}, true},
            {"principled of all lobes",
             bsdf("principled", amber + glass + number("spec_trans", 0.5) + number("metallic", 0.2) +
                                    number("roughness", 0.3) + number("clearcoat", 1)),
             1.5,
             {},
             true},
        };
    }
    Models operator()(std::type_identity<PrincipledThin>) const {
        const std::string amber = rgb("base_color", "0.6, 0.4, 0.1");
        return {
            {"thin principled sheet",
             bsdf("principledthin", amber + number("diff_trans", 0.8) + number("sheen", 0.4) + number("flatness", 0.3)),
             1,
             {},
             true},
            {"thin principled pane",
             bsdf("principledthin", amber + number("spec_trans", 1) + number("roughness", 0.4) +
                                        number("spec_tint", 0.5) + number("eta", 1.33)),
             1,
             {},
             true},
            {"thin principled of all lobes",
             bsdf("principledthin", amber + number("spec_trans", 0.5) + number("diff_trans", 0.6) +
                                        number("roughness", 0.35) + number("anisotropic", 0.7) + number("sheen", 0.2)),
             1,
             {},
             true},
        };
    }

private:
    const std::string white = rgb("diffuse_reflectance", "1");
};

/// Whether the material of this bsdf element has a layer of type T.
template <typename T>
bool contains(const std::string& xml) {
    const Bsdf bsdf = bsdf_of(xml);
    return std::any_of(bsdf.layers().begin(), bsdf.layers().end(),
                       [](const Bsdf::Layer& layer) { return std::holds_alternative<T>(layer.model); });
}

/// Throws std::logic_error if there is no model for T, or if one of them does not contain T.
template <typename T>
std::vector<BsdfModel> checked_models_of(std::type_identity<T> type) {
    std::vector<BsdfModel> models = ModelsOf()(type);
    if (models.empty()) throw std::logic_error("a scattering model has no test case");
    for (const BsdfModel& model : models)
        if (!contains<T>(model.xml)) throw std::logic_error("not of its scattering model: " + model.name);
    return models;
}

std::vector<BsdfModel> mixed_models() {
    const std::string diffuse = one_sided("0.5");
    const std::string rough = bsdf("roughconductor", mirror_index + microfacets("ggx", 0.05));
    const std::string absorbing = glass_index + rgb("sigma_a", "0.1, 0.4, 1") + number("thickness", 0.5);
    return {
        {"coating of diffuse", bsdf("coating", absorbing + diffuse)},
        {"coating of thin index of diffuse", bsdf("coating", number("int_ior", 1) + number("ext_ior", 1.3) + diffuse)},
        {"coating of a rough metal, both sides", bsdf("coating", absorbing + bsdf("twosided", rough)), 1, {}, true},
        {"coating of a mirror", bsdf("coating", glass_index + bsdf("conductor", mirror_index))},
        {"roughcoating of a blend",
         bsdf("roughcoating",
              absorbing + microfacets("ggx", 0.2) + bsdf("blendbsdf", number("weight", 0.3) + diffuse + rough))},
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
    auto models = listed_for_every_alternative<Scattering>([](auto type) { return checked_models_of(type); });
    for (BsdfModel& model : mixed_models())
        models.push_back(std::move(model));
    return models;
}

// The steep normals show their back to an eye at the azimuth of bsdf_case that is 33
// degrees or more off the vertical.
std::vector<BsdfModel> perturbed_models() {
    const std::string white = one_sided("1");
    const std::string glossy = bsdf("roughconductor", mirror_index + microfacets("ggx", 0.3));
    const std::string plain = flag("flip_invalid_normals", false) + flag("use_shadowing_function", false);
    const auto map = [](const std::string& normal, const std::string& inside) {
        return bsdf("normalmap", rgb("normalmap", "" + normal + "") + inside);
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
