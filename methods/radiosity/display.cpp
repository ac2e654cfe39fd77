#include "methods/radiosity/display.h"

#include "common/core/parallel.h"
#include "methods/radiosity/contacts.h"

#include <algorithm>
#include <atomic>
#include <numbers>

namespace gib {

namespace {

constexpr std::size_t vertices_per_block = 64;
/// Number of rays from a corner to a patch that is partly hidden.
constexpr std::uint32_t rays_to_patch = 4;
/// A patch is halved if irradiance changes over it by more than this share of the mean irradiance.
constexpr double allowed_change = 0.1;
/// How far inside a leaf the rays to its corners end, as a share of the way to its middle.
constexpr double corner_inset = 0.02;
/// The radius down to which patches are halved for display, as a share of the parameter `patch`.
constexpr double least_shown = 0.125;
/// Weight of the standard deviation of radiosity over a node against the error that a link may make.
constexpr double shown_stray_weight = 200;

/// The form factor from a point to a patch. If a patch is small and lies above the horizon, it is the kernel at its
/// centre plus the term of second order for a square: area / 24 times the Laplacian of the kernel over its plane.
double factor_of(const Vec3d& p, const Vec3d& n, const PatchNode& patch) {
    constexpr double small = 0.15;  // radius over distance
    const Vec3d way = patch.center - p;
    const double distance2 = way.squaredNorm(), height = n.dot(way), front = -patch.polygon.normal.dot(way);
    if (sqr(patch.radius) > sqr(small) * distance2 || std::abs(height) < patch.radius)
        return patch.uncovered() * point_form_factor(p, n, patch.polygon);
    if (!(height > 0 && front > 0)) return 0;
    const double second = height * (1 - 3 * sqr(front) / distance2) - n.dot(patch.polygon.normal) * front;
    return patch.area * front / (std::numbers::pi * sqr(distance2)) *
           (height + patch.polygon.area / (3 * distance2) * second);
}

}  // namespace

RadiosityDisplay::RadiosityDisplay(PatchMesh& mesh, const RadiositySystem& system, const PatchLight& light,
                                   const std::vector<PatchLink>& seen, const DisplaySettings& settings)
    : mesh_(mesh),
      system_(system),
      light_(light),
      links_(seen, mesh.nodes()),
      settings_(settings),
      areas_shown_(system.sent(links_, PatchColors(mesh.nodes().size(), Colord::Ones()))),
      known_(mesh.sides().size()) {
    add_rows();
}

std::uint32_t RadiosityDisplay::solved_patch(std::uint32_t leaf) const {
    while (leaf >= system_.node_count())
        leaf = mesh_.nodes()[leaf].parent;
    return leaf;
}

double RadiosityDisplay::add_terms(RayQueries& rays, const Viewpoint& from, std::uint32_t node, double visible,
                                   std::vector<Term>& row) const {
    const PatchNode& patch = mesh_.nodes()[node];
    const double factor = factor_of(from.p, from.n, patch);
    if (!(factor > 0)) return 0;
    const double nearness = std::min(1.0, patch.radius / (patch.center - from.p).norm());
    const double stray = shown_stray_weight * factor * nearness * light_.spread[node];
    if (patch.child < system_.node_count() && stray > settings_.links * light_.mean_irradiance)
        return add_terms(rays, from, patch.child, visible, row) + add_terms(rays, from, patch.child + 1, visible, row);
    if (visible < 0) return add_rays(rays, from, node, factor, row);
    // Seen from a place that is moved by as much as the middle of the light lies off the centre, the patch has the
    // factor with which its light arrives, up to terms of second order in its size.
    const Vec3d lean = light_.middle[node] - patch.center;
    const double leant = lean.isZero(0) ? factor : factor_of(from.p - lean, from.n, patch);
    row.push_back({node, static_cast<float>(visible * leant)});
    return visible * factor;
}

/// The light of a node that is partly hidden is that of the leaves which rays meet: the parts that are seen may be
/// brighter than its mean.
double RadiosityDisplay::add_rays(RayQueries& rays, const Viewpoint& from, std::uint32_t node, double factor,
                                  std::vector<Term>& row) const {
    const std::uint64_t key = combine_keys(from.key, node);
    const std::size_t first = row.size();
    double total = 0, passed = 0;
    for (std::uint32_t i = 0; i < rays_to_patch; ++i) {
        const auto [leaf, to] =
            light_.point_of(mesh_, node, static_cast<double>(Sampler(PointSet::sobol, key, 0, i).get_1d(0)));
        const double weight = light_between(from.hit, to, mesh_.nodes()[node].area);
        if (!(weight > 0)) continue;
        total += weight;
        const double arriving = weight * passing(rays, from.hit, to);
        passed += arriving;
        if (arriving > 0) row.push_back({leaf, static_cast<float>(arriving)});
    }
    if (!(total > 0)) return 0;
    for (std::size_t i = first; i < row.size(); ++i)
        row[i].factor *= static_cast<float>(factor / total);
    return factor * passed / total;
}

double RadiosityDisplay::irradiance_row(RayQueries& rays, const PatchVertex& vertex, std::vector<Term>& row) const {
    const auto& nodes = mesh_.nodes();
    const PatchSide& side = mesh_.sides()[nodes[vertex.leaf].side];
    const SurfaceHit point = mesh_.point_of_side(side, vertex.uv);
    const Viewpoint from{.hit = point,
                         .p = mesh_.charts()[side.chart].position(vertex.uv),
                         .n = point.ns.cast<double>(),
                         .key = combine_keys(combine_keys(settings_.seed, nodes[vertex.leaf].side), key_of(vertex.at))};
    row.clear();
    if (nodes[solved_patch(vertex.leaf)].dark) return 0;
    double sum = 0;
    for (std::uint32_t node = solved_patch(vertex.leaf); node != no_node; node = nodes[node].parent)
        for (const LinkTable::Entry& link : links_.of(node)) {
            const auto visible = static_cast<double>(link.visible);
            const PatchNode& other = nodes[link.other];
            if (!other.is_cluster()) {
                const bool known = link.visible == 1.f || nodes[node].is_cluster();
                sum += add_terms(rays, from, link.other, known ? visible : -1, row);
                continue;
            }
            const Vec3d way = other.center - from.p;
            const double cosine = from.n.dot(way.normalized());
            if (!(cosine > 0)) continue;
            const double factor = visible * cosine / (std::numbers::pi * way.squaredNorm());
            row.push_back({static_cast<std::uint32_t>(system_.node_count() + links_.number_of(link)),
                           static_cast<float>(factor)});
            sum += factor * areas_shown_[links_.number_of(link)][0];
        }
    return sum;
}

/// Finds the corners that nothing separates from their leaf's middle. A corner behind a wall that stands on the
/// surface has the light of the other side, and is left out of the interpolation.
void RadiosityDisplay::look_at_corners() {
    const auto& nodes = mesh_.nodes();
    const std::size_t first = seen_corners_.size();
    seen_corners_.resize(nodes.size(), 0);
    std::atomic<std::uint64_t> traced = 0;
    parallel_blocks(nodes.size() - first, vertices_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        RayQueries rays(mesh_.charts().scene());
        for (std::size_t i = first + begin; i < first + end; ++i) {
            if (!nodes[i].is_leaf()) continue;
            seen_corners_[i] = 15;
            if (mesh_.chart_of(nodes[i]).curved) continue;  // a curved leaf may block the ray itself
            seen_corners_[i] = 0;
            const SurfaceHit middle = mesh_.inside_corner(nodes[i], 0, 1);
            for (int k = 0; k < nodes[i].corner_count(); ++k)
                if (way_is_clear(rays, middle, mesh_.inside_corner(nodes[i], k, corner_inset), nodes[i].radius))
                    seen_corners_[i] = static_cast<std::uint8_t>(seen_corners_[i] | (1u << k));
            if (seen_corners_[i] == 0) seen_corners_[i] = 15;
        }
        traced += rays.count();
    });
    rays_ += traced;
}

void RadiosityDisplay::add_rows() {
    vertices_.emplace(mesh_);
    look_at_corners();
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
    parallel_blocks(unknown.size(), vertices_per_block, [&](std::size_t begin, std::size_t end, std::size_t b) {
        RayQueries rays(mesh_.charts().scene());
        std::vector<Term> row;
        for (std::size_t i = begin; i < end; ++i) {
            const double sum = irradiance_row(rays, vertices[unknown[i]], row);
            // In a closed scene, all of the hemisphere is seen.
            const double scale = system_.is_closed() && sum > 0 ? 1 / sum : 1;
            rows_[unknown[i]] = {blocks[b].size(), static_cast<std::uint32_t>(row.size()), static_cast<float>(scale)};
            blocks[b].insert(blocks[b].end(), row.begin(), row.end());
        }
        traced += rays.count();
    });
    rays_ += traced;
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
    PatchColors values = X;
    const PatchColors sent = system_.sent(links_, X);
    values.insert(values.end(), sent.begin(), sent.end());
    parallel_blocks(rows_.size(), 1024, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            Colord sum = Colord::Zero();
            for (std::size_t t = rows_[i].begin; t < rows_[i].begin + rows_[i].count; ++t)
                sum += static_cast<double>(terms_[t].factor) * values[terms_[t].value];
            // All factors are positive; X is below 0 only by the solver's remaining error.
            irradiance_[i] = rows_[i].scale * sum.max(0.0).cast<float>();
        }
    });
    for (const PatchVertices::Bound& bound : vertices_->bound())
        irradiance_[bound.vertex] = 0.5f * (irradiance_[bound.first] + irradiance_[bound.second]);
}

bool RadiosityDisplay::changes_over(std::uint32_t leaf, double allowed) const {
    const auto& corners = vertices_->of_leaf(leaf);
    const auto count = static_cast<std::size_t>(mesh_.nodes()[leaf].corner_count());
    if (seen_corners_[leaf] + 1u < 1u << count) return true;
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
    const double least = least_shown * mesh_.size();
    for (std::uint32_t first = 0; first < mesh_.nodes().size();) {
        const auto end = static_cast<std::uint32_t>(mesh_.nodes().size());
        for (std::uint32_t i = first; i < end; ++i)
            if (mesh_.nodes()[i].is_leaf() && mesh_.nodes()[i].radius > least && changes_over(i, allowed))
                mesh_.split(i);
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
    float total = 0.f;
    for (std::size_t i = 0; i < static_cast<std::size_t>(leaf.corner_count()); ++i) {
        if ((seen_corners_[place->leaf] >> i & 1) == 0) continue;
        const float weight = static_cast<float>(weights[i]) + 1e-6f;
        E += weight * irradiance_[corners[i]];
        total += weight;
    }
    return E / total;
}

Color RadiosityDisplay::whole_irradiance(const SurfaceHit& hit, const Vec3& wo) const {
    const auto place = mesh_.locate(hit, wo);
    if (!place) return Color::Zero();
    return irradiance(hit, wo) + light_.irradiance[solved_patch(place->leaf)].cast<float>();
}

}  // namespace gib
