#pragma once
// The state of a Markov chain in primary sample space: the random numbers of a path, which a chain keeps and perturbs.
// Source: Kelemen et al. 2002, "A Simple and Robust Mutation Strategy for the Metropolis Light Transport Algorithm",
// sections 3 and 4. Numbers that no path has asked for yet are worked out when one does (section 4.3).

#include "common/sampling/sampler.h"

#include <vector>

namespace gib {

class PrimarySample final : public NumberStore {
public:
    /// Starts another chain, in the memory of the last one.
    void restart();
    /// Proposes the next state: all numbers anew for a large step, else a small perturbation of each. It is to be
    /// accepted or rejected before the next one is proposed. Both take what they need from the fresh numbers, which must differ
    /// between proposals.
    void propose(bool is_large);
    void accept() { changed_.clear(); }
    void reject();

    EightFloats block(std::uint64_t path_key, std::uint32_t block, const EightFloats& fresh) override;

private:
    struct Block {
        EightFloats numbers;
        std::uint64_t key;
        std::uint32_t state;  ///< number of the accepted state that the numbers belong to; 0: none
    };
    /// The block of this key in the table, or the empty place for it.
    Block& find(std::uint64_t key);
    void grow();

    std::uint32_t state_ = 1;  ///< number of the current state: of accepted proposals, and one more during a proposal
    std::uint32_t last_large_ = 1, last_large_before_ = 1;
    std::vector<Block> table_ = std::vector<Block>(64);  ///< by hash, a power of two; a block without a key is empty
    std::size_t used_ = 0;
    std::vector<Block> changed_;  ///< blocks as they were before the proposal
};

}  // namespace gib
