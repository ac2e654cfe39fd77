#include "common/materials/smooth_scattering.h"

#include "common/materials/fresnel.h"

namespace gib {

namespace {

/// A delta lobe that takes `weight` of the light and is chosen with `probability`.
/// Made in place, member by member: the copy of a whole sample would wait until its members are stored.
std::optional<BsdfSample> delta_sample(const Vec3& wi, const Color& weight, float probability, float eta) {
    std::optional<BsdfSample> sample(std::in_place);
    sample->wi = wi;
    sample->f = weight / std::abs(wi.z());
    sample->pdf_w = probability;
    sample->delta = true;
    sample->lobe = LobeKind::specular;
    sample->eta = eta;
    return sample;
}

bool transmits_nothing(const Color& reflectance, const Color& transmittance) {
    return is_black(reflectance) && is_black(transmittance);
}

}  // namespace

LobeTraits Dielectric::traits() const {
    LobeTraits t;
    t.delta = !transmits_nothing(specular_reflectance, specular_transmittance);
    t.transmission = true;
    t.refraction = eta != 1.f && !is_black(specular_transmittance);
    return t;
}

std::optional<BsdfSample> Dielectric::sample_local(const Vec3& wo, float u_lobe, const Vec2&, Transport transport,
                                                   Lobes which) const {
    if (which == Lobes::diffuse) return std::nullopt;
    const DielectricFresnel fresnel = fresnel_dielectric(wo.z(), eta);
    const float r = fresnel.reflectance;
    if (u_lobe < r) {
        if (wo.z() == 0.f) return std::nullopt;
        return delta_sample(mirrored(wo), specular_reflectance * r, r, 1.f);
    }
    if (fresnel.cos_t == 0.f || r >= 1.f) return std::nullopt;
    // The delta lobe divides by the cosine of the TRANSMITTED ray. Seen from the eye, the radiance from the side of
    // wi is scaled by (eta_o / eta_i)^2; power is not.
    const float scale = transport == Transport::radiance ? 1.f / sqr(fresnel.eta_ti) : 1.f;
    const Vec3 wi(-wo.x() / fresnel.eta_ti, -wo.y() / fresnel.eta_ti, fresnel.cos_t);
    return delta_sample(wi, specular_transmittance * ((1.f - r) * scale), 1.f - r, fresnel.eta_ti);
}

ScatteringCoefficients Dielectric::coefficients_local(const Vec3& wo) const {
    const float r = fresnel_dielectric(wo.z(), eta).reflectance;
    return {.specular = r * specular_reflectance + (1.f - r) * specular_transmittance};
}

LobeTraits ThinDielectric::traits() const {
    LobeTraits t;
    t.delta = !is_black(specular_reflectance);
    t.transmission = true;
    return t;
}

float ThinDielectric::reflectance(float cos_theta) const {
    const float r = fresnel_dielectric(std::abs(cos_theta), eta).reflectance;
    return r < 1.f ? 2.f * r / (1.f + r) : 1.f;
}

std::optional<BsdfSample> ThinDielectric::sample_local(const Vec3& wo, float, const Vec2&, Transport,
                                                       Lobes which) const {
    if (which == Lobes::diffuse || wo.z() == 0.f) return std::nullopt;
    return delta_sample(mirrored(wo), specular_reflectance * reflectance(wo.z()), 1.f, 1.f);
}

ScatteringCoefficients ThinDielectric::coefficients_local(const Vec3& wo) const {
    return {.specular = reflectance(wo.z()) * specular_reflectance};
}

LobeTraits Conductor::traits() const { return {.delta = !is_black(specular_reflectance)}; }

Color Conductor::reflectance(float cos_theta) const {
    return index ? Color(specular_reflectance * fresnel_conductor(cos_theta, index->eta, index->k))
                 : specular_reflectance;
}

std::optional<BsdfSample> Conductor::sample_local(const Vec3& wo, float, const Vec2&, Transport, Lobes which) const {
    if (which == Lobes::diffuse || wo.z() <= 0.f) return std::nullopt;
    return delta_sample(mirrored(wo), reflectance(wo.z()), 1.f, 1.f);
}

ScatteringCoefficients Conductor::coefficients_local(const Vec3& wo) const {
    ScatteringCoefficients c;
    if (wo.z() > 0.f) c.specular = reflectance(wo.z());
    return c;
}

}  // namespace gib
