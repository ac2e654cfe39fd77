#include "common/bsdf.h"

#include <algorithm>
#include <array>
#include <utility>

namespace gib {

namespace {

LobeTraits traits_of(const Scattering& model) {
    return std::visit([](const auto& m) { return m.traits(); }, model);
}

/// Into the layer's own frame.
Vec3 to_layer(const Bsdf::Layer& layer, const Vec3& w) {
    if (layer.to_layer) return *layer.to_layer * w;
    return layer.flipped ? Vec3(w.x(), w.y(), -w.z()) : w;
}

Vec3 from_layer(const Bsdf::Layer& layer, const Vec3& w) {
    if (layer.to_layer) return layer.to_layer->transpose() * w;
    return layer.flipped ? Vec3(w.x(), w.y(), -w.z()) : w;
}

/// A tilted normal must not let light through the surface: a direction counts only if it lies on the same side of both.
bool same_side(const Bsdf::Layer& layer, const Vec3& w, const Vec3& w_layer) {
    return !layer.to_layer || w.z() * (layer.flipped ? -w_layer.z() : w_layer.z()) > 0.f;
}

/// The caller multiplies by the cosine of the shading frame; a tilted layer has its own. For radiance it is that of the light's
/// direction wi; for power the light comes along wo, and the caller's correction for shading normals expects the same
/// ratio there (Veach 1997, section 5.3).
float tilted_cosine_ratio(const Bsdf::Layer& layer, Transport transport, const Vec3& wo, const Vec3& wo_layer,
                          const Vec3& wi, const Vec3& wi_layer) {
    if (!layer.to_layer || injected(Fault::tilted_cosine)) return 1.f;
    const float ratio = transport == Transport::radiance ? wi_layer.z() / wi.z() : wo_layer.z() / wo.z();
    return std::abs(ratio);
}

float choice_weight(const Bsdf::Layer& layer, const Vec3& wo_layer, Lobes which) {
    return layer.weight *
           std::visit([&](const auto& m) { return m.coefficients_local(wo_layer).of(which).mean(); }, layer.model);
}

}  // namespace

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
    const auto plain = [](const Layer& layer) { return !layer.to_layer && layer.weight == 1.f; };
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

bool Bsdf::two_sided() const {
    return std::any_of(layers_.begin(), layers_.end(), [](const Layer& l) { return l.flipped; });
}

LobeTraits Bsdf::traits_of_side(bool below) const {
    LobeTraits traits;
    for (const Layer& layer : layers_) {
        const LobeTraits t = traits_of(layer.model);
        if (t.transmission || layer.flipped == below) traits |= t;
    }
    return traits;
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
        const LobeValues f = std::visit([&](const auto& m) { return m.f_local(o, i, transport); }, layer.model);
        const float weight = layer.weight * tilted_cosine_ratio(layer, transport, wo, o, wi, i);
        sum.diffuse += weight * f.diffuse;
        sum.specular += weight * f.specular;
    }
    return sum;
}

float Bsdf::layered_pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which) const {
    if (const Layer* only = only_layer(wo.z())) {
        const Vec3 o = to_layer(*only, wo), i = to_layer(*only, wi);
        return std::visit([&](const auto& m) { return m.pdf_w_local(o, i, which); }, only->model);
    }
    float sum = 0.f, total = 0.f;
    for (const Layer& layer : layers_) {
        const Vec3 o = to_layer(layer, wo), i = to_layer(layer, wi);
        if (!same_side(layer, wo, o)) continue;
        const float weight = choice_weight(layer, o, which);
        total += weight;
        if (weight > 0.f && same_side(layer, wi, i))
            sum += weight * std::visit([&](const auto& m) { return m.pdf_w_local(o, i, which); }, layer.model);
    }
    return total > 0.f ? sum / total : 0.f;
}

std::optional<BsdfSample> Bsdf::sample_layered_local(const Vec3& wo, const Vec2& u_lobe, const Vec2& u,
                                                     Transport transport, Lobes which) const {
    const Layer* only = only_layer(wo.z());
    if (!only) return sample_mixture_local(wo, u_lobe, u, transport, which);
    auto sample =
        std::visit([&](const auto& m) { return m.sample_local(to_layer(*only, wo), u_lobe.x(), u, transport, which); },
                   only->model);
    if (!sample) return sample;
    if (only->flipped) sample->wi.z() = -sample->wi.z();
    if (mixes_kinds_ && which == Lobes::all && !sample->delta) choose_kind(wo, u_lobe.y(), transport, *sample);
    return sample;
}

std::optional<BsdfSample> Bsdf::sample_mixture_local(const Vec3& wo, const Vec2& u_lobe, const Vec2& u,
                                                     Transport transport, Lobes which) const {
    std::array<float, max_layers> weights;
    float total = 0.f;
    for (std::size_t l = 0; l < layers_.size(); ++l) {
        const Vec3 o = to_layer(layers_[l], wo);
        weights[l] = same_side(layers_[l], wo, o) ? choice_weight(layers_[l], o, which) : 0.f;
        total += weights[l];
    }
    if (!(total > 0.f)) return std::nullopt;
    // The layer in whose share of [0, total) the number falls; what is left of the number chooses inside the layer.
    float rest = u_lobe.x() * total;
    std::size_t chosen = 0;
    for (std::size_t l = 0; l < layers_.size(); ++l) {
        if (weights[l] == 0.f) continue;
        chosen = l;
        if (rest < weights[l]) break;
        rest -= weights[l];
    }
    const Layer& layer = layers_[chosen];
    const Vec3 o = to_layer(layer, wo);
    const float u_layer = std::clamp(rest / weights[chosen], 0.f, 1.f - unit_roundoff);
    auto sample =
        std::visit([&](const auto& m) { return m.sample_local(o, u_layer, u, transport, which); }, layer.model);
    if (!sample) return sample;
    const Vec3 wi = from_layer(layer, sample->wi);
    if (wi.z() == 0.f || !same_side(layer, wi, sample->wi)) return std::nullopt;
    if (sample->delta) {
        sample->f *= layer.weight * tilted_cosine_ratio(layer, transport, wo, o, wi, sample->wi);
        sample->pdf_w *= weights[chosen] / total;
        sample->wi = wi;
        return sample;
    }
    sample->wi = wi;
    sample->pdf_w = pdf_w_local(wo, wi, which);
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

ScatteringCoefficients Bsdf::coefficients_local(const Vec3& wo) const {
    ScatteringCoefficients sum;
    for (const Layer& layer : layers_) {
        const Vec3 o = to_layer(layer, wo);
        if (!same_side(layer, wo, o)) continue;
        const auto c = std::visit([&](const auto& m) { return m.coefficients_local(o); }, layer.model);
        sum.diffuse += layer.weight * c.diffuse;
        sum.specular += layer.weight * c.specular;
    }
    return sum;
}

}  // namespace gib
