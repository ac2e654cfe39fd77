#include "common/materials/material.h"

#include "common/color/dispersion.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace gib {

namespace {

using Matrix = Eigen::Matrix3f;

/// How light reaches one part of a material: the part's share of the light, and the tilts and flips on the way to it.
struct Passage {
    float share = 1.f;
    Frame frame;  ///< the shading frame as tilted so far, in world space
    Matrix to_layer = Matrix::Identity();
    bool tilted = false, flipped = false;
    bool again = false;  ///< the part is seen with its second normal: its holes are already counted
    std::vector<Perturbation> perturbations;
    std::shared_ptr<const Coat> coat;
};

Matrix axes(const Frame& f) {
    Matrix m;
    m << f.s, f.t, f.n;
    return m;
}

/// Calls `use` with the model if its index depends on the wavelength.
template <typename Model, typename Use>
void if_dispersive(Model& model, Use use) {
    std::visit(
        [&](auto& m) {
            if constexpr (requires { m.cauchy_b; })
                if (m.cauchy_b != 0.f) use(m);
        },
        model);
}

/// Sets the index of a model to that of one stratum of wavelengths.
void disperse(Scattering& model, int stratum) {
    if_dispersive(model, [&](auto& m) {
        const auto eta = static_cast<double>(m.eta), b = static_cast<double>(m.cauchy_b);
        m.eta = static_cast<float>(cauchy_index(eta, b, stratum_wavelength(stratum)));
    });
}

bool is_dispersive(const Scattering& model) {
    bool found = false;
    if_dispersive(model, [&](const auto&) { found = true; });
    return found;
}

/// v over the largest of its absolute coordinates; a zero vector stays zero.
Vec3 in_own_units(const Vec3& v) {
    const float largest = v.cwiseAbs().maxCoeff();
    return largest > 0.f ? Vec3(v / largest) : v;
}

/// Collects the layers of a material at a point, for one stratum of wavelengths or for light that is not split.
class Layers {
public:
    Layers(const MaterialPoint& point, std::optional<int> stratum) : point_(point), stratum_(stratum) {}

    void add(const Material& material, const Passage& passage) {
        if (passage.share > 0.f) std::visit([&](const auto& node) { add(node, passage); }, material.node());
    }
    Bsdf bsdf() && { return Bsdf(std::move(layers_), pass_through_); }

private:
    void add(const TexturedScattering& node, const Passage& passage) {
        Bsdf::Layer layer{node.model, passage.share, passage.flipped};
        for (const TexturedParameter& p : node.parameters) {
            if (p.set_color) p.set_color(layer.model, p.texture.color(point_.texture_point()).max(0.f));
            else p.set_value(layer.model, p.texture.value(point_.texture_point()));
        }
        if (stratum_) disperse(layer.model, *stratum_);
        if (passage.tilted) {
            layer.to_layer = passage.to_layer;
            layer.perturbations = passage.perturbations;
        }
        layer.coat = passage.coat;
        layers_.push_back(std::move(layer));
    }
    void add(const Nothing&, const Passage& passage) { pass_through(passage, passage.share); }
    void add(const Blend& node, Passage passage) {
        const float share = passage.share;
        const float weight = std::clamp(node.weight.value(point_.texture_point()), 0.f, 1.f);
        passage.share = share * (1.f - weight);
        add(*node.first, passage);
        passage.share = share * weight;
        add(*node.second, passage);
    }
    void add(const Mask& node, Passage passage) {
        const float opacity = std::clamp(node.opacity.value(point_.texture_point()), 0.f, 1.f);
        pass_through(passage, passage.share * (1.f - opacity));
        passage.share *= opacity;
        add(*node.nested, passage);
    }
    void pass_through(const Passage& passage, float share) {
        if (!passage.again) pass_through_ += share;
    }
    void add(const TwoSided& node, Passage passage) {
        add(*node.front, passage);
        add(*node.back, turned_over(std::move(passage)));
    }
    void add(const Coating& node, Passage passage) {
        add(*node.surface, passage);
        if (node.nested->two_sided()) add(*node.surface, turned_over(passage));
        passage.coat = node.absorption.constant() ? node.coat : coat_here(node);
        add(*node.nested, passage);
    }
    std::shared_ptr<const Coat> coat_here(const Coating& node) const {
        Coat coat = *node.coat;
        coat.absorption = node.absorption.color(point_.texture_point()).max(0.f) * node.thickness;
        return std::make_shared<const Coat>(std::move(coat));
    }
    static Passage turned_over(Passage passage) {
        passage.flipped = !passage.flipped;
        passage.to_layer = Eigen::Vector3f(1.f, 1.f, -1.f).asDiagonal() * passage.to_layer;
        return passage;
    }
    void add(const BumpMap& node, const Passage& passage) {
        const Vec3& n = passage.frame.n;
        const Vec2 slope = node.scale * node.height.gradient(point_.uv);
        // Each vector is scaled by itself, because float cannot hold the product of two lengths of 1e-20 or of 1e20.
        const Vec3 du = in_own_units(point_.dp_du + n * (slope.x() - n.dot(point_.dp_du)));
        const Vec3 dv = in_own_units(point_.dp_dv + n * (slope.y() - n.dot(point_.dp_dv)));
        Vec3 tilted = du.cross(dv);
        if (point_.ng.dot(tilted) < 0.f) tilted = -tilted;
        add_perturbed(*node.nested, node.options, passage, tilted);
    }
    void add(const NormalMap& node, const Passage& passage) {
        const Color c = node.normal.color(point_.texture_point());
        add_perturbed(*node.nested, node.options, passage, passage.frame.to_world(Vec3((2.f * c - 1.f).matrix())));
    }
    /// `normal` may have any length; without a direction (zero or not finite) it tilts nothing.
    void add_perturbed(const Material& nested, const PerturbationOptions& options, Passage passage,
                       const Vec3& normal) {
        using Eye = Perturbation::Eye;
        const float length = normal.norm();
        if (!(length > 0.f && std::isfinite(length))) return add(nested, passage);
        const Vec3 base = passage.frame.n, tilted = normal / length;
        const Vec3 turned = 2.f * base.dot(tilted) * base - tilted;
        const bool flips = options.flip_invalid_normals && (tilted - turned).squaredNorm() > 0.f;
        const auto perturbation = [&](Eye eye) {
            const Matrix to_shading = passage.to_layer.transpose() * axes(passage.frame).transpose();
            return Perturbation(to_shading * base, to_shading * tilted, eye, options.use_shadowing_function);
        };
        add_tilted(nested, passage, tilted, perturbation(flips ? Eye::in_front : Eye::any));
        if (!flips) return;
        passage.again = true;
        add_tilted(nested, passage, turned.normalized(), perturbation(Eye::behind));
    }
    void add_tilted(const Material& nested, Passage passage, const Vec3& normal, const Perturbation& perturbation) {
        const Frame tilted = frame_along(normal, passage.frame.s);
        passage.to_layer = axes(tilted).transpose() * axes(passage.frame) * passage.to_layer;
        passage.frame = tilted;
        passage.tilted = true;
        if (!perturbation.does_nothing()) passage.perturbations.push_back(perturbation);
        add(nested, passage);
    }

    const MaterialPoint& point_;
    std::optional<int> stratum_;
    std::vector<Bsdf::Layer> layers_;
    float pass_through_ = 0.f;
};

/// The traits for every combination of the textures' extreme values: they depend only on whether a colour is black
/// and on which side of glossy_roughness a roughness lies. An index that depends on the wavelength is 1 at single
/// wavelengths at most; one stratum and the index at the d line together show whether there is refraction.
LobeTraits possible_traits(const TexturedScattering& node) {
    LobeTraits traits;
    for (std::size_t highest = 0; highest >> node.parameters.size() == 0; ++highest) {  // one bit per parameter
        Scattering model = node.model;
        for (std::size_t i = 0; i < node.parameters.size(); ++i) {
            const TexturedParameter& p = node.parameters[i];
            const bool high = (highest >> i & 1) != 0;
            const Color c = high ? p.texture.maximum() : p.texture.minimum();
            if (p.set_color) p.set_color(model, c.max(0.f));
            else p.set_value(model, high ? c.maxCoeff() : c.minCoeff());
        }
        traits |= std::visit([](const auto& m) { return m.traits(); }, model);
        disperse(model, 0);
        traits |= std::visit([](const auto& m) { return m.traits(); }, model);
    }
    return traits;
}

}  // namespace

Material::Material(Scattering model) : Material(Node(TexturedScattering{std::move(model), {}})) {}

Material::Material(Node node) : node_(std::move(node)) {
    bool constant = true;
    const auto nest = [&](const NestedMaterial& nested) {
        traits_ |= nested->traits_;
        has_holes_ |= nested->has_holes_;
        is_textured_ |= nested->is_textured_;
        is_bumped_ |= nested->is_bumped_;
        two_sided_ |= nested->two_sided_;
        is_dispersive_ |= nested->is_dispersive_;
        is_coated_ |= nested->is_coated_;
        models_ += nested->models_;
        constant &= nested->constant_ != nullptr;
    };
    const auto vary = [&](const Texture& texture) {
        if (texture.constant()) return;
        is_textured_ = true;
        constant = false;
    };
    if (const auto* model = std::get_if<TexturedScattering>(&node_)) {
        traits_ = possible_traits(*model);
        is_dispersive_ = gib::is_dispersive(model->model);
        has_holes_ = std::holds_alternative<ThinDielectric>(model->model);
        models_ = 1;
        for (const auto& p : model->parameters)
            vary(p.texture);
    } else if (std::holds_alternative<Nothing>(node_)) {
        has_holes_ = true;
    } else if (const auto* blend = std::get_if<Blend>(&node_)) {
        nest(blend->first);
        nest(blend->second);
        vary(blend->weight);
    } else if (const auto* mask = std::get_if<Mask>(&node_)) {
        nest(mask->nested);
        vary(mask->opacity);
        has_holes_ |= mask->opacity.minimum().minCoeff() < 1.f;
    } else if (const auto* sides = std::get_if<TwoSided>(&node_)) {
        nest(sides->front);
        nest(sides->back);
        two_sided_ = true;
    } else if (const auto* coating = std::get_if<Coating>(&node_)) {
        nest(coating->surface);
        nest(coating->nested);
        vary(coating->absorption);
        if (two_sided_) models_ += coating->surface->models_;
        is_coated_ = true;
    } else {
        const auto* bump = std::get_if<BumpMap>(&node_);
        nest(bump ? bump->nested : std::get<NormalMap>(node_).nested);
        // At a point each model appears once for each of the two normals.
        if ((bump ? bump->options : std::get<NormalMap>(node_).options).flip_invalid_normals) models_ *= 2;
        is_bumped_ = true;
        constant = false;
    }
    if (models_ > Bsdf::max_layers) throw std::invalid_argument("a material of too many models");
    if (!constant) return;
    const MaterialPoint anywhere{.uv = Vec2::Zero(),
                                 .ng = Vec3::UnitZ(),
                                 .dp_du = Vec3::UnitX(),
                                 .dp_dv = Vec3::UnitY(),
                                 .shading = Frame(Vec3::UnitZ())};
    constant_ = std::make_shared<const Bsdf>(at(anywhere));
    if (!is_dispersive_) return;
    std::vector<Bsdf> strata;
    for (int stratum = 0; stratum < wavelength_strata; ++stratum)
        strata.push_back(at(anywhere, stratum));
    constant_strata_ = std::make_shared<const std::vector<Bsdf>>(std::move(strata));
}

Bsdf Material::at(const MaterialPoint& point, std::optional<int> stratum) const {
    Passage passage;
    passage.frame = point.shading;
    Layers layers(point, stratum);
    layers.add(*this, passage);
    return std::move(layers).bsdf();
}

}  // namespace gib
