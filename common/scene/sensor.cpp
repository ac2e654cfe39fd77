#include "common/scene/sensor.h"

#include "common/sampling/warp.h"

#include <algorithm>

namespace gib {

ReconstructionFilter ReconstructionFilter::box(float radius) {
    ReconstructionFilter f;
    f.radius_ = radius;
    return f;
}

ReconstructionFilter ReconstructionFilter::tent(float radius) {
    ReconstructionFilter f;
    f.shape_ = Shape::tent;
    f.radius_ = radius;
    return f;
}

ReconstructionFilter ReconstructionFilter::gaussian(float stddev) {
    ReconstructionFilter f;
    f.shape_ = Shape::table;
    f.radius_ = 4.f * stddev;
    constexpr int cells = 512;
    const double r = f.radius_, a = 1 / (2.0 * stddev * stddev);
    // The integral of the filter from -r to x, in closed form at the nodes of the table.
    const auto integral = [&](double x) {
        return std::sqrt(std::numbers::pi / a) / 2 * (std::erf(std::sqrt(a) * x) + std::erf(std::sqrt(a) * r)) -
               std::exp(-a * r * r) * (x + r);
    };
    for (int i = 0; i <= cells; ++i)
        f.cumulative_.push_back(static_cast<float>(integral(-r + 2 * r * i / cells) / integral(r)));
    f.cumulative_.front() = 0.f;
    f.cumulative_.back() = 1.f;
    for (int i = 0; i < cells; ++i) {
        const float u = static_cast<float>(i) / cells;
        const auto above = std::upper_bound(f.cumulative_.begin() + 1, f.cumulative_.end() - 1, u);
        f.first_.push_back(static_cast<std::uint16_t>(above - f.cumulative_.begin() - 1));
    }
    return f;
}

float ReconstructionFilter::sample(float u) const {
    if (shape_ == Shape::table) return sample_table(u);
    if (shape_ == Shape::box) return (2.f * u - 1.f) * radius_;
    return (u < 0.5f ? std::sqrt(2.f * u) - 1.f : 1.f - std::sqrt(2.f - 2.f * u)) * radius_;
}

float ReconstructionFilter::sample_table(float u) const {
    const std::size_t cells = first_.size();
    std::size_t cell =
        first_[std::min(static_cast<std::size_t>(u * static_cast<float>(cells)), cells - 1)];  // u may be 1
    while (cell + 1 < cells && cumulative_[cell + 1] <= u)
        ++cell;
    const float lower = cumulative_[cell], width = cumulative_[cell + 1] - lower;
    const float t = width > 0.f ? (u - lower) / width : 0.5f;
    return ((static_cast<float>(cell) + t) / static_cast<float>(cells) * 2.f - 1.f) * radius_;
}

float ReconstructionFilter::density(float x) const {
    const float r = radius_;
    if (!(std::abs(x) <= r)) return 0.f;
    if (shape_ == Shape::box) return 0.5f / r;
    if (shape_ == Shape::tent) return (1.f - std::abs(x) / r) / r;
    const auto cells = cumulative_.size() - 1;
    const auto cell = std::min(static_cast<std::size_t>((x / r + 1.f) * 0.5f * static_cast<float>(cells)), cells - 1);
    return (cumulative_[cell + 1] - cumulative_[cell]) * static_cast<float>(cells) / (2.f * r);
}

/// Chooses along one axis, and makes a new random number of `u`.
int ReconstructionFilter::choose(float film, float& u, float& sum) const {
    const int first = static_cast<int>(std::ceil(film - radius_ - 0.5f));
    const int last = static_cast<int>(std::floor(film + radius_ - 0.5f));
    const auto of = [&](int pixel) { return density(film - (static_cast<float>(pixel) + 0.5f)); };
    sum = 0.f;
    for (int pixel = first; pixel <= last; ++pixel)
        sum += of(pixel);
    float left = u * sum;
    int chosen = last;
    for (int pixel = first; pixel <= last; ++pixel) {
        const float share = of(pixel);
        if (left < share || pixel == last) {
            chosen = pixel;
            u = share > 0.f ? std::clamp(left / share, 0.f, 1.f) : 0.f;
            break;
        }
        left -= share;
    }
    return chosen;
}

double Sensor::tan_half_width(double fov, FovAxis axis, double aspect) {
    const double tan_half = std::tan(fov * std::numbers::pi / 360);
    if (axis == FovAxis::diagonal) return tan_half / std::sqrt(1 + 1 / (aspect * aspect));
    const bool spans_height = axis == FovAxis::y || axis == (aspect > 1 ? FovAxis::smaller : FovAxis::larger);
    return spans_height ? tan_half * aspect : tan_half;
}

Sensor::Sensor(const Parameters& p)
    : projection_(p.projection),
      width_(p.width),
      height_(p.height),
      filter_(p.filter),
      near_clip_(p.near_clip),
      far_clip_(p.far_clip),
      position_(p.to_world.block<3, 1>(0, 3)),
      has_lens_(p.aperture_radius > 0),
      aperture_radius_(static_cast<float>(p.aperture_radius)),
      inv_focus_distance_(static_cast<float>(1 / p.focus_distance)) {
    origin_ = position_.cast<float>();
    left_ = p.to_world.block<3, 1>(0, 0).cast<float>();
    up_ = p.to_world.block<3, 1>(0, 1).cast<float>();
    forward_ = p.to_world.block<3, 1>(0, 2).cast<float>();
    const Eigen::Matrix3d axes = p.to_world.block<3, 3>(0, 0);
    to_axes_ = axes.inverse();
    volume_ = std::abs(axes.determinant());
    const Crop crop = p.crop.value_or(Crop{Vec2d(p.width, p.height), Vec2d::Zero()});
    const double width = crop.film.x(), height = crop.film.y();
    const double half_width =
        p.projection == Projection::perspective ? tan_half_width(p.fov, p.fov_axis, width / height) : 1.0;
    const double half_height = half_width * height / width;
    crop_offset_ = crop.offset.cast<float>();
    scale_ = Vec2d(-2 * half_width / width, -2 * half_height / height).cast<float>();
    offset_ =
        Vec2d(half_width * (1 - 2 * p.principal_point_offset.x()), half_height * (1 - 2 * p.principal_point_offset.y()))
            .cast<float>();
}

void Sensor::translate(const Vec3d& by) {
    position_ += by;
    origin_ = position_.cast<float>();
}

Vec3 Sensor::lens_shift(const Vec2& u_lens) const {
    if (!has_lens_) return Vec3::Zero();
    const Vec2 lens = aperture_radius_ * square_to_disk(u_lens);
    return lens.x() * left_ + lens.y() * up_;
}

std::optional<Sensor::View> Sensor::view_of(const Vec3& p, const Vec2& u_lens) const {
    const Vec3 shift = lens_shift(u_lens);
    const Vec3d at = to_axes_ * (p - origin_ - shift).cast<double>();
    if (!(at.z() > 0)) return std::nullopt;
    const bool parallel = is_orthographic();
    const Vec2d c = parallel ? Vec2d(at.head<2>()) : Vec2d(at.head<2>() / at.z());
    std::optional<View> seen(std::in_place);  // returned as it is, since a copy would wait for its parts
    View& view = *seen;
    Vec3 d = forward_;
    Vec2 on_film = c.cast<float>();
    if (parallel) {
        view.ray.o = origin_ + on_film.x() * left_ + on_film.y() * up_;
    } else {
        view.ray.o = origin_ + shift;
        d = p - view.ray.o;
        if (has_lens_) on_film += inv_focus_distance_ * (to_axes_ * shift.cast<double>()).head<2>().cast<float>();
    }
    view.film = (on_film - offset_).cwiseQuotient(scale_) - crop_offset_;
    view.distance = parallel ? static_cast<float>(at.z()) * d.norm() : d.norm();
    view.ray.d = d.normalized();
    // Clip distances count along the axis.
    const float per_depth = view.distance / static_cast<float>(at.z());
    view.ray.t_min = near_clip_ * per_depth;
    view.ray.t_max = far_clip_ * per_depth;
    return seen;
}

double Sensor::ray_density(const Vec3& w) const {
    const double pixel = std::abs(double{scale_.x()} * double{scale_.y()});  // its area at z = 1
    if (is_orthographic()) return double{forward_.norm()} / (volume_ * pixel);
    const double depth = (to_axes_.row(2) * w.cast<double>()).value();
    return 1 / (depth * depth * depth * volume_ * pixel);
}

Ray Sensor::generate_ray(int x, int y, const Vec2& u_film, const Vec2& u_lens) const {
    const Vec2 pixel = Vec2(static_cast<float>(x), static_cast<float>(y)) + crop_offset_;
    const Vec2 film = pixel + Vec2::Constant(0.5f) + filter_.sample(u_film);
    const Vec2 c = film.cwiseProduct(scale_) + offset_;
    if (projection_ == Projection::orthographic) {
        const float length = forward_.norm();
        return {.o = origin_ + c.x() * left_ + c.y() * up_,
                .d = forward_ / length,
                .t_min = near_clip_ * length,
                .t_max = far_clip_ * length};
    }
    Vec3 o = origin_, d = c.x() * left_ + c.y() * up_ + forward_;
    if (has_lens_) {
        // All rays of a film position meet in the plane of focus: o + focus_distance * d is the same for all.
        const Vec3 shift = lens_shift(u_lens);
        o += shift;
        d -= inv_focus_distance_ * shift;
    }
    const float length = d.norm();
    // Clip distances count along the axis: t = z / cos.
    return {.o = o, .d = d * (1.f / length), .t_min = near_clip_ * length, .t_max = far_clip_ * length};
}

}  // namespace gib
