#pragma once
// The material at one point of a surface, all its parameters known: a mixture of scattering models, each of which may
// be seen from behind or through a tilted normal, and the probability that nothing is there at all.

#include "common/materials/phong.h"
#include "common/materials/plastic.h"
#include "common/materials/rough_scattering.h"
#include "common/materials/smooth_scattering.h"

#include <array>
#include <variant>
#include <vector>

namespace gib {

using Scattering = std::variant<Diffuse, Dielectric, Conductor, ThinDielectric, RoughConductor, RoughDielectric,
                                Plastic, RoughPlastic, Phong>;

/// A bump or normal map as one layer sees it, in the shading frame of the hit.
///
/// Mitsuba turns a normal that the eye would see from behind about the surface's own (`flip_invalid_normals`). Light
/// that is traced from its source does not know yet where the eye lies: a layer then stands for one of the two normals,
/// and scatters only towards eyes that see this one.
///
/// The shadowing is that of Estevez, Lecocq and Stein 2019, "A Microfacet-Based Shadowing Function to Solve the Bump
/// Terminator Problem" (Ray Tracing Gems, chapter 12), equations 1 to 3: the light's, whichever way it is followed.
class Perturbation {
public:
    /// The eyes that see a layer, by their side of the normal before it was turned. Of the surface, they see either
    /// side.
    enum class Eye { any, in_front, behind };

    /// `base` and `tilted`, both normalised: the normal before and after the map, not turned. `shadows`: the factor is
    /// not 1.
    Perturbation(const Vec3& base, const Vec3& tilted, Eye eye, bool shadows);

    /// Whether the layer exists for an eye in this direction.
    bool exists_for(const Vec3& eye) const {
        return eye_ == Eye::any || (eye.dot(base_) * eye.dot(tilted_) > 0.f) == (eye_ == Eye::in_front);
    }
    /// The share of directions for which it exists.
    float share() const;
    /// It leaves all light to its layer, for every eye.
    bool does_nothing() const { return eye_ == Eye::any && alpha2_ == 0.f; }
    /// 0 to 1.
    float shadowing(const Vec3& light) const;

private:
    Vec3 base_, tilted_;
    Eye eye_;
    float alpha2_;  ///< of the distribution of normals that the map stands for
};

/// f, densities and samples are those of the surface where it is there: a mask of opacity o is a surface that is there
/// with probability o. Directions are in the shading frame of the hit.
class Bsdf {
public:
    /// One model of a mixture.
    struct Layer {
        Scattering model;
        float weight = 1.f;
        bool flipped = false;  ///< its front is the surface's back
        std::optional<Eigen::Matrix3f> to_layer =
            {};  ///< orthogonal, the flip included: from the shading frame to a tilted one
        std::vector<Perturbation> perturbations = {};  ///< of the maps that tilted it, without those that do nothing

        bool exists_for(const Vec3& eye) const;
        float shadowing(const Vec3& light) const;
        float share() const;
    };

    static constexpr std::size_t max_layers = 32;

    explicit Bsdf(Scattering one_sided);
    /// Two models back to back (Mitsuba's `twosided`).
    Bsdf(Scattering front, Scattering back);
    /// Weights as shares of all light; the sum of what one side shows and `pass_through` is at most 1. They are kept
    /// divided by 1 - pass_through. At most max_layers.
    Bsdf(std::vector<Layer> layers, float pass_through);

    /// The probability that light goes straight on, as if there were no surface (`null`, `mask`).
    float pass_through() const { return pass_through_; }

    /// f(wo, wi) of the lobes that are no delta [1/sr].
    LobeValues f_local(const Vec3& wo, const Vec3& wi, Transport transport = Transport::radiance) const {
        const DiffuseSide& side = diffuse_side(wo.z());
        return side.alone ? side.model.f_local(side.seen(wo), side.seen(wi), transport)
                          : layered_f_local(wo, wi, transport);
    }
    /// Density of sample_local for those lobes [1/sr].
    float pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which = Lobes::all,
                      Transport transport = Transport::radiance) const {
        const DiffuseSide& side = diffuse_side(wo.z());
        return side.alone ? side.model.pdf_w_local(side.seen(wo), side.seen(wi), which)
                          : layered_pdf_w_local(wo, wi, which, transport);
    }
    /// Empty where nothing is scattered. u_lobe.x() chooses the lobe. Where a diffuse and a glossy lobe could both have
    /// given the direction, u_lobe.y() decides which of them the path belongs to, with a probability that goes by their
    /// f; the sample's f is then that lobe's f over this probability, so that each class of paths has its own share of
    /// light.
    std::optional<BsdfSample> sample_local(const Vec3& wo, const Vec2& u_lobe, const Vec2& u, Transport transport,
                                           Lobes which = Lobes::all) const {
        const DiffuseSide& side = diffuse_side(wo.z());
        if (!side.alone) return sample_layered_local(wo, u_lobe, u, transport, which);
        auto sample = side.model.sample_local(side.seen(wo), u_lobe.x(), u, transport, which);
        if (sample) sample->wi = side.seen(sample->wi);
        return sample;
    }
    /// The share of light from wo that is scattered: see ScatteringCoefficients.
    ScatteringCoefficients coefficients_local(const Vec3& wo) const;
    /// The two delta lobes of a smooth interface, where light from wo has no other way to go: for paths that follow
    /// both instead of choosing one. The weight of a path is then f |cos|, not divided by pdf_w.
    std::optional<std::array<BsdfSample, 2>> delta_pair_local(const Vec3& wo, Transport transport) const;

    /// Of all layers, on both sides.
    const LobeTraits& traits() const { return traits_; }
    /// Some light is scattered at all.
    bool reflects() const { return traits_.scatters(); }
    bool two_sided() const;
    /// Some layer has a normal of its own, by a bump or normal map.
    bool is_tilted() const;
    const std::vector<Layer>& layers() const { return layers_; }

    /// The reflectance of a side with nothing but an ideal diffuse layer, which irradiance alone decides about; else
    /// empty.
    std::optional<Color> ideal_diffuse_reflectance(float cos_o) const {
        const DiffuseSide& side = diffuse_side(cos_o);
        return side.alone ? std::optional(side.model.reflectance) : std::nullopt;
    }

    /// The lobes that light meets which leaves on the side of this cosine.
    const LobeTraits& traits_at(float cos_o) const { return traits_of_side_[below(cos_o)]; }

private:
    /// A side with nothing but an ideal diffuse layer, by far the most common, which is evaluated without a call.
    struct DiffuseSide {
        Diffuse model{Color::Zero()};
        bool alone = false;
        float front = 1.f;  ///< the sign of its front's z

        Vec3 seen(const Vec3& w) const { return {w.x(), w.y(), front * w.z()}; }
    };
    static std::size_t below(float cos_o) { return cos_o < 0.f ? 1 : 0; }
    const DiffuseSide& diffuse_side(float cos_o) const { return diffuse_sides_[below(cos_o)]; }

    void prepare();
    /// The layer that alone matters on this side; null if there are several, or tilted ones.
    const Layer* only_layer(float cos_o) const {
        const int i = only_[below(cos_o)];
        return i < 0 ? nullptr : &layers_[static_cast<std::size_t>(i)];
    }
    LobeTraits traits_of_side(bool below) const;
    LobeValues layered_f_local(const Vec3& wo, const Vec3& wi, Transport transport) const;
    float layered_pdf_w_local(const Vec3& wo, const Vec3& wi, Lobes which, Transport transport) const;
    std::optional<BsdfSample> sample_layered_local(const Vec3& wo, const Vec2& u_lobe, const Vec2& u,
                                                   Transport transport, Lobes which) const;
    LobeValues mixture_f_local(const Vec3& wo, const Vec3& wi, Transport transport) const;
    std::optional<BsdfSample> sample_mixture_local(const Vec3& wo, const Vec2& u_lobe, const Vec2& u,
                                                   Transport transport, Lobes which) const;
    void choose_kind(const Vec3& wo, float u, Transport transport, BsdfSample& sample) const;

    std::vector<Layer> layers_;
    float pass_through_ = 0.f;
    LobeTraits traits_;
    bool mixes_kinds_ = false;  ///< diffuse and glossy lobes together
    // By side, above and below:
    std::array<LobeTraits, 2> traits_of_side_;
    std::array<int, 2> only_ = {-1, -1};  ///< the index of only_layer()
    std::array<DiffuseSide, 2> diffuse_sides_;
};

}  // namespace gib
