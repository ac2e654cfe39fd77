#pragma once
// Which kinds of chains a scene has, and which lamps are left to paths that hit them: decided by a pilot whose samples are not
// used, so that the image has no bias.

#include "methods/parts/manifold/chain_light.h"

namespace gib {

/// Sets the probabilities of the sampler's kinds. With the light c of one sample of kind k, without its probability, the variance
/// is least for q_k in proportion to sqrt(E[c^2]). A lamp is made by chains if that promises a smaller squared error in the
/// same time: the same samples tell E[c^2] of paths that hit the lamp by chance, c^2 pdf_chains / pdf_hits. The light of delta
/// lights is made by nothing else. Returns the number of rays of the pilot.
std::uint64_t learn_kinds(const Scene& scene, ChainSampler& chains, int max_edges);

}  // namespace gib
