#pragma once
// Which kinds of chains a scene has, and which lamps are left to paths that hit them: decided by a pilot whose samples
// are not used, so that the image has no bias.

#include "methods/parts/manifold/chain_light.h"

namespace gib {

/// Sets the sampler's weights. Photons first: the kinds of the chains by which they reach surfaces, in proportion to the
/// roots of their power, are the first guess of the probabilities. Then paths. With the light c of one search for kind k,
/// without its probability, the variance A = (sum of sqrt(E[c^2]))^2 of the searches of a table is least for q_k in
/// proportion to sqrt(E[c^2]). With u samples of a light at a point and v_t searches of its table t, the straight lines'
/// variance A_0, and that of all other light V, the variance times time
///     (V + A_0 / u + sum of A_t / v_t) (1 + u t_0 + sum of v_t t_t)
/// is least where the share of each part in the variance is its share in the time. A lamp is made by chains if that
/// promises a smaller squared error in the same time than hits: the same samples estimate E[c^2] of these. The light of
/// delta lights is made by nothing else. Returns the number of rays of the pilot.
std::uint64_t learn_kinds(const Scene& scene, ChainSampler& chains, int max_edges);

}  // namespace gib
