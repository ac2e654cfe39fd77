#pragma once
// The state of a Markov chain in primary sample space: the random numbers of a path, which a chain keeps and perturbs.
// Source: Kelemen et al. 2002, "A Simple and Robust Mutation Strategy for the Metropolis Light Transport Algorithm",
// sections 3 and 4. Numbers that no path has asked for yet are worked out when one does (section 4.3).

#include "common/sampling/sampler.h"

#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gib {

class PrimarySample final : public NumberStore {
public:
    /// The first state has the numbers that hashes of `first` give; mutations take theirs from `mutations`.
    PrimarySample(std::uint64_t first, std::uint64_t mutations) : first_(first), mutations_(mutations) {}

    /// Proposes the next state: all numbers anew for a large step, else a small perturbation of each. It is to be
    /// accepted or rejected before the next one is proposed.
    void propose(bool is_large);
    void accept() { changed_.clear(); }
    void reject();

    EightFloats block(std::uint64_t path_key, std::uint32_t block) override;

private:
    struct Block {
        EightFloats numbers;
        std::uint32_t state;  ///< number of the accepted state that the numbers belong to
    };
    EightFloats hashed(std::uint64_t key, std::uint32_t step) const;

    std::uint64_t first_, mutations_;
    std::uint32_t trial_ = 0;  ///< number of proposals so far
    std::uint32_t state_ = 0;  ///< number of the current state: of accepted proposals, and one more during a proposal
    std::uint32_t last_large_ = 0, last_large_before_ = 0;
    std::unordered_map<std::uint64_t, Block> blocks_;
    /// Blocks as they were before the proposal; empty for those that it has made.
    std::vector<std::pair<std::uint64_t, std::optional<Block>>> changed_;
};

}  // namespace gib
