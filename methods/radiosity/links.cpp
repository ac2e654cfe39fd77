#include "methods/radiosity/links.h"

#include "common/core/parallel.h"

#include <algorithm>
#include <atomic>
#include <numbers>

namespace gib {

namespace {

/// Number of rays between two leaves; and between groups, or between two leaves whose first rays disagree.
constexpr std::uint32_t few_rays = 4, more_rays = 16;
/// Number of further rays between groups whose first rays agree although a shadow would matter. If the share V of light
/// passes, all of n rays are blocked with the probability (1 - V)^n; the light between the groups is then lost. In
/// cornell-box.xml 0.6 % of all indirect light is lost without these rays.
constexpr std::uint32_t sure_rays = 48;
/// Number of tries, times the number of rays, to find points that face each other.
constexpr std::uint32_t most_tries = 16;
/// Weights of the standard deviation of radiosity over a source against the error that a link may make; the second one
/// is for shadows between clusters. With 400 instead of 64, cornell-box.xml took twice as many links, and its mean
/// indirect light changed by 0.1 %.
constexpr double stray_weight = 64, cluster_stray_weight = 4;
/// The largest size of a cluster and what it is linked to, over their distance: all sides of the cluster must see the
/// other end in nearly one direction.
constexpr double cluster_nearness = 0.5;
constexpr std::size_t pairs_per_block = 256;

/// The largest cosine between the normal and a direction to the other end, which lies within `reach` of `way`.
double largest_cosine(const PatchNode& node, const Vec3d& way, double distance, double reach) {
    if (node.is_cluster()) return 1;
    return std::clamp((node.polygon.normal.dot(way) + reach) / distance, 0.0, 1.0);
}

/// Whether part of q may lie in front of p.
bool faces(const PatchNode& p, const PatchNode& q) {
    if (p.is_cluster()) return true;
    const double slack = 1e-7 * (p.radius + q.radius);
    if (q.is_cluster()) return p.polygon.normal.dot(q.center - p.center) + q.radius > slack;
    const auto corners = q.polygon.corners();
    return std::any_of(corners.begin(), corners.end(),
                       [&](const Vec3d& corner) { return p.polygon.normal.dot(corner - p.center) > slack; });
}

struct Pair {
    std::uint32_t p, q;
    float visible = -1;  ///< V as found for the pair's parents; negative: not known yet
};

class Refinement {
public:
    Refinement(const PatchMesh& mesh, const PatchLight& light, const LinkSettings& settings)
        : mesh_(mesh), nodes_(mesh.nodes()), light_(light), settings_(settings) {}

    /// Refines one pair, which becomes nothing, a link, or pairs with the halves of one of its nodes (Hanrahan
    /// et al. 1991). Once its visibility is known well enough, halves inherit it.
    void look_at(RayQueries& rays, Pair pair, PatchLinks& found, std::vector<Pair>& pairs) const {
        const PatchNode& p = nodes_[pair.p];
        const PatchNode& q = nodes_[pair.q];
        if (pair.p == pair.q) {
            if (p.is_cluster())
                for (const Pair& halves :
                     {Pair{p.child, p.child}, Pair{p.child + 1, p.child + 1}, Pair{p.child, p.child + 1}})
                    pairs.push_back(halves);
            return;
        }
        if (p.dark || q.dark || !faces(p, q) || !faces(q, p)) return;
        const bool can_split = !p.is_leaf() || !q.is_leaf();
        const Errors errors = can_split ? errors_of(pair) : Errors{};
        if (pair.visible < 0) {
            if (errors.light > 1) return split(pair, pairs);
            const std::uint64_t key = combine_keys(combine_keys(settings_.seed, pair.p), pair.q);
            const auto visibility = [&](std::uint32_t n, std::uint64_t seed) {
                return visibility_between(rays, mesh_, light_, pair.p, pair.q, n, seed);
            };
            double visible = visibility(can_split ? more_rays : few_rays, key);
            const bool agree = visible == 0 || visible == 1;
            if (can_split && agree && errors.shadow > 1) visible = visibility(sure_rays, mix64(key));
            else if (!can_split && !agree) visible = visibility(more_rays, mix64(key));
            if (visible == 0) return;
            if (visible < 1 && errors.shadow > 1) return split(pair, pairs);
            pair.visible = static_cast<float>(visible);
            found.seen.push_back({.p = pair.p, .q = pair.q, .exchange = 0, .visible = pair.visible});
        }
        if (errors.shape > 1) return split(pair, pairs);
        const double exchange = static_cast<double>(pair.visible) * unoccluded(p, q);
        if (exchange > 0)
            found.links.push_back(
                {.p = pair.p, .q = pair.q, .exchange = static_cast<float>(exchange), .visible = pair.visible});
    }

private:
    void split(const Pair& pair, std::vector<Pair>& pairs) const {
        const PatchNode& p = nodes_[pair.p];
        const PatchNode& q = nodes_[pair.q];
        const bool first = !p.is_leaf() && (q.is_leaf() || p.radius >= q.radius);
        const std::uint32_t child = first ? p.child : q.child;
        for (const std::uint32_t half : {child, child + 1})
            pairs.push_back(first ? Pair{half, pair.q, pair.visible} : Pair{pair.p, half, pair.visible});
    }

    /// The errors of a link, each over the allowed error. `light` is a bound of the light that the link carries, times
    /// how much the exchange changes over the pair (BF refinement of Hanrahan et al. 1991). `shape` is the part of it
    /// that the change of radiosity over the source causes: bright parts of a source tend to lie where the exchange
    /// is largest, so this error has the same sign for many links, and less of it is allowed. `shadow` is the error
    /// if something is between the nodes; it does not fall with distance.
    struct Errors {
        double light = 0, shape = 0, shadow = 0;
    };
    Errors errors_of(const Pair& pair) const {
        const PatchNode& p = nodes_[pair.p];
        const PatchNode& q = nodes_[pair.q];
        const Vec3d way = q.center - p.center;
        const double distance = way.norm(), reach = p.radius + q.radius;
        const bool near = (p.is_cluster() || q.is_cluster()) && reach > cluster_nearness * distance;
        if (settings_.refine_all || near) return {2, 2, 2};
        if (!(light_.mean_irradiance > 0)) return {};
        const double nearness = std::min(1.0, reach / distance);
        const double cosines =
            largest_cosine(p, way, distance, reach) * largest_cosine(q, -way, distance, reach) / settings_.error;
        // A bound of the irradiance that `to` receives from `from`, by the mean of its radiosity or by its deviation.
        const auto carried = [&](const PatchNode& from, double radiosity) {
            const double area =
                from.is_cluster() ? std::min(from.area, std::numbers::pi * sqr(from.radius)) : from.area;
            return cosines * area / (std::numbers::pi * sqr(distance) + area) * radiosity / light_.mean_irradiance;
        };
        const double light = std::max(carried(p, light_.expected[pair.p]), carried(q, light_.expected[pair.q]));
        const double stray = std::max(carried(p, light_.spread[pair.p]), carried(q, light_.spread[pair.q]));
        return {.light = nearness * light,
                .shape = nearness * std::max(light, stray_weight * stray),
                // Clusters take a smaller weight, because rays between them are most of the time in scenes with meshes.
                .shadow = std::max(0.5 * light,
                                   (p.is_cluster() || q.is_cluster() ? cluster_stray_weight : stray_weight) * stray)};
    }

    double unoccluded(const PatchNode& p, const PatchNode& q) const {
        if (p.is_cluster() || q.is_cluster()) return 1 / (std::numbers::pi * (q.center - p.center).squaredNorm());
        return p.area * polygon_form_factor(p.polygon, q.polygon) * q.uncovered();
    }

    const PatchMesh& mesh_;
    const std::vector<PatchNode>& nodes_;
    const PatchLight& light_;
    const LinkSettings& settings_;
};

}  // namespace

double passing(RayQueries& rays, const SurfacePoint& from, const SurfacePoint& to) {
    const Vec3 target = shadow_ray_target(to, from.p);
    const Vec3 way = target - from.p;
    const float distance = way.norm();
    if (!(distance > 0.f)) return 1;
    const LightSample end{.wi = way / distance,
                          .distance = distance,
                          .Le = Color::Ones(),
                          .pdf_w = 1.f,
                          .delta = false,
                          .target = target};
    SurfacePoint start = from;
    // The ray leaves on the node's side, wherever the other end lies.
    start.p += start.offset * start.ng;
    start.offset = 0.f;
    return static_cast<double>(rays.visibility(start, end).mean());
}

double light_between(const SurfacePoint& from, const SurfacePoint& to, double area) {
    const Vec3d way = (to.p - from.p).cast<double>();
    const double distance2 = way.squaredNorm();
    const double cosines =
        std::max(0.0, from.ng.cast<double>().dot(way)) * std::max(0.0, -to.ng.cast<double>().dot(way));
    constexpr double least_distance2 = 0.05;  // as a share of the area
    return cosines > 0 ? cosines / (distance2 * (distance2 + least_distance2 * area)) : 0;
}

PatchLight::Choice PatchLight::point_of(const PatchMesh& mesh, std::uint32_t node, double u) const {
    const auto& nodes = mesh.nodes();
    // The number that chooses a half by its area is used again in that half.
    while (nodes[node].child < first_point.size()) {
        const std::uint32_t child = nodes[node].child;
        const double share = nodes[child].area / (nodes[child].area + nodes[child + 1].area);
        const bool first = u < share;
        u = first ? u / share : (u - share) / (1 - share);
        node = first ? child : child + 1;
    }
    const auto i = std::min(static_cast<std::uint32_t>(u * samples), samples - 1);
    return {node, points[first_point[node] + i]};
}

double visibility_between(RayQueries& rays, const PatchMesh& mesh, const PatchLight& light, std::uint32_t p,
                          std::uint32_t q, std::uint32_t n, std::uint64_t key) {
    const double area = std::min(mesh.nodes()[p].area, mesh.nodes()[q].area);
    double total = 0, passed = 0;
    bool all = true;
    // Points that do not face each other cost no ray. More are tried if only small parts of the nodes
    // face each other.
    for (std::uint32_t i = 0; i < n || (i < most_tries * n && total == 0); ++i) {
        const Vec2d u = Sampler(PointSet::sobol, key, 0, i).get_2d(0).cast<double>();
        const auto [first, from] = light.point_of(mesh, p, u.x());
        const auto [second, to] = light.point_of(mesh, q, u.y());
        const double weight = light_between(from, to, area);
        if (!(weight > 0) || mesh.nodes()[first].dark || mesh.nodes()[second].dark) continue;
        const double share = passing(rays, from, to);
        all &= share == 1;
        total += weight;
        passed += weight * share;
    }
    // No points face each other, or all that do are covered.
    if (total == 0) return 0;
    return all ? 1 : passed / total;
}

PatchLinks link_patches(const PatchMesh& mesh, const PatchLight& light, const LinkSettings& settings,
                        const StageTimes* stages) {
    const Refinement refinement(mesh, light, settings);
    PatchLinks result;
    std::vector<Pair> pairs;
    if (!mesh.nodes().empty()) pairs.push_back({0, 0});
    struct Block {
        PatchLinks found;
        std::vector<Pair> pairs;
    };
    std::atomic<std::uint64_t> traced = 0;
    while (!pairs.empty()) {
        std::vector<Block> blocks((pairs.size() + pairs_per_block - 1) / pairs_per_block);
        std::optional<StageProgress> progress;
        if (stages) progress.emplace(*stages, "links", pairs.size());
        parallel_blocks(pairs.size(), pairs_per_block, [&](std::size_t begin, std::size_t end, std::size_t b) {
            RayQueries rays(mesh.charts().scene());
            for (std::size_t i = begin; i < end; ++i)
                refinement.look_at(rays, pairs[i], blocks[b].found, blocks[b].pairs);
            traced += rays.count();
            if (progress) progress->add(end - begin);
        });
        for (const Block& block : blocks) {
            result.links.insert(result.links.end(), block.found.links.begin(), block.found.links.end());
            result.seen.insert(result.seen.end(), block.found.seen.begin(), block.found.seen.end());
        }
        pairs = joined(blocks, &Block::pairs);
    }
    result.rays = traced;
    return result;
}

LinkTable::LinkTable(const std::vector<PatchLink>& links, const std::vector<PatchNode>& nodes)
    : begin_(nodes.size() + 1, 0) {
    for (const PatchLink& link : links) {
        ++begin_[link.p + 1];
        ++begin_[link.q + 1];
    }
    for (std::size_t i = 0; i < nodes.size(); ++i)
        begin_[i + 1] += begin_[i];
    entries_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (const PatchLink& link : links) {
        const PatchNode &p = nodes[link.p], &q = nodes[link.q];
        Vec3 w = Vec3::Zero();
        if (p.is_cluster() || q.is_cluster()) w = (q.center - p.center).normalized().cast<float>();
        entries_[next[link.p]++] = {link.q, link.exchange, link.visible, w};
        entries_[next[link.q]++] = {link.p, link.exchange, link.visible, -w};
    }
}

}  // namespace gib
