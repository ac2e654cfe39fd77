#include "methods/parts/density/photon_search.h"

#include "methods/parts/density/place_rounding.h"

#include <algorithm>

namespace gib {

namespace {

/// The memory of a thread's look-ups, which none of them has to take for itself.
std::vector<Neighbour>& neighbours_of_thread() {
    static thread_local std::vector<Neighbour> neighbours;
    return neighbours;
}

}  // namespace

PhotonSearch::PhotonSearch(const DensityEstimator& estimator, const PhotonMap& map, RayQueries& rays,
                           const SurfaceHit& hit, const Vec3& wo, const EyePath& eye, const Vec2& u, LastLookUp* last)
    : e_(estimator),
      map_(map),
      rays_(rays),
      hit_(hit),
      counts_(hit, wo, eye, estimator.area),
      disc_(hit, counts_.normal(), u),
      neighbours_(neighbours_of_thread()),
      last_(last) {}

float PhotonSearch::unresolved_radius() const {
    return std::min(place_rounding(rays_.scene(), hit_.p), e_.max_radius);
}

/// Rays look for obstacles and layers only as far as the photons lie that were found without them, so a look-up without
/// obstacles traces a few short rays. If something stands there, the search is repeated without the photons that it
/// hides.
std::vector<Neighbour>& PhotonSearch::nearest() {
    bool any_off_plane = false;
    find_k([&](const Photon& photon, float distance2) {
        const Vec3 offset = photon.p - hit_.p;
        if (!counts_(photon, offset, distance2)) return false;
        any_off_plane |= disc_.off_plane(offset);
        return true;
    });
    if (e_.area != DiscArea::surface || neighbours_.empty()) return neighbours_;

    const auto offset_of = [this](const Neighbour& n) -> Vec3 { return map_[n.index].p - hit_.p; };
    bool hidden = false;
    // The search may also have met photons off the plane that are not among the nearest.
    if (any_off_plane && std::any_of(neighbours_.begin(), neighbours_.end(),
                                     [&](const auto& n) { return disc_.off_plane(offset_of(n)); })) {
        disc_.find_layers(rays_, max_elevation_slope * e_.max_radius);
        near_obstacle_ = true;
        hidden = std::any_of(neighbours_.begin(), neighbours_.end(),
                             [&](const auto& n) { return !disc_.in_layer(offset_of(n)); });
    }
    const float r = neighbours_.size() == e_.k && !hidden ? std::sqrt(neighbours_.back().distance2) : e_.max_radius;
    if (!hidden && is_flat_within(r)) return neighbours_;
    if (!disc_.find_obstacles(rays_, r, e_.max_radius) && !hidden) return neighbours_;
    near_obstacle_ = true;
    map_.nearest(
        hit_.p, e_.k, e_.max_radius,
        [this](const Photon& photon, float distance2) {
            const Vec3 offset = photon.p - hit_.p;
            return counts_(photon, offset, distance2) && disc_.contains(offset);
        },
        neighbours_);
    return neighbours_;
}

/// Finds the k nearest photons that `accept` accepts. By the triangle inequality, the ball of the last look-up lies
/// within its radius and the distance to it. If the last look-up was close by, this ball holds hardly more than k
/// photons. If it holds fewer, which other surfaces or limits may cause, the search is repeated in the largest one.
template <typename Accept>
void PhotonSearch::find_k(const Accept& accept) {
    const float near = last_ ? last_->radius + (hit_.p - last_->p).norm() : infinity;
    if (near < e_.max_radius) map_.nearest(hit_.p, e_.k, near, accept, neighbours_);
    if (!(near < e_.max_radius) || neighbours_.size() < e_.k)
        map_.nearest(hit_.p, e_.k, e_.max_radius, accept, neighbours_);
    if (last_) *last_ = {hit_.p, neighbours_.size() == e_.k ? std::sqrt(neighbours_.back().distance2) : infinity};
}

/// Whether nothing but the surface's plane lies as far from the centre as the rays of disc_ for this radius reach.
bool PhotonSearch::is_flat_within(float r) {
    constexpr float reach = 1.1f;  // rays for obstacles are r / cos(pi / 8) long
    flat_ = e_.flat_regions && e_.flat_regions->flat_around(hit_, reach * r);
    return flat_;
}

}  // namespace gib
