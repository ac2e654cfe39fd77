#include "methods/radiosity/form_factors/polygon_contour.h"

#include "methods/radiosity/form_factors/closest_approach.h"
#include "methods/radiosity/form_factors/quadrature_rules.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace gib {

namespace {

/// The inner contour, with the closed form of the integral around it.
class LogarithmicContour {
public:
    /// Lengths are measured in units of `scale`. This adds a constant to every logarithm, which cancels around the
    /// contour, and brings the logarithms near zero, where they lose fewer digits.
    LogarithmicContour(const ConvexRegion& region, double scale) : region_(region), scale_(scale) {
        for (std::size_t i = 0; i < region.size(); ++i) {
            const Vec3d edge = region.after(i) - region[i];
            lengths_[i] = edge.norm();
            directions_[i] = lengths_[i] > 0 ? Vec3d(edge / lengths_[i]) : Vec3d::Zero();
            perimeter_ += lengths_[i];
        }
    }

    double perimeter() const { return perimeter_; }

    /// The integral of ln |x - y| `along` . dy around the contour, up to a constant. With u the coordinate along an
    /// edge and p the distance of x from the edge's line, the integral of ln sqrt(u^2 + p^2) is
    /// u ln sqrt(u^2 + p^2) - u + p atan(u / p). The second term adds up to the constant, and the third is p times
    /// the angle that the edge subtends.
    double integral(const Vec3d& x, const Vec3d& along) const {
        std::array<Vec3d, ConvexRegion::max_vertices> rays;
        std::array<double, ConvexRegion::max_vertices> logarithms;
        for (std::size_t i = 0; i < region_.size(); ++i) {
            rays[i] = region_[i] - x;
            const double squared = rays[i].squaredNorm() / sqr(scale_);
            logarithms[i] = squared > 0 ? 0.5 * std::log(squared) : 0;  // its factor is 0
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

/// A section of an edge of the outer contour, with a coordinate t in [0, 1] that concentrates nodes at the section's
/// ends. With u = t^2 (3 - 2 t) the share of the way, the singular term u ln u du, which occurs where contours meet,
/// becomes about t^3 ln t dt.
struct Section {
    Vec3d from, along;

    double integrand(double t, const LogarithmicContour& inner) const {
        return 6 * t * (1 - t) * inner.integral(from + t * t * (3 - 2 * t) * along, along);
    }
};

/// The part of a section between two values of t.
struct Piece {
    Section section;
    double lower, upper;
    double value = 0, error = 0;

    bool operator<(const Piece& other) const { return error < other.error; }
};

/// The integral over a piece by Kronrod's 15 points. The error given is that of Gauss's 7 points, which
/// is far larger.
Piece integrated(const Section& section, double lower, double upper, const LogarithmicContour& inner) {
    const double middle = 0.5 * (lower + upper), half = 0.5 * (upper - lower);
    double kronrod = 0, gauss = 0;
    for (const KronrodNode& node : kronrod_15) {
        double value = section.integrand(middle + node.x * half, inner);
        if (node.x > 0) value += section.integrand(middle - node.x * half, inner);
        kronrod += node.weight * value;
        gauss += node.gauss_weight * value;
    }
    return {.section = section,
            .lower = lower,
            .upper = upper,
            .value = half * kronrod,
            .error = half * std::abs(kronrod - gauss)};
}

/// The points at which to divide an edge of the outer contour, as shares of its length: those closest to
/// vertices and edges of the inner contour. There the integrand bends as sharply as |x|, which a rule for smooth
/// functions may miss.
std::vector<double> divisions(const Vec3d& from, const Vec3d& to, const ConvexRegion& inner) {
    // A share of the length: what is farther away shows in the difference between the two rules.
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
    std::vector<Piece> pieces;  // a heap: the piece with the largest error comes first
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
