#include "methods/radiosity_display.h"

#include "common/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>

namespace gib {

namespace {

constexpr std::size_t vertices_per_block = 64;
/// Rays from a corner to a patch of which something hides a part.
constexpr std::uint32_t rays_to_patch = 4;
/// A patch is halved where irradiance changes over it by this share of the mean.
constexpr double allowed_change = 0.1;
/// As often as this at most.
constexpr int extra_halvings = 4;

}  // namespace

RadiosityDisplay::RadiosityDisplay(PatchMesh& mesh, const RadiositySystem& system, const PatchLight& light,
                                   const DisplaySettings& settings)
    : mesh_(mesh),
      system_(system),
      light_(light),
      settings_(settings),
      solved_nodes_(mesh.nodes().size()),
      known_(mesh.sides().size()) {
    add_rows();
}

std::uint32_t RadiosityDisplay::solved_patch(std::uint32_t leaf) const {
    while (leaf >= solved_nodes_)
        leaf = mesh_.nodes()[leaf].parent;
    return leaf;
}

void RadiosityDisplay::gather_row(RayQueries& rays, const PatchVertex& vertex, std::vector<Term>& row) const {
    const PatchSide& side = mesh_.sides()[mesh_.nodes()[vertex.leaf].side];
    const SurfaceHit point = mesh_.point_of_side(side, vertex.uv);
    const Vec3d p = mesh_.charts().position(mesh_.charts()[side.chart], vertex.uv), n = point.ns.cast<double>();
    const std::uint64_t key =
        combine_keys(combine_keys(settings_.seed, mesh_.nodes()[vertex.leaf].side), key_of(vertex.at));
    double sum = 0;
    row.clear();
    for (std::uint32_t node = solved_patch(vertex.leaf); node != no_node; node = mesh_.nodes()[node].parent)
        for (const LinkTable::Entry& link : system_.links().of(node)) {
            const PatchNode& other = mesh_.nodes()[link.other];
            double factor = 0;
            if (link.other == node) factor = static_cast<double>(link.exchange) / other.area;
            else factor = point_form_factor(p, n, other.polygon) * area_correction(other);
            if (factor > 0 && !link.clear)
                factor *= visibility_from(rays, mesh_, point, other, rays_to_patch, combine_keys(key, link.other));
            if (!(factor > 0)) continue;
            sum += factor;
            row.push_back({link.other, static_cast<float>(factor)});
        }
    if (settings_.normalise && sum > 0)
        for (Term& term : row)
            term.factor = static_cast<float>(static_cast<double>(term.factor) / sum);
}

void RadiosityDisplay::add_rows() {
    vertices_.emplace(mesh_);
    const auto& vertices = vertices_->vertices();
    rows_.assign(vertices.size(), {});
    std::vector<std::uint32_t> unknown;
    for (std::uint32_t i = 0; i < vertices.size(); ++i) {
        const auto& known = known_[mesh_.nodes()[vertices[i].leaf].side];
        const auto found = known.find(key_of(vertices[i].at));
        if (found == known.end()) unknown.push_back(i);
        else rows_[i] = found->second;
    }
    std::vector<std::vector<Term>> blocks((unknown.size() + vertices_per_block - 1) / vertices_per_block);
    std::atomic<std::uint64_t> traced = 0;
    std::atomic<std::size_t> made = 0;
    parallel_blocks(unknown.size(), vertices_per_block, [&](std::size_t begin, std::size_t end, std::size_t b) {
        RayQueries rays(mesh_.charts().scene());
        std::vector<Term> row;
        for (std::size_t i = begin; i < end; ++i) {
            gather_row(rays, vertices[unknown[i]], row);
            rows_[unknown[i]] = {blocks[b].size(), static_cast<std::uint32_t>(row.size())};
            blocks[b].insert(blocks[b].end(), row.begin(), row.end());
        }
        traced += rays.count();
        made += blocks[b].size();
    });
    rays_ += traced;
    const double needed = 2 * static_cast<double>((terms_.size() + made) * sizeof(Term));
    if (needed > settings_.most_bytes)
        throw InputError(
            fmt::format("the light at the corners of patches needs {:.0f} bytes, and memory leaves {:.0f}; set a "
                        "larger patch, larger links, or more memory",
                        needed, settings_.most_bytes));
    terms_.reserve(terms_.size() + made);
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        const std::size_t begin = b * vertices_per_block, end = std::min(unknown.size(), begin + vertices_per_block);
        for (std::size_t i = begin; i < end; ++i) {
            rows_[unknown[i]].begin += terms_.size();
            const PatchVertex& vertex = vertices[unknown[i]];
            known_[mesh_.nodes()[vertex.leaf].side].emplace(key_of(vertex.at), rows_[unknown[i]]);
        }
        terms_.insert(terms_.end(), blocks[b].begin(), blocks[b].end());
        blocks[b] = {};
    }
}

void RadiosityDisplay::show(const PatchColors& X) {
    irradiance_.resize(rows_.size());
    parallel_blocks(rows_.size(), 1024, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            Colord sum = Colord::Zero();
            for (std::size_t t = rows_[i].begin; t < rows_[i].begin + rows_[i].count; ++t)
                sum += static_cast<double>(terms_[t].factor) * X[terms_[t].node];
            irradiance_[i] = sum.max(0.0).cast<float>();
        }
    });
    for (const PatchVertices::Bound& bound : vertices_->bound())
        irradiance_[bound.vertex] = 0.5f * (irradiance_[bound.first] + irradiance_[bound.second]);
}

bool RadiosityDisplay::changes_over(std::uint32_t leaf, double allowed) const {
    const auto& corners = vertices_->of_leaf(leaf);
    const auto count = static_cast<std::size_t>(mesh_.nodes()[leaf].corner_count());
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const auto E = static_cast<double>(irradiance_[corners[i]].mean());
        least = std::min(least, E);
        most = std::max(most, E);
    }
    return most - least > allowed;
}

void RadiosityDisplay::refine(const PatchColors& X) {
    show(X);
    if (!settings_.adapt || irradiance_.empty()) return;
    Colord mean = Colord::Zero();
    double area = 0;
    for (const std::uint32_t leaf : system_.leaves()) {
        const auto& corners = vertices_->of_leaf(leaf);
        mean += system_.area(leaf) * irradiance_[corners[0]].cast<double>();
        area += system_.area(leaf);
    }
    const double allowed = allowed_change * mean.mean() / area;
    std::uint32_t first = 0;
    for (int round = 0; round < extra_halvings; ++round) {
        const auto end = static_cast<std::uint32_t>(mesh_.nodes().size());
        for (std::uint32_t i = first; i < end; ++i)
            if (mesh_.nodes()[i].is_leaf() && changes_over(i, allowed)) mesh_.split(i);
        if (mesh_.nodes().size() == end) break;
        first = end;
        add_rows();
        show(X);
    }
}

Color RadiosityDisplay::irradiance(const SurfaceHit& hit, const Vec3& wo) const {
    const auto place = mesh_.locate(hit, wo);
    if (!place) return Color::Zero();
    const PatchNode& leaf = mesh_.nodes()[place->leaf];
    const auto weights = mesh_.weights(leaf, place->uv);
    const auto& corners = vertices_->of_leaf(place->leaf);
    Color E = Color::Zero();
    for (std::size_t i = 0; i < static_cast<std::size_t>(leaf.corner_count()); ++i)
        E += static_cast<float>(weights[i]) * irradiance_[corners[i]];
    return E;
}

Color RadiosityDisplay::whole_irradiance(const SurfaceHit& hit, const Vec3& wo) const {
    const auto place = mesh_.locate(hit, wo);
    if (!place) return Color::Zero();
    return irradiance(hit, wo) + light_.irradiance[solved_patch(place->leaf)].cast<float>();
}

}  // namespace gib
