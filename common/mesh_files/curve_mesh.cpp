#include "common/mesh_files/curve_mesh.h"

#include "common/core/reject.h"
#include "common/core/text_cursor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gib {

namespace {

constexpr double most_triangles = 4e6;
constexpr int fewest_sides = 6, most_sides = 32;

/// A point on a curve: x, y, z and the radius.
using Knot = Eigen::Vector4d;
using Curve = std::vector<Knot>;

std::vector<Curve> parse_control_points(std::string_view text, const std::string& file, std::size_t fewest) {
    TextCursor cursor(text, file);
    std::vector<Curve> curves;
    SourceLocation last;
    bool is_open = false;
    const auto close = [&] {
        if (is_open && curves.back().size() < fewest)
            reject(last, "a curve needs {} control points, found {}", fewest, curves.back().size());
        is_open = false;
    };
    for (; !cursor.at_end(); cursor.next_line()) {
        cursor.skip_blanks();
        if (cursor.at_line_end()) {
            close();
            continue;
        }
        last = cursor.location();
        if (!is_open) curves.emplace_back();
        is_open = true;
        Knot knot;
        for (int i = 0; i < 4; ++i)
            knot[i] = cursor.finite_number("a control point");
        if (!(knot[3] > 0)) reject(last, "the radius of a curve must be above 0, not {}", knot[3]);
        cursor.skip_blanks();
        if (!cursor.at_line_end()) reject(cursor.location(), "a control point has four numbers: x y z radius");
        curves.back().push_back(knot);
    }
    close();
    if (curves.empty()) throw InputError(cursor.location(), "the file has no curves");
    return curves;
}

/// Points on a B-spline, `steps` for each of its spans.
Curve points_on(const Curve& control, int steps) {
    Curve points;
    for (std::size_t i = 0; i + 3 < control.size(); ++i)
        for (int k = i == 0 ? 0 : 1; k <= steps; ++k) {
            const double t = 1.0 * k / steps, s = 1 - t;
            points.push_back((s * s * s * control[i] + (3 * t * t * t - 6 * t * t + 4) * control[i + 1] +
                              (3 * s * s * s - 6 * s * s + 4) * control[i + 2] + t * t * t * control[i + 3]) /
                             6);
        }
    return points;
}

class TubeMaker {
public:
    explicit TubeMaker(int sides) : sides_(sides) {
        const double angle = 2 * std::numbers::pi / sides;
        stretch_ = std::sqrt(angle / std::sin(angle));  // a polygon and a circle of one area
    }

    void add(const Curve& points) {
        Vec3d across = Vec3d::Zero();
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Vec3d before = points[i > 0 ? i - 1 : i].head<3>(),
                        after = points[std::min(i + 1, points.size() - 1)].head<3>();
            const Vec3d along = (after - before).normalized();
            // The last direction across the curve, turned as little as possible.
            across -= across.dot(along) * along;
            if (!(across.norm() > 1e-6)) across = Frame(along.cast<float>()).s.cast<double>();
            across = (across - across.dot(along) * along).normalized();
            add_ring(points[i], across, along.cross(across));
            if (i > 0) connect_rings();
        }
    }

    MeshData mesh;

private:
    void add_ring(const Knot& center, const Vec3d& x, const Vec3d& y) {
        for (int k = 0; k < sides_; ++k) {
            const double angle = 2 * std::numbers::pi * k / sides_;
            const Vec3d normal = std::cos(angle) * x + std::sin(angle) * y;
            mesh.positions.push_back(center.head<3>() + stretch_ * center[3] * normal);
            mesh.normals.push_back(normal.cast<float>());
        }
    }
    /// Fills the space between the last two rings.
    void connect_rings() {
        const auto sides = static_cast<std::uint32_t>(sides_);
        const auto upper = static_cast<std::uint32_t>(mesh.positions.size()) - sides, lower = upper - sides;
        for (std::uint32_t k = 0; k < sides; ++k) {
            const std::uint32_t next = (k + 1) % sides;
            mesh.triangles.push_back({lower + k, lower + next, upper + next});
            mesh.triangles.push_back({lower + k, upper + next, upper + k});
        }
    }

    int sides_;
    double stretch_;
};

}  // namespace

MeshData parse_curves(std::string_view text, const std::string& file, CurveKind kind, const Mat4d& to_world) {
    const bool bspline = kind == CurveKind::bspline;
    std::vector<Curve> curves = parse_control_points(text, file, bspline ? 4 : 2);
    double pieces = 0;
    for (Curve& curve : curves) {
        for (Knot& knot : curve)
            knot.head<3>() = (to_world * Eigen::Vector4d(knot[0], knot[1], knot[2], 1)).head<3>();
        // Control points in one place, which would leave a tube without a direction.
        const auto same = [](const Knot& a, const Knot& b) { return a.head<3>() == b.head<3>(); };
        if (!bspline) curve.erase(std::unique(curve.begin(), curve.end(), same), curve.end());
        pieces += static_cast<double>(curve.size()) - (bspline ? 3 : 1);
    }
    // A span of a B-spline has half as many steps as a ring has sides.
    const double wanted = bspline ? std::sqrt(most_triangles / pieces) : most_triangles / (2 * pieces);
    const int sides = static_cast<int>(std::clamp(wanted, double{fewest_sides}, double{most_sides})) / 2 * 2;
    TubeMaker maker(sides);
    for (const Curve& curve : curves)
        if (curve.size() > 1) maker.add(bspline ? points_on(curve, sides / 2) : curve);
    if (maker.mesh.triangles.empty()) throw InputError({file, 1, 1}, "the file has no curve of any length");
    return std::move(maker.mesh);
}

}  // namespace gib
