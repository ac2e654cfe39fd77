#include "methods/radiosity/form_factors/polygon_contour.h"

#include "methods/radiosity/form_factors/closest_approach.h"
#include "methods/radiosity/form_factors/quadrature_rules.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace gib {

namespace {

/// The inner contour.
class LogarithmicContour {
public:
    /// Lengths count in units of `scale`, which adds a constant to every logarithm: it cancels around the contour, and
    /// logarithms near zero lose fewer digits.
    LogarithmicContour(const ConvexRegion& region, double scale) : region_(region), scale_(scale) {
        for (std::size_t i = 0; i < region.size(); ++i) {
            const Vec3d edge = region.after(i) - region[i];
            lengths_[i] = edge.norm();
            directions_[i] = lengths_[i] > 0 ? Vec3d(edge / lengths_[i]) : Vec3d::Zero();
            perimeter_ += lengths_[i];
        }
    }

    double perimeter() const { return perimeter_; }

    /// The integral of ln |x - y| `along` . dy, but for a constant. With u the coordinate along an edge and p the
    /// distance from its line, the integral of ln sqrt(u^2 + p^2) is u ln sqrt(u^2 + p^2) - u + p atan(u / p); the
    /// second term adds up to that constant, and the third to p times the angle that the edge subtends.
    double integral(const Vec3d& x, const Vec3d& along) const {
        std::array<Vec3d, ConvexRegion::max_vertices> rays;
        std::array<double, ConvexRegion::max_vertices> logarithms;
        for (std::size_t i = 0; i < region_.size(); ++i) {
            rays[i] = region_[i] - x;
            const double squared = rays[i].squaredNorm() / sqr(scale_);
            logarithms[i] = squared > 0 ? 0.5 * std::log(squared) : 0;  // it is multiplied by 0
        }
        double sum = 0;
        for (std::size_t i = 0; i < region_.size(); ++i) {
            const double cosine = along.dot(directions_[i]);
            if (cosine == 0) continue;
            const std::size_t next = i + 1 == region_.size() ? 0 : i + 1;
            const double p = rays[i].cross(directions_[i]).norm();
            const double angle = std::atan2(p * lengths_[i], rays[i].dot(rays[next]));
            sum += cosine * (rays[next].dot(directions_[i]) * logarithms[next] -
                             rays[i].dot(directions_[i]) * logarithms[i] + p * angle);
        }
        return sum;
    }

private:
    const ConvexRegion& region_;
    double scale_, perimeter_ = 0;
    std::array<double, ConvexRegion::max_vertices> lengths_;
    std::array<Vec3d, ConvexRegion::max_vertices> directions_;
};

/// A section of an edge of the outer contour, with the coordinate t in [0, 1] that gathers nodes at its ends: with u =
/// t^2 (3 - 2 t) of the way, u ln u du, as where contours meet, becomes about t^3 ln t dt.
struct Section {
    Vec3d from, along;

    double integrand(double t, const LogarithmicContour& inner) const {
        return 6 * t * (1 - t) * inner.integral(from + t * t * (3 - 2 * t) * along, along);
    }
};

/// The part between two values of t.
struct Piece {
    Section section;
    double lower, upper;
    double value = 0, error = 0;

    bool operator<(const Piece& other) const { return error < other.error; }
};

/// The error is that of Gauss's 7 points, far above that of the 15 that give the value.
Piece integrated(const Section& section, double lower, double upper, const LogarithmicContour& inner) {
    const double middle = 0.5 * (lower + upper), half = 0.5 * (upper - lower);
    double kronrod = 0, gauss = 0;
    for (const KronrodNode& node : kronrod_15) {
        double value = section.integrand(middle + node.x * half, inner);
        if (node.x > 0) value += section.integrand(middle - node.x * half, inner);
        kronrod += node.weight * value;
        gauss += node.gauss_weight * value;
    }
    return {section, lower, upper, half * kronrod, half * std::abs(kronrod - gauss)};
}

/// Where to divide an edge of the outer contour: next to vertices and edges of the inner one. There the integrand bends
/// as sharply as |x|, and a rule for smooth functions may not notice.
std::vector<double> divisions(const Vec3d& from, const Vec3d& to, const ConvexRegion& inner) {
    // Of the length: what is farther away shows in the difference between the two rules.
    constexpr double near = 0.125;
    const double length = (to - from).norm();
    std::vector<double> places = {0, 1};
    const auto add = [&](const ClosestApproach& place) {
        if (place.distance < near * length) places.push_back(place.s);
    };
    for (std::size_t i = 0; i < inner.size(); ++i) {
        add(closest_approach(from, to, inner[i], inner[i]));
        add(closest_approach(from, to, inner[i], inner.after(i)));
    }
    std::ranges::sort(places);
    const auto same = [](double a, double b) { return b - a < 1e-9; };
    places.erase(std::unique(places.begin(), places.end(), same), places.end());
    places.back() = 1;
    return places;
}

}  // namespace

double contour_integral(const ConvexRegion& outer, const ConvexRegion& inner, double error_share, double negligible) {
    const LogarithmicContour contour(inner, inner.radius(inner.mean()));
    std::vector<Piece> pieces;  // a heap: the piece of the largest error first
    const auto add = [&](const Section& section, double lower, double upper) {
        pieces.push_back(integrated(section, lower, upper, contour));
        std::push_heap(pieces.begin(), pieces.end());
    };
    double perimeter = 0;
    for (std::size_t i = 0; i < outer.size(); ++i) {
        const Vec3d &from = outer[i], edge = outer.after(i) - from;
        const std::vector<double> places = divisions(from, outer.after(i), inner);
        for (std::size_t k = 1; k < places.size(); ++k)
            add({from + places[k - 1] * edge, (places[k] - places[k - 1]) * edge}, 0, 1);
        perimeter += edge.norm();
    }
    const double rounding = 32 * std::numeric_limits<double>::epsilon() * perimeter * contour.perimeter();
    for (;;) {
        double value = 0, error = 0;
        for (const Piece& piece : pieces) {
            value += piece.value;
            error += piece.error;
        }
        const double accepted = error_share * std::max(std::abs(value), 2 * std::numbers::pi * negligible);
        if (!(error > std::max(accepted, rounding))) return value / (2 * std::numbers::pi);
        std::pop_heap(pieces.begin(), pieces.end());
        const Piece worst = pieces.back();
        pieces.pop_back();
        const double middle = 0.5 * (worst.lower + worst.upper);
        add(worst.section, worst.lower, middle);
        add(worst.section, middle, worst.upper);
    }
}

}  // namespace gib
