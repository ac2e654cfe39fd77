#pragma once
// Tests whether the reference methods agree, in every component over blocks of 8 x 8 and 64 x 64 pixels and the whole
// image (z_statistic.h). Only the means over the blocks of 8 x 8 pixels are kept.
//
// Evidence that a reference lacks light: an unbiased method finds more of it than the noise of both explains. Less
// light is no evidence, because a method that has not met rare bright paths yet is too dark and seems to have no noise.

#include "common/images/image.h"
#include "experiments/metrics/z_statistic.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gib {

enum class Differing { either_way, brighter };

/// The most significant difference of x from r, among blocks of `edge` and 8 `edge` pixels and the whole, or, with
/// `brighter`, among those where x is brighter; empty if none is significant. If x and r are equal but for noise, there
/// is one with a probability of `alpha` at most.
std::optional<BlockTest> significant_difference(const ReferenceLayer& x, const ReferenceLayer& r, double alpha,
                                                Differing differing, int edge = z_block_edge);

/// Place and size of a difference, such as "pixels x 0 to 7, y 8 to 15: 0.1 more, 5.3 standard errors".
std::string text_of(const BlockTest& difference);

struct Contradiction {
    Component component;
    bool is_black = false;  ///< the reference's component is black, and images of the method have light in it
    BlockTest where;        ///< the region, if not black; the deviation is that of the method

    /// Such as "light of caustic, which the reference lacks (pixels ...)".
    std::string text() const;
};

inline constexpr int agreement_edge = 8;  ///< [pixels]

/// The means over blocks of pixels.
Image block_means(const Image& image);
ComponentImages block_means(const ComponentImages& images);

/// The most significant difference between two sets of groups, which hold block means, about a component; empty if
/// there is none. Its place is in blocks.
std::optional<BlockTest> disagreement(const std::vector<ComponentImages>& a, const std::vector<ComponentImages>& b,
                                      Component c, double alpha, Differing differing);

/// A difference in a component between two reference methods, or between the pilot of one and the finished reference.
struct Disagreement {
    Component component;
    std::size_t a = 0, b = 0;  ///< the methods; b = a for a pilot
    BlockTest where;           ///< place in pixels; the deviation is that of a from b, or from the reference

    /// The method that has found less light.
    std::size_t lesser() const { return where.deviation < 0 ? a : b; }
    std::size_t greater() const { return where.deviation < 0 ? b : a; }
};

class MethodAgreement {
public:
    explicit MethodAgreement(std::size_t methods) : pilots_(methods), groups_(methods), passes_(methods, 0) {}
    bool has_pilots() const { return !pilots_.empty() && !pilots_.front().empty(); }
    /// Keeps the groups of a method's pilot.
    void set_pilot(std::size_t method, const std::vector<ComponentImages>& groups);
    /// Adds the images of all groups of a method, each of `passes` passes.
    void add(std::size_t method, const std::vector<ComponentImages>& groups, std::uint32_t passes);
    /// Forgets all images but the pilots'.
    void restart();
    /// Writes all images to a file beside the reference, and reads them again, so that tests find the same whichever
    /// process has made which round. `state` is that of the reference; a file of another state, or a damaged one, is
    /// not read.
    void write(const std::string& path, const std::string& state) const;
    void read(const std::string& path, const std::string& state);

    /// The disagreements between methods about the components that both sample (`samples(method, component)`). All
    /// tests of a round together reject methods that agree with a probability of at most 0.1 %.
    template <typename Samples>
    std::vector<Disagreement> between_methods(const Samples& samples) const {
        std::vector<Disagreement> pairs;
        for (Component c : all_components)
            for (std::size_t a = 0; a < groups_.size(); ++a)
                for (std::size_t b = a + 1; b < groups_.size(); ++b)
                    if (holds(groups_[a], c) && holds(groups_[b], c) && samples(a, c) && samples(b, c))
                        pairs.push_back({c, a, b, {}});
        return tested(std::move(pairs), nullptr);
    }
    /// The light that pilots have found and the groups of the finished reference lack, also of methods that sample a
    /// component incompletely.
    std::vector<Disagreement> with_pilots(const std::vector<ComponentImages>& reference) const {
        std::vector<Disagreement> pairs;
        for (Component c : all_components)
            for (std::size_t m = 0; m < pilots_.size(); ++m)
                if (holds(pilots_[m], c)) pairs.push_back({c, m, m, {}});
        return tested(std::move(pairs), &reference);
    }

private:
    static bool holds(const std::vector<ComponentImages>& groups, Component c) {
        return !groups.empty() && groups.front()[c];
    }
    /// The pairs that disagree; with the reference if there is one.
    std::vector<Disagreement> tested(std::vector<Disagreement> pairs,
                                     const std::vector<ComponentImages>* reference) const;

    std::vector<std::vector<ComponentImages>> pilots_, groups_;  ///< by method, the mean of each group over blocks
    std::vector<std::uint64_t> passes_;
    Grid pixels_;  ///< the pixels of each block
};

/// The components of a reference that images of a method contradict: every one that is black there and lit in an image;
/// and every one of `unbiased_for`, for which the method is unbiased, where it is significantly brighter. Components
/// that the reference lacks anyway are left out. The second kind needs two replicates.
std::vector<Contradiction> contradictions(const Reference& reference, const std::vector<ComponentImages>& replicates,
                                          const std::vector<Component>& unbiased_for);

}  // namespace gib
