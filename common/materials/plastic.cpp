#include "common/materials/plastic.h"

#include "common/materials/fresnel.h"

#include <algorithm>

namespace gib {

namespace {

/// The base's reflectance summed over all rounds under the coat: rho / (1 - rho R), or rho / (1 -
/// R) without `nonlinear`.
Color base_reflectance(const Color& rho, float internal_reflectance, bool nonlinear) {
    if (nonlinear) return rho / (1.f - rho * internal_reflectance);
    return rho / (1.f - internal_reflectance);
}

/// The probabilities of sampling the lobes; both are zero if there is nothing to sample.
struct LobeChoice {
    float coat = 0.f, base = 0.f;
};

/// Chooses in proportion to the light that each lobe reflects, among the lobes that take part (Mitsuba 3's weights).
LobeChoice choose_lobe(float transmittance, const Color& coat_color, const Color& base_color, bool has_coat,
                       bool has_base) {
    has_coat = has_coat && !is_black(coat_color);
    has_base = has_base && !is_black(base_color);
    if (!(has_coat && has_base)) return {has_coat ? 1.f : 0.f, has_base ? 1.f : 0.f};
    const float coat = (1.f - transmittance) * coat_color.mean(), base = transmittance * base_color.mean();
    return {coat / (coat + base), base / (coat + base)};
}

/// The mean of a function of the facet's normal and its cosine with wo. The two halves of the unit square give
/// normals that are mirror images: one half is enough.
template <typename F>
double mean_over_visible_normals(const MicrofacetDistribution& distribution, const Vec3& wo, int size, F&& f) {
    // Midpoint rule in t with u = t^2 (3 - 2 t), which refines the steps towards the ends, where slopes
    // grow without bounds.
    const auto u = [](double t) { return t * t * (3 - 2 * t); };
    const bool ggx = distribution.type == MicrofacetType::ggx;
    double sum = 0;
    for (int i = 0; i < size; ++i) {
        const double t = (i + 0.5) / size, width = u((i + 1.0) / size) - u(static_cast<double>(i) / size);
        const auto along = static_cast<float>(u(t));
        for (int j = 0; 2 * j < size; ++j) {
            const double v = (j + 0.5) / size, height = u((j + 1.0) / size) - u(static_cast<double>(j) / size);
            // For GGX this number is the angle around wo: the integrand is periodic in it, and equal steps are best.
            const Vec2 point = ggx ? Vec2(static_cast<float>(v), along) : Vec2(along, static_cast<float>(u(v)));
            const Vec3 m = distribution.sample_visible(wo, point);
            sum += width * (ggx ? 1.0 / size : height) * static_cast<double>(f(m, std::max(wo.dot(m), 0.f)));
        }
    }
    return 2 * sum;
}

/// The share of light from wo that the surface reflects after a single scattering.
double rough_reflectance(const MicrofacetDistribution& distribution, const Vec3& wo, float eta_ti, int size) {
    return mean_over_visible_normals(distribution, wo, size, [&](const Vec3& m, float cos_o) {
        const Vec3 wi = reflected(wo, m, cos_o);
        return wi.z() > 0.f ? fresnel_dielectric(cos_o, eta_ti).reflectance * distribution.g1(wi) : 0.f;
    });
}

double rough_transmittance(const MicrofacetDistribution& distribution, const Vec3& wo, float eta_ti, int size) {
    return mean_over_visible_normals(distribution, wo, size, [&](const Vec3& m, float cos_o) {
        const DielectricFresnel fresnel = fresnel_dielectric(cos_o, eta_ti);
        const Vec3 wi = -refracted(wo, m, cos_o, -fresnel.cos_t, eta_ti).wi;
        return wi.z() > 0.f && fresnel.cos_t < 0.f ? (1.f - fresnel.reflectance) * distribution.g1(wi) : 0.f;
    });
}

constexpr int table_size = 64;  // as in Mitsuba 3

Vec3 table_direction(int i) {
    const float c = std::max(static_cast<float>(i) / (table_size - 1), 1e-6f);
    return {safe_sqrt((1.f - c) * (1.f + c)), 0.f, c};
}

}  // namespace

float diffuse_fresnel_reflectance(float eta_ti) {
    // From the denser side: by reciprocity, the transmitted share of diffuse light is that from the other
    // side over eta^2.
    if (eta_ti < 1.f) return 1.f - sqr(eta_ti) * (1.f - diffuse_fresnel_reflectance(1.f / eta_ti));
    // The substitution cos = t^2 refines the steps near the horizon, where the reflectance changes fastest.
    constexpr int n = 2000;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        const double t = (i + 0.5) / n;
        sum += static_cast<double>(fresnel_dielectric(static_cast<float>(t * t), eta_ti).reflectance) * 4 * t * t * t;
    }
    return static_cast<float>(sum / n);
}

void Plastic::prepare() { internal_reflectance_ = diffuse_fresnel_reflectance(1.f / eta); }

LobeTraits Plastic::traits() const {
    LobeTraits t;
    t.diffuse = !is_black(diffuse_reflectance);
    t.delta = !is_black(specular_reflectance);
    return t;
}

LobeValues Plastic::f_local(const Vec3& wo, const Vec3& wi, Transport) const {
    LobeValues f;
    if (!(wo.z() > 0.f && wi.z() > 0.f)) return f;
    const float in = 1.f - fresnel_dielectric(wi.z(), eta).reflectance;
    const float out = 1.f - fresnel_dielectric(wo.z(), eta).reflectance;
    f.diffuse =
        base_reflectance(diffuse_reflectance, internal_reflectance_, nonlinear) * (in * out * inv_pi / sqr(eta));
    return f;
}

float Plastic::pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const {
    if (!(wo.z() > 0.f && wi.z() > 0.f)) return 0.f;
    const float t = 1.f - fresnel_dielectric(wo.z(), eta).reflectance;
    const LobeChoice choice =
        choose_lobe(t, specular_reflectance, diffuse_reflectance, which != Lobes::diffuse, which != Lobes::specular);
    return choice.base * cosine_hemisphere_pdf(wi.z());
}

std::optional<BsdfSample> Plastic::sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport transport,
                                                Lobes which) const {
    if (!(wo.z() > 0.f)) return std::nullopt;
    const float r = fresnel_dielectric(wo.z(), eta).reflectance;
    const LobeChoice choice = choose_lobe(1.f - r, specular_reflectance, diffuse_reflectance, which != Lobes::diffuse,
                                          which != Lobes::specular);
    if (u_lobe < choice.coat) {
        const Color weight = specular_reflectance * r;
        return BsdfSample{.wi = Vec3(-wo.x(), -wo.y(), wo.z()),
                          .f = weight / wo.z(),
                          .pdf_w = choice.coat,
                          .delta = true,
                          .lobe = LobeKind::specular};
    }
    if (choice.base == 0.f) return std::nullopt;
    const Vec3 wi = square_to_cosine_hemisphere(u);
    return BsdfSample{.wi = wi,
                      .f = f_local(wo, wi, transport).diffuse,
                      .pdf_w = choice.base * cosine_hemisphere_pdf(wi.z()),
                      .lobe = LobeKind::diffuse};
}

ScatteringCoefficients Plastic::coefficients_local(const Vec3& wo) const {
    if (!(wo.z() > 0.f)) return {};
    const float r = fresnel_dielectric(wo.z(), eta).reflectance;
    // The integral of (1 - F(wi)) cos / (pi eta^2) is 1 - R.
    const Color base = base_reflectance(diffuse_reflectance, internal_reflectance_, nonlinear);
    return {base * ((1.f - r) * (1.f - internal_reflectance_)), r * specular_reflectance};
}

RoughCoat::RoughCoat(const MicrofacetDistribution& distribution, float eta) {
    double reflectance = 0, transmitted = 0;
    for (int i = 0; i < table_size; ++i) {
        const Vec3 w = table_direction(i);
        nodes.push_back(static_cast<float>(rough_transmittance(distribution, w, eta, 64)));
        reflectance += 2 * static_cast<double>(w.z()) * rough_reflectance(distribution, w, 1.f / eta, 64);
        // The integral of 2 cos T(cos) between two nodes, where T is linear.
        if (i == 0) continue;
        const double a = nodes[nodes.size() - 2], b = nodes.back();
        const double left = (i - 1.0) / (table_size - 1), right = static_cast<double>(i) / (table_size - 1);
        transmitted += (right - left) * (a * (2 * left + right) + b * (left + 2 * right)) / 3;
    }
    diffuse_transmittance = static_cast<float>(transmitted);
    // By reciprocity the coat transmits the share `transmitted` / eta^2 of diffuse light from inside. R is at most
    // the rest.
    internal_reflectance = static_cast<float>(std::min(reflectance / table_size, 1 - transmitted / sqr(double{eta})));
}

float RoughCoat::transmittance(float cos_o) const {
    const float x = std::clamp(cos_o, 0.f, 1.f) * (table_size - 1);
    const auto i = std::min(static_cast<std::size_t>(x), nodes.size() - 2);
    const float t = x - static_cast<float>(i);
    return (1.f - t) * nodes[i] + t * nodes[i + 1];
}

void RoughPlastic::prepare() {
    distribution.alpha_v = distribution.alpha_u;
    coat_ = std::make_shared<const RoughCoat>(distribution, eta);
}

LobeTraits RoughPlastic::traits() const {
    LobeTraits t;
    if (!is_black(specular_reflectance)) {
        t.rough = true;
        const bool diffuse = kind_of_roughness(distribution.roughness()) == LobeKind::diffuse;
        (diffuse ? t.diffuse : t.glossy) = true;
    }
    t.diffuse = t.diffuse || !is_black(diffuse_reflectance);
    return t;
}

LobeValues RoughPlastic::f_local(const Vec3& wo, const Vec3& wi, Transport) const {
    LobeValues f;
    if (!(wo.z() > 0.f && wi.z() > 0.f)) return f;
    const Facet facet = reflecting_facet(wo, wi);
    const float coat = fresnel_dielectric(facet.cos_o, eta).reflectance * distribution.density(facet.m) *
                       facet.jacobian / (distribution.visible_area(wo) * distribution.visible_area(wi));
    f.add(kind_of_roughness(distribution.roughness()), specular_reflectance * coat);
    f.diffuse += base_reflectance(diffuse_reflectance, coat_->internal_reflectance, nonlinear) *
                 (coat_->transmittance(wo.z()) * coat_->transmittance(wi.z()) * inv_pi / sqr(eta));
    return f;
}

float RoughPlastic::pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const {
    if (!(wo.z() > 0.f && wi.z() > 0.f)) return 0.f;
    const LobeChoice choice =
        choose_lobe(coat_->transmittance(wo.z()), specular_reflectance, diffuse_reflectance,
                    includes(which, kind_of_roughness(distribution.roughness())), which != Lobes::specular);
    float pdf_w = choice.base * cosine_hemisphere_pdf(wi.z());
    if (choice.coat > 0.f) {
        const Facet facet = reflecting_facet(wo, wi);
        pdf_w += choice.coat * distribution.density(facet.m) * facet.jacobian / distribution.visible_area(wo);
    }
    return pdf_w;
}

std::optional<BsdfSample> RoughPlastic::sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport transport,
                                                     Lobes which) const {
    if (!(wo.z() > 0.f)) return std::nullopt;
    const LobeKind coat_kind = kind_of_roughness(distribution.roughness());
    const LobeChoice choice = choose_lobe(coat_->transmittance(wo.z()), specular_reflectance, diffuse_reflectance,
                                          includes(which, coat_kind), which != Lobes::specular);
    if (choice.coat + choice.base == 0.f) return std::nullopt;
    const bool coat = u_lobe < choice.coat;
    Vec3 wi;
    if (coat) {
        const Vec3 m = distribution.sample_visible(wo, u);
        wi = reflected(wo, m, wo.dot(m));
    } else {
        wi = square_to_cosine_hemisphere(u);
    }
    const float pdf_w = pdf_w_local(wo, wi, which);
    if (!(pdf_w > 0.f)) return std::nullopt;  // the facet sends it below the horizon
    return BsdfSample{.wi = wi,
                      .f = f_local(wo, wi, transport).of(which),
                      .pdf_w = pdf_w,
                      .lobe = coat ? coat_kind : LobeKind::diffuse};
}

ScatteringCoefficients RoughPlastic::coefficients_local(const Vec3& wo) const {
    ScatteringCoefficients c;
    if (!(wo.z() > 0.f)) return c;
    const float t = coat_->transmittance(wo.z());
    // Nearly all light that does not enter is reflected; the rest is lost.
    const Color coat = (1.f - t) * specular_reflectance;
    (kind_of_roughness(distribution.roughness()) == LobeKind::diffuse ? c.diffuse : c.specular) = coat;
    c.diffuse += base_reflectance(diffuse_reflectance, coat_->internal_reflectance, nonlinear) *
                 (t * coat_->diffuse_transmittance / sqr(eta));
    return c;
}

}  // namespace gib
