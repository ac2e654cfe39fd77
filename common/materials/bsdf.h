#pragma once
// The material at one point of a surface, with all its parameters known. It is a mixture of scattering models, each
// of which may be seen from behind or through a tilted normal, together with the probability that there is no surface
// at all.

#include "common/materials/coat.h"
#include "common/materials/phong.h"
#include "common/materials/plastic.h"
#include "common/materials/principled.h"
#include "common/materials/principled_thin.h"
#include "common/materials/rough_diffuse.h"
#include "common/materials/rough_scattering.h"
#include "common/materials/smooth_scattering.h"
#include "common/materials/ward.h"

#include <array>
#include <variant>
#include <vector>

namespace gib {

using Scattering = std::variant<Diffuse, Dielectric, Conductor, ThinDielectric, RoughConductor, RoughDielectric,
                                Plastic, RoughPlastic, Phong, Principled, PrincipledThin, RoughDiffuse, Ward>;

/// The effect of a bump or normal map on one layer, in the shading frame of the hit.
///
/// If the eye would see the tilted normal from behind, Mitsuba turns this normal by 180 degrees about the surface's
/// own (`flip_invalid_normals`). Light traced from its source does not know yet where the eye lies. Therefore each of
/// the two normals has a layer of its own, which scatters only towards eyes that see this normal.
///
/// The shadowing factor is that of Estevez, Lecocq and Stein 2019, "A Microfacet-Based Shadowing Function to Solve
/// the Bump Terminator Problem" (Ray Tracing Gems, chapter 12), equations 1 to 3. It depends on the light's
/// direction, whether the path is traced from the eye or from the light.
class Perturbation {
public:
    /// Which eyes see a layer: all, those that are on the same side of the tilted normal (before it is turned) as of
    /// the surface's own, or those that are on different sides.
    enum class Eye { any, in_front, behind };

    /// `base` and `tilted` are the unit normals before and after the map, the latter not turned. `shadows`: whether
    /// there is a shadowing factor; without it the factor is 1.
    Perturbation(const Vec3& base, const Vec3& tilted, Eye eye, bool shadows);

    /// Whether the layer exists for an eye in this direction.
    bool exists_for(const Vec3& eye) const {
        return eye_ == Eye::any || (eye.dot(base_) * eye.dot(tilted_) > 0.f) == (eye_ == Eye::in_front);
    }
    /// The share of eye directions for which the layer exists.
    float share() const;
    /// Whether the layer keeps all its light, for every eye.
    bool does_nothing() const { return eye_ == Eye::any && alpha2_ == 0.f; }
    /// The shadowing factor for light from this direction, from 0 to 1.
    float shadowing(const Vec3& light) const;

private:
    Vec3 base_, tilted_;
    Eye eye_;
    float alpha2_;  ///< squared roughness of the normals that the map stands for; 0: no shadowing
};

/// A surface with a mask of opacity o exists with probability o; f, densities and samples are those of the existing
/// surface, without the light that a thin sheet lets straight on. Directions are in the shading frame of the hit.
class Bsdf {
public:
    /// One model of a mixture.
    struct Layer {
        Scattering model;
        float weight = 1.f;
        bool flipped = false;  ///< its front is the surface's back
        std::optional<Eigen::Matrix3f> to_layer =
            {};  ///< from the shading frame to a tilted one: orthogonal, includes the flip
        std::vector<Perturbation> perturbations = {};  ///< maps that tilted it, if they have an effect
        std::shared_ptr<const Coat> coat = {};         ///< what covers the model, in the layer's frame; null: nothing

        bool exists_for(const Vec3& eye) const;
        float shadowing(const Vec3& light) const;
        float share() const;
    };

    static constexpr std::size_t max_layers = 32;

    explicit Bsdf(Scattering one_sided);
    /// Two models back to back (Mitsuba's `twosided`).
    Bsdf(Scattering front, Scattering back);
    /// Each weight is a layer's share of all light; a coat and what it covers have one share together. On each side the
    /// shares and `pass_through` sum to at most 1;
    /// they are stored divided by 1 - pass_through. There are at most max_layers layers.
    Bsdf(std::vector<Layer> layers, float pass_through);

    /// The probability that there is no surface (`null`, `mask`).
    float pass_through() const { return pass_through_; }
    /// The share of light from wo that goes straight on: where there is no surface, and through thin sheets. It is no
    /// sample and no part of f. The same for -wo.
    Color straight_on_local(const Vec3& wo) const {
        return has_sheets_ ? straight_on_with_sheets(wo) : Color(Color::Constant(pass_through_));
    }
    /// Whether it is a thin sheet and nothing else.
    bool is_sheet() const { return has_sheets_ && layers_.size() == 1 && pass_through_ == 0.f; }

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
    /// The densities of both walks along a path at this point: pdf_w_local(wo, wi) of radiance, and of power the other
    /// way round, pdf_w_local(wi, wo).
    struct PairPdfs {
        float radiance, power;
    };
    PairPdfs pdfs_local(const Vec3& wo, const Vec3& wi) const {
        const DiffuseSide& side = diffuse_side(wo.z());
        if (side.alone && below(wo.z()) == below(wi.z())) {
            const float cos_o = side.front * wo.z(), cos_i = side.front * wi.z();
            return {cos_o > 0.f ? cosine_hemisphere_pdf(cos_i) : 0.f, cos_i > 0.f ? cosine_hemisphere_pdf(cos_o) : 0.f};
        }
        return {pdf_w_local(wo, wi, Lobes::all, Transport::radiance),
                pdf_w_local(wi, wo, Lobes::all, Transport::power)};
    }
    /// Empty if nothing is scattered. u_lobe.x() chooses the lobe. If both a diffuse and a glossy lobe could have
    /// generated the direction, u_lobe.y() decides to which of them the path belongs, with probabilities proportional
    /// to their f. The sample's f is then that lobe's f over its probability, so that each class of paths gets its
    /// own share of the light.
    std::optional<BsdfSample> sample_local(const Vec3& wo, const Vec2& u_lobe, const Vec2& u, Transport transport,
                                           Lobes which = Lobes::all) const {
        const DiffuseSide& side = diffuse_side(wo.z());
        if (!side.alone) return sample_layered_local(wo, u_lobe, u, transport, which);
        return side.sample_local(wo, u, which);
    }
    /// The share of light from wo that is scattered: see ScatteringCoefficients.
    ScatteringCoefficients coefficients_local(const Vec3& wo) const {
        const DiffuseSide& side = diffuse_side(wo.z());
        return side.alone ? side.model.coefficients_local(side.seen(wo)) : layered_coefficients_local(wo);
    }
    /// The two delta lobes of a smooth interface, for paths that follow both instead of choosing one: the weight of
    /// each path is then f |cos|, not divided by pdf_w. Empty if light from wo has any other way to go.
    std::optional<std::array<BsdfSample, 2>> delta_pair_local(const Vec3& wo, Transport transport) const;

    /// The lobes of all layers, on both sides.
    const LobeTraits& traits() const { return traits_; }
    /// Whether any light is scattered.
    bool reflects() const { return traits_.scatters(); }
    /// Whether a bump or normal map gives any layer its own normal.
    bool is_tilted() const { return is_tilted_; }
    const std::vector<Layer>& layers() const { return layers_; }

    /// The reflectance of a side that has only an ideal diffuse layer, where the irradiance alone determines the
    /// reflected radiance; empty for other sides.
    std::optional<Color> ideal_diffuse_reflectance(float cos_o) const {
        const DiffuseSide& side = diffuse_side(cos_o);
        return side.alone ? std::optional(side.model.reflectance) : std::nullopt;
    }

    /// The lobes on the side of an outgoing direction with this cosine.
    const LobeTraits& traits_at(float cos_o) const { return traits_of_side_[below(cos_o)]; }

private:
    /// One side of the material. If it has only an ideal diffuse layer, by far the most common case, it
    /// is evaluated inline.
    struct DiffuseSide {
        Diffuse model{Color::Zero()};
        bool alone = false;  ///< whether the ideal diffuse layer is the only one
        float front = 1.f;   ///< the sign of z on the layer's front

        Vec3 seen(const Vec3& w) const { return {w.x(), w.y(), front * w.z()}; }
        std::optional<BsdfSample> sample_local(const Vec3& wo, const Vec2& u, Lobes which) const {
            auto sample = model.sample_local(seen(wo), 0.f, u, Transport::radiance, which);
            if (sample) sample->wi.z() *= front;
            return sample;
        }
    };
    static std::size_t below(float cos_o) { return cos_o < 0.f ? 1 : 0; }
    const DiffuseSide& diffuse_side(float cos_o) const { return diffuse_sides_[below(cos_o)]; }

    void prepare();
    /// The only layer of this side; null if there are several, or tilted ones.
    const Layer* only_layer(float cos_o) const {
        const int i = only_[below(cos_o)];
        return i < 0 ? nullptr : &layers_[static_cast<std::size_t>(i)];
    }
    LobeTraits traits_of_side(bool below) const;
    Color straight_on_with_sheets(const Vec3& wo) const;
    LobeValues layered_f_local(const Vec3& wo, const Vec3& wi, Transport transport) const;
    ScatteringCoefficients layered_coefficients_local(const Vec3& wo) const;
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
    bool has_sheets_ = false;   ///< some layer is a thin sheet
    bool is_tilted_ = false;
    // By side, above and below:
    std::array<LobeTraits, 2> traits_of_side_;
    std::array<int, 2> only_ = {-1, -1};  ///< the index of only_layer()
    std::array<DiffuseSide, 2> diffuse_sides_;
};

}  // namespace gib
