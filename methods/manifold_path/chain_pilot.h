#pragma once
// Which kinds of chains a scene has, and which lamps are left to paths that hit them: decided by a pilot whose samples
// are not used, so that the image has no bias.

#include "methods/parts/manifold/chain_light.h"

namespace gib {

/// Sets the probabilities of the sampler's kinds and the number of samples at a point. With the light c of one sample
/// of kind k, without its probability, the variance S = (sum of sqrt(E[c^2]))^2 is least for q_k in proportion to
/// sqrt(E[c^2]). With s samples, the variance V of all other light of a path, and their cost of t paths each, (V + S /
/// s) (1 + s t) is least for s^2 = S / (V t). A lamp is made by chains if that promises a smaller squared error in the
/// same time than hits, whose E[c^2] comes from the same samples. The light of delta lights is made by nothing else.
/// Returns the number of rays of the pilot.
std::uint64_t learn_kinds(const Scene& scene, ChainSampler& chains, int max_edges);

}  // namespace gib
