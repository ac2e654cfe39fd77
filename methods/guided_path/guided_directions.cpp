#include "methods/guided_path/guided_directions.h"

#include <cmath>

namespace gib {

std::optional<ScatteredRay> GuidedDirections::scatter(PathWalk& walk, const SurfaceHit& hit, const Vec3& wo_local,
                                                      const VertexNumbers& u, bool sees_lights) {
    const LobeTraits& lobes = hit.bsdf->traits_at(wo_local.z());
    const bool has_choice = !hit.delta_only && (lobes.diffuse || lobes.glossy);
    has_left_ = false;
    expected_ = 0.f;
    if (has_choice) stand(walk);
    const float a =
        lobes.diffuse && has_choice ? selection(walk) : 0.f;  // glossy lobes are narrower than the field knows
    auto next = scatter_by_mixture(*known_, a, hit, wo_local, u, Transport::radiance);
    if (!next) return std::nullopt;
    unguided_ = std::min(next->unguided, 1.f);
    if (is_black(next->weight)) return std::nullopt;
    // Emission is weighed against light sampling by the density of the lobes alone: any weights that add up to 1 are right, and
    // light sampling need not look the field up.
    walk.take(*next, sees_lights);
    if (has_choice && !next->delta) leave(walk, next->wi, next->mixture_pdf_w);
    return next;
}

std::optional<Vec3> GuidedDirections::scatter_in_medium(PathWalk& walk, const VertexNumbers& u, bool sees_lights) {
    const PhaseFunction& phase = walk.at.medium->phase();
    stand(walk);
    const float a = 0.5f * selection(walk);  // a path through mist has many bounces
    const auto [wi, by_phase, pdf_w] = scatter_by_mixture(*known_, a, phase, walk.wo(), u);
    unguided_ = 1.f;
    walk.at.beta *= by_phase / pdf_w;
    walk.at.pdf_w = sees_lights ? by_phase : infinity;
    leave(walk, wi, pdf_w);
    return wi;
}

/// The probability to follow the field. A direction of the bsdf that the field leaves out weighs 1 / (1 - a). Such weights must
/// not multiply over the bounces of a long path, so a path that weighs much follows the bsdf alone.
float GuidedDirections::selection(const PathWalk& walk) const {
    constexpr float heavy = 2.f;
    return walk.at.beta.maxCoeff() > heavy ? 0.f : known_->selection();
}

/// The path is about to choose a direction.
void GuidedDirections::stand(const PathWalk& walk) {
    const Color& beta = walk.at.beta;
    vertices_.push_back({place_, known_->reflected(), beta, beta, found_on_arrival_, found_});
    expected_ = luminance(beta) * known_->indirect();
    if (at_first_ == 0.f) at_first_ = expected_;
}

void GuidedDirections::leave(const PathWalk& walk, const Vec3& wi, float pdf_w) {
    has_left_ = true;
    vertices_.back().wi = wi;
    vertices_.back().pdf_w = pdf_w;
    vertices_.back().after = walk.at.beta;
}

/// Roulette by the throughput would end the paths that the field sends where light is: their throughput is low because the
/// field chose them often. So paths survive in proportion to the light that is left to find (Vorba and Krivanek 2016,
/// "Adjoint-Driven Russian Roulette and Splitting in Light Transport Simulation"), or, where the field does not know it, as if
/// the bsdf alone had chosen their directions.
bool GuidedDirections::survives(PathWalk& walk, float most, float u, Color& lost) {
    constexpr float least = 0.1f;  // what the field expects may be wrong
    Color& beta = walk.at.beta;
    if (!beta.isFinite().all()) {
        lost += beta;
        return false;
    }
    const float expected = expected_ > 0.f ? std::max(expected_ / at_first_, least) : unguided_;
    const bool goes_on = gib::survives(beta, std::min(expected * walk.at.eta_scale, most), u);
    if (has_left_ && goes_on) vertices_.back().after = beta;
    else if (has_left_) vertices_.back().pdf_w.reset();
    return goes_on;
}

/// The light behind a vertex is what the path has found before it came to the next one, and what that place reflects: as the
/// field knows it, which varies far less than what this path has found there (Dahm and Keller 2017, "Learning Light Transport
/// the Reinforced Way"), or as the path has found it while the field does not know it. Values that are not finite count as 0: the
/// field is less right then, and no image is biased by that.
void GuidedDirections::tell(RadianceField& field, const Sampler& sampler) const {
    constexpr std::uint64_t tag = 0x6775696465;  // of the numbers that blur the field
    const Sampler numbers = sampler.split(0, 1, tag);
    const auto ratio = [](const Colord& light, const Color& throughput) -> double {
        const Color all = (light / throughput.cast<double>()).cast<float>();
        const double value = luminance((throughput > 0.f).select(all, Color::Zero()));
        return std::isfinite(value) ? std::max(value, 0.) : 0.;
    };
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
        const Vertex& v = vertices_[i];
        field.visit(v.place, ratio(found_ - v.found_on_arrival, v.before), ratio(found_ - v.found, v.before));
        if (!v.pdf_w) continue;
        const Vertex* next = i + 1 < vertices_.size() ? &vertices_[i + 1] : nullptr;
        const double radiance = next && next->reflected > 0.f
                                    ? ratio(next->found_on_arrival - v.found, v.after) +
                                          ratio(next->before.cast<double>(), v.after) * double{next->reflected}
                                    : ratio(found_ - v.found, v.after);
        const double cosine = v.place.normal.isZero() ? 1 : std::abs(double{v.place.normal.dot(v.wi)});
        field.record(v.place, v.wi, radiance * cosine / double{*v.pdf_w}, numbers.at_vertex(static_cast<int>(i)));
    }
}

}  // namespace gib
