#pragma once
// The radiance that arrives in a scene, by place and direction, as paths have found it: a binary tree over space, with
// a quadtree over directions in each of its leaves (an "SD-tree"). Sources: Mueller, Gross and Novak 2017, "Practical
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

/// One direction that a path has followed, and what it found.
struct FollowedDirection {
    Vec3 p, wi;
    float radiance = 0.f;   ///< luminance of what arrives from wi, as one sample has found it [W/(sr m^2)]
    float reflected = 0.f;  ///< luminance of the same times f |cos| / pdf_w
    float pdf_w = 0.f;      ///< [1/sr] with which the path has chosen the direction
    float by_lobes = 0.f;   ///< [1/sr] of the bsdf or phase function alone
    float by_field = -1.f;  ///< [1/sr] of the field alone; negative: there was no choice
    bool delta = false;     ///< chosen by a delta lobe, whose direction tells nothing of the field
};

class RadianceField {
    /// A square of directions in four quadrants. Children stand behind their parents.
    struct Node {
        std::array<std::uint64_t, 4> sums{};      ///< [quantum] radiance / pdf_w, of quadrants without a child
        std::array<float, 4> shares{};            ///< of the node's flux, as the field has learned it
        std::array<std::uint32_t, 4> children{};  ///< 0: none
    };
    /// The probabilities among which each leaf chooses the one to follow the field.
    static constexpr std::array<float, 5> selections = {0.1f, 0.3f, 0.5f, 0.7f, 0.9f};
    /// A leaf of the tree over space.
    struct Leaf {
        std::uint32_t root = 0;
        float selection = 0.f;                                ///< probability to follow the field
        std::uint64_t count = 0;                              ///< directions recorded
        std::array<std::int64_t, selections.size()> gains{};  ///< [quantum] of the selections, see record()
    };

public:
    /// What the field knows about one place, until it learns again.
    class Distribution {
    public:
        struct Sample {
            Vec3 wi;
            float pdf_w;  ///< [1/sr]
        };

        Distribution(const std::vector<Node>& nodes, const Leaf& leaf) : nodes_(&nodes), leaf_(&leaf) {}
        /// The probability with which paths follow the field rather than the bsdf; 0 where no light is known.
        float selection() const { return leaf_->selection; }
        float pdf_w(const Vec3& wi) const;
        Sample sample(Vec2 u) const;

    private:
        const std::vector<Node>* nodes_;
        const Leaf* leaf_;
    };

    /// `unit` is a typical radiance of the scene [W/(sr m^2)], `memory` the limit [bytes] of all that is stored, also
    /// while it learns.
    RadianceField(const Bounds& bounds, double unit, double memory);

    Distribution at(const Vec3& p) const { return {nodes_, leaves_[cell_at(p).leaf]}; }
    /// Adds to the sums. `u` moves the place and the direction at random within the size of their cells, which blurs
    /// the field (Mueller 2019, section 2: spatio-directional filtering).
    void record(const FollowedDirection& followed, const VertexNumbers& u);
    /// Takes over what has been recorded since the last call, in `passes` passes, and refines both kinds of trees where
    /// much light has been found.
    void learn(double passes);

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
    struct Cell {
        std::uint32_t leaf;
        Vec3 size;  ///< [scene units]
    };

    Cell cell_at(const Vec3& p) const;
    void add_up();
    void split_crowded(double most);
    void rebuild(Leaf& leaf, std::size_t most_nodes);
    static float learned_selection(const Leaf& leaf);

    Vec3 corner_;
    float edge_;  ///< of the cube around the scene
    double quantum_;
    std::size_t most_nodes_;
    std::vector<Box> boxes_;
    std::vector<Leaf> leaves_;
    std::vector<Node> nodes_, rebuilt_;  ///< the second is empty unless it learns
};

}  // namespace gib
