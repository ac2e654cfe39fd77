#pragma once
// The interface of every scattering model: its lobes, their values and samples. f never holds the cosine; directions
// point away from the surface; local means the shading frame with its normal as z.
//
// A model is a struct with these members:
//   LobeTraits traits() const;
//   LobeValues f_local(wo, wi, transport) const;                    f of the lobes that are no delta [1/sr]
//   float pdf_w_local(wo, wi, which) const;                         density of sample_local for them [1/sr]
//   optional<BsdfSample> sample_local(wo, u_lobe, u, transport, which) const;
//   ScatteringCoefficients coefficients_local(wo) const;
// Where a model scatters nothing, such as a one-sided model seen from behind, all of these are zero or empty.

#include "common/core/components.h"
#include "common/core/math.h"

#include <optional>

namespace gib {

/// The quantity that a path carries. Radiance is scaled by the squared index ratio at a refraction, power is not
/// (Veach 1997, section 5.2: f is not symmetric there).
enum class Transport { radiance, power };

/// Selects the lobes that take part, by their kind.
enum class Lobes { all, diffuse, specular };
constexpr bool includes(Lobes which, LobeKind kind) {
    return which == Lobes::all || (which == Lobes::diffuse) == (kind == LobeKind::diffuse);
}

/// The direction in which an ideal mirror reflects `w`, in local coordinates.
inline Vec3 mirrored(const Vec3& w) { return {-w.x(), -w.y(), w.z()}; }
/// `w`, mirrored at the surface if `below`, in local coordinates.
inline Vec3 on_side(const Vec3& w, bool below) { return below ? Vec3(w.x(), w.y(), -w.z()) : w; }

/// The lobes of a model, on either side.
struct LobeTraits {
    bool diffuse = false;       ///< counts as D; never a delta
    bool glossy = false;        ///< counts as S, though it is no delta
    bool rough = false;         ///< neither a delta nor ideally diffuse, whatever it counts as
    bool delta = false;         ///< counts as S
    bool transmission = false;  ///< light passes to the other side; such a model scatters on both
    bool refraction = false;    ///< transmitted light is bent

    bool anisotropic = false;  ///< depends on where the shading frame's axes point

    bool specular() const { return glossy || delta; }
    bool scatters() const { return diffuse || specular(); }

    LobeTraits& operator|=(const LobeTraits& other) {
        diffuse |= other.diffuse;
        glossy |= other.glossy;
        rough |= other.rough;
        delta |= other.delta;
        transmission |= other.transmission;
        refraction |= other.refraction;
        anisotropic |= other.anisotropic;
        return *this;
    }
};

/// The kind of a lobe of this roughness (alpha of a microfacet distribution, the larger of two).
constexpr LobeKind kind_of_roughness(float alpha) {
    return alpha > glossy_roughness ? LobeKind::diffuse : LobeKind::specular;
}

/// Values by the kind of lobe, without delta lobes: f [1/sr], or the radiance that the lobes scatter.
struct LobeValues {
    Color diffuse = Color::Zero();
    Color specular = Color::Zero();

    Color sum() const { return diffuse + specular; }
    Color of(Lobes which) const { return which == Lobes::all ? sum() : which == Lobes::diffuse ? diffuse : specular; }
    void add(LobeKind kind, const Color& f) { (kind == LobeKind::diffuse ? diffuse : specular) += f; }
};

struct BsdfSample {
    Vec3 wi;
    Color f;      ///< [1/sr]; for a delta lobe its weight / |cos|, so that f |cos| / pdf_w is the weight of the path
    float pdf_w;  ///< [1/sr]; for a delta lobe the probability of choosing it
    bool delta = false;
    LobeKind lobe;
    float eta = 1.f;  ///< index on wi's side over index on wo's side; 1 without refraction
};

/// Reflection coefficients (Jensen 2001, chapter 5): the shares of the light from one direction that are scattered
/// diffusely and specularly. They are exact for smooth models; for rough ones they are estimates that are not zero
/// where the model scatters. They only decide probabilities: the weights of samples correct for their errors.
struct ScatteringCoefficients {
    Color diffuse = Color::Zero();
    Color specular = Color::Zero();  ///< reflected and transmitted

    Color of(Lobes which) const {
        return which == Lobes::all ? Color(diffuse + specular) : which == Lobes::diffuse ? diffuse : specular;
    }
};

}  // namespace gib
