#pragma once
// Light path vertices shared by a group of pixels: the first vertex of a camera's walk is connected with vertices of
// the light paths of all pixels of its group, which gives a pixel more light paths at few more rays. Source: Popov et
// al. 2015, "Probabilistic Connections for Bidirectional Path Tracing".
//
// Let c(z, v) be what the connection of z, the first vertex of a camera's walk that can be joined, with the vertex v of a light
// path makes. A walk that has a light path of its own takes the sum of c(z, v) over the vertices of this path. Here the group has
// n light paths, whose mean it is to take, over all V vertices of the n paths. `picks` of them estimate it:
//
//   1/n sum over v of c(z, v)  =  E[ 1 / (n picks) sum over k of c(z, v_k) / q(v_k) ],   v_k of probability q.
//
// q is one half uniform, and one half in proportion to what the vertices gave to the walks that have been connected with all of
// them, which every eighth walk is: that also says which vertices are hidden, as q by the unoccluded light would not (in
// door-ajar that made the variance larger). q depends on earlier walks alone, so the estimate has no bias. The weights
// of techniques take a connection there for `first_samples` independent ones (technique_sums.h).

#include "common/sampling/sampler.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

namespace gib {

template <typename Vertex>
class SharedVertices {
public:
    /// The next group begins.
    void clear() {
        vertices_.clear();
        begins_.clear();
        walks_ = 0;
    }
    void begin_path() { begins_.push_back(vertices_.size()); }
    /// A vertex of the present light path.
    void add(const Vertex& vertex) { vertices_.push_back(vertex); }

    /// The vertices of light path i.
    std::span<const Vertex> path(std::size_t i) const {
        const std::size_t end = i + 1 < begins_.size() ? begins_[i + 1] : vertices_.size();
        return std::span(vertices_).subspan(begins_[i], end - begins_[i]);
    }

    /// The next walk of the group comes to its first vertex. Calls join(v, factor) for vertices v: what their connections make
    /// times `factor` is the walk's estimate. join() returns the size of what the connection makes without this factor.
    template <typename Join>
    void join_first(NumberStream& u, Join&& join) {
        const std::size_t count = vertices_.size();
        if (count == 0) return;
        const double share = 1 / static_cast<double>(begins_.size());
        if (walks_++ % walks_per_survey == 0) {
            if (walks_ == 1) given_.assign(count, 0.0);
            for (std::size_t v = 0; v < count; ++v)
                if (const double size = join(vertices_[v], share); std::isfinite(size)) given_[v] += size;
            sums_.resize(count);
            std::partial_sum(given_.begin(), given_.end(), sums_.begin());
            return;
        }
        const double all = sums_.back(), uniform = all > 0 ? 0.5 : 1;
        const double first = double{u.next()};
        for (int k = 0; k < picks; ++k) {
            // Stratified: below `uniform` all vertices lie side by side, above it each takes what it has given.
            const double at = (k + first) / picks;
            const std::size_t v = at < uniform ? static_cast<std::size_t>(at / uniform * static_cast<double>(count))
                                               : index_at((at - uniform) / (1 - uniform) * all);
            const double q = uniform / static_cast<double>(count) + (all > 0 ? (1 - uniform) * given_[v] / all : 0);
            join(vertices_[v], share / (picks * q));
        }
    }

private:
    // Measured in door-ajar, lamp-in-shade and cornell-box (experiments/STUDIES.md).
    static constexpr std::size_t walks_per_survey = 8;
    static constexpr int picks = 3;

    std::size_t index_at(double sum) const {
        const auto after = std::upper_bound(sums_.begin(), sums_.end(), sum);
        return static_cast<std::size_t>(std::min(after, sums_.end() - 1) - sums_.begin());
    }

    std::vector<Vertex> vertices_;
    std::vector<std::size_t> begins_;   ///< the first vertex of each light path
    std::size_t walks_ = 0;             ///< that came to a first vertex in this group
    std::vector<double> given_, sums_;  ///< by vertex, in the surveys so far, and sums up to each
};

}  // namespace gib
