#include "common/bsdf.h"

#include "common/warp.h"

namespace gib {

Color Diffuse::f_local(const Vec3& wo, const Vec3& wi) const {
    if (wo.z() <= 0.f || wi.z() <= 0.f) return Color::Zero();
    return reflectance * inv_pi;
}

float Diffuse::pdf_w_local(const Vec3& wo, const Vec3& wi) const {
    return wo.z() <= 0.f ? 0.f : cosine_hemisphere_pdf(wi.z());
}

std::optional<BsdfSample> Diffuse::sample_local(const Vec3& wo, float, const Vec2& u, Transport) const {
    if (wo.z() <= 0.f || is_black(reflectance)) return std::nullopt;
    const Vec3 wi = square_to_cosine_hemisphere(u);
    return BsdfSample{wi, reflectance * inv_pi, cosine_hemisphere_pdf(wi.z()), false, LobeKind::diffuse, 1.f};
}

std::optional<BsdfSample> Dielectric::sample_local(const Vec3& wo, float u_lobe, const Vec2&,
                                                   Transport transport) const {
    const DielectricFresnel fresnel = fresnel_dielectric(wo.z(), eta);
    const float r = fresnel.reflectance;
    if (u_lobe < r) {
        const float cos_i = std::abs(wo.z());
        if (cos_i == 0.f) return std::nullopt;
        return BsdfSample{
            Vec3(-wo.x(), -wo.y(), wo.z()), specular_reflectance * (r / cos_i), r, true, LobeKind::specular, 1.f};
    }
    const float cos_t = std::abs(fresnel.cos_t);
    if (cos_t == 0.f || r >= 1.f) return std::nullopt;
    // The delta lobe divides by the cosine of the TRANSMITTED ray. Seen from the eye, the radiance that comes from the
    // side wi is scaled by (eta_o / eta_i)^2; power is not.
    const float scale = transport == Transport::radiance ? 1.f / sqr(fresnel.eta_ti) : 1.f;
    const Vec3 wi(-wo.x() / fresnel.eta_ti, -wo.y() / fresnel.eta_ti, fresnel.cos_t);
    return BsdfSample{
        wi, specular_transmittance * ((1.f - r) * scale / cos_t), 1.f - r, true, LobeKind::specular, fresnel.eta_ti};
}

Color Conductor::reflectance(float cos_theta) const {
    return index ? Color(specular_reflectance * fresnel_conductor(cos_theta, index->eta, index->k))
                 : specular_reflectance;
}

std::optional<BsdfSample> Conductor::sample_local(const Vec3& wo, float, const Vec2&, Transport) const {
    if (wo.z() <= 0.f) return std::nullopt;
    return BsdfSample{Vec3(-wo.x(), -wo.y(), wo.z()), reflectance(wo.z()) / wo.z(), 1.f, true, LobeKind::specular, 1.f};
}

namespace {
void flip_z(Vec3& w) { w.z() = -w.z(); }
}  // namespace

Color Bsdf::f_local(Vec3 wo, Vec3 wi) const {
    const Scattering* s = side(wo.z());
    if (s != &front_) {
        flip_z(wo);
        flip_z(wi);
    }
    const auto* diffuse = std::get_if<Diffuse>(s);
    return diffuse ? diffuse->f_local(wo, wi) : Color(Color::Zero());
}

float Bsdf::pdf_w_local(Vec3 wo, Vec3 wi) const {
    const Scattering* s = side(wo.z());
    if (s != &front_) {
        flip_z(wo);
        flip_z(wi);
    }
    const auto* diffuse = std::get_if<Diffuse>(s);
    return diffuse ? diffuse->pdf_w_local(wo, wi) : 0.f;
}

std::optional<BsdfSample> Bsdf::sample_local(Vec3 wo, float u_lobe, const Vec2& u, Transport transport) const {
    const Scattering* s = side(wo.z());
    const bool flipped = s != &front_;
    if (flipped) flip_z(wo);
    auto sample = std::visit([&](const auto& model) { return model.sample_local(wo, u_lobe, u, transport); }, *s);
    if (sample && flipped) flip_z(sample->wi);
    return sample;
}

ScatteringCoefficients Bsdf::coefficients_local(Vec3 wo) const {
    const Scattering* s = side(wo.z());
    if (s != &front_) flip_z(wo);
    ScatteringCoefficients c;
    if (const auto* diffuse = std::get_if<Diffuse>(s)) {
        if (wo.z() > 0.f) c.diffuse = diffuse->reflectance;
    } else if (const auto* conductor = std::get_if<Conductor>(s)) {
        if (wo.z() > 0.f) c.specular = conductor->reflectance(wo.z());
    } else {
        const auto& dielectric = std::get<Dielectric>(*s);
        const float r = fresnel_dielectric(wo.z(), dielectric.eta).reflectance;
        c.specular = r * dielectric.specular_reflectance + (1.f - r) * dielectric.specular_transmittance;
    }
    return c;
}

bool Bsdf::reflects() const {
    return any([](const Scattering& s) {
        if (const auto* diffuse = std::get_if<Diffuse>(&s)) return !is_black(diffuse->reflectance);
        if (const auto* conductor = std::get_if<Conductor>(&s)) return !is_black(conductor->specular_reflectance);
        const auto& dielectric = std::get<Dielectric>(s);
        return !is_black(dielectric.specular_reflectance) || !is_black(dielectric.specular_transmittance);
    });
}

}  // namespace gib
