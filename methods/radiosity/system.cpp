#include "methods/radiosity/system.h"

#include "common/core/parallel.h"

#include <algorithm>

namespace gib {

namespace {

constexpr std::size_t nodes_per_block = 1024;
/// The largest number of rounds of scaling; each about squares a small error.
constexpr int scaling_rounds = 40;
/// The largest distance of a row sum from 1 at which scaling ends.
constexpr double scaled_enough = 1e-7;

}  // namespace

RadiositySystem::RadiositySystem(const PatchMesh& mesh, const PatchLight& light, const std::vector<PatchLink>& links,
                                 bool normalise)
    : mesh_(mesh), light_(light), table_(links, mesh.nodes()) {
    for (const PatchNode& node : mesh.nodes()) {
        if (node.is_leaf()) leaves_.push_back(static_cast<std::uint32_t>(children_.size()));
        children_.push_back(node.child);
    }
    const std::vector<double> sums = row_sums();
    double whole = 0;
    for (const std::uint32_t leaf : leaves_) {
        const double distance = std::abs(sums[leaf] - 1);
        closure_.mean += area(leaf) * distance;
        closure_.largest = std::max(closure_.largest, distance);
        whole += area(leaf);
    }
    if (whole > 0) closure_.mean /= whole;
    if (normalise) normalise_rows();
}

std::vector<double> RadiositySystem::row_sums() const {
    const PatchColors E = irradiance(PatchColors(node_count(), Colord::Ones()));
    std::vector<double> sums(node_count(), 0.0);
    for (const std::uint32_t leaf : leaves_)
        sums[leaf] = E[leaf][0];
    return sums;
}

/// Scales rows and columns alike by s, so that G stays symmetric, until all row sums of K are 1.
void RadiositySystem::normalise_rows() {
    scales_.assign(node_count(), 1.0);
    for (int round = 0; round < scaling_rounds; ++round) {
        const std::vector<double> sums = row_sums();
        double worst = 0;
        for (const std::uint32_t leaf : leaves_) {
            if (!(sums[leaf] > 0)) continue;  // the patch sees nothing
            scales_[leaf] /= std::sqrt(sums[leaf]);
            worst = std::max(worst, std::abs(sums[leaf] - 1));
        }
        if (worst < scaled_enough) break;
    }
}

/// Hanrahan et al. 1991: values are pulled up from the leaves to the groups.
void RadiositySystem::pull(PatchColors& X) const {
    for (std::size_t i = node_count(); i-- > 0;) {
        const std::uint32_t a = children_[i];
        if (a != no_node) X[i] = (area(a) * X[a] + area(a + 1) * X[a + 1]) / (area(a) + area(a + 1));
    }
}

PatchColors RadiositySystem::sent(const LinkTable& links, const PatchColors& X) const {
    const auto& nodes = mesh_.nodes();
    struct Side {
        Vec3d area;  ///< along the normal
        Colord X;
    };
    std::vector<Side> sides;
    for (const PatchSide& side : mesh_.sides()) {
        const PatchNode& root = nodes[side.root];
        sides.push_back({(root.dark ? 0 : root.area) * root.polygon.normal, X[side.root]});
    }
    PatchColors sent(links.size(), Colord::Zero());
    parallel_blocks(node_count(), nodes_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i)
            for (const LinkTable::Entry& link : links.of(static_cast<std::uint32_t>(i))) {
                if (!link.has_cluster()) continue;
                const PatchNode& other = nodes[link.other];
                const Vec3d w = -link.towards.cast<double>();
                Colord& sum = sent[links.number_of(link)];
                if (!other.is_cluster()) sum = other.area_towards(w) * X[link.other];
                else
                    for (std::uint32_t side = other.side; side < other.side_end; ++side)
                        sum += std::max(0.0, sides[side].area.dot(w)) * sides[side].X;
            }
    });
    return sent;
}

/// Hanrahan et al. 1991: X is pulled up to the groups and multiplied over the links; the irradiance of groups is then
/// pushed down to their leaves, that of clusters with the cosines of their sides.
PatchColors RadiositySystem::irradiance(PatchColors X) const {
    const auto& nodes = mesh_.nodes();
    if (is_closed())
        for (const std::uint32_t leaf : leaves_)
            X[leaf] *= scales_[leaf];
    pull(X);
    const PatchColors sent = this->sent(table_, X);
    PatchColors E(node_count(), Colord::Zero());
    parallel_blocks(node_count(), nodes_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            const PatchNode& patch = nodes[i];
            if (patch.is_cluster()) continue;
            const Vec3d n = patch.dark ? Vec3d(Vec3d::Zero()) : patch.polygon.normal;
            const auto add = [&](std::uint32_t node) {
                for (const LinkTable::Entry& link : table_.of(node)) {
                    const auto exchange = static_cast<double>(link.exchange);
                    if (!link.has_cluster()) {
                        E[i] += exchange / patch.area * X[link.other];
                        continue;
                    }
                    const double cosine = n.dot(link.towards.cast<double>());
                    if (cosine > 0) E[i] += exchange * cosine * sent[table_.number_of(link)];
                }
            };
            add(static_cast<std::uint32_t>(i));
            // The root of a side takes what arrives at all clusters around it.
            for (std::uint32_t above = patch.parent; above != no_node && nodes[above].is_cluster();
                 above = nodes[above].parent)
                add(above);
        }
    });
    for (std::size_t i = 1; i < node_count(); ++i)
        E[i] += E[nodes[i].parent];
    if (is_closed())
        for (const std::uint32_t leaf : leaves_)
            E[leaf] *= scales_[leaf];
    return E;
}

Colord RadiositySystem::power(const PatchColors& values) const {
    Colord sum = Colord::Zero();
    for (const std::uint32_t leaf : leaves_)
        sum += area(leaf) * values[leaf].abs();
    return sum;
}

RadiositySolution::RadiositySolution(const RadiositySystem& system) : system_(system) {
    first_.assign(system.node_count(), Colord::Zero());
    for (const std::uint32_t leaf : system.leaves())
        first_[leaf] = system.first_reflection(leaf);
    first_power_ = system.power(first_);
    X_ = first_;
    system_.pull(X_);
}

Colord RadiositySolution::residual_power(const PatchColors& residual) const {
    const Colord power = system_.power(residual);
    Colord relative = Colord::Zero();
    for (int c = 0; c < 3; ++c)
        if (first_power_[c] > 0) relative[c] = power[c] / first_power_[c];
    return relative;
}

void RadiositySolution::measure_residual() {
    PatchColors r = system_.irradiance(X_);
    for (const std::uint32_t leaf : system_.leaves())
        r[leaf] = first_[leaf] + system_.reflectance(leaf) * r[leaf] - X_[leaf];
    residual_ = residual_power(r).maxCoeff();
}

}  // namespace gib
