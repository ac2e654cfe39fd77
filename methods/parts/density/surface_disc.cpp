#include "methods/parts/density/surface_disc.h"

#include "common/sampling/warp.h"

#include <algorithm>
#include <cmath>

namespace gib {

namespace {

/// Slope of the rays that look for obstacles. They start at the surface, so that they are below any low ceiling, and
/// rise, so that they do not run along the surface. Anything lower than the rays is no obstacle.
constexpr float rising_slope = 0.02f;
/// Fraction of the radius at which the disc is probed first. Edges of the surface show at the rim: 8 probes at 95 %
/// of the radius miss less than 2.5 % of the disc's area.
constexpr float rim = 0.95f;

/// Points of the ball are probed until this many are visible from its centre.
constexpr int probes_in_sight = 8;
/// Largest number of probes, which bounds their time: a point that sees less than a 64th of its ball is
/// estimated too dark.
constexpr int most_probes = 64 * probes_in_sight;

/// end / r, at most 1; defined for r = 0, too.
float part_of_radius(float end, float r) { return end < r ? end / r : 1.f; }

}  // namespace

bool belongs_to(const SurfaceHit& found, const SurfaceHit& centre, const Vec3& normal) {
    if (!(normal_towards(found, normal).dot(normal) > min_normal_cosine)) return false;
    const LobeTraits& lobes = found.bsdf->traits_at(found.ns.dot(normal));
    return lobes.diffuse || (lobes.glossy && !centre.bsdf->traits_at(centre.ns.dot(normal)).diffuse);
}

float reciprocal_share_in_sight(Kernel kernel, RayQueries& rays, const Vec3& p, float r, NumberStream& u) {
    int in_sight = 0, probes = 0;
    for (; in_sight < probes_in_sight && probes < most_probes; ++probes) {
        const float first = u.next();
        const Vec3 w = square_to_sphere({first, u.next()});
        const float distance = r * ball_kernel_radius(kernel, u.next());
        if (!rays.intersect({.o = p, .d = w, .t_max = distance})) ++in_sight;
    }
    return static_cast<float>(probes) / static_cast<float>(std::max(in_sight, 1));
}

SurfaceDisc::SurfaceDisc(const SurfaceHit& hit, const Vec3& normal, const Vec2& u)
    : hit_(hit), frame_(normal), origin_(offset_origin(hit, normal)), u_(u), rounding_(4.f * hit.offset) {}

Vec3 SurfaceDisc::direction(float turns) const {
    const float phi = 2.f * pi * turns;
    return std::cos(phi) * frame_.s + std::sin(phi) * frame_.t;
}

bool SurfaceDisc::find_layers(RayQueries& rays, float reach) {
    const auto half_way = [&](const Vec3& w) {
        const Vec3 from = offset_origin(hit_, w);
        const auto layer = rays.intersect_bodies({.o = from, .d = w, .t_max = reach});
        return layer ? std::max(0.5f * (layer->p - hit_.p).norm(), rounding_) : infinity;
    };
    above_ = half_way(frame_.n);
    below_ = half_way(-frame_.n);
    return std::min(above_, below_) < infinity;
}

bool SurfaceDisc::find_obstacles(RayQueries& rays, float r, float max_radius) {
    if (!look_around(rays, r, few)) return false;
    look_around(rays, max_radius, many);
    return true;
}

float SurfaceDisc::end_of_rise(RayQueries& rays, const Vec3& w, float reach) const {
    const auto found =
        rays.intersect_bodies({.o = origin_, .d = reach * (w + max_elevation_slope * frame_.n), .t_max = 1.f});
    return found ? std::max((found->p - hit_.p).dot(w), 0.f) : infinity;
}

bool SurfaceDisc::look_around(RayQueries& rays, float r, int directions) {
    directions_ = directions;
    const float narrow = std::cos(pi / static_cast<float>(directions));
    const float reach = r / narrow;  // every straight wall within r is then hit by one of the rays
    std::array<Ray, many> tested;
    std::array<std::optional<Intersection>, many> met;
    for (int i = 0; i < directions; ++i) {
        const Vec3 w = direction((static_cast<float>(i) + u_.x()) / static_cast<float>(directions));
        tested[static_cast<std::size_t>(i)] = {.o = origin_, .d = reach * (w + rising_slope * frame_.n), .t_max = 1.f};
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(directions); i += Accelerator::packet_size)
        rays.trace_bodies(std::span(tested).subspan(i, Accelerator::packet_size), std::span(met).subspan(i));
    bool any = false;
    for (int i = 0; i < directions; ++i) {
        const auto at = static_cast<std::size_t>(i);
        free_[at] = rise_[at] = infinity;
        const auto found = rays.surface_hit({tested[at], met[at]});
        if (!found) continue;
        const Vec3 w = direction((static_cast<float>(i) + u_.x()) / static_cast<float>(directions));
        // Rounding of p may give an obstacle at the centre itself a negative distance.
        const float distance = std::max((found->p - hit_.p).dot(w), 0.f);
        const float cosine = normal_towards(*found, -w).dot(frame_.n);
        if (cosine > min_normal_cosine) {  // the surface curves up, or a ramp starts
            rise_[at] = distance;
            const float slope = std::sqrt(std::max(1.f - cosine * cosine, 0.f)) / cosine;
            // Seen from the centre it exceeds the largest slope beyond d, where
            // (d - distance) slope = d max_elevation_slope.
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
    const auto [shortest, longest] = std::minmax_element(sector_.begin(), sector_.begin() + directions);
    shortest_ = *shortest;
    longest_ = *longest;
    return any;
}

bool SurfaceDisc::inside(const Vec3& offset) const {
    if (directions_ == 0) return true;
    const float x = offset.dot(frame_.s), y = offset.dot(frame_.t), distance2 = x * x + y * y;
    if (distance2 <= sqr(shortest_)) return true;
    if (distance2 > sqr(longest_)) return false;
    const auto n = static_cast<float>(directions_);
    float sector = std::atan2(y, x) / (2.f * pi) * n - u_.x();
    sector -= n * std::floor(sector / n);
    const int i = std::min(static_cast<int>(sector), directions_ - 1);
    return distance2 <= sqr(sector_[static_cast<std::size_t>(i)]);
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
    return {.o = origin_ + distance * w + height * frame_.n, .d = -frame_.n, .t_max = height + depth + hit_.offset};
}

bool SurfaceDisc::is_covered(RayQueries& rays, const Vec3& w, float distance, float rise) const {
    if (distance >= rise) return true;  // found before: the surface rises above the disc here
    const auto found = rays.intersect_bodies(probe(w, distance));
    return found && belongs_to(*found, hit_, frame_.n);
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
    rays.trace_bodies(tested, met);
    bool ends = false;
    for (int i = 0; i < few && !ends; ++i) {
        const auto at = static_cast<std::size_t>(i * step);
        const auto found = rays.surface_hit({tested[static_cast<std::size_t>(i)], met[static_cast<std::size_t>(i)]});
        const bool risen = rim * std::min(end_of(at), r) >= rise_of(at);  // found before
        ends = !risen && !(found && belongs_to(*found, hit_, frame_.n));
    }
    if (!ends) return 1.f;

    float sum = 0.f, on_surface = 0.f;
    for (int i = 0; i < many; ++i) {
        const auto at = static_cast<std::size_t>(directions_ == many ? i : i * few / many);
        // A direction inside sector `at` of S. If there are fewer sectors than directions, several lie in each.
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
    if (!(sum > 0.f)) return 1.f;  // an obstacle at the centre itself
    // The centre lies on the surface, so the share is above zero even if no probe hits the surface.
    return std::max(on_surface / sum, 0.5f / (many * strata));
}

}  // namespace gib
