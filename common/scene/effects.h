#pragma once
// The effects of light transport that a scene calls for. The analysis looks at materials, lights and shapes, never at
// sampled rays. It is conservative: it may name an effect that no path shows, but it never leaves one out.

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace gib {

class Scene;

enum class Effect {
    direct_light,
    diffuse_interreflection,
    specular_reflection,
    refraction,
    caustics,
    glossy_lobes,
    participating_media,
    dispersion,
    textures,
    bump_maps,
    smooth_normals,
    depth_of_field,
    environment_light
};

struct EffectDescription {
    Effect effect;
    std::string_view name;
    std::string_view sentence;
};
/// All effects, in the order in which they are listed everywhere.
const std::vector<EffectDescription>& effect_descriptions();
std::string_view name_of(Effect effect);

/// A set of effects.
class Effects {
public:
    Effects() = default;
    Effects(std::initializer_list<Effect> effects) {
        for (Effect e : effects)
            add(e);
    }
    static Effects all();
    void add(Effect e) { bits_ |= bit(e); }
    bool empty() const { return bits_ == 0; }
    bool has(Effect e) const { return (bits_ & bit(e)) != 0; }
    /// The effects of the set, in the order of effect_descriptions().
    std::vector<Effect> list() const;
    /// The names of these effects in the same order, with `;` between them.
    std::string names() const;
    friend Effects operator|(Effects a, Effects b) { return Effects(a.bits_ | b.bits_); }
    friend Effects operator&(Effects a, Effects b) { return Effects(a.bits_ & b.bits_); }
    friend Effects operator-(Effects a, Effects b) { return Effects(a.bits_ & ~b.bits_); }
    friend bool operator==(Effects, Effects) = default;

private:
    explicit Effects(unsigned bits) : bits_(bits) {}
    static unsigned bit(Effect e) { return 1u << static_cast<unsigned>(e); }
    unsigned bits_ = 0;
};

Effects effects_of(const Scene& scene);

}  // namespace gib
