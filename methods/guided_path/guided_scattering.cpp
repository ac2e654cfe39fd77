#include "methods/guided_path/guided_scattering.h"

namespace gib {

namespace {

/// A direction that the field has chosen, with its density by the field alone; the weight is f |cos|. Where diffuse and
/// glossy lobes reflect in this direction, u_lobe.y() decides which of them the path belongs to, as in Bsdf::sample_local().
std::optional<ScatteredRay> scatter_by_field(const RadianceField::Distribution& known, const SurfaceHit& hit,
                                             const Vec3& wo_local, Vec2 u_lobe, const Vec2& u, Transport transport) {
    const auto chosen = known.sample(u);
    if (!hit.normals_agree_about(chosen.wi)) return std::nullopt;
    const Vec3 wi_local = hit.shading.to_local(chosen.wi);
    const LobeValues f = hit.bsdf->f_local(wo_local, wi_local, transport);
    if (is_black(f.sum())) return std::nullopt;
    const float diffuse = f.diffuse.mean() / f.sum().mean();
    const bool is_diffuse = u_lobe.y() < diffuse;
    const Color value = is_diffuse ? Color(f.diffuse / diffuse) : Color(f.specular / (1.f - diffuse));
    float cosine = std::abs(wi_local.z());
    if (transport == Transport::power && !hit.is_flat()) {  // see scattered_ray.h
        const float arriving = std::abs(hit.shading.to_world(wo_local).dot(hit.ng));
        if (!(arriving > 0.f)) return std::nullopt;
        cosine = std::abs(chosen.wi.dot(hit.ng) * wo_local.z()) / arriving;
    }
    return ScatteredRay{.wi = chosen.wi,
                        .weight = value * cosine,
                        .pdf_w = chosen.pdf_w,
                        .delta = false,
                        .lobe = is_diffuse ? LobeKind::diffuse : LobeKind::specular,
                        .eta = 1.f};  // only roulette reads it, and may take any value
}

}  // namespace

std::optional<MixtureRay> scatter_by_mixture(const RadianceField::Distribution& known, float a, const SurfaceHit& hit,
                                             const Vec3& wo_local, const VertexNumbers& u, Transport transport) {
    Vec2 u_lobe = u.bsdf_lobe();
    const bool from_field = u_lobe.x() < a;
    u_lobe.x() = std::min(from_field ? u_lobe.x() / a : (u_lobe.x() - a) / (1.f - a), 1.f - unit_roundoff);
    const auto ray = from_field ? scatter_by_field(known, hit, wo_local, u_lobe, u.bsdf_direction(), transport)
                                : sample_scattering(hit, wo_local, u_lobe, u.bsdf_direction(), transport);
    if (!ray) return std::nullopt;
    MixtureRay next{*ray, ray->pdf_w, ray->weight.maxCoeff()};
    if (next.delta) {
        next.weight /= 1.f - a;
        return next;
    }
    const float by_field = !(a > 0.f) ? 0.f : from_field ? next.pdf_w : known.pdf_w(next.wi);
    if (from_field) next.pdf_w = hit.bsdf->pdf_w_local(wo_local, hit.shading.to_local(next.wi), Lobes::all, transport);
    else next.weight *= next.pdf_w;
    next.unguided = next.weight.maxCoeff() / next.pdf_w;
    next.mixture_pdf_w = a * by_field + (1.f - a) * next.pdf_w;
    next.weight /= next.mixture_pdf_w;
    return next;
}

MixtureDirection scatter_by_mixture(const RadianceField::Distribution& known, float a, const PhaseFunction& phase,
                                    const Vec3& wo, const VertexNumbers& u) {
    RadianceField::Distribution::Sample chosen{};
    if (u.bsdf_lobe().x() < a) {
        chosen = known.sample(u.bsdf_direction());
    } else {
        chosen.wi = phase.sample(wo, u.bsdf_direction());
        chosen.pdf_w = a > 0.f ? known.pdf_w(chosen.wi) : 0.f;
    }
    const float by_phase = phase.value(wo, chosen.wi);
    return {chosen.wi, by_phase, a * chosen.pdf_w + (1.f - a) * by_phase};
}

}  // namespace gib
