#include "methods/guided_path/radiance_field.h"

#include "methods/parts/stored_light/stored_light.h"

#include "common/sampling/warp.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace gib {

namespace {

// A quadrant is cut if it holds more than this share of its leaf's light (Mueller 2017, section 3.2).
constexpr double cut_above = 0.01;
// See concentrated_share(). Of 64 x 64 pixels after 255 passes, less than a tenth of the paths come to denser light in ten scenes of
// the library, such as cornell-box (none) and fog (0.05), and more than a fifth in eleven, such as door-ajar (0.27).
constexpr double concentrated_density = 12;
constexpr int most_cuts = 16;  // the numbers of directions in float allow no more
constexpr std::size_t nodes_of_small_tree = 64;
// The probability to follow the field, which has no light in some directions from where light comes: the weight of the bsdf's
// directions, at most twice that without a field, bounds what this costs.
constexpr float selection = 0.5f;
// Numbers of quanta in the unit, and in the largest value that is recorded whole. Sums hold more than 2^15 of these.
constexpr double quanta_of_unit = 0x1p28, most_quanta = 0x1p47;

/// Surfaces that face in six directions, and media, have trees of their own: a wall is lit otherwise in front than behind, and the
/// cosine of light that arrives belongs to one normal.
constexpr std::uint32_t trees = 7;
std::uint32_t tree_of(const Vec3& normal) {
    if (normal.isZero()) return trees - 1;
    int axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    return 2 * static_cast<std::uint32_t>(axis) + (normal[axis] < 0.f ? 1 : 0);
}

/// The square of directions keeps areas: its coordinates are (z + 1) / 2 and the azimuth [turns].
Vec2 square_of(const Vec3& w) {
    const float turns = std::atan2(w.y(), w.x()) * (0.5f * inv_pi);
    const float most = 1.f - unit_roundoff;
    return {std::clamp(0.5f * (w.z() + 1.f), 0.f, most), std::clamp(turns < 0.f ? turns + 1.f : turns, 0.f, most)};
}
Vec3 direction_of(const Vec2& square) { return square_to_sphere({1.f - square.x(), square.y()}); }

/// The quadrant of x, which becomes the place within that quadrant.
std::size_t descend(Vec2& x) {
    std::size_t quadrant = 0;
    for (int i = 0; i < 2; ++i) {
        x[i] *= 2.f;
        if (x[i] < 1.f) continue;
        x[i] -= 1.f;
        quadrant |= std::size_t{1} << i;
    }
    return quadrant;
}

/// Chooses between halves of these shares. `u` becomes uniform again.
bool choose_upper(float lower, float upper, float& u) {
    const float first = lower / (lower + upper);
    const bool is_upper = upper > 0.f && !(u < first);
    u = std::clamp(is_upper ? (u - first) / (1.f - first) : u / first, 0.f, 1.f - unit_roundoff);
    return is_upper;
}

template <typename Integer>
void add(Integer& sum, double quanta) {
    std::atomic_ref(sum).fetch_add(static_cast<Integer>(std::llround(quanta)), std::memory_order_relaxed);
}

}  // namespace

RadianceField::RadianceField(const Bounds& bounds, double unit, double memory, std::uint64_t fewest)
    : corner_(bounds.lower),
      edge_((bounds.upper - bounds.lower).maxCoeff()),
      quantum_(unit / quanta_of_unit),
      fewest_visits_(fewest),
      // Two trees exist while one is made of the other. Leaves take less than a twentieth of the memory of their nodes.
      most_nodes_(
          std::max(static_cast<std::size_t>(memory / (2.1 * sizeof(Node) + sizeof(Sums))), nodes_of_small_tree)),
      boxes_(trees),
      leaves_(trees),
      nodes_(trees) {
    static_assert(sizeof(Leaf) + 4 * sizeof(Box) < nodes_of_small_tree * sizeof(Node) / 20);
    if (!(edge_ > 0.f)) edge_ = 1.f;
    for (std::uint32_t tree = 0; tree < trees; ++tree)
        boxes_[tree].leaf = leaves_[tree].root = tree;
    nodes_.reserve(most_nodes_);
    sums_.reserve(most_nodes_);
    sums_.resize(trees);
    rebuilt_.reserve(most_nodes_);
}

double RadianceField::bytes() const {
    return static_cast<double>((nodes_.capacity() + rebuilt_.capacity()) * sizeof(Node) +
                               sums_.capacity() * sizeof(Sums) + leaves_.capacity() * sizeof(Leaf) +
                               boxes_.capacity() * sizeof(Box));
}

RadianceField::Place RadianceField::place(const Vec3& p, const Vec3& normal) const {
    Vec3 x = (p - corner_) * (1.f / edge_);  // in units of the box
    Place place{p, normal, 0, Vec3::Constant(edge_)};
    std::uint32_t box = tree_of(normal);
    for (int axis = 0; boxes_[box].children != 0; axis = axis == 2 ? 0 : axis + 1) {
        x[axis] *= 2.f;
        place.size[axis] *= 0.5f;
        const bool upper = x[axis] >= 1.f;
        if (upper) x[axis] -= 1.f;
        box = boxes_[box].children + (upper ? 1 : 0);
    }
    place.leaf = boxes_[box].leaf;
    return place;
}

float RadianceField::Distribution::pdf_w(const Vec3& wi) const {
    Vec2 x = square_of(wi);
    float density = 0.25f * inv_pi;
    for (std::uint32_t at = leaf_->root;;) {
        const Node& node = (*nodes_)[at];
        const std::size_t quadrant = descend(x);
        density *= 4.f * node.shares[quadrant];
        if (node.children[quadrant] == 0) return density;
        at = node.children[quadrant];
    }
}

RadianceField::Distribution::Sample RadianceField::Distribution::sample(Vec2 u) const {
    Vec2 corner = Vec2::Zero();
    float density = 0.25f * inv_pi, size = 1.f;
    for (std::uint32_t at = leaf_->root;;) {
        const Node& node = (*nodes_)[at];
        const auto& s = node.shares;
        const std::size_t right = choose_upper(s[0] + s[2], s[1] + s[3], u[0]) ? 1 : 0;
        const std::size_t up = choose_upper(s[right], s[right + 2], u[1]) ? 1 : 0;
        const std::size_t quadrant = right + 2 * up;
        density *= 4.f * s[quadrant];
        size *= 0.5f;
        corner += Vec2(static_cast<float>(right), static_cast<float>(up)) * size;
        if (node.children[quadrant] == 0) return {direction_of(corner + u * size), density};
        at = node.children[quadrant];
    }
}

void RadianceField::record(const Place& from, const Vec3& wi, double light, const VertexNumbers& u) {
    if (!(light > 0)) return;
    const auto& random = u.all();
    const Vec3 in_cell(random[0] - 0.5f, random[1] - 0.5f, random[2] - 0.5f);
    const Leaf& leaf = leaves_[place(from.p + from.size.cwiseProduct(in_cell), from.normal).leaf];
    const double quanta = std::min(light / quantum_, most_quanta);
    Vec2 x = square_of(wi);
    float size = 1.f;
    for (int pass = 0; pass < 2; ++pass) {
        Vec2 rest = x;
        std::uint32_t at = leaf.root;
        std::size_t quadrant = descend(rest);
        for (size = 0.5f; nodes_[at].children[quadrant] != 0; size *= 0.5f) {
            at = nodes_[at].children[quadrant];
            quadrant = descend(rest);
        }
        if (pass == 1) return add(sums_[at][quadrant], quanta);
        x += Vec2(random[3] - 0.5f, random[4] - 0.5f) * size;
        x.x() = std::min(std::abs(x.x()), 2.f - x.x());  // reflected at the poles
        x.y() -= std::floor(x.y());
        x = x.cwiseMin(1.f - unit_roundoff).cwiseMax(0.f);
    }
}

void RadianceField::visit(const Place& place, double reflected, double indirect) {
    Leaf& leaf = leaves_[place.leaf];
    add(leaf.visits, 1.);
    add(leaf.sum_of_reflected, std::min(reflected / quantum_, most_quanta));
    add(leaf.sum_of_indirect, std::min(indirect / quantum_, most_quanta));
}

void RadianceField::learn(double crowd) {
    add_up();
    split_crowded(crowd);
    rebuilt_.clear();
    double visits = 0, concentrated = 0;
    for (Leaf& leaf : leaves_) {
        const auto of_leaf = static_cast<double>(leaf.visits);
        visits += of_leaf;
        if (rebuild(leaf, most_nodes_ / leaves_.size()) > concentrated_density) concentrated += of_leaf;
    }
    concentrated_share_ = visits > 0 ? concentrated / visits : 0;
    nodes_.swap(rebuilt_);
    sums_.assign(nodes_.size(), Sums{});
}

/// Gives quadrants with children the sums of these.
void RadianceField::add_up() {
    for (std::size_t node = nodes_.size(); node-- > 0;)
        for (std::size_t q = 0; q < 4; ++q)
            if (const std::uint32_t child = nodes_[node].children[q]; child != 0)
                sums_[node][q] = sums_[child][0] + sums_[child][1] + sums_[child][2] + sums_[child][3];
}

/// Cuts boxes until each leaf has at most `most` visits. Both halves begin with what the whole knows.
void RadianceField::split_crowded(double most) {
    for (std::size_t box = 0; box < boxes_.size(); ++box) {
        const std::uint32_t leaf = boxes_[box].leaf;
        if (boxes_[box].children != 0 || !(static_cast<double>(leaves_[leaf].visits) > most)) continue;
        if (leaves_.size() >= most_nodes_ / nodes_of_small_tree) return;
        for (auto* sum : {&leaves_[leaf].visits, &leaves_[leaf].sum_of_reflected, &leaves_[leaf].sum_of_indirect})
            *sum /= 2;
        boxes_[box].children = static_cast<std::uint32_t>(boxes_.size());
        boxes_.push_back({0, leaf});
        boxes_.push_back({0, static_cast<std::uint32_t>(leaves_.size())});
        leaves_.push_back(Leaf(leaves_[leaf]));
    }
}

/// Makes the leaf's new quadtree in `rebuilt_`, level by level, so that a tree that reaches the limit is even.
/// Returns 4 pi times the mean density of directions [1/sr], over these directions; 0 if the leaf's light is not known.
double RadianceField::rebuild(Leaf& leaf, std::size_t most_nodes) {
    struct Square {
        std::uint32_t node;
        std::uint32_t old;  ///< 0: there was none
        std::array<double, 4> sums;
        int cuts;
    };
    const auto sums_of = [&](std::uint32_t node) {
        std::array<double, 4> sums;
        std::transform(sums_[node].begin(), sums_[node].end(), sums.begin(), [](auto sum) { return double(sum); });
        return sums;
    };
    const auto total_of = [](const std::array<double, 4>& sums) { return sums[0] + sums[1] + sums[2] + sums[3]; };
    const auto root = static_cast<std::uint32_t>(rebuilt_.size());
    std::vector<Square> squares = {{root, leaf.root, sums_of(leaf.root), 1}};
    const double flux = total_of(squares[0].sums);
    const double least = flux * cut_above;
    double density = 0;
    rebuilt_.emplace_back();
    for (std::size_t i = 0; i < squares.size(); ++i) {
        const Square square = squares[i];
        const double total = total_of(square.sums);
        for (std::size_t q = 0; q < 4; ++q) {
            rebuilt_[square.node].shares[q] = static_cast<float>(total > 0 ? square.sums[q] / total : 0.25);
            if (!(square.sums[q] > least) || square.cuts == most_cuts || squares.size() == most_nodes) {
                if (flux > 0) density += std::ldexp(sqr(square.sums[q] / flux), 2 * square.cuts);
                continue;
            }
            const std::uint32_t old = square.cuts == 1 || square.old != 0 ? nodes_[square.old].children[q] : 0;
            const double quarter = 0.25 * square.sums[q];
            const auto child = static_cast<std::uint32_t>(rebuilt_.size());
            rebuilt_[square.node].children[q] = child;
            rebuilt_.emplace_back();
            squares.push_back({child, old, old != 0 ? sums_of(old) : std::array{quarter, quarter, quarter, quarter},
                               square.cuts + 1});
        }
    }
    const bool known = leaf.visits >= fewest_visits_;
    const double unit = quantum_ / static_cast<double>(std::max<std::uint64_t>(leaf.visits, 1));
    leaf = {.root = root,
            .selection = flux > 0 && known ? selection : 0.f,
            .reflected = known ? static_cast<float>(static_cast<double>(leaf.sum_of_reflected) * unit) : leaf.reflected,
            .indirect = known ? static_cast<float>(static_cast<double>(leaf.sum_of_indirect) * unit) : leaf.indirect};
    return known ? density : 0;
}

}  // namespace gib
