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
    : light_(light), node_count_(mesh.nodes().size()), table_(links, mesh.nodes().size()) {
    const auto& nodes = mesh.nodes();
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        areas_.push_back(nodes[i].area);
        parents_.push_back(nodes[i].parent);
        children_.push_back(nodes[i].child);
        if (nodes[i].is_leaf()) leaves_.push_back(i);
    }
    const auto measure = [&](const std::vector<double>& sums) {
        Closure closure;
        double area = 0;
        for (const std::uint32_t leaf : leaves_) {
            const double distance = std::abs(sums[leaf] - 1);
            closure.mean += areas_[leaf] * distance;
            closure.largest = std::max(closure.largest, distance);
            area += areas_[leaf];
        }
        if (area > 0) closure.mean /= area;
        return closure;
    };
    closure_ = measure(row_sums());
    if (normalise) normalise_rows();
}

std::vector<double> RadiositySystem::row_sums() const {
    const PatchColors E = irradiance(PatchColors(node_count_, Colord::Ones()));
    std::vector<double> sums(node_count_, 0.0);
    for (const std::uint32_t leaf : leaves_)
        sums[leaf] = E[leaf][0];
    return sums;
}

/// Scales rows and columns alike by s, so that G stays symmetric, until all row sums of K are 1.
void RadiositySystem::normalise_rows() {
    scales_.assign(node_count_, 1.0);
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
    for (std::size_t i = node_count_; i-- > 0;) {
        const std::uint32_t a = children_[i];
        if (a == no_node) continue;
        const double area = areas_[a] + areas_[a + 1];
        X[i] = area > 0 ? Colord((areas_[a] * X[a] + areas_[a + 1] * X[a + 1]) / area) : Colord(Colord::Zero());
    }
}

/// Hanrahan et al. 1991: X is pulled up to the groups and multiplied over the links; the irradiance of groups is then
/// pushed down to their leaves.
PatchColors RadiositySystem::irradiance(PatchColors X) const {
    if (!scales_.empty())
        for (const std::uint32_t leaf : leaves_)
            X[leaf] *= scales_[leaf];
    pull(X);
    PatchColors E(node_count_);
    parallel_blocks(node_count_, nodes_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            Colord sum = Colord::Zero();
            for (const LinkTable::Entry& link : table_.of(static_cast<std::uint32_t>(i)))
                sum += static_cast<double>(link.exchange) * X[link.other];
            E[i] = areas_[i] > 0 ? Colord(sum / areas_[i]) : Colord(Colord::Zero());
        }
    });
    for (std::size_t i = 0; i < node_count_; ++i)
        if (parents_[i] != no_node) E[i] += E[parents_[i]];
    if (!scales_.empty())
        for (const std::uint32_t leaf : leaves_)
            E[leaf] *= scales_[leaf];
    return E;
}

Colord RadiositySystem::power(const PatchColors& values) const {
    Colord sum = Colord::Zero();
    for (const std::uint32_t leaf : leaves_)
        sum += areas_[leaf] * values[leaf].abs();
    return sum;
}

RadiositySolution::RadiositySolution(const RadiositySystem& system) : system_(system) {
    std::uint32_t nodes = 0;
    for (const std::uint32_t leaf : system.leaves())
        nodes = std::max(nodes, leaf + 1);
    first_.assign(nodes, Colord::Zero());
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
