#include "tests/samplers/adaptive_quadrature.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <stdexcept>

namespace gib::test {

namespace {

/// A box with its integral by one application of the rule, and the integrals of its halves, for a cut across x and
/// for one across y.
struct Box {
    Rectangle area;
    double whole;
    std::array<std::array<double, 2>, 2> halves;

    double change(std::size_t axis) const { return std::abs(halves[axis][0] + halves[axis][1] - whole); }
    std::size_t worse_axis() const { return change(0) >= change(1) ? 0 : 1; }
    double error() const { return change(0) + change(1); }
    double value() const { return halves[worse_axis()][0] + halves[worse_axis()][1]; }
};

std::array<Rectangle, 2> halve(const Rectangle& r, std::size_t axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    std::array<Rectangle, 2> halves = {r, r};
    halves[0].upper[i] = halves[1].lower[i] = 0.5 * (r.lower[i] + r.upper[i]);
    return halves;
}

class Rule {
public:
    explicit Rule(const PlaneFunction& f) : f_(f) {}

    /// The rule is exact for cubics along each axis. Like Simpson's rule it has nodes at the sides, so that a box
    /// notices a jump that cuts off a sliver of it, which all nodes of Gauss's rule would miss. The nodes lie
    /// slightly inside, because the density may jump between two boxes.
    double operator()(const Rectangle& r) {
        constexpr double inset = 0.995;
        constexpr std::array<double, 3> node = {-inset, 0, inset};
        constexpr double outer = 1 / (6 * inset * inset);
        constexpr std::array<double, 3> weight = {outer, 1 - 2 * outer, outer};
        const Vec2d middle = 0.5 * (r.lower + r.upper), half = 0.5 * r.extent();
        double sum = 0;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j)
                sum += weight[i] * weight[j] * at(middle + half.cwiseProduct(Vec2d(node[i], node[j])));
        return sum * r.area();
    }

    Box examine(const Rectangle& r, double whole) {
        Box box{r, whole, {}};
        for (std::size_t axis : {0u, 1u}) {
            const auto halves = halve(r, axis);
            box.halves[axis] = {(*this)(halves[0]), (*this)(halves[1])};
        }
        return box;
    }

    std::size_t evaluations() const { return evaluations_; }

private:
    double at(const Vec2d& x) {
        ++evaluations_;
        const double value = f_(x);
        if (!std::isfinite(value)) {
            std::ostringstream message;
            message << "not finite at (" << x.x() << ", " << x.y() << "): " << value;
            throw std::domain_error(message.str());
        }
        return value;
    }

    const PlaneFunction& f_;
    std::size_t evaluations_ = 0;
};

}  // namespace

Integral integrate(const PlaneFunction& f, const std::vector<Rectangle>& boxes,
                   const std::function<double(double)>& tolerance, std::size_t max_evaluations) {
    Rule rule(f);
    const auto less_wrong = [](const Box& a, const Box& b) { return a.error() < b.error(); };
    std::vector<Box> heap;
    double value = 0, variance = 0;
    const auto add = [&](const Box& box, double sign) {
        value += sign * box.value();
        variance += sign * sqr(box.error());
    };
    for (const Rectangle& r : boxes) {
        heap.push_back(rule.examine(r, rule(r)));
        add(heap.back(), 1);
    }
    std::make_heap(heap.begin(), heap.end(), less_wrong);
    const auto wrong = [&] { return variance > sqr(tolerance(value)); };
    while (wrong() && rule.evaluations() < max_evaluations) {
        std::pop_heap(heap.begin(), heap.end(), less_wrong);
        const Box box = heap.back();
        heap.pop_back();
        add(box, -1);
        const auto parts = halve(box.area, box.worse_axis());
        for (std::size_t i : {0u, 1u}) {
            heap.push_back(rule.examine(parts[i], box.halves[box.worse_axis()][i]));
            add(heap.back(), 1);
            std::push_heap(heap.begin(), heap.end(), less_wrong);
        }
    }
    return {value, std::sqrt(std::max(variance, 0.0)), !wrong()};
}

}  // namespace gib::test
