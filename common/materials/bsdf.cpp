#include "common/materials/bsdf.h"

#include <algorithm>
#include <array>
#include <utility>

namespace gib {

namespace {

LobeTraits traits_of(const Scattering& model) {
    return std::visit([](const auto& m) { return m.traits(); }, model);
}

/// Carries a direction from the shading frame of the hit into the layer's own frame.
Vec3 to_layer(const Bsdf::Layer& layer, const Vec3& w) {
    if (layer.to_layer) return *layer.to_layer * w;
    return layer.flipped ? Vec3(w.x(), w.y(), -w.z()) : w;
}

Vec3 from_layer(const Bsdf::Layer& layer, const Vec3& w) {
    if (layer.to_layer) return layer.to_layer->transpose() * w;
    return layer.flipped ? Vec3(w.x(), w.y(), -w.z()) : w;
}

/// Values of the layer's model below its coat, for directions in the layer's frame.
LobeValues model_f(const Bsdf::Layer& layer, const Vec3& wo, const Vec3& wi, Transport transport) {
    const auto f = [&](const Vec3& o, const Vec3& i) {
        return std::visit([&](const auto& m) { return m.f_local(o, i, transport); }, layer.model);
    };
    if (!layer.coat) return f(wo, wi);
    const Coat& coat = *layer.coat;
    const Vec3 o = coat.refracted(wo), i = coat.refracted(wi);
    const Color share = coat.transmittance(wo, o) * coat.transmittance(wi, i) / sqr(coat.eta);
    LobeValues values = f(o, i);
    values.diffuse *= share;
    values.specular *= share;
    return values;
}

/// The solid angle inside a coat over that outside: n^2 cos domega is the same on both sides of the surface.
float solid_angle_ratio(const Coat& coat, const Vec3& outside, const Vec3& inside) {
    return inside.z() == 0.f ? 0.f : outside.z() / (sqr(coat.eta) * inside.z());
}

float model_pdf_w(const Bsdf::Layer& layer, const Vec3& wo, const Vec3& wi, Lobes which) {
    const auto pdf_w = [&](const Vec3& o, const Vec3& i) {
        return std::visit([&](const auto& m) { return m.pdf_w_local(o, i, which); }, layer.model);
    };
    if (!layer.coat) return pdf_w(wo, wi);
    const Vec3 i = layer.coat->refracted(wi);
    return pdf_w(layer.coat->refracted(wo), i) * solid_angle_ratio(*layer.coat, wi, i);
}

/// A sample of the layer's model. Below a coat, f and pdf_w are valid for a delta lobe only.
std::optional<BsdfSample> model_sample(const Bsdf::Layer& layer, const Vec3& wo, float u_lobe, const Vec2& u,
                                       Transport transport, Lobes which) {
    const auto sample_of = [&](const Vec3& o) {
        return std::visit([&](const auto& m) { return m.sample_local(o, u_lobe, u, transport, which); }, layer.model);
    };
    if (!layer.coat) return sample_of(wo);
    const Vec3 o = layer.coat->refracted(wo);
    auto sample = sample_of(o);
    if (!sample) return sample;
    const Vec3 i = sample->wi;
    const auto wi = layer.coat->leaving(i);
    if (!wi) return std::nullopt;
    sample->wi = *wi;
    // f of a delta lobe is its weight over the cosine.
    sample->f *= layer.coat->transmittance(wo, o) * layer.coat->transmittance(*wi, i) * (i.z() / wi->z());
    return sample;
}

ScatteringCoefficients model_coefficients(const Bsdf::Layer& layer, const Vec3& wo) {
    const Vec3 o = layer.coat ? layer.coat->refracted(wo) : wo;
    auto c = std::visit([&](const auto& m) { return m.coefficients_local(o); }, layer.model);
    if (!layer.coat) return c;
    const Color share = layer.coat->transmittance(wo, o);
    return {c.diffuse * share, c.specular * share};
}

/// Whether w lies on the same side of the surface's normal as of the layer's tilted one. Only then does it count,
/// because a tilted normal must not let light through the surface.
bool same_side(const Bsdf::Layer& layer, const Vec3& w, const Vec3& w_layer) {
    return !layer.to_layer || w.z() * (layer.flipped ? -w_layer.z() : w_layer.z()) > 0.f;
}

/// The cosine about the layer's normal over that about the shading normal: callers multiply f by the latter, but a
/// tilted layer scatters by the former. For radiance these are the cosines of the light's direction wi. For power the
/// light comes along wo, and the caller's correction for shading normals expects the ratio of that direction (Veach
/// 1997, section 5.3).
float tilted_cosine_ratio(const Bsdf::Layer& layer, Transport transport, const Vec3& wo, const Vec3& wo_layer,
                          const Vec3& wi, const Vec3& wi_layer) {
    if (!layer.to_layer) return 1.f;
    const float ratio = transport == Transport::radiance ? wi_layer.z() / wi.z() : wo_layer.z() / wo.z();
    return std::abs(ratio);
}

/// The weight with which a layer is chosen for light from wo; 0 if the layer scatters nothing from there. A path
/// that carries power does not know its eye yet: the weight then includes the share of eye directions for which
/// the layer exists.
float choice_weight(const Bsdf::Layer& layer, const Vec3& wo, Lobes which, Transport transport) {
    const Vec3 wo_layer = to_layer(layer, wo);
    if (!same_side(layer, wo, wo_layer)) return 0.f;
    if (transport == Transport::radiance && !layer.exists_for(wo)) return 0.f;
    const float share = transport == Transport::radiance ? 1.f : layer.share();
    return share * layer.weight * model_coefficients(layer, wo_layer).of(which).mean();
}

/// Whether light leaves a layer along wi. Power leaves it only towards eyes that see this layer.
bool joins(const Bsdf::Layer& layer, Transport transport, const Vec3& wi, const Vec3& wi_layer) {
    return same_side(layer, wi, wi_layer) && (transport == Transport::radiance || layer.exists_for(wi));
}

/// Power leaves a tilted diffuse layer in proportion to the cosine about the surface's normal. Samples by the layer's
/// own cosine, which vanishes at the layer's horizon, would have unbounded weights there. This share of the samples
/// therefore follows the surface's cosine.
constexpr float untilted_share = 0.5f;

bool samples_untilted(const Bsdf::Layer& layer, Transport transport, Lobes which) {
    return transport == Transport::power && layer.to_layer && which != Lobes::specular &&
           traits_of(layer.model).diffuse;
}

/// The density of the samples of one layer [1/sr].
float layer_pdf_w(const Bsdf::Layer& layer, Transport transport, Lobes which, const Vec3& wo, const Vec3& wo_layer,
                  const Vec3& wi, const Vec3& wi_layer) {
    const float tilted = model_pdf_w(layer, wo_layer, wi_layer, which);
    if (!samples_untilted(layer, transport, which)) return tilted;
    return untilted_share * cosine_hemisphere_pdf(std::copysign(1.f, wo.z()) * wi.z()) +
           (1.f - untilted_share) * tilted;
}

/// Samples a direction, in the shading frame of the hit. For a delta lobe f and the density are valid too, as those
/// of the layer alone.
std::optional<BsdfSample> sample_layer(const Bsdf::Layer& layer, Transport transport, Lobes which, const Vec3& wo,
                                       float u_lobe, const Vec2& u) {
    const bool untilted = samples_untilted(layer, transport, which);
    if (untilted && u_lobe < untilted_share) {
        const Vec3 w = square_to_cosine_hemisphere(u);
        return BsdfSample{.wi = {w.x(), w.y(), std::copysign(w.z(), wo.z())},
                          .f = Color::Zero(),
                          .pdf_w = 0.f,
                          .lobe = LobeKind::diffuse};
    }
    if (untilted) u_lobe = std::min((u_lobe - untilted_share) / (1.f - untilted_share), 1.f - unit_roundoff);
    auto sample = model_sample(layer, to_layer(layer, wo), u_lobe, u, transport, which);
    if (!sample) return sample;
    if (untilted) sample->pdf_w *= 1.f - untilted_share;
    sample->wi = from_layer(layer, sample->wi);
    return sample;
}

/// The share of the light between these directions that the layer's bump and normal maps leave: the shadowing factor,
/// or 0 if the eye sees the other of the two normals.
float perturbed_share(const Bsdf::Layer& layer, Transport transport, const Vec3& wo, const Vec3& wi) {
    if (layer.perturbations.empty()) return 1.f;
    const bool radiance = transport == Transport::radiance;
    return layer.exists_for(radiance ? wo : wi) ? layer.shadowing(radiance ? wi : wo) : 0.f;
}

}  // namespace

Perturbation::Perturbation(const Vec3& base, const Vec3& tilted, Eye eye, bool shadows)
    : base_(base), tilted_(tilted), eye_(eye) {
    const float cosine = base.dot(tilted), sine2 = base.cross(tilted).squaredNorm();
    alpha2_ = !shadows ? 0.f : sine2 < 8.f * sqr(cosine) ? 0.125f * sine2 / sqr(cosine) : 1.f;
}

float Perturbation::share() const {
    if (eye_ == Eye::any) return 1.f;
    const float behind = std::acos(std::clamp(base_.dot(tilted_), -1.f, 1.f)) * inv_pi;
    return eye_ == Eye::in_front ? 1.f - behind : behind;
}

float Perturbation::shadowing(const Vec3& light) const {
    if (alpha2_ == 0.f) return 1.f;
    const float cosine = light.dot(base_), sine2 = base_.cross(light).squaredNorm();
    // The factor 2 / (1 + sqrt(1 + alpha^2 tan^2)), multiplied out by |cos| because tan is infinite at the horizon.
    return 2.f * std::abs(cosine) / (std::abs(cosine) + std::sqrt(sqr(cosine) + alpha2_ * sine2));
}

bool Bsdf::Layer::exists_for(const Vec3& eye) const {
    return std::all_of(perturbations.begin(), perturbations.end(), [&](const auto& p) { return p.exists_for(eye); });
}

float Bsdf::Layer::shadowing(const Vec3& light) const {
    float product = 1.f;
    for (const Perturbation& p : perturbations)
        product *= p.shadowing(light);
    return product;
}

float Bsdf::Layer::share() const {
    float product = 1.f;
    for (const Perturbation& p : perturbations)
        product *= p.share();
    return product;
}

Bsdf::Bsdf(Scattering one_sided) : layers_{{one_sided}} { prepare(); }

Bsdf::Bsdf(Scattering front, Scattering back) : layers_{{front}, {back, 1.f, true}} { prepare(); }

Bsdf::Bsdf(std::vector<Layer> layers, float pass_through) : layers_(std::move(layers)), pass_through_(pass_through) {
    if (pass_through_ >= 1.f) layers_.clear();
    std::erase_if(layers_, [](const Layer& layer) { return !(layer.weight > 0.f); });
    for (Layer& layer : layers_)
        layer.weight /= 1.f - pass_through_;
    prepare();
}

void Bsdf::prepare() {
    traits_of_side_ = {traits_of_side(false), traits_of_side(true)};
    traits_ = traits_of_side_[0];
    traits_ |= traits_of_side_[1];
    mixes_kinds_ = traits_.diffuse && traits_.glossy;
    has_sheets_ = std::any_of(layers_.begin(), layers_.end(),
                              [](const Layer& l) { return std::holds_alternative<ThinDielectric>(l.model); });
    is_tilted_ = std::any_of(layers_.begin(), layers_.end(), [](const Layer& l) { return l.to_layer.has_value(); });
    const auto plain = [](const Layer& layer) { return !layer.to_layer && layer.weight == 1.f && !layer.coat; };
    if (layers_.size() == 1 && plain(layers_[0])) only_ = {0, 0};
    const bool back_to_back = layers_.size() == 2 && plain(layers_[0]) && plain(layers_[1]) && !layers_[0].flipped &&
                              layers_[1].flipped && !traits_.transmission;
    if (back_to_back) only_ = {0, 1};
    for (std::size_t side = 0; side < 2; ++side) {
        if (only_[side] < 0) continue;
        const Layer& layer = layers_[static_cast<std::size_t>(only_[side])];
        if (const auto* diffuse = std::get_if<Diffuse>(&layer.model))
            diffuse_sides_[side] = {*diffuse, true, layer.flipped ? -1.f : 1.f};
    }
}

LobeTraits Bsdf::traits_of_side(bool below) const {
    LobeTraits traits;
    for (const Layer& layer : layers_) {
        const LobeTraits t = traits_of(layer.model);
        if (t.transmission || layer.flipped == below) traits |= t;
    }
    return traits;
}

std::optional<std::array<BsdfSample, 2>> Bsdf::delta_pair_local(const Vec3& wo, Transport transport) const {
    const LobeTraits& lobes = traits_at(wo.z());
    if (!lobes.delta || !lobes.transmission || lobes.diffuse || lobes.glossy) return std::nullopt;
    // The smallest and the largest random number choose these two lobes. If their probabilities add up to 1, there is
    // no third lobe.
    const auto first = sample_local(wo, Vec2(0.f, 0.f), Vec2::Zero(), transport, Lobes::specular);
    const auto last = sample_local(wo, Vec2(1.f - unit_roundoff, 0.f), Vec2::Zero(), transport, Lobes::specular);
    if (!first || !last || !(std::abs(first->pdf_w + last->pdf_w - 1.f) <= 4.f * unit_roundoff)) return std::nullopt;
    return std::array{*first, *last};
}

Color Bsdf::straight_on_with_sheets(const Vec3& wo) const {
    Color sum = Color::Constant(pass_through_);
    for (const Layer& layer : layers_) {
        const auto* sheet = std::get_if<ThinDielectric>(&layer.model);
        const Vec3 o = to_layer(layer, wo);
        if (!sheet || !same_side(layer, wo, o)) continue;
        sum += (1.f - pass_through_) * layer.weight * perturbed_share(layer, Transport::radiance, wo, -wo) *
               sheet->straight_on(o.z());
    }
    return sum;
}

LobeValues Bsdf::layered_f_local(const Vec3& wo, const Vec3& wi, Transport transport) const {
    if (const Layer* only = only_layer(wo.z())) {
        const Vec3 o = to_layer(*only, wo), i = to_layer(*only, wi);
        return std::visit([&](const auto& m) { return m.f_local(o, i, transport); }, only->model);
    }
    return mixture_f_local(wo, wi, transport);
}

LobeValues Bsdf::mixture_f_local(const Vec3& wo, const Vec3& wi, Transport transport) const {
    LobeValues sum;
    if (wo.z() == 0.f || wi.z() == 0.f) return sum;
    for (const Layer& layer : layers_) {
        const Vec3 o = to_layer(layer, wo), i = to_layer(layer, wi);
        if (!same_side(layer, wo, o) || !same_side(layer, wi, i)) continue;
        const float share = layer.weight * perturbed_share(layer, transport, wo, wi);
        if (share == 0.f) continue;
        const LobeValues f = model_f(layer, o, i, transport);
        const float weight = share * tilted_cosine_ratio(layer, transport, wo, o, wi, i);
        sum.diffuse += weight * f.diffuse;
        sum.specular += weight * f.specular;
    }
    return sum;
}

float Bsdf::layered_pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which, Transport transport) const {
    if (const Layer* only = only_layer(wo.z())) {
        const Vec3 o = to_layer(*only, wo), i = to_layer(*only, wi);
        return std::visit([&](const auto& m) { return m.pdf_w_local(o, i, which); }, only->model);
    }
    float sum = 0.f, total = 0.f;
    for (const Layer& layer : layers_) {
        const Vec3 o = to_layer(layer, wo), i = to_layer(layer, wi);
        const float weight = choice_weight(layer, wo, which, transport);
        total += weight;
        if (weight > 0.f && joins(layer, transport, wi, i))
            sum += weight * layer_pdf_w(layer, transport, which, wo, o, wi, i);
    }
    return total > 0.f ? sum / total : 0.f;
}

std::optional<BsdfSample> Bsdf::sample_layered_local(const Vec3& wo, const Vec2& u_lobe, const Vec2& u,
                                                     Transport transport, Lobes which) const {
    const Layer* only = only_layer(wo.z());
    // The only variable that is returned, so that it is made in place: a copy would wait until its members are stored.
    auto sample =
        only ? std::visit(
                   [&](const auto& m) { return m.sample_local(to_layer(*only, wo), u_lobe.x(), u, transport, which); },
                   only->model)
             : sample_mixture_local(wo, u_lobe, u, transport, which);
    if (!only || !sample) return sample;
    if (only->flipped) sample->wi.z() = -sample->wi.z();
    if (mixes_kinds_ && which == Lobes::all && !sample->delta) choose_kind(wo, u_lobe.y(), transport, *sample);
    return sample;
}

std::optional<BsdfSample> Bsdf::sample_mixture_local(const Vec3& wo, const Vec2& u_lobe, const Vec2& u,
                                                     Transport transport, Lobes which) const {
    std::array<float, max_layers> weights;
    float total = 0.f;
    for (std::size_t l = 0; l < layers_.size(); ++l) {
        weights[l] = choice_weight(layers_[l], wo, which, transport);
        total += weights[l];
    }
    if (!(total > 0.f)) return std::nullopt;
    // The number falls into one layer's part of [0, total); its position within this part chooses the lobe
    // inside the layer.
    float rest = u_lobe.x() * total;
    std::size_t chosen = 0;
    for (std::size_t l = 0; l < layers_.size(); ++l) {
        if (weights[l] == 0.f) continue;
        chosen = l;
        if (rest < weights[l]) break;
        rest -= weights[l];
    }
    const Layer& layer = layers_[chosen];
    const float u_layer = std::clamp(rest / weights[chosen], 0.f, 1.f - unit_roundoff);
    auto sample = sample_layer(layer, transport, which, wo, u_layer, u);
    if (!sample) return sample;
    const Vec3 wi = sample->wi, o = to_layer(layer, wo), i = to_layer(layer, wi);
    if (wi.z() == 0.f || !joins(layer, transport, wi, i)) return std::nullopt;
    if (sample->delta) {
        sample->f *= layer.weight * perturbed_share(layer, transport, wo, wi) *
                     tilted_cosine_ratio(layer, transport, wo, o, wi, i);
        sample->pdf_w *= weights[chosen] / total;
        return sample;
    }
    sample->pdf_w = pdf_w_local(wo, wi, which, transport);
    if (!(sample->pdf_w > 0.f)) return std::nullopt;
    if (mixes_kinds_ && which == Lobes::all) choose_kind(wo, u_lobe.y(), transport, *sample);
    else sample->f = f_local(wo, wi, transport).of(which);
    return sample;
}

void Bsdf::choose_kind(const Vec3& wo, float u, Transport transport, BsdfSample& sample) const {
    const LobeValues f = f_local(wo, sample.wi, transport);
    const float sum = f.sum().mean();
    const float diffuse = sum > 0.f ? f.diffuse.mean() / sum : 1.f;
    const bool is_diffuse = u < diffuse;
    sample.lobe = is_diffuse ? LobeKind::diffuse : LobeKind::specular;
    sample.f = is_diffuse ? Color(f.diffuse / diffuse) : Color(f.specular / (1.f - diffuse));
}

ScatteringCoefficients Bsdf::layered_coefficients_local(const Vec3& wo) const {
    ScatteringCoefficients sum;
    for (const Layer& layer : layers_) {
        const Vec3 o = to_layer(layer, wo);
        if (!same_side(layer, wo, o) || !layer.exists_for(wo)) continue;
        const ScatteringCoefficients c = model_coefficients(layer, o);
        sum.diffuse += layer.weight * c.diffuse;
        sum.specular += layer.weight * c.specular;
    }
    return sum;
}

}  // namespace gib
