#include "methods/radiosity/links.h"

#include "common/core/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <numbers>

namespace gib {

namespace {

/// Number of rays between two patches; and between groups, or between two patches whose first rays disagree.
constexpr std::uint32_t few_rays = 4, more_rays = 16;
/// Relative tolerance of form factors between leaves, and between groups.
constexpr double leaf_tolerance = 1e-4, link_tolerance = 1e-3;
/// The largest angle between normals [rad] over a group that is linked as a whole.
constexpr double max_link_spread = 0.6;
constexpr std::size_t pairs_per_block = 256;

/// The largest cosine between `normal` and a direction to the other end, which lies within `reach` of `way`.
double largest_cosine(const Vec3d& normal, const Vec3d& way, double distance, double reach) {
    return std::clamp((normal.dot(way) + reach) / distance, 0.0, 1.0);
}

/// Whether part of q may lie in front of p. Curved patches bulge beyond their chord polygons, so both sagittas
/// are allowed for.
bool faces(const PatchNode& p, const PatchNode& q) {
    const double slack = 1e-7 * (p.radius + q.radius) - std::abs(p.sagitta) - std::abs(q.sagitta);
    const auto corners = q.polygon.corners();
    return std::any_of(corners.begin(), corners.end(),
                       [&](const Vec3d& corner) { return p.polygon.normal.dot(corner - p.center) > slack; });
}

struct Pair {
    std::uint32_t p, q;
};

class Refinement {
public:
    Refinement(const PatchMesh& mesh, const PatchLight& light, const LinkSettings& settings)
        : mesh_(mesh), nodes_(mesh.nodes()), light_(light), settings_(settings) {}

    /// Refines one pair, which becomes nothing, a link, or pairs with the halves of one of its nodes (Hanrahan
    /// et al. 1991).
    void look_at(RayQueries& rays, const Pair& pair, std::vector<PatchLink>& links, std::vector<Pair>& pairs) const {
        const PatchNode& p = nodes_[pair.p];
        const PatchNode& q = nodes_[pair.q];
        if (pair.p == pair.q) return look_inside(pair.p, links, pairs);
        if (!faces(p, q) || !faces(q, p)) return;
        const bool can_split = !p.is_leaf() || !q.is_leaf();
        const double error = can_split ? error_of(pair) : 0;
        if (error > 1) return split(pair, pairs);
        const std::uint64_t key = combine_keys(combine_keys(settings_.seed, pair.p), pair.q);
        double visible = visibility_between(rays, mesh_, p, q, can_split ? more_rays : few_rays, key);
        if (!can_split && visible > 0 && visible < 1)
            visible = visibility_between(rays, mesh_, p, q, more_rays, mix64(key));
        if (visible == 0) return;
        const bool clear = visible == 1;
        if (can_split && !clear && shadow_error_of(pair) > 1) return split(pair, pairs);
        const double exchange = visible * unoccluded(p, q);
        if (exchange > 0)
            links.push_back({.p = pair.p, .q = pair.q, .exchange = static_cast<float>(exchange), .clear = clear});
    }

private:
    void look_inside(std::uint32_t node, std::vector<PatchLink>& links, std::vector<Pair>& pairs) const {
        const PatchNode& n = nodes_[node];
        if (mesh_.charts()[mesh_.sides()[n.side].chart].is_flat()) return;
        if (!n.is_leaf()) {
            pairs.push_back({n.child, n.child});
            pairs.push_back({n.child + 1, n.child + 1});
            pairs.push_back({n.child, n.child + 1});
        } else if (n.sagitta < 0 && n.area > n.polygon.area) {
            // A hollow patch sees itself in every direction that does not leave through its chords.
            links.push_back(
                {.p = node, .q = node, .exchange = static_cast<float>(n.area - n.polygon.area), .clear = true});
        }
    }

    void split(const Pair& pair, std::vector<Pair>& pairs) const {
        const PatchNode& p = nodes_[pair.p];
        const PatchNode& q = nodes_[pair.q];
        const bool first = !p.is_leaf() && (q.is_leaf() || must_split(p) > must_split(q) ||
                                            (must_split(p) == must_split(q) && p.polygon.area >= q.polygon.area));
        const std::uint32_t child = first ? p.child : q.child;
        for (const std::uint32_t half : {child, child + 1})
            pairs.push_back(first ? Pair{half, pair.q} : Pair{pair.p, half});
    }

    static bool must_split(const PatchNode& node) { return !node.is_leaf() && node.spread > max_link_spread; }

    /// A bound of the irradiance that q causes at p, in mean irradiances: `light` by the radiosity of q, `stray` by
    /// its standard deviation over q. `nearness` is the size of both over their distance, at most 1.
    struct Carried {
        double light = 0, stray = 0, nearness = 1;
    };
    Carried carried(std::uint32_t p_index, std::uint32_t q_index) const {
        const PatchNode& p = nodes_[p_index];
        const PatchNode& q = nodes_[q_index];
        const Vec3d way = q.center - p.center;
        const double distance = way.norm(), reach = p.radius + q.radius;
        Carried result;
        double factor = 1;
        if (distance > 0) {
            result.nearness = std::min(1.0, reach / distance);
            const double cosines = largest_cosine(p.polygon.normal, way, distance, reach) *
                                   largest_cosine(q.polygon.normal, -way, distance, reach);
            factor = cosines * q.polygon.area / (std::numbers::pi * sqr(distance) + q.polygon.area);
        }
        result.light = factor * light_.expected[q_index] / light_.mean_irradiance;
        result.stray = factor * light_.spread[q_index] / light_.mean_irradiance;
        return result;
    }

    /// The error of a link over the allowed error: a bound of the light that the link carries, times how much the
    /// exchange changes over the pair (BF refinement of Hanrahan et al. 1991). Stray over the source errs alike for
    /// many receivers and links, so less of it is allowed.
    double error_of(const Pair& pair) const {
        const bool bent = must_split(nodes_[pair.p]) || must_split(nodes_[pair.q]);
        if (settings_.refine_all || bent) return 2;
        if (!(light_.mean_irradiance > 0)) return 0;
        const Carried to_p = carried(pair.p, pair.q), to_q = carried(pair.q, pair.p);
        const double error = std::max({to_p.light, to_q.light, stray_weight * to_p.stray, stray_weight * to_q.stray});
        return error * to_p.nearness / settings_.error;
    }
    /// The error of a link with something between its nodes, over the allowed error. It does not fall with distance.
    double shadow_error_of(const Pair& pair) const {
        if (!(light_.mean_irradiance > 0)) return 0;
        return 0.5 * std::max(carried(pair.p, pair.q).light, carried(pair.q, pair.p).light) / settings_.error;
    }

    double unoccluded(const PatchNode& p, const PatchNode& q) const {
        const bool leaves = p.is_leaf() && q.is_leaf();
        const double tolerance = leaves ? leaf_tolerance : link_tolerance;
        const bool from_p = p.polygon.area <= q.polygon.area;
        const PatchPolygon& from = from_p ? p.polygon : q.polygon;
        const PatchPolygon& to = from_p ? q.polygon : p.polygon;
        return from.area * polygon_form_factor(from, to, tolerance) * area_correction(p) * area_correction(q);
    }

    const PatchMesh& mesh_;
    const std::vector<PatchNode>& nodes_;
    const PatchLight& light_;
    const LinkSettings& settings_;
};

void check_bytes(double needed, double most) {
    if (needed <= most) return;
    throw InputError(
        fmt::format("the links between patches need {:.0f} bytes or more, and memory allows {:.0f}; set a larger "
                    "patch, larger links, or more memory",
                    needed, most));
}

std::vector<Pair> pairs_of_sides(const PatchMesh& mesh, double most_bytes) {
    const auto n = static_cast<double>(mesh.sides().size());
    check_bytes(0.5 * n * (n + 1) * sizeof(Pair), most_bytes);
    std::vector<Pair> pairs;
    pairs.reserve(static_cast<std::size_t>(0.5 * n * (n + 1)));
    for (std::size_t i = 0; i < mesh.sides().size(); ++i)
        for (std::size_t j = i; j < mesh.sides().size(); ++j)
            pairs.push_back({mesh.sides()[i].root, mesh.sides()[j].root});
    return pairs;
}

/// The share of light that passes between two points.
double passing(RayQueries& rays, const SurfaceHit& from, const SurfaceHit& to) {
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
    return static_cast<double>(rays.visibility(start, end));
}

}  // namespace

double area_correction(const PatchNode& node) {
    return node.sagitta > 0 && node.polygon.area > 0 ? node.area / node.polygon.area : 1.0;
}

namespace {

/// The mean visibility of rays, each weighted by the light that it would carry: where patches touch, most light takes
/// the shortest ways.
class WeighedRays {
public:
    WeighedRays(RayQueries& rays, double area) : rays_(rays), area_(area) {}

    void add(const SurfaceHit& from, const SurfaceHit& to) {
        const Vec3d way = (to.p - from.p).cast<double>();
        const double distance2 = way.squaredNorm();
        const double cosines =
            std::max(0.0, from.ng.cast<double>().dot(way)) * std::max(0.0, -to.ng.cast<double>().dot(way));
        if (!(cosines > 0)) return;
        // The weight is the kernel with a bound: without it one ray could decide.
        const double weight = cosines / (distance2 * (distance2 + least_distance2 * area_));
        total_ += weight;
        const double share = passing(rays_, from, to);
        all_ &= share == 1;
        passed_ += weight * share;
    }
    bool has_rays() const { return total_ > 0; }
    /// 0 without rays: curved patches may be back to back although their chords face each other.
    double share() const {
        if (!has_rays()) return 0;
        return all_ ? 1.0 : passed_ / total_;
    }

private:
    static constexpr double least_distance2 = 0.05;  // as a share of the area

    RayQueries& rays_;
    double area_;
    double total_ = 0, passed_ = 0;
    bool all_ = true;
};

}  // namespace

constexpr std::uint32_t most_tries = 16;  // times the number of rays

double visibility_between(RayQueries& rays, const PatchMesh& mesh, const PatchNode& p, const PatchNode& q,
                          std::uint32_t n, std::uint64_t key) {
    WeighedRays mean(rays, std::min(p.area, q.area));
    // Points that do not face each other cost no ray. More are tried if only small parts of the nodes
    // face each other.
    for (std::uint32_t i = 0; i < n || (i < most_tries * n && !mean.has_rays()); ++i) {
        const Sampler u(PointSet::sobol, key, 0, i);
        mean.add(mesh.point_on(p, u.get_2d(0).cast<double>()), mesh.point_on(q, u.get_2d(1).cast<double>()));
    }
    return mean.share();
}

double visibility_from(RayQueries& rays, const PatchMesh& mesh, const SurfaceHit& point, const PatchNode& q,
                       std::uint32_t n, std::uint64_t key) {
    WeighedRays mean(rays, q.area);
    for (std::uint32_t i = 0; i < n || (i < most_tries * n && !mean.has_rays()); ++i)
        mean.add(point, mesh.point_on(q, Sampler(PointSet::sobol, key, 0, i).get_2d(0).cast<double>()));
    return mean.share();
}

PatchLinks link_patches(const PatchMesh& mesh, const PatchLight& light, const LinkSettings& settings,
                        const StageTimes* stages) {
    const Refinement refinement(mesh, light, settings);
    PatchLinks result;
    std::vector<Pair> pairs = pairs_of_sides(mesh, settings.most_bytes);
    struct Block {
        std::vector<PatchLink> links;
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
                refinement.look_at(rays, pairs[i], blocks[b].links, blocks[b].pairs);
            traced += rays.count();
            if (progress) progress->add(end - begin);
        });
        std::size_t next = 0, links = result.links.size();
        for (const Block& block : blocks) {
            next += block.pairs.size();
            links += block.links.size();
        }
        check_bytes(
            static_cast<double>(links) * LinkTable::bytes_per_link + static_cast<double>(next) * 2 * sizeof(Pair),
            settings.most_bytes);
        pairs.clear();
        pairs.reserve(next);
        for (const Block& block : blocks) {
            pairs.insert(pairs.end(), block.pairs.begin(), block.pairs.end());
            result.links.insert(result.links.end(), block.links.begin(), block.links.end());
        }
    }
    result.rays = traced;
    return result;
}

LinkTable::LinkTable(const std::vector<PatchLink>& links, std::size_t nodes) : begin_(nodes + 1, 0) {
    for (const PatchLink& link : links) {
        ++begin_[link.p + 1];
        if (link.q != link.p) ++begin_[link.q + 1];
    }
    for (std::size_t i = 0; i < nodes; ++i)
        begin_[i + 1] += begin_[i];
    entries_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (const PatchLink& link : links) {
        entries_[next[link.p]++] = {link.q, link.exchange, link.clear};
        if (link.q != link.p) entries_[next[link.q]++] = {link.p, link.exchange, link.clear};
    }
}

}  // namespace gib
