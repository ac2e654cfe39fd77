#pragma once
// Materials: a closed set of scattering models behind one interface. f never holds the cosine; directions point away
// from the surface; local means the shading frame with its normal as z.

#include "common/components.h"
#include "common/fresnel.h"
#include "common/math.h"

#include <optional>
#include <string_view>
#include <variant>

namespace gib {

/// What a path carries. Radiance is scaled by the squared index ratio at a refraction, power is not
/// (Veach 1997, section 5.2: f is not symmetric there).
enum class Transport { radiance, power };

struct BsdfSample {
    Vec3 wi;
    Color f;      ///< [1/sr]; for a delta lobe its weight / |cos|, so that f |cos| / pdf_w is the weight of the path
    float pdf_w;  ///< [1/sr]; for a delta lobe the probability of choosing it
    bool delta;
    LobeKind lobe;
    float eta;  ///< index on wi's side over index on wo's side; 1 without refraction
};

/// Ideal diffuse reflection: f = reflectance / pi above the surface, one-sided.
struct Diffuse {
    Color reflectance;

    Color f_local(const Vec3& wo, const Vec3& wi) const;
    float pdf_w_local(const Vec3& wo, const Vec3& wi) const;
    std::optional<BsdfSample> sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport) const;
};

/// A smooth interface between two dielectrics; `eta` = interior index / exterior index.
struct Dielectric {
    float eta;
    Color specular_reflectance = Color::Ones();
    Color specular_transmittance = Color::Ones();

    std::optional<BsdfSample> sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport) const;
};

/// A smooth conductor, one-sided. Index eta + i k per channel; without one ("none"), a perfect mirror.
struct Conductor {
    struct Index {
        Color eta, k;
    };
    std::optional<Index> index;
    Color specular_reflectance = Color::Ones();

    Color reflectance(float cos_theta) const;
    std::optional<BsdfSample> sample_local(const Vec3& wo, float u_lobe, const Vec2& u, Transport) const;
};

using Scattering = std::variant<Diffuse, Dielectric, Conductor>;

/// The slides' reflection coefficients: how much of the light from one direction is scattered diffusely and specularly.
struct ScatteringCoefficients {
    Color diffuse = Color::Zero();
    Color specular = Color::Zero();  ///< reflected and transmitted
};

/// The material of a surface: one model, or two back to back (Mitsuba's `twosided`).
class Bsdf {
public:
    explicit Bsdf(Scattering one_sided) : front_(one_sided) {}
    Bsdf(Scattering front, Scattering back) : front_(front), back_(back) {}

    /// f(wo, wi) of the non-delta lobes [1/sr]; directions in the shading frame.
    Color f_local(Vec3 wo, Vec3 wi) const;
    /// Density of sample_local for the non-delta lobes [1/sr].
    float pdf_w_local(Vec3 wo, Vec3 wi) const;
    /// Empty where nothing is scattered. `u_lobe` chooses among lobes and matters only if several_lobes().
    std::optional<BsdfSample> sample_local(Vec3 wo, float u_lobe, const Vec2& u, Transport transport) const;
    /// The share of light from wo that is scattered, exactly.
    ScatteringCoefficients coefficients_local(Vec3 wo) const;

    bool has_diffuse() const {
        return any([](const Scattering& s) { return std::holds_alternative<Diffuse>(s); });
    }
    bool has_specular() const {
        return any([](const Scattering& s) { return !std::holds_alternative<Diffuse>(s); });
    }
    bool has_refraction() const {
        return any([](const Scattering& s) {
            const auto* d = std::get_if<Dielectric>(&s);
            return d && d->eta != 1.f;
        });
    }
    /// Some light is scattered at all.
    bool reflects() const;
    bool several_lobes() const { return several_lobes_; }
    bool two_sided() const { return back_.has_value(); }
    /// A non-delta lobe scatters light that leaves on wo's side.
    bool samples_lights(float cos_o) const {
        const auto* diffuse = std::get_if<Diffuse>(side(cos_o));
        return diffuse && !is_black(diffuse->reflectance);
    }

private:
    /// The model that light from a direction with this cosine meets.
    const Scattering* side(float cos_o) const { return cos_o < 0.f && back_ ? &*back_ : &front_; }
    template <typename Predicate>
    bool any(Predicate p) const {
        return p(front_) || (back_ && p(*back_));
    }

    Scattering front_;
    std::optional<Scattering> back_;
    bool several_lobes_ = any([](const Scattering& s) { return std::holds_alternative<Dielectric>(s); });
};

}  // namespace gib
