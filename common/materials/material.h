#pragma once
// Materials as a scene describes them: scattering models with textured parameters, nested in blends, masks, bump maps
// and two-sided materials. At a point of a surface a material becomes a Bsdf.

#include "common/images/texture.h"
#include "common/materials/bsdf.h"

#include <memory>
#include <optional>
#include <variant>
#include <vector>

namespace gib {

class Material;
using NestedMaterial = std::shared_ptr<const Material>;

/// A parameter of a scattering model whose value is taken from a texture.
struct TexturedParameter {
    Texture texture;
    void (*set_color)(Scattering& model, const Color& color) = nullptr;  ///< exactly one of the two is set
    void (*set_value)(Scattering& model, float value) = nullptr;
};
struct TexturedScattering {
    Scattering model;
    std::vector<TexturedParameter> parameters;
};
/// Lets everything through (Mitsuba's `null`).
struct Nothing {};
/// (1 - weight) first + weight second.
struct Blend {
    Texture weight;
    NestedMaterial first, second;
};
/// A surface that exists with probability `opacity`.
struct Mask {
    Texture opacity;
    NestedMaterial nested;
};
struct TwoSided {
    NestedMaterial front, back;
};
/// A clear coat over another material, which must not tilt normals or let light pass.
struct Coating {
    std::shared_ptr<const Coat> coat;
    Texture absorption;      ///< absorption coefficient by place; where it varies it replaces that of the coat
    float thickness;         ///< factor of `absorption` to the optical depth straight through
    NestedMaterial surface;  ///< what the coat's surface reflects: one-sided
    NestedMaterial nested;
};
/// How tilted normals that contradict the geometry are treated: see Perturbation.
struct PerturbationOptions {
    bool flip_invalid_normals = true, use_shadowing_function = true;
};
/// The normal of the surface displaced by scale * height along its shading normal, in scene units; the change of the
/// shading normal over the surface is neglected. Source: Blinn 1978, "Simulation of Wrinkled Surfaces".
struct BumpMap {
    Texture height;
    float scale;
    NestedMaterial nested;
    PerturbationOptions options{};
};
/// The normal 2 c - 1 of a colour c, in the shading frame whose first axis follows u.
struct NormalMap {
    Texture normal;
    NestedMaterial nested;
    PerturbationOptions options{};
};

/// The geometry that a material needs at the point where light meets it.
struct MaterialPoint {
    Vec2 uv;
    Vec3 ng;
    Vec3 dp_du, dp_dv;            ///< [scene units per unit of uv]
    Frame shading;                ///< its first axis along dp_du
    std::uint32_t triangle = 0;   ///< index of the triangle in a mesh
    Vec2 weights = Vec2::Zero();  ///< the barycentric weights of its second and third vertex

    TexturePoint texture_point() const { return {uv, triangle, weights}; }
};

class Material {
public:
    using Node = std::variant<TexturedScattering, Nothing, Blend, Mask, TwoSided, BumpMap, NormalMap, Coating>;

    /// Throws std::invalid_argument if there are more than Bsdf::max_layers models.
    explicit Material(Node node);
    explicit Material(Scattering model);

    const Node& node() const { return node_; }
    /// The Bsdf of a material that is the same everywhere; null if it varies.
    const Bsdf* constant() const { return constant_.get(); }
    Bsdf at(const MaterialPoint& point) const { return at(point, std::nullopt); }
    /// constant() and at() of a material that splits light, for one stratum of wavelengths (dispersion.h).
    const Bsdf* constant(int stratum) const {
        return constant_strata_ ? &(*constant_strata_)[static_cast<std::size_t>(stratum)] : nullptr;
    }
    Bsdf at(const MaterialPoint& point, std::optional<int> stratum) const;

    /// The lobes of all models, for all values that their textures may have.
    const LobeTraits& traits() const { return traits_; }
    bool has_holes() const { return has_holes_; }      ///< some light may go straight on
    bool is_textured() const { return is_textured_; }  ///< a parameter varies
    bool is_bumped() const { return is_bumped_; }      ///< its normals are not the shape's
    bool two_sided() const { return two_sided_; }
    bool is_coated() const { return is_coated_; }          ///< a part has a clear coat (Coating)
    bool is_dispersive() const { return is_dispersive_; }  ///< its index depends on the wavelength
    /// Whether its shading frame must follow u, because normals or anisotropic models depend on the frame.
    bool follows_uv() const { return is_bumped_ || traits_.anisotropic; }

private:
    Node node_;
    LobeTraits traits_;
    bool has_holes_ = false, is_textured_ = false, is_bumped_ = false, two_sided_ = false, is_dispersive_ = false,
         is_coated_ = false;
    std::size_t models_ = 0;  ///< number of layers that all nested materials may give at a point
    std::shared_ptr<const Bsdf> constant_;
    std::shared_ptr<const std::vector<Bsdf>> constant_strata_;
};

}  // namespace gib
