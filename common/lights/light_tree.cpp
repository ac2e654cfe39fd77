#include "common/lights/light_tree.h"

#include "common/lights/emission_bounds.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <tuple>

namespace gib {

namespace {

/// The part of the choices that is even. It costs at most 1 / 0.8 = 1.25 times the variance where importance is right, and
/// bounds the variance by five times that of an even choice where it is not.
constexpr double even_share = 0.2;

/// An angle in [0, pi] by its cosine and sine.
struct Angle {
    double cosine, sine;

    /// The difference, or 0 if `other` is larger.
    Angle minus(const Angle& other) const {
        if (cosine >= other.cosine) return {1, 0};
        return {cosine * other.cosine + sine * other.sine, sine * other.cosine - cosine * other.sine};
    }
};

/// Takes one random number apart into a sequence of choices.
struct Choices {
    double u;

    /// Whether an event of this probability happens; u is uniform again afterwards.
    bool happens(double chance) {
        const bool yes = u < chance;
        u = yes ? u / chance : (u - chance) / (1 - chance);
        return yes;
    }
};

struct Ball {
    Vec3d center;
    double radius;
};

/// The smallest ball that holds both.
Ball ball_around(const Ball& a, const Ball& b) {
    const Vec3d between = b.center - a.center;
    const double distance = between.norm();
    if (distance + b.radius <= a.radius) return a;
    if (distance + a.radius <= b.radius) return b;
    const double radius = 0.5 * (distance + a.radius + b.radius);
    // The factor is for the rounding of the centre.
    return {a.center + between * ((radius - a.radius) / distance), radius * (1 + 1e-12)};
}

/// The emission at an angle of this cosine beyond the cone's spread, as a share of the peak: the cosine of a surface, or
/// the fall of a spot, which is linear in the angle, as sin(angle / 2) / sin(fall / 2) nearly is.
double share_of_peak(const EmissionCone& cone, double cosine) {
    if (cosine < cone.cos_fall) return 0;
    if (!(cone.cos_fall < 1)) return 1;
    const double squared = std::max(1 - cosine, 0.0) / (1 - cone.cos_fall);
    return cone.fall < 0.5 * std::numbers::pi ? 1 - std::sqrt(squared) : 1 - squared;
}

}  // namespace

EmissionCone::EmissionCone(const Vec3d& along, double theta_o, double theta_e)
    : axis(along),
      spread(theta_o),
      fall(theta_e),
      cos_spread(std::cos(theta_o)),
      sin_spread(std::sin(theta_o)),
      cos_fall(std::cos(theta_e)) {}

/// With the spread s, the fall F and t the angle beyond s, this is 2 pi times
///     1 - cos s + integral from 0 to e of sin(s + t) (cos t - cos F) / (1 - cos F) dt, e = min(F, pi - s).
/// The integral is (sin s A + cos s B) / q, written here without cancellation, with q = 1 - cos F and p = 1 - cos e.
double EmissionCone::solid_angle() const {
    const auto one_minus_cos = [](double angle) { return 2 * sqr(std::sin(0.5 * angle)); };
    const double q = one_minus_cos(fall), end = std::min(fall, std::numbers::pi - spread), p = one_minus_cos(end);
    const double a = 0.5 * (end - std::sin(end) * std::cos(end)) + std::sin(end) * (q - p), b = p * (q - 0.5 * p);
    const double falling = q > 0 ? (sin_spread * a + cos_spread * b) / q : 0;
    return 2 * std::numbers::pi * (one_minus_cos(spread) + falling);
}

EmissionCone united(const EmissionCone& first, const EmissionCone& second) {
    const bool ordered = first.spread >= second.spread;
    const EmissionCone &a = ordered ? first : second, &b = ordered ? second : first;
    const double fall = std::max(a.fall, b.fall);
    const double between = std::acos(std::clamp(a.axis.dot(b.axis), -1.0, 1.0));
    if (std::min(between + b.spread, std::numbers::pi) <= a.spread) return {a.axis, a.spread, fall};
    const double spread = 0.5 * (a.spread + between + b.spread);
    if (spread >= std::numbers::pi) return {a.axis, std::numbers::pi, fall};
    // The axis turns until the cone touches the far side of both.
    const double turn = spread - a.spread;
    const Vec3d across = b.axis - a.axis.dot(b.axis) * a.axis;
    const Vec3d side = across.squaredNorm() > 1e-20 ? across.normalized() : a.axis.unitOrthogonal();
    return {(std::cos(turn) * a.axis + std::sin(turn) * side).normalized(), spread, fall};
}

double LightBounds::importance(const LitPoint& at) const {
    const Vec3d way = at.p.cast<double>() - center;
    if (at.side.cast<double>().dot(way) > radius) return 0;
    const double d2 = way.squaredNorm(), r2 = sqr(radius);
    if (d2 <= r2) return r2 > 0 ? intensity / r2 : 0;
    const double cosine = std::clamp(cone.axis.dot(way) / std::sqrt(d2), -1.0, 1.0);
    const Angle to_axis{cosine, std::sqrt(1 - sqr(cosine))};
    const Angle of_ball{std::sqrt(1 - r2 / d2), std::sqrt(r2 / d2)};
    const Angle least = to_axis.minus(of_ball).minus({cone.cos_spread, cone.sin_spread});
    return intensity * share_of_peak(cone, least.cosine) / d2;
}

LightBounds bounds_of(const Light& light, const std::vector<Shape>& shapes) {
    const RayBundle rays = emission_bundle(light, shapes, EmissionBox());
    const double half = std::min(rays.cone.half_angle, std::numbers::pi), quarter_turn = 0.5 * std::numbers::pi;
    LightBounds bounds{rays.center, rays.radius, {}, 0};
    if (const auto* spot = std::get_if<SpotLight>(&light)) {
        const double beam = std::min(spot->beam_width(), half);
        bounds.cone = {rays.cone.axis, beam, half - beam};
        bounds.intensity = power_of(light).mean() * spot->pdf_w(rays.cone.axis.cast<float>());
        return bounds;
    }
    // A surface emits with a cosine about its normals, which lie a quarter turn inside the cone of its rays.
    if (is_point(light)) bounds.cone = {rays.cone.axis, half, 0};
    else if (half >= std::numbers::pi) bounds.cone = {rays.cone.axis, std::numbers::pi, quarter_turn};
    else bounds.cone = {rays.cone.axis, std::max(half - quarter_turn, 0.0), quarter_turn};
    bounds.intensity = power_of(light).mean() / bounds.cone.solid_angle();
    return bounds;
}

LightBounds united(const LightBounds& a, const LightBounds& b) {
    const Ball ball = ball_around({a.center, a.radius}, {b.center, b.radius});
    return {ball.center, ball.radius, united(a.cone, b.cone), a.intensity + b.intensity};
}

struct LightTree::Leaf {
    std::uint32_t light;
    LightBounds bounds;
};

namespace {

/// The irradiance of a light at infinity (LightTree::Distant); none for other lights.
std::optional<double> irradiance_of_distant(const Light& light) {
    if (const auto* sun = std::get_if<DirectionalLight>(&light)) return double{sun->irradiance.mean()};
    if (!is_environment(light)) return std::nullopt;
    const auto* const constant = std::get_if<ConstantEnvironment>(&light);
    const BoundingSphere& scene = constant ? constant->scene : std::get<MappedEnvironment>(light).scene;
    return 0.25 * power_of(light).mean() / scene.area();
}

}  // namespace

LightTree::LightTree(const std::vector<Light>& lights, const std::vector<Shape>& shapes)
    : leaf_of_(lights.size(), none) {
    std::vector<Leaf> leaves;
    for (std::uint32_t l = 0; l < lights.size(); ++l) {
        if (!(power_of(lights[l]).mean() > 0)) continue;
        if (const auto irradiance = irradiance_of_distant(lights[l])) {
            const auto* const sun = std::get_if<DirectionalLight>(&lights[l]);
            distant_.push_back({l, *irradiance, sun ? sun->direction : Vec3(Vec3::Zero())});
        } else {
            leaves.push_back({l, bounds_of(lights[l], shapes)});
            finite_.push_back(l);
        }
    }
    if (distant_.size() + finite_.size() == 1) only_ = distant_.empty() ? finite_[0] : distant_[0].light;
    if (leaves.empty()) return;
    nodes_.reserve(2 * leaves.size() - 1);
    nodes_.push_back({{}, none, none, none});
    build(leaves, 0, leaves.size(), 0);
}

/// Makes the tree of some leaves below `node`.
void LightTree::build(std::vector<Leaf>& leaves, std::size_t begin, std::size_t end, std::uint32_t node) {
    if (end - begin == 1) {
        const Leaf& leaf = leaves[begin];
        nodes_[node].bounds = leaf.bounds;
        nodes_[node].light = leaf.light;
        leaf_of_[leaf.light] = node;
        return;
    }
    const std::size_t middle = split(leaves, begin, end);
    const auto child = static_cast<std::uint32_t>(nodes_.size());
    nodes_[node].child = child;
    nodes_.push_back({{}, node, none, none});
    nodes_.push_back({{}, node, none, none});
    build(leaves, begin, middle, child);
    build(leaves, middle, end, child + 1);
    nodes_[node].bounds = united(nodes_[child].bounds, nodes_[child + 1].bounds);
}

/// Sorts the leaves and returns where to cut them in two. Among all cuts along the three axes it takes the one with the
/// least sum of intensity x solid angle x radius^2 over both halves: the lights of a half are near together and shine in
/// similar directions. Equal cuts are taken near the middle, so that the tree is not deep.
std::size_t LightTree::split(std::vector<Leaf>& leaves, std::size_t begin, std::size_t end) {
    const std::size_t count = end - begin;
    const auto sort_along = [&](Eigen::Index axis) {
        const auto first = leaves.begin();
        std::sort(first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(end),
                  [axis](const Leaf& a, const Leaf& b) {
                      const double x = a.bounds.center[axis], y = b.bounds.center[axis];
                      return x != y ? x < y : a.light < b.light;
                  });
    };
    const auto cost = [](const LightBounds& b) { return b.intensity * b.cone.solid_angle() * sqr(b.radius); };
    const auto from_middle = [&](std::size_t size) {
        return size < count - size ? count - 2 * size : 2 * size - count;
    };
    struct Cut {
        double cost;
        std::size_t from_middle, size;
        Eigen::Index axis;
    };
    Cut best{std::numeric_limits<double>::infinity(), count, count / 2, 0};
    std::vector<double> above(count);  // the cost of the leaves from i on
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        sort_along(axis);
        LightBounds sum = leaves[end - 1].bounds;
        for (std::size_t i = count - 1; i > 0; --i) {
            if (i < count - 1) sum = united(sum, leaves[begin + i].bounds);
            above[i] = cost(sum);
        }
        sum = leaves[begin].bounds;
        for (std::size_t i = 1; i < count; ++i) {
            if (i > 1) sum = united(sum, leaves[begin + i - 1].bounds);
            const Cut cut{cost(sum) + above[i], from_middle(i), i, axis};
            if (std::tie(cut.cost, cut.from_middle) < std::tie(best.cost, best.from_middle)) best = cut;
        }
    }
    sort_along(best.axis);
    return begin + best.size;
}

double LightTree::share(double importance, double sum) const {
    const auto groups = static_cast<double>(distant_.size() + (nodes_.empty() ? 0 : 1));
    return (1 - even_share) * (sum > 0 ? importance / sum : 1 / groups) + even_share / groups;
}

double LightTree::importance_of_all(const LitPoint& at) const {
    double sum = importance_of_tree(at);
    for (const Distant& distant : distant_)
        sum += distant.importance(at);
    return sum;
}

std::optional<LightTree::Choice> LightTree::choose_of_several(const LitPoint& at, float u) const {
    const double sum = importance_of_all(at);
    Choices choices{double{u}};
    double rest = 1;  // the probability of what has not been asked for
    for (const Distant& distant : distant_) {
        const double chance = share(distant.importance(at), sum);
        const bool is_last = nodes_.empty() && &distant == &distant_.back();
        if (is_last || choices.happens(std::min(chance / rest, 1.0)))
            return Choice{distant.light, static_cast<float>(chance)};
        rest -= chance;
    }
    if (nodes_.empty()) return std::nullopt;
    std::optional<std::uint32_t> light;
    if (choices.happens(even_share)) {
        const auto count = static_cast<double>(finite_.size());
        light = finite_[static_cast<std::size_t>(std::min(choices.u * count, count - 1))];
    } else {
        light = descend(at, choices.u);
    }
    if (!light) return std::nullopt;
    return Choice{*light, static_cast<float>(share(importance_of_tree(at), sum) * probability_in_tree(at, *light))};
}

/// A light of the tree, node by node in proportion to importance; none if an importance turns out to be 0.
std::optional<std::uint32_t> LightTree::descend(const LitPoint& at, double u) const {
    Choices choices{u};
    std::uint32_t node = 0;
    while (nodes_[node].child != none) {
        const std::uint32_t child = nodes_[node].child;
        const double first = nodes_[child].bounds.importance(at), second = nodes_[child + 1].bounds.importance(at);
        if (!(first + second > 0)) return std::nullopt;
        node = choices.happens(first / (first + second)) ? child : child + 1;
    }
    return nodes_[node].light;
}

/// The probability of a light of the tree, given that the tree is chosen.
double LightTree::probability_in_tree(const LitPoint& at, std::uint32_t light) const {
    double by_importance = 1;
    for (std::uint32_t node = leaf_of_[light]; node != 0 && by_importance > 0; node = nodes_[node].parent) {
        const std::uint32_t first = nodes_[nodes_[node].parent].child;
        const double own = nodes_[node].bounds.importance(at);
        const double other = nodes_[node == first ? first + 1 : first].bounds.importance(at);
        by_importance *= own > 0 ? own / (own + other) : 0;
    }
    return (1 - even_share) * by_importance + even_share / static_cast<double>(finite_.size());
}

float LightTree::probability(const LitPoint& at, std::uint32_t light) const {
    if (only_) return light == *only_ ? 1.f : 0.f;
    const double sum = importance_of_all(at);
    for (const Distant& distant : distant_)
        if (distant.light == light) return static_cast<float>(share(distant.importance(at), sum));
    if (leaf_of_[light] == none) return 0.f;
    return static_cast<float>(share(importance_of_tree(at), sum) * probability_in_tree(at, light));
}

}  // namespace gib
