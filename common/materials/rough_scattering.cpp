#include "common/materials/rough_scattering.h"

#include "common/materials/fresnel.h"

#include <algorithm>

namespace gib {

namespace {

LobeTraits rough_lobe(const MicrofacetDistribution& distribution) {
    LobeTraits t;
    t.rough = true;
    t.diffuse = kind_of_roughness(distribution.roughness()) == LobeKind::diffuse;
    t.glossy = !t.diffuse;
    t.anisotropic = distribution.alpha_u != distribution.alpha_v;
    return t;
}

ScatteringCoefficients of_kind(LobeKind kind, const Color& coefficient) {
    ScatteringCoefficients c;
    (kind == LobeKind::diffuse ? c.diffuse : c.specular) = coefficient;
    return c;
}

}  // namespace

LobeTraits RoughConductor::traits() const {
    return is_black(specular_reflectance) ? LobeTraits{} : rough_lobe(distribution);
}

Color RoughConductor::reflectance(float cos_o) const {
    if (!index) return specular_reflectance;
    return specular_reflectance * fresnel_conductor(std::min(cos_o, 1.f), index->eta, index->k);
}

LobeValues RoughConductor::f_local(const Vec3& wo, const Vec3& wi, Transport) const {
    LobeValues f;
    if (!(wo.z() > 0.f && wi.z() > 0.f)) return f;
    const Facet facet = reflecting_facet(wo, wi);
    const float area = distribution.visible_area(wo) * distribution.visible_area(wi);
    f.add(kind_of_roughness(distribution.roughness()),
          reflectance(facet.cos_o) * (distribution.density(facet.m) * facet.jacobian / area));
    return f;
}

float RoughConductor::pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const {
    if (!(wo.z() > 0.f && wi.z() > 0.f) || !includes(which, kind_of_roughness(distribution.roughness()))) return 0.f;
    const Facet facet = reflecting_facet(wo, wi);
    return distribution.density(facet.m) * facet.jacobian / distribution.visible_area(wo);
}

std::optional<BsdfSample> RoughConductor::sample_local(const Vec3& wo, float, const Vec2& u, Transport,
                                                       Lobes which) const {
    const LobeKind kind = kind_of_roughness(distribution.roughness());
    if (!(wo.z() > 0.f) || !includes(which, kind)) return std::nullopt;
    const Vec3 m = distribution.sample_visible(wo, u);
    const float cos_o = wo.dot(m);
    const Vec3 wi = reflected(wo, m, cos_o);
    if (!(cos_o > 0.f && wi.z() > 0.f)) return std::nullopt;
    const float pdf_w = distribution.density(m) * reflection_jacobian / distribution.visible_area(wo);
    return BsdfSample{
        .wi = wi, .f = reflectance(cos_o) * (pdf_w / distribution.visible_area(wi)), .pdf_w = pdf_w, .lobe = kind};
}

ScatteringCoefficients RoughConductor::coefficients_local(const Vec3& wo) const {
    if (!(wo.z() > 0.f)) return {};
    return of_kind(kind_of_roughness(distribution.roughness()), reflectance(wo.z()));
}

/// The scattering at the facet that connects two given directions.
struct RoughDielectric::Event {
    bool reflects;
    float eta_ti;
    float pdf_w;
    float area_i;  ///< A(wi)
};

std::optional<RoughDielectric::Event> RoughDielectric::event(const Vec3& wo, const Vec3& wi) const {
    if (wo.z() == 0.f || wi.z() == 0.f || eta == 1.f) return std::nullopt;
    const bool below = wo.z() < 0.f, reflects = below == (wi.z() < 0.f);
    const float eta_ti = below ? 1.f / eta : eta;
    const Vec3 o = on_side(wo, below), i = on_side(wi, below);
    const std::optional<Facet> facet = reflects ? reflecting_facet(o, i) : refracting_facet(o, i, eta_ti);
    if (!facet) return std::nullopt;
    const float choice = reflects ? fresnel_dielectric(facet->cos_o, eta_ti).reflectance
                                  : 1.f - dielectric_reflectance(facet->cos_o, facet->cos_i, eta_ti);
    const float pdf_w = choice * distribution.density(facet->m) * facet->jacobian / distribution.visible_area(o);
    return Event{.reflects = reflects,
                 .eta_ti = eta_ti,
                 .pdf_w = pdf_w,
                 .area_i = distribution.visible_area(on_side(wi, wi.z() < 0.f))};
}

Color RoughDielectric::transmission(Transport transport, float eta_ti) const {
    const float scale = transport == Transport::radiance ? 1.f / sqr(eta_ti) : 1.f;
    return specular_transmittance * scale;
}

LobeTraits RoughDielectric::traits() const {
    LobeTraits t;
    const bool transmits = !is_black(specular_transmittance);
    if (eta == 1.f) t.delta = transmits;
    else if (transmits || !is_black(specular_reflectance)) t = rough_lobe(distribution);
    t.transmission = true;
    t.refraction = eta != 1.f && transmits;
    return t;
}

LobeValues RoughDielectric::f_local(const Vec3& wo, const Vec3& wi, Transport transport) const {
    LobeValues f;
    if (const std::optional<Event> e = event(wo, wi)) {
        const Color tint = e->reflects ? specular_reflectance : transmission(transport, e->eta_ti);
        f.add(kind_of_roughness(distribution.roughness()), tint * (e->pdf_w / e->area_i));
    }
    return f;
}

float RoughDielectric::pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const {
    if (!includes(which, kind_of_roughness(distribution.roughness()))) return 0.f;
    const std::optional<Event> e = event(wo, wi);
    return e ? e->pdf_w : 0.f;
}

std::optional<BsdfSample> RoughDielectric::sample_local(const Vec3& wo, float u_lobe, const Vec2& u,
                                                        Transport transport, Lobes which) const {
    if (wo.z() == 0.f) return std::nullopt;
    if (eta == 1.f) {
        if (which == Lobes::diffuse) return std::nullopt;
        return BsdfSample{.wi = -wo,
                          .f = specular_transmittance / std::abs(wo.z()),
                          .pdf_w = 1.f,
                          .delta = true,
                          .lobe = LobeKind::specular};
    }
    const LobeKind kind = kind_of_roughness(distribution.roughness());
    if (!includes(which, kind)) return std::nullopt;
    const bool below = wo.z() < 0.f;
    const float eta_ti = below ? 1.f / eta : eta;
    const Vec3 o = on_side(wo, below);
    const Vec3 m = distribution.sample_visible(o, u);
    const float cos_o = o.dot(m);
    if (!(cos_o > 0.f)) return std::nullopt;
    const DielectricFresnel fresnel = fresnel_dielectric(cos_o, eta_ti);
    const float facets = distribution.density(m) / distribution.visible_area(o);
    if (u_lobe < fresnel.reflectance) {
        const Vec3 i = reflected(o, m, cos_o);
        if (!(i.z() > 0.f)) return std::nullopt;
        const float pdf_w = fresnel.reflectance * facets * reflection_jacobian;
        return BsdfSample{.wi = on_side(i, below),
                          .f = specular_reflectance * (pdf_w / distribution.visible_area(i)),
                          .pdf_w = pdf_w,
                          .lobe = kind};
    }
    const float cos_i = -fresnel.cos_t;
    if (!(cos_i > 0.f)) return std::nullopt;
    const auto [i, length] = refracted(o, m, cos_o, cos_i, eta_ti);
    if (!(i.z() < 0.f)) return std::nullopt;
    const float pdf_w = (1.f - fresnel.reflectance) * facets * refraction_jacobian(cos_o, cos_i, eta_ti, length);
    const Color f = transmission(transport, eta_ti) * (pdf_w / distribution.visible_area(on_side(i, true)));
    return BsdfSample{.wi = on_side(i, below), .f = f, .pdf_w = pdf_w, .lobe = kind, .eta = eta_ti};
}

ScatteringCoefficients RoughDielectric::coefficients_local(const Vec3& wo) const {
    if (wo.z() == 0.f) return {};
    if (eta == 1.f) return {.specular = specular_transmittance};
    // Facets are tilted: no lobe vanishes, even if it does for a smooth interface at this angle.
    const float margin = 0.05f * std::min(distribution.roughness(), 1.f);
    const float r = std::clamp(fresnel_dielectric(wo.z(), eta).reflectance, margin, 1.f - margin);
    return of_kind(kind_of_roughness(distribution.roughness()),
                   r * specular_reflectance + (1.f - r) * specular_transmittance);
}

}  // namespace gib
