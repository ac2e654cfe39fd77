#pragma once
// The five components into which an image is split by the class of its light paths. Classes are regular expressions
// in Heckbert's notation, read from the eye: E eye, L light, S specular vertex, D diffuse vertex.

#include <array>
#include <optional>
#include <string_view>

namespace gib {

enum class Component { emission, direct, caustic, indirect, volume };
inline constexpr int component_count = 5;
inline constexpr std::array<Component, component_count> all_components = {
    Component::emission, Component::direct, Component::caustic, Component::indirect, Component::volume};
inline constexpr std::array<std::string_view, component_count> component_names = {"emission", "direct", "caustic",
                                                                                  "indirect", "volume"};

inline std::string_view name_of(Component c) { return component_names[static_cast<int>(c)]; }
inline int index_of(Component c) { return static_cast<int>(c); }
inline std::optional<Component> component_named(std::string_view name) {
    for (Component c : all_components)
        if (name_of(c) == name) return c;
    return std::nullopt;
}

/// How a vertex scattered: S (specular) or D (diffuse). A lobe rougher than glossy_roughness counts as diffuse, any
/// other as specular.
enum class LobeKind { diffuse, specular };
inline constexpr float glossy_roughness = 0.1f;

/// The properties of a path, seen from the eye, that decide its component. All methods use this one rule, so that no
/// path is counted in two components.
struct PathClass {
    int diffuse_vertices = 0;             ///< D vertices so far
    bool specular_since_diffuse = false;  ///< an S vertex after the last D (or after the eye)
    bool in_medium = false;               ///< a vertex so far lies in a medium

    void scatter(LobeKind kind) {
        if (kind == LobeKind::diffuse) {
            ++diffuse_vertices;
            specular_since_diffuse = false;
        } else {
            specular_since_diffuse = true;
        }
    }
    /// The component of the path if it ends on a light now: volume if a vertex lies in a medium, otherwise emission
    /// E S* L, direct E S* D L, caustic E S* D S+ L or indirect E S* D (S* D)+ S* L.
    Component component() const {
        if (in_medium) return Component::volume;
        if (diffuse_vertices == 0) return Component::emission;
        if (diffuse_vertices > 1) return Component::indirect;
        return specular_since_diffuse ? Component::caustic : Component::direct;
    }
    /// The class of a path that has this vertex before all others, for paths that are built from the light.
    PathClass preceded_by(LobeKind kind) const {
        PathClass first;
        first.scatter(kind);
        return first.followed_by(*this);
    }
    /// The class of this path and, after its last vertex, the vertices of `rest`.
    PathClass followed_by(const PathClass& rest) const {
        return {diffuse_vertices + rest.diffuse_vertices,
                rest.specular_since_diffuse || (rest.diffuse_vertices == 0 && specular_since_diffuse),
                in_medium || rest.in_medium};
    }
    PathClass after(LobeKind kind) const {
        PathClass next = *this;
        next.scatter(kind);
        return next;
    }
};

}  // namespace gib
