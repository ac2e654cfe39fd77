#include "common/materials/principled_thin.h"

#include "common/materials/burley.h"
#include "common/materials/fresnel.h"
#include "common/sampling/warp.h"

#include <algorithm>

namespace gib {

namespace {

/// Mirrors w in the sheet if `flip` is true.
Vec3 turned(const Vec3& w, bool flip) { return flip ? Vec3(w.x(), w.y(), -w.z()) : w; }

}  // namespace

/// The estimated shares of the light that the lobes scatter, or the probabilities of choosing them.
struct PrincipledThin::Shares {
    Color diffuse = Color::Zero(), diffuse_through = Color::Zero(), main = Color::Zero(), main_through = Color::Zero();
};

MicrofacetDistribution PrincipledThin::distribution(bool through) const {
    return burley::facets(through ? (0.65f * eta - 0.35f) * roughness : roughness, anisotropic);
}

Color PrincipledThin::sheen_color() const {
    return (1.f - spec_trans) * (1.f - 0.5f * diff_trans) * sheen *
           (1.f + sheen_tint * (burley::tint_of(base_color) - 1.f));
}

Color PrincipledThin::reflectance(float cos_d) const {
    Color f = Color::Constant((1.f - spec_tint) * fresnel_dielectric(cos_d, eta).reflectance);
    if (spec_tint > 0.f)
        f += spec_tint * burley::schlick(burley::tint_of(base_color) * sqr((eta - 1.f) / (eta + 1.f)),
                                         burley::schlick_weight(cos_d, eta));
    return spec_trans * f;
}

Color PrincipledThin::transmittance(float cos_d) const {
    return spec_trans * (1.f - fresnel_dielectric(cos_d, eta).reflectance) * base_color;
}

LobeTraits PrincipledThin::traits() const {
    LobeTraits t;
    t.diffuse = spec_trans < 1.f && (!is_black(base_color) || (sheen > 0.f && diff_trans < 2.f));
    if (spec_trans > 0.f) {
        for (const bool through : {false, true}) {
            const MicrofacetDistribution facets = distribution(through);
            t.anisotropic |= facets.alpha_u != facets.alpha_v;
            (main_kind(through) == LobeKind::diffuse ? t.diffuse : t.glossy) = true;
        }
    }
    if (!t.scatters()) return {};
    t.rough = true;
    t.transmission = true;  // the model scatters on both sides, even if nothing is transmitted
    return t;
}

LobeValues PrincipledThin::f_local(const Vec3& wo, const Vec3& wi, Transport) const {
    LobeValues f;
    if (wo.z() == 0.f || wi.z() == 0.f) return f;
    const bool through = (wo.z() < 0.f) != (wi.z() < 0.f);
    const Vec3 o = turned(wo, wo.z() < 0.f), i = turned(wi, wi.z() < 0.f);
    const Facet facet = reflecting_facet(o, i);
    if (spec_trans > 0.f) {
        const MicrofacetDistribution facets = distribution(through);
        const float per_share = facets.density(facet.m) * facet.jacobian / facets.visible_area(o);
        const Color share = through ? transmittance(facet.cos_o) : reflectance(facet.cos_o);
        f.add(main_kind(through), share * (per_share / facets.visible_area(i)));
    }
    const float transmitted = 0.5f * diff_trans;
    if (through) {
        f.diffuse += base_color * ((1.f - spec_trans) * transmitted * inv_pi);
        return f;
    }
    const float diffuse = burley::diffuse(roughness, flatness, o.z(), i.z(), facet.cos_o);
    f.diffuse += base_color * ((1.f - spec_trans) * (1.f - transmitted) * inv_pi * diffuse);
    if (sheen > 0.f) f.diffuse += burley::schlick_weight(facet.cos_o) * sheen_color();
    return f;
}

/// The reflectance of the facets lies between that at this angle and that at 60 degrees, where tilted facets may
/// reflect totally. A floor keeps both lobes sampled.
PrincipledThin::Shares PrincipledThin::shares(float cos_o) const {
    const float cosine = std::min(std::abs(cos_o), 0.98f), transmitted = 0.5f * diff_trans;
    Shares s;
    s.diffuse = (1.f - spec_trans) * (1.f - transmitted) * base_color;
    // The mean of Schlick's weight of d over wi in the hemisphere is between 0.02 and 0.2.
    s.diffuse += pi * burley::lerp(0.02f, 0.2f, burley::schlick_weight(cosine)) * sheen_color();
    s.diffuse_through = (1.f - spec_trans) * transmitted * base_color;
    if (!(spec_trans > 0.f)) return s;
    constexpr float tilted = 0.5f;
    const float least = 0.1f * spec_trans;
    s.main = (0.5f * (reflectance(cosine) + reflectance(tilted))).max(least);
    s.main_through = (0.5f * (transmittance(cosine) + transmittance(tilted))).max(least * base_color);
    return s;
}

PrincipledThin::Shares PrincipledThin::choice(float cos_o, Lobes which) const {
    if (cos_o == 0.f) return {};
    Shares s = shares(cos_o);
    if (!includes(which, LobeKind::diffuse)) s.diffuse = s.diffuse_through = Color::Zero();
    if (!includes(which, main_kind(false))) s.main = Color::Zero();
    if (!includes(which, main_kind(true))) s.main_through = Color::Zero();
    const float total = (s.diffuse + s.diffuse_through + s.main + s.main_through).mean();
    if (!(total > 0.f)) return {};
    for (Color* share : {&s.diffuse, &s.diffuse_through, &s.main, &s.main_through})
        *share = Color::Constant(share->mean() / total);
    return s;
}

float PrincipledThin::pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const {
    if (wo.z() == 0.f || wi.z() == 0.f) return 0.f;
    const bool through = (wo.z() < 0.f) != (wi.z() < 0.f);
    const Vec3 o = turned(wo, wo.z() < 0.f), i = turned(wi, wi.z() < 0.f);
    const Shares c = choice(wo.z(), which);
    float pdf_w = (through ? c.diffuse_through : c.diffuse)[0] * cosine_hemisphere_pdf(i.z());
    const float main = (through ? c.main_through : c.main)[0];
    if (!(main > 0.f)) return pdf_w;
    const Facet facet = reflecting_facet(o, i);
    const MicrofacetDistribution facets = distribution(through);
    return pdf_w += main * facets.density(facet.m) * facet.jacobian / facets.visible_area(o);
}

std::optional<BsdfSample> PrincipledThin::sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport transport,
                                                       Lobes which) const {
    const bool below = wo.z() < 0.f;
    const Shares c = choice(wo.z(), which);
    const float diffuse = c.diffuse[0] + c.diffuse_through[0], main = c.main[0] + c.main_through[0];
    if (!(diffuse + main > 0.f)) return std::nullopt;
    const bool is_diffuse = u_lobe < diffuse || !(main > 0.f);
    const bool through = is_diffuse ? u_lobe >= c.diffuse[0] && c.diffuse_through[0] > 0.f
                                    : u_lobe - diffuse >= c.main[0] && c.main_through[0] > 0.f;
    Vec3 i;
    if (is_diffuse) {
        i = square_to_cosine_hemisphere(u);
    } else {
        const Vec3 o = turned(wo, below), m = distribution(through).sample_visible(o, u);
        const float cos_o = o.dot(m);
        if (!(cos_o > 0.f)) return std::nullopt;
        i = reflected(o, m, cos_o);
        if (!(i.z() > 0.f)) return std::nullopt;
    }
    const Vec3 wi = turned(i, below != through);
    const float pdf_w = pdf_w_local(wo, wi, which);
    if (!(pdf_w > 0.f)) return std::nullopt;
    return BsdfSample{.wi = wi,
                      .f = f_local(wo, wi, transport).of(which),
                      .pdf_w = pdf_w,
                      .lobe = is_diffuse ? LobeKind::diffuse : main_kind(through)};
}

ScatteringCoefficients PrincipledThin::coefficients_local(const Vec3& wo) const {
    ScatteringCoefficients c;
    if (wo.z() == 0.f) return c;
    const Shares s = shares(wo.z());
    c.diffuse = s.diffuse + s.diffuse_through;
    (main_kind(false) == LobeKind::diffuse ? c.diffuse : c.specular) += s.main;
    (main_kind(true) == LobeKind::diffuse ? c.diffuse : c.specular) += s.main_through;
    return burley::at_most_one(c);
}

}  // namespace gib
