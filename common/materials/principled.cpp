#include "common/materials/principled.h"

#include "common/materials/burley.h"
#include "common/materials/fresnel.h"
#include "common/materials/gtr1.h"
#include "common/sampling/warp.h"

#include <algorithm>

namespace gib {

using burley::lerp, burley::schlick, burley::schlick_weight;

namespace {

/// Roughness of the clear coat at the ends of clearcoat_gloss, and that of its masking (Burley 2012).
constexpr float coat_alpha_dull = 0.1f, coat_alpha_glossy = 1e-3f, coat_masking_alpha = 0.25f;
constexpr float coat_f0 = 0.04f;
constexpr float coat_share = 0.25f;

/// Smith's masking of GGX (Walter et al. 2007, equation 34), multiplied out by the cosine.
float coat_masking(float cosine) {
    return 2.f * cosine / (cosine + std::sqrt(sqr(cosine) + sqr(coat_masking_alpha) * (1.f - sqr(cosine))));
}

}  // namespace

/// The main lobes at the facet that connects two given directions.
struct Principled::MainEvent {
    Color f;      ///< [1/sr], of power
    float pdf_w;  ///< [1/sr], once a main lobe is chosen
    float eta;    ///< index on wi's side over index on wo's side; 1 for a reflection
};

/// The probabilities of the lobes, by the light that each of them is estimated to scatter; all 0 if there is none.
struct Principled::Choice {
    float diffuse = 0.f, coat = 0.f, main = 0.f;
};

double Principled::eta_of_specular(double specular) { return 2 / (1 - std::sqrt(0.08 * specular)) - 1; }

MicrofacetDistribution Principled::distribution() const { return burley::facets(roughness, anisotropic); }

Color Principled::tint() const { return burley::tint_of(base_color); }

LobeTraits Principled::traits() const {
    LobeTraits t;
    t.rough = true;
    t.transmission = transmits();
    t.refraction = t.transmission && !is_black(base_color);
    t.diffuse = (opaque() > 0.f && !is_black(base_color)) || (1.f - metallic) * sheen > 0.f;
    t.glossy = clearcoat > 0.f;
    if (metallic > 0.f || eta != 1.f) {
        (main_kind() == LobeKind::diffuse ? t.diffuse : t.glossy) = true;
        const MicrofacetDistribution facets = distribution();
        t.anisotropic = facets.alpha_u != facets.alpha_v;
    }
    return t.scatters() ? t : LobeTraits{};
}

/// Diffuse light, retro-reflection, approximated subsurface scattering and sheen.
Color Principled::diffuse_f(float cos_o, float cos_i, float cos_d) const {
    Color f = base_color * (opaque() * inv_pi * burley::diffuse(roughness, flatness, cos_o, cos_i, cos_d));
    const float fuzz = (1.f - metallic) * sheen * schlick_weight(cos_d);
    if (fuzz > 0.f) f += fuzz * (1.f + sheen_tint * (tint() - 1.f));
    return f;
}

/// The reflectance of a facet; `dielectric` is the exact one of the interface.
Color Principled::main_reflectance(float cos_d, float dielectric, bool below) const {
    if (below) return Color::Constant(transparent() * dielectric);
    const float insulating = 1.f - metallic;
    Color f = Color::Constant(insulating * (1.f - spec_tint) * dielectric);
    if (metallic == 0.f && spec_tint == 0.f) return f;
    const float weight = schlick_weight(cos_d, eta);
    f += metallic * schlick(base_color, weight);
    if (spec_tint > 0.f && eta != 1.f)
        f += insulating * spec_tint * schlick(tint() * sqr((eta - 1.f) / (eta + 1.f)), weight);
    return f;
}

Color Principled::main_transmittance(float dielectric) const {
    if (!transmits()) return Color::Zero();
    return transparent() * (1.f - dielectric) * base_color.sqrt();
}

std::optional<Principled::MainEvent> Principled::main_event(const Vec3& wo, const Vec3& wi) const {
    const bool below = wo.z() < 0.f, reflects = below == (wi.z() < 0.f);
    const float eta_ti = below ? 1.f / eta : eta;
    if (!reflects && !transmits()) return std::nullopt;
    const Vec3 o = on_side(wo, below), i = on_side(wi, below);
    const std::optional<Facet> facet = reflects ? reflecting_facet(o, i) : refracting_facet(o, i, eta_ti);
    if (!facet) return std::nullopt;
    const float dielectric = reflects ? fresnel_dielectric(facet->cos_o, eta_ti).reflectance
                                      : dielectric_reflectance(facet->cos_o, facet->cos_i, eta_ti);
    const Color reflectance = main_reflectance(facet->cos_o, dielectric, below);
    const Color transmittance = main_transmittance(dielectric);
    const float total = reflectance.mean() + transmittance.mean();
    if (!(total > 0.f)) return std::nullopt;
    const Color& share = reflects ? reflectance : transmittance;
    const MicrofacetDistribution facets = distribution();
    const float per_wi = facets.density(facet->m) * facet->jacobian / facets.visible_area(o);
    return MainEvent{.f = share * (per_wi / facets.visible_area(on_side(wi, wi.z() < 0.f))),
                     .pdf_w = share.mean() / total * per_wi,
                     .eta = reflects ? 1.f : eta_ti};
}

float Principled::clearcoat_f(const Vec3& wo, const Vec3& wi) const {
    const Facet facet = reflecting_facet(wo, wi);
    const Gtr1 facets{lerp(coat_alpha_dull, coat_alpha_glossy, clearcoat_gloss)};
    const float fresnel = lerp(coat_f0, 1.f, schlick_weight(facet.cos_o, eta));
    return coat_share * clearcoat * fresnel * facets.density(facet.m) * coat_masking(wo.z()) * coat_masking(wi.z());
}

LobeValues Principled::f_local(const Vec3& wo, const Vec3& wi, Transport transport) const {
    LobeValues f;
    if (!scatters_from(wo.z()) || wi.z() == 0.f) return f;
    if (const auto event = main_event(wo, wi)) {
        const float scale = transport == Transport::radiance ? 1.f / sqr(event->eta) : 1.f;
        f.add(main_kind(), scale * event->f);
    }
    if (!(wo.z() > 0.f && wi.z() > 0.f)) return f;
    f.diffuse += diffuse_f(wo.z(), wi.z(), reflecting_facet(wo, wi).cos_o);
    if (clearcoat > 0.f) f.specular += clearcoat_f(wo, wi);
    return f;
}

/// The light that the lobes scatter, by their values at the mean surface. The main lobes' facets are tilted: there the
/// reflectance at this angle has bounds, so that no lobe vanishes.
ScatteringCoefficients Principled::estimate(float cos_o) const {
    ScatteringCoefficients c;
    if (!scatters_from(cos_o)) return c;
    const bool below = cos_o < 0.f;
    if (metallic > 0.f || eta != 1.f) {
        const float margin = 0.05f * std::min(distribution().roughness(), 1.f);
        const float exact = fresnel_dielectric(cos_o, eta).reflectance;
        const float dielectric = eta == 1.f ? 0.f : std::clamp(exact, margin, 1.f - margin);
        // The cosine is limited, so that Schlick's weight is not 0 for a metal without red, green or blue.
        const Color main = main_reflectance(std::min(std::abs(cos_o), 0.6f), dielectric, below);
        (main_kind() == LobeKind::diffuse ? c.diffuse : c.specular) += main + main_transmittance(dielectric);
    }
    if (below) return c;
    c.diffuse += opaque() * base_color;
    // The mean of w(d) over wi in the hemisphere is between 0.02 at normal incidence and 0.2 at grazing incidence.
    const float fuzz = (1.f - metallic) * sheen * lerp(0.02f, 0.2f, schlick_weight(cos_o)) * pi;
    if (fuzz > 0.f) c.diffuse += fuzz * (1.f + sheen_tint * (tint() - 1.f));
    return c;
}

Principled::Choice Principled::choice(float cos_o, Lobes which) const {
    if (!scatters_from(cos_o)) return {};
    Choice c;
    const bool front = cos_o > 0.f;
    if (front && which != Lobes::specular) {
        const float fuzz = (1.f - metallic) * sheen * 0.2f;
        c.diffuse = opaque() * base_color.mean() + fuzz;
    }
    if (front && which != Lobes::diffuse)
        c.coat = clearcoat * lerp(coat_f0, 1.f, schlick_weight(cos_o)) * std::max(cos_o, 0.1f);
    if ((metallic > 0.f || eta != 1.f) && includes(which, main_kind())) {
        // The floor keeps the lobes sampled where tilted facets reflect more than the mean surface.
        const float dielectric = fresnel_dielectric(cos_o, eta).reflectance;
        const Color main = main_reflectance(std::abs(cos_o), dielectric, !front) + main_transmittance(dielectric);
        c.main = std::max(main.mean(), 0.05f);
    }
    const float total = c.diffuse + c.coat + c.main;
    if (total > 0.f) c = {c.diffuse / total, c.coat / total, c.main / total};
    return c;
}

float Principled::pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const {
    if (!scatters_from(wo.z()) || wi.z() == 0.f) return 0.f;
    const Choice c = choice(wo.z(), which);
    float pdf_w = 0.f;
    if (c.main > 0.f)
        if (const auto event = main_event(wo, wi)) pdf_w += c.main * event->pdf_w;
    if (!(wo.z() > 0.f && wi.z() > 0.f)) return pdf_w;
    pdf_w += c.diffuse * cosine_hemisphere_pdf(wi.z());
    if (c.coat > 0.f) {
        const Facet facet = reflecting_facet(wo, wi);
        const Gtr1 facets{lerp(coat_alpha_dull, coat_alpha_glossy, clearcoat_gloss)};
        pdf_w += c.coat * facets.density(facet.m) * facet.m.z() * reflection_jacobian / facet.cos_o;
    }
    return pdf_w;
}

/// A direction by a visible facet, which reflects or refracts with probabilities in proportion to its lobes.
std::optional<Vec3> Principled::sample_main(const Vec3& wo, float u_lobe, const Vec2& u) const {
    const bool below = wo.z() < 0.f;
    const float eta_ti = below ? 1.f / eta : eta;
    const Vec3 o = on_side(wo, below), m = distribution().sample_visible(o, u);
    const float cos_o = o.dot(m);
    if (!(cos_o > 0.f)) return std::nullopt;
    const DielectricFresnel fresnel = fresnel_dielectric(cos_o, eta_ti);
    const float reflects = main_reflectance(cos_o, fresnel.reflectance, below).mean();
    const float refracts = main_transmittance(fresnel.reflectance).mean();
    if (u_lobe * (reflects + refracts) < reflects) {
        const Vec3 i = reflected(o, m, cos_o);
        return i.z() > 0.f ? std::optional(on_side(i, below)) : std::nullopt;
    }
    const float cos_i = -fresnel.cos_t;
    if (!(cos_i > 0.f)) return std::nullopt;
    const Vec3 i = refracted(o, m, cos_o, cos_i, eta_ti).wi;
    return i.z() < 0.f ? std::optional(on_side(i, below)) : std::nullopt;
}

std::optional<BsdfSample> Principled::sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport transport,
                                                   Lobes which) const {
    const Choice c = choice(wo.z(), which);
    std::optional<Vec3> wi;
    LobeKind lobe = LobeKind::specular;
    if (u_lobe < c.diffuse) {
        wi = square_to_cosine_hemisphere(u);
        lobe = LobeKind::diffuse;
    } else if (u_lobe < c.diffuse + c.coat) {
        const Vec3 m = Gtr1{lerp(coat_alpha_dull, coat_alpha_glossy, clearcoat_gloss)}.sample(u);
        const float cos_o = wo.dot(m);
        if (cos_o > 0.f) wi = reflected(wo, m, cos_o);
        if (wi && !(wi->z() > 0.f)) return std::nullopt;
    } else if (c.main > 0.f) {
        const float rest = (u_lobe - c.diffuse - c.coat) / c.main;
        wi = sample_main(wo, std::clamp(rest, 0.f, 1.f - unit_roundoff), u);
        lobe = main_kind();
    }
    if (!wi) return std::nullopt;
    const float pdf_w = pdf_w_local(wo, *wi, which);
    if (!(pdf_w > 0.f)) return std::nullopt;
    const bool refracts = (wi->z() < 0.f) != (wo.z() < 0.f);
    return BsdfSample{.wi = *wi,
                      .f = f_local(wo, *wi, transport).of(which),
                      .pdf_w = pdf_w,
                      .lobe = lobe,
                      .eta = !refracts      ? 1.f
                             : wo.z() < 0.f ? 1.f / eta
                                            : eta};
}

ScatteringCoefficients Principled::coefficients_local(const Vec3& wo) const {
    ScatteringCoefficients c = estimate(wo.z());
    if (wo.z() > 0.f) c.specular += clearcoat * lerp(coat_f0, 1.f, schlick_weight(wo.z())) * std::max(wo.z(), 0.1f);
    return burley::at_most_one(c);
}

}  // namespace gib
