#pragma once
// The choice of one of many lights for a point that they may light, by what each of them can do there. Source: Conty
// Estevez and Kulla 2018 (importance sampling of many lights with adaptive tree splitting).
//
// Every light has a bound: a ball from which it shines, a cone of directions, and a peak intensity [W/sr]. Its
// importance at p is an irradiance [W/m^2] without regard to surfaces in between,
//     I f(theta') / max(d^2, r^2),
// where d is the distance to the ball's centre, r the ball's radius, theta' the least angle that the direction to p can
// make with the light's cone, from anywhere in the ball, and f the cone's fall: for surfaces the cosine. It is 0 if the
// ball lies behind the surface at p. Lights at infinity have an importance that is the same everywhere, on surfaces
// that face them. The others are the leaves of a binary tree, whose nodes bound those below. A node's child is chosen
// in proportion to its importance, so that a choice costs the logarithm of the number of lights, as its probability
// does.
//
// Surfaces may hide what is important. A share of the choices is therefore even: among the lights at infinity and the
// tree as a whole, and among the lights of the tree.

#include "common/lights/light.h"

namespace gib {

/// A point that lights may light: in a medium from all sides, or on a surface from one side.
struct LitPoint {
    /// `towards` is a normal of the side from which light counts [unit]; zero: light from all sides counts.
    LitPoint(const Vec3& point, const Vec3& towards = Vec3::Zero()) : p(point), side(towards) {}

    Vec3 p, side;
};

/// The directions in which a light, or a group of lights, shines.
struct EmissionCone {
    EmissionCone() = default;
    EmissionCone(const Vec3d& along, double theta_o, double theta_e);

    Vec3d axis = Vec3d(0, 0, 1);
    double spread = 0;  ///< theta_o [rad]: the axes of emission are within this angle of `axis`
    /// theta_e [rad]: emission falls beyond the spread and ends at this angle. A right angle is that of a surface, whose
    /// emission is the cosine; a smaller one is that of a spot, whose emission falls linearly in the angle.
    double fall = 0;
    double cos_spread = 1, sin_spread = 0, cos_fall = 1;

    /// The integral over all directions [sr] of a profile that is 1 within the spread and falls linearly in the cosine.
    double solid_angle() const;
};
/// A cone that holds both.
EmissionCone united(const EmissionCone& a, const EmissionCone& b);

/// A bound of what a light, or a group of lights, sends to a point.
struct LightBounds {
    Vec3d center = Vec3d::Zero();
    double radius = 0;
    EmissionCone cone;
    double intensity = 0;  ///< peak [W/sr], mean of the channels

    /// The importance at the point [W/m^2]; 0 only if none of this light reaches it.
    double importance(const LitPoint& at) const;
};

/// The bound of a light that is not at infinity.
LightBounds bounds_of(const Light& light, const std::vector<Shape>& shapes);
/// A bound of what both bounds allow.
LightBounds united(const LightBounds& a, const LightBounds& b);

class LightTree {
public:
    /// Not ready for any call.
    LightTree() = default;
    LightTree(const std::vector<Light>& lights, const std::vector<Shape>& shapes);

    struct Choice {
        std::uint32_t light;
        float probability;
    };
    /// Whether there are several lights to choose from. If not, only the position of a LitPoint takes part.
    bool chooses() const { return !only_; }
    std::uint32_t only() const { return *only_; }
    /// Chooses a light by u in [0, 1). Empty if no light was found that can reach the point: that sample is 0.
    std::optional<Choice> choose(const LitPoint& at, float u) const {
        if (only_) return Choice{*only_, 1.f};
        return choose_of_several(at, u);
    }
    /// The probability with which choose() returns the light.
    float probability(const LitPoint& at, std::uint32_t light) const;

private:
    static constexpr std::uint32_t none = ~0u;
    struct Node {
        LightBounds bounds;
        std::uint32_t parent;
        std::uint32_t child;  ///< the first of two, one after the other; none: the node is a leaf
        std::uint32_t light;  ///< index of a leaf's light
    };
    /// A light at infinity with its irradiance [W/m^2] across its direction; of an environment, the mean over all
    /// orientations of a surface's front, a quarter of the integral of its radiance.
    struct Distant {
        std::uint32_t light;
        double irradiance;
        Vec3 direction;  ///< direction in which the light travels; zero for an environment

        double importance(const LitPoint& at) const { return at.side.dot(direction) > 0 ? 0 : irradiance; }
    };

    std::optional<Choice> choose_of_several(const LitPoint& at, float u) const;
    struct Leaf;
    void build(std::vector<Leaf>& leaves, std::size_t begin, std::size_t end, std::uint32_t node);
    static std::size_t split(std::vector<Leaf>& leaves, std::size_t begin, std::size_t end);
    /// The probability of choosing the tree or a distant light of this irradiance, out of all of them.
    double share(double importance, double sum) const;
    double importance_of_tree(const LitPoint& at) const { return nodes_.empty() ? 0 : nodes_[0].bounds.importance(at); }
    double importance_of_all(const LitPoint& at) const;
    std::optional<std::uint32_t> descend(const LitPoint& at, double u) const;
    double probability_in_tree(const LitPoint& at, std::uint32_t light) const;

    std::optional<std::uint32_t> only_;  ///< the light, if there is no other
    std::vector<Distant> distant_;
    std::vector<Node> nodes_;
    std::vector<std::uint32_t> finite_;   ///< the lights of the tree
    std::vector<std::uint32_t> leaf_of_;  ///< the node of each light; none: it is at infinity or black
};

}  // namespace gib
