#pragma once
// The material at one point of a surface, all its parameters known: a mixture of scattering models, each of which may
// be seen from behind or through a tilted normal, and the probability that nothing is there at all.

#include "common/smooth_scattering.h"

#include <variant>
#include <vector>

namespace gib {

using Scattering = std::variant<Diffuse, Dielectric, Conductor, ThinDielectric>;

/// f, densities and samples are those of the surface where it is there: a mask of opacity o is a surface that is there with
/// probability o. Directions are in the shading frame of the hit.
class Bsdf {
public:
    /// One model of a mixture.
    struct Layer {
        Scattering model;
        float weight = 1.f;
        bool flipped = false;  ///< its front is the surface's back
        std::optional<Eigen::Matrix3f> to_layer =
            {};  ///< orthogonal, the flip included: from the shading frame to a tilted one
    };

    static constexpr std::size_t max_layers = 16;

    explicit Bsdf(Scattering one_sided);
    /// Two models back to back (Mitsuba's `twosided`).
    Bsdf(Scattering front, Scattering back);
    /// Weights as shares of all light; the sum of what one side shows and `pass_through` is at most 1. They are kept divided
    /// by 1 - pass_through. At most max_layers.
    Bsdf(std::vector<Layer> layers, float pass_through);

    /// The probability that light goes straight on, as if there were no surface (`null`, `mask`).
    float pass_through() const { return pass_through_; }

    /// f(wo, wi) of the lobes that are no delta [1/sr].
    LobeValues f_local(const Vec3& wo, const Vec3& wi, Transport transport = Transport::radiance) const;
    /// Density of sample_local for those lobes [1/sr].
    float pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which = Lobes::all) const;
    /// Empty where nothing is scattered. u_lobe.x() chooses the lobe. Where a diffuse and a glossy lobe could both have given
    /// the direction, u_lobe.y() decides which of them the path belongs to, with a probability that goes by their f; the
    /// sample's f is then that lobe's f over this probability, so that each class of paths has its own share of light.
    /// u_lobe matters only if several_lobes().
    std::optional<BsdfSample> sample_local(const Vec3& wo, const Vec2& u_lobe, const Vec2& u, Transport transport,
                                           Lobes which = Lobes::all) const;
    /// The share of light from wo that is scattered: see ScatteringCoefficients.
    ScatteringCoefficients coefficients_local(const Vec3& wo) const;

    /// Of all layers, on both sides.
    const LobeTraits& traits() const { return traits_; }
    /// Some light is scattered at all.
    bool reflects() const { return traits_.scatters(); }
    bool several_lobes() const { return several_lobes_; }
    bool two_sided() const;
    const std::vector<Layer>& layers() const { return layers_; }

    /// The lobes that light meets which leaves on the side of this cosine.
    const LobeTraits& traits_at(float cos_o) const { return cos_o < 0.f ? traits_below_ : traits_above_; }

private:
    void prepare();
    /// The layer that alone matters on this side; null if there are several, or tilted ones.
    const Layer* only_layer(float cos_o) const {
        const int i = cos_o < 0.f ? below_ : above_;
        return i < 0 ? nullptr : &layers_[static_cast<std::size_t>(i)];
    }
    LobeTraits traits_of_side(bool below) const;
    LobeValues mixture_f_local(const Vec3& wo, const Vec3& wi, Transport transport) const;
    std::optional<BsdfSample> sample_mixture_local(const Vec3& wo, const Vec2& u_lobe, const Vec2& u,
                                                   Transport transport, Lobes which) const;
    void choose_kind(const Vec3& wo, float u, Transport transport, BsdfSample& sample) const;

    std::vector<Layer> layers_;
    float pass_through_ = 0.f;
    LobeTraits traits_, traits_above_, traits_below_;
    bool several_lobes_ = false;
    bool mixes_kinds_ = false;     ///< diffuse and glossy lobes together
    int above_ = -1, below_ = -1;  ///< the index of only_layer() by side
};

}  // namespace gib
