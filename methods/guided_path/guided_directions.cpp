#include "methods/guided_path/guided_directions.h"

#include "methods/parts/transport/light_sample.h"

#include <cmath>

namespace gib {

/// The power heuristic, against the density with which paths go on towards the light.
float GuidedDirections::weight_of(const LightSample& light, float by_lobes) const {
    if (light.delta) return 1.f;
    const float a = known_->selection();
    return power_heuristic(light.pdf_w, a > 0.f ? a * known_->pdf_w(light.wi) + (1.f - a) * by_lobes : by_lobes);
}

LobeValues GuidedDirections::direct_light(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local,
                                          const VertexNumbers& u) {
    const auto weight = [&](const LightSample& light, auto by_lobes) { return weight_of(light, by_lobes()); };
    return sampled_for_surface(walk.rays, hit, wo_local, u, walk.at.medium, walk.flights, weight, Lobes::all);
}

Color GuidedDirections::direct_light(PathWalk& walk, const Vec3& p, const VertexNumbers& u) {
    const auto weight = [&](const LightSample& light, auto by_lobes) { return weight_of(light, by_lobes()); };
    return sampled_for_medium(walk.rays, p, walk.wo(), u, *walk.at.medium, walk.flights, weight);
}

/// A direction that the field has chosen, with its density by the field alone; the weight is f |cos|. Where diffuse and
/// glossy lobes reflect in this direction, u_lobe.y() decides which of them the path belongs to, as in Bsdf::sample_local().
std::optional<ScatteredRay> GuidedDirections::scatter_by_field(const SurfaceHit& hit, const Vec3& wo_local, Vec2 u_lobe,
                                                               const Vec2& u) const {
    const auto chosen = known_->sample(u);
    if (!hit.normals_agree_about(chosen.wi)) return std::nullopt;
    const Vec3 wi_local = hit.shading.to_local(chosen.wi);
    const LobeValues f = hit.bsdf->f_local(wo_local, wi_local);
    if (is_black(f.sum())) return std::nullopt;
    const float diffuse = f.diffuse.mean() / f.sum().mean();
    const bool is_diffuse = u_lobe.y() < diffuse;
    const Color value = is_diffuse ? Color(f.diffuse / diffuse) : Color(f.specular / (1.f - diffuse));
    return ScatteredRay{.wi = chosen.wi,
                        .weight = value * std::abs(wi_local.z()),
                        .pdf_w = chosen.pdf_w,
                        .delta = false,
                        .lobe = is_diffuse ? LobeKind::diffuse : LobeKind::specular,
                        .eta = 1.f};  // only roulette reads it, and may take any value
}

std::optional<ScatteredRay> GuidedDirections::scatter(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local,
                                                      const VertexNumbers& u, bool sees_lights) {
    const LobeTraits& lobes = hit.bsdf->traits_at(wo_local.z());
    const bool has_choice = !hit.delta_only && (lobes.diffuse || lobes.glossy);
    const float a = has_choice ? known_->selection() : 0.f;
    Vec2 u_lobe = u.bsdf_lobe();
    const bool by_field = u_lobe.x() < a;
    u_lobe.x() = std::min(by_field ? u_lobe.x() / a : (u_lobe.x() - a) / (1.f - a), 1.f - unit_roundoff);
    auto next = by_field ? scatter_by_field(hit, wo_local, u_lobe, u.bsdf_direction())
                         : sample_scattering(hit, wo_local, u_lobe, u.bsdf_direction(), Transport::radiance);
    if (!next) return next;

    FollowedDirection followed;
    followed.p = here_;
    followed.wi = next->wi;
    followed.by_lobes = next->pdf_w;
    followed.delta = next->delta;
    float unguided = 1.f;  // f |cos| over the density of the lobes, which roulette takes for the albedo
    if (next->delta) {
        unguided = next->weight.maxCoeff();
        next->weight /= 1.f - a;
        if (a > 0.f) followed.by_field = 0.f;
    } else {
        if (by_field) {
            followed.by_field = next->pdf_w;
            followed.by_lobes = hit.bsdf->pdf_w_local(wo_local, hit.shading.to_local(next->wi));
        } else {
            next->weight *= next->pdf_w;
            if (a > 0.f) followed.by_field = known_->pdf_w(next->wi);
        }
        unguided = std::min(next->weight.maxCoeff() / followed.by_lobes, 1.f);
        next->pdf_w = a > 0.f ? a * followed.by_field + (1.f - a) * followed.by_lobes : followed.by_lobes;
        next->weight /= next->pdf_w;
    }
    if (is_black(next->weight)) return std::nullopt;
    followed.pdf_w = next->pdf_w;
    const Color before = walk.at.beta;
    walk.take(*next, sees_lights);
    if (has_choice) follow(walk, before, followed, unguided / next->weight.maxCoeff());
    return next;
}

std::optional<Vec3> GuidedDirections::scatter_in_medium(PathWalk& walk, const VertexNumbers& u, bool sees_lights) {
    const PhaseFunction& phase = walk.at.medium->phase();
    const float a = known_->selection();
    const bool by_field = u.bsdf_lobe().x() < a;
    FollowedDirection followed;
    followed.p = here_;
    if (by_field) {
        const auto chosen = known_->sample(u.bsdf_direction());
        followed.wi = chosen.wi;
        followed.by_field = chosen.pdf_w;
    } else {
        followed.wi = phase.sample(walk.wo(), u.bsdf_direction());
        if (a > 0.f) followed.by_field = known_->pdf_w(followed.wi);
    }
    followed.by_lobes = phase.value(walk.wo(), followed.wi);
    followed.pdf_w = a > 0.f ? a * followed.by_field + (1.f - a) * followed.by_lobes : followed.by_lobes;
    const Color before = walk.at.beta;
    const float weight = followed.by_lobes / followed.pdf_w;
    walk.at.beta *= weight;
    walk.at.pdf_w = sees_lights ? followed.pdf_w : infinity;
    follow(walk, before, followed, 1.f / weight);
    return followed.wi;
}

/// `unguided` is the weight that the step would have had by the lobes alone, over its weight.
void GuidedDirections::follow(const PathWalk& walk, const Color& before, const FollowedDirection& followed,
                              float unguided) {
    steered_ /= double{unguided};
    vertices_.push_back({followed, before, walk.at.beta, found_});
}

/// Roulette by the throughput would end the paths that the field sends where light is: their throughput is low because the
/// field chose them often. So paths survive as if the bsdf alone had chosen their directions.
bool GuidedDirections::survives(PathWalk& walk, float most, float u, Color& lost) {
    Color& beta = walk.at.beta;
    if (!beta.isFinite().all()) {
        lost += beta;
        return false;
    }
    const double unguided = double{beta.maxCoeff()} / steered_;
    const auto q = static_cast<float>(std::min(unguided * double{walk.at.eta_scale}, double{most}));
    return gib::survives(beta, q, u);
}

void GuidedDirections::tell(RadianceField& field, const Sampler& sampler) {
    constexpr std::uint64_t tag = 0x6775696465;  // of the numbers that blur the field
    const Sampler numbers = sampler.split(0, 1, tag);
    const auto ratio = [](const Colord& light, const Color& throughput) -> float {
        const Color all = (light / throughput.cast<double>()).cast<float>();
        return luminance((throughput > 0.f).select(all, Color::Zero()));
    };
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
        Vertex& vertex = vertices_[i];
        const Colord light = found_ - vertex.found;
        vertex.followed.radiance = ratio(light, vertex.after);
        vertex.followed.reflected = ratio(light, vertex.before);
        if (std::isfinite(vertex.followed.radiance) && std::isfinite(vertex.followed.reflected))
            field.record(vertex.followed, numbers.at_vertex(static_cast<int>(i)));
    }
    forget();
}

}  // namespace gib
