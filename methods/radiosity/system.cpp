#include "methods/radiosity/system.h"

#include "common/core/parallel.h"

#include <algorithm>
#include <numbers>

namespace gib {

namespace {

constexpr std::size_t nodes_per_block = 1024;
/// The largest number of rounds of scaling; each about squares a small error.
constexpr int scaling_rounds = 40;
/// The largest distance of a row sum from 1 at which scaling ends.
constexpr double scaled_enough = 1e-7;

}  // namespace

RadiositySystem::RadiositySystem(const PatchMesh& mesh, const PatchLight& light, const std::vector<PatchLink>& links,
                                 bool is_closed)
    : mesh_(mesh),
      light_(light),
      is_closed_(is_closed),
      first_link_(mesh.nodes().size() + 1, 0),
      scales_(mesh.nodes().size(), 1.0) {
    sort_links(links);
    has_clusters_ = std::ranges::any_of(links, [&](const PatchLink& link) { return has_cluster(link.p, link.q); });
    const PatchColors sums = irradiance(ones());
    double whole = 0;
    for (const std::uint32_t leaf : leaves()) {
        const double distance = std::abs(sums[leaf][0] - 1);
        closure_.mean += area(leaf) * distance;
        closure_.largest = std::max(closure_.largest, distance);
        whole += area(leaf);
    }
    if (whole > 0) closure_.mean /= whole;
    if (is_closed) normalise_rows();
}

void RadiositySystem::sort_links(const std::vector<PatchLink>& links) {
    for (const PatchLink& link : links) {
        ++first_link_[link.p + 1];
        ++first_link_[link.q + 1];
    }
    for (std::size_t i = 1; i < first_link_.size(); ++i)
        first_link_[i] += first_link_[i - 1];
    links_.resize(first_link_.back());
    std::vector<std::size_t> next(first_link_.begin(), first_link_.end() - 1);
    for (const PatchLink& link : links) {
        links_[next[link.p]++] = {link.q, link.exchange, link.visible};
        links_[next[link.q]++] = {link.p, link.exchange, link.visible};
    }
}

/// Scales rows and columns alike by s, so that G stays symmetric, until all row sums of K are 1.
void RadiositySystem::normalise_rows() {
    for (int round = 0; round < scaling_rounds; ++round) {
        const PatchColors sums = irradiance(ones());
        double worst = 0;
        for (const std::uint32_t leaf : leaves()) {
            if (!(sums[leaf][0] > 0)) continue;  // the patch sees nothing
            scales_[leaf] /= std::sqrt(sums[leaf][0]);
            worst = std::max(worst, std::abs(sums[leaf][0] - 1));
        }
        if (worst < scaled_enough) break;
    }
}

PatchColors RadiositySystem::irradiance(PatchColors X) const {
    const auto& nodes = mesh_.nodes();
    for (const std::uint32_t leaf : leaves())
        X[leaf] *= scales_[leaf];
    pull(X);
    PatchColors E = gathered(X);
    for (std::size_t i = 1; i < node_count(); ++i)  // push
        E[i] += E[nodes[i].parent];
    for (const std::uint32_t leaf : leaves())
        E[leaf] *= scales_[leaf];
    return E;
}

bool RadiositySystem::has_cluster(std::uint32_t p, std::uint32_t q) const {
    return mesh_.nodes()[p].is_cluster() || mesh_.nodes()[q].is_cluster();
}

Vec3d RadiositySystem::direction(std::uint32_t from, std::uint32_t to) const {
    return (mesh_.nodes()[to].center - mesh_.nodes()[from].center).normalized();
}

/// The radiosity of a group is the mean over its halves, weighted by area.
void RadiositySystem::pull(PatchColors& X) const {
    for (std::size_t i = node_count(); i-- > 0;)
        if (const std::uint32_t a = mesh_.nodes()[i].child; a != no_node)
            X[i] = (area(a) * X[a] + area(a + 1) * X[a + 1]) / (area(a) + area(a + 1));
}

/// Gather of Hanrahan et al. 1991: E_p = sum of F_pq X_q over the links of each node p. What arrives at a cluster is
/// received by the roots of its sides, with their cosines.
PatchColors RadiositySystem::gathered(const PatchColors& X) const {
    const auto& nodes = mesh_.nodes();
    const PatchColors sent = sent_over_clusters(X);
    PatchColors E(node_count(), Colord::Zero());
    parallel_blocks(node_count(), nodes_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
            if (nodes[i].is_cluster()) continue;
            const auto gather = [&](std::uint32_t node) {
                for (std::size_t n = first_link_[node]; n < first_link_[node + 1]; ++n) {
                    const auto exchange = static_cast<double>(links_[n].exchange);
                    if (!has_cluster(node, links_[n].other)) {
                        E[i] += exchange / area(i) * X[links_[n].other];
                        continue;
                    }
                    const double cosine = nodes[i].polygon.normal.dot(direction(node, links_[n].other));
                    if (cosine > 0) E[i] += exchange * cosine * sent[n];
                }
            };
            gather(i);
            for (std::uint32_t above = nodes[i].parent; above != no_node && nodes[above].is_cluster();
                 above = nodes[above].parent)
                gather(above);
        }
    });
    return E;
}

PatchColors RadiositySystem::irradiance_at_centres(PatchColors X) const {
    PatchColors E = gathered_at_centres(std::move(X));
    if (!is_closed_) return E;
    // In a closed scene all of the hemisphere is seen.
    const PatchColors sums = gathered_at_centres(ones());
    for (const std::uint32_t leaf : leaves())
        if (sums[leaf][0] > 0) E[leaf] /= sums[leaf];
    return E;
}

PatchColors RadiositySystem::gathered_at_centres(PatchColors X) const {
    const auto& nodes = mesh_.nodes();
    pull(X);
    const PatchColors sent = sent_over_clusters(X);
    PatchColors E(node_count(), Colord::Zero());
    parallel_blocks(leaves().size(), nodes_per_block / 16, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t k = begin; k < end; ++k) {
            const std::uint32_t leaf = leaves()[k];
            const Vec3d &x = nodes[leaf].center, &normal = nodes[leaf].polygon.normal;
            for (std::uint32_t node = leaf; node != no_node; node = nodes[node].parent)
                for (std::size_t n = first_link_[node]; n < first_link_[node + 1]; ++n) {
                    const PatchNode& other = nodes[links_[n].other];
                    const auto visible = static_cast<double>(links_[n].visible);
                    if (other.is_cluster()) {
                        const Vec3d way = other.center - x;
                        const double cosine = normal.dot(way.normalized());
                        if (cosine > 0) E[leaf] += visible * cosine / (std::numbers::pi * way.squaredNorm()) * sent[n];
                    } else if (node == leaf && other.is_leaf()) {
                        E[leaf] += static_cast<double>(links_[n].exchange) / area(leaf) * X[links_[n].other];
                    } else {
                        E[leaf] += visible * area(links_[n].other) / other.area *
                                   point_form_factor(x, normal, other.polygon) * X[links_[n].other];
                    }
                }
        }
    });
    return E;
}

/// By entry of `links_`: what the other end sends if one of the two is a cluster [W]; else 0. Empty if none is.
PatchColors RadiositySystem::sent_over_clusters(const PatchColors& X) const {
    if (!has_clusters_) return {};
    PatchColors sent(links_.size(), Colord::Zero());
    parallel_blocks(node_count(), nodes_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i)
            for (std::size_t n = first_link_[i]; n < first_link_[i + 1]; ++n)
                if (has_cluster(i, links_[n].other))
                    sent[n] = sent_towards(links_[n].other, direction(links_[n].other, i), X);
    });
    return sent;
}

/// The sum over the sides of a node of their radiosity times the area that they show in the direction w [W].
Colord RadiositySystem::sent_towards(std::uint32_t node, const Vec3d& w, const PatchColors& X) const {
    const auto& nodes = mesh_.nodes();
    const auto sent_by = [&](std::uint32_t patch) -> Colord {
        return std::max(0.0, nodes[patch].polygon.normal.dot(w)) * area(patch) * X[patch];
    };
    if (!nodes[node].is_cluster()) return sent_by(node);
    Colord sum = Colord::Zero();
    for (std::uint32_t side = nodes[node].side; side < nodes[node].side_end; ++side)
        sum += sent_by(mesh_.sides()[side].root);
    return sum;
}

Colord RadiositySystem::power(const PatchColors& values) const {
    Colord sum = Colord::Zero();
    for (const std::uint32_t leaf : leaves())
        sum += area(leaf) * values[leaf].abs();
    return sum;
}

}  // namespace gib
