#include "methods/parts/density/surface_disc.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

/// The rays that look for obstacles rise by this slope, so that they neither start above a low ceiling nor run along
/// the surface. What is lower is no obstacle.
constexpr float rising_slope = 0.02f;
/// Where the disc is probed first: edges show at its rim, and at 95 % of the radius 8 probes miss less than 2.5 % of
/// its area.
constexpr float rim = 0.95f;

bool is_surface(const SurfaceHit& found, const Vec3& normal) {
    return normal_towards(found, normal).dot(normal) > min_normal_cosine &&
           found.bsdf->traits_at(found.ns.dot(normal)).diffuse;
}

/// The part of the radius r that ends at `end`, at most 1; defined for r = 0 too.
float part_of_radius(float end, float r) { return end < r ? end / r : 1.f; }

}  // namespace

SurfaceDisc::SurfaceDisc(const SurfaceHit& hit, const Vec3& normal, const Vec2& u)
    : hit_(hit), frame_(normal), origin_(offset_origin(hit, normal)), u_(u), rounding_(4.f * hit.offset) {}

Vec3 SurfaceDisc::direction(float turns) const {
    const float phi = 2.f * pi * turns;
    return std::cos(phi) * frame_.s + std::sin(phi) * frame_.t;
}

void SurfaceDisc::find_layers(RayQueries& rays, float reach) {
    const auto half_way = [&](const Vec3& w) {
        const Vec3 from = offset_origin(hit_, w);
        const auto layer = rays.intersect({from, w, 0.f, reach});
        return layer ? std::max(0.5f * (layer->p - hit_.p).norm(), rounding_) : infinity;
    };
    above_ = half_way(frame_.n);
    below_ = half_way(-frame_.n);
}

bool SurfaceDisc::find_obstacles(RayQueries& rays, float r, float max_radius) {
    if (!look_around(rays, r, few)) return false;
    look_around(rays, max_radius, many);
    return true;
}

float SurfaceDisc::end_of_rise(RayQueries& rays, const Vec3& w, float reach) const {
    const auto found = rays.intersect({origin_, reach * (w + max_elevation_slope * frame_.n), 0.f, 1.f});
    return found ? std::max((found->p - hit_.p).dot(w), 0.f) : infinity;
}

bool SurfaceDisc::look_around(RayQueries& rays, float r, int directions) {
    directions_ = directions;
    const float narrow = std::cos(pi / static_cast<float>(directions));
    const float reach = r / narrow;  // a straight wall within r is met by the direction nearest to its foot
    std::array<Ray, many> tested;
    std::array<std::optional<Intersection>, many> met;
    for (int i = 0; i < directions; ++i) {
        const Vec3 w = direction((static_cast<float>(i) + u_.x()) / static_cast<float>(directions));
        tested[static_cast<std::size_t>(i)] = {origin_, reach * (w + rising_slope * frame_.n), 0.f, 1.f};
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(directions); i += Accelerator::packet_size)
        rays.trace(std::span(tested).subspan(i, Accelerator::packet_size), std::span(met).subspan(i));
    bool any = false;
    for (int i = 0; i < directions; ++i) {
        const auto at = static_cast<std::size_t>(i);
        free_[at] = rise_[at] = infinity;
        const auto found = rays.surface_hit({tested[at], met[at]});
        if (!found) continue;
        const Vec3 w = direction((static_cast<float>(i) + u_.x()) / static_cast<float>(directions));
        // The rounding of p could put what stands at the centre behind it.
        const float distance = std::max((found->p - hit_.p).dot(w), 0.f);
        const float cosine = normal_towards(*found, -w).dot(frame_.n);
        if (cosine > min_normal_cosine) {  // the surface curves up, or a ramp starts
            rise_[at] = distance;
            const float slope = std::sqrt(std::max(1.f - cosine * cosine, 0.f)) / cosine;
            // It is seen at more than the largest slope from where (d - distance) slope = d max_elevation_slope.
            if (slope > max_elevation_slope) free_[at] = distance * slope / (slope - max_elevation_slope);
            free_[at] = std::min(free_[at], end_of_rise(rays, w, reach));
        } else {
            free_[at] = distance;
        }
        any = any || free_[at] < reach;
    }
    for (int i = 0; i < directions; ++i)
        sector_[static_cast<std::size_t>(i)] = narrow * std::min(free_[static_cast<std::size_t>(i)],
                                                                 free_[static_cast<std::size_t>((i + 1) % directions)]);
    return any;
}

bool SurfaceDisc::inside(const Vec3& offset) const {
    if (directions_ == 0) return true;
    const float x = offset.dot(frame_.s), y = offset.dot(frame_.t);
    const auto n = static_cast<float>(directions_);
    float sector = std::atan2(y, x) / (2.f * pi) * n - u_.x();
    if (sector < 0.f) sector += n;
    if (sector < 0.f) sector += n;  // from -n/2 - 1
    const int i = std::min(static_cast<int>(sector), directions_ - 1);
    return x * x + y * y <= sqr(sector_[static_cast<std::size_t>(i)]);
}

float SurfaceDisc::share(Kernel kernel, float r) const {
    if (directions_ == 0) return 1.f;
    float sum = 0.f;
    for (int i = 0; i < directions_; ++i)
        sum += kernel_mass(kernel, part_of_radius(sector_[static_cast<std::size_t>(i)], r));
    return sum / static_cast<float>(directions_);
}

Ray SurfaceDisc::probe(const Vec3& w, float distance) const {
    const float height = rising_slope * distance;
    const float depth = std::min(max_elevation_slope * distance, below_) + rounding_;
    return {origin_ + distance * w + height * frame_.n, -frame_.n, 0.f, height + depth + hit_.offset};
}

bool SurfaceDisc::is_covered(RayQueries& rays, const Vec3& w, float distance, float rise) const {
    if (distance >= rise) return true;  // seen already: the surface is above the disc there
    const auto found = rays.intersect(probe(w, distance));
    return found && is_surface(*found, frame_.n);
}

float SurfaceDisc::covered(RayQueries& rays, Kernel kernel, float r) const {
    const float whole = 2.f * r;
    const int step = directions_ == many ? many / few : 1;
    const auto end_of = [&](std::size_t i) { return directions_ == 0 ? whole : sector_[i]; };
    const auto rise_of = [&](std::size_t i) { return directions_ == 0 ? infinity : rise_[i]; };
    std::array<Ray, few> tested;
    std::array<std::optional<Intersection>, few> met;
    for (int i = 0; i < few; ++i) {
        const auto at = static_cast<std::size_t>(i * step);
        const Vec3 w = direction((static_cast<float>(i * step) + u_.x()) / static_cast<float>(few * step));
        tested[static_cast<std::size_t>(i)] = probe(w, rim * std::min(end_of(at), r));
    }
    rays.trace(tested, met);
    bool ends = false;
    for (int i = 0; i < few && !ends; ++i) {
        const auto at = static_cast<std::size_t>(i * step);
        const auto found = rays.surface_hit({tested[static_cast<std::size_t>(i)], met[static_cast<std::size_t>(i)]});
        const bool risen = rim * std::min(end_of(at), r) >= rise_of(at);  // seen already
        ends = !risen && !(found && is_surface(*found, frame_.n));
    }
    if (!ends) return 1.f;

    float sum = 0.f, on_surface = 0.f;
    for (int i = 0; i < many; ++i) {
        const auto at = static_cast<std::size_t>(directions_ == many ? i : i * few / many);
        // The middle of a sector of S, or of a part of one.
        const Vec3 w = direction((static_cast<float>(i) + u_.y()) / static_cast<float>(many) +
                                 (directions_ == 0 ? 0.f : u_.x() / static_cast<float>(directions_)));
        const float mass = kernel_mass(kernel, part_of_radius(end_of(at), r));
        const float rise =
            std::min(rise_of(at), rise_of((at + 1) % std::max<std::size_t>(1, static_cast<std::size_t>(directions_))));
        const float turned = u_.x() + 0x1p-32f * static_cast<float>(reverse_bits(static_cast<std::uint32_t>(i)));
        const float offset = turned - std::floor(turned);
        for (int j = 0; j < strata; ++j) {
            const float v = (static_cast<float>(j) + offset) / strata;
            sum += mass;
            if (is_covered(rays, w, r * kernel_radius(kernel, mass * v), rise)) on_surface += mass;
        }
    }
    // The centre is on the surface, so the share cannot be zero even where no probe finds it.
    return std::max(on_surface / sum, 0.5f / (many * strata));
}

}  // namespace gib
