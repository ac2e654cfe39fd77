#pragma once
// The light that arrives in a scene, by place and direction, as paths have found it: a binary tree over space, with a
// quadtree over directions in each of its leaves (an "SD-tree"). Sources: Mueller, Gross and Novak 2017, "Practical
// Path Guiding for Efficient Light-Transport Simulation"; Mueller 2019, "Practical Path Guiding in Production".
//
// All sums are in fixed point, so that they do not depend on the order of the additions. Between two calls of learn() the
// distributions stay as they are, and any thread may add to the sums.

#include "common/core/math.h"
#include "common/sampling/sampler.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gib {

class RadianceField {
    /// A square of directions in four quadrants. Children stand behind their parents.
    struct Node {
        std::array<float, 4> shares{};            ///< of the node's light, as the field has learned it
        std::array<std::uint32_t, 4> children{};  ///< 0: none
    };
    using Sums =
        std::array<std::uint64_t, 4>;  ///< [quantum] of a node's quadrants; for those with a child after add_up()
    /// A leaf of the tree over space.
    struct Leaf {
        std::uint32_t root = 0;
        float selection = 0.f, reflected = 0.f, indirect = 0.f;  ///< see Distribution
        std::uint64_t visits = 0;
        std::uint64_t sum_of_reflected = 0, sum_of_indirect = 0;  ///< [quantum] over the visits
    };

public:
    /// A place of a path, and the cell of space around it.
    struct Place {
        Vec3 p;
        Vec3 normal;  ///< of the surface, on the side of the path; zero in media
        std::uint32_t leaf = 0;
        Vec3 size;  ///< of the cell [scene units]
    };

    /// The field's knowledge of one place, until it learns again.
    class Distribution {
    public:
        struct Sample {
            Vec3 wi;
            float pdf_w;  ///< [1/sr]
        };

        Distribution(const std::vector<Node>& nodes, const Leaf& leaf) : nodes_(&nodes), leaf_(&leaf) {}
        /// The probability with which paths follow the field rather than the bsdf; 0 where no light is known.
        float selection() const { return leaf_->selection; }
        /// Mean radiance that surfaces here reflect, or media scatter: all, and what is left of it without light that has come
        /// straight from lights and was sampled there [W/(sr m^2)], luminance; 0 if it is not known.
        float reflected() const { return leaf_->reflected; }
        float indirect() const { return leaf_->indirect; }
        /// In proportion to the radiance from wi, times the cosine at surfaces [1/sr].
        float pdf_w(const Vec3& wi) const;
        Sample sample(Vec2 u) const;

    private:
        const std::vector<Node>* nodes_;
        const Leaf* leaf_;
    };

    /// `unit` is a typical radiance of the scene [W/(sr m^2)], `memory` the limit [bytes] of all that is stored, also
    /// while it learns.
    /// The light of leaves with fewer visits than `fewest` counts as unknown.
    RadianceField(const Bounds& bounds, double unit, double memory, std::uint64_t fewest = 256);

    Place place(const Vec3& p, const Vec3& normal) const;
    Distribution at(const Place& place) const { return {nodes_, leaves_[place.leaf]}; }

    /// Adds that a path has found this light in the direction wi: the radiance, times the cosine at a surface, over the density
    /// with which the path had chosen wi [W/m^2], luminance. `u` moves the place and the direction at random within the size
    /// of their cells, which blurs the field (Mueller 2019, section 2: spatio-directional filtering).
    void record(const Place& place, const Vec3& wi, double light, const VertexNumbers& u);
    /// Adds that a path has found this light, reflected here; see Distribution.
    void visit(const Place& place, double reflected, double indirect);
    /// Takes over what has been recorded since the last call. Cuts leaves with more than `crowd` visits, and quadrants with much
    /// light.
    void learn(double crowd);

    /// The share of the paths that came to places with concentrated light, as the field has learned it last. The density of
    /// directions in proportion to what is known there has a mean, over these directions, of more than 12 / (4 pi) [1/sr]; of the
    /// cosine alone, under an even sky, it is 8/3 / (4 pi).
    double concentrated_share() const { return concentrated_share_; }
    std::size_t leaf_count() const { return leaves_.size(); }
    std::size_t node_count() const { return nodes_.size(); }
    /// The memory that it has reserved.
    double bytes() const;

private:
    /// A box of the tree over space, which is cut into halves or is a leaf.
    struct Box {
        std::uint32_t children = 0;  ///< index of the first of two; 0: none
        std::uint32_t leaf = 0;
    };

    void add_up();
    void split_crowded(double most);
    double rebuild(Leaf& leaf, std::size_t most_nodes);

    Vec3 corner_;
    float edge_;  ///< of the cube around the scene
    double concentrated_share_ = 0;
    double quantum_;
    std::uint64_t fewest_visits_;
    std::size_t most_nodes_;
    std::vector<Box> boxes_;
    std::vector<Leaf> leaves_;
    std::vector<Sums> sums_;
    std::vector<Node> nodes_, rebuilt_;  ///< the second is empty unless it learns
};

}  // namespace gib
