#include "methods/parts/density/volume_estimate.h"

#include "methods/parts/density/surface_disc.h"
#include "methods/parts/kd_tree/nearest.h"

namespace gib {

Scattered VolumeEstimator::scattered_radiance(const PhotonMap& map, RayQueries& rays, const Vec3& p,
                                              const PhaseFunction& phase, const Vec3& wo, const EyePath& eye,
                                              NumberStream& u) const {
    if (!(max_radius > 0.f)) return {};
    const auto scattered = [&](const Photon& photon, float distance2, float r) -> Colord {
        const double scale =
            map.unit() * double{phase.value(wo, photon.direction())} * ball_kernel_weight(kernel, distance2, r);
        return scale * photon.power().cast<double>() * eye.weight(photon).cast<double>();
    };
    float r = max_radius;
    const float narrow_r = estimates_bias ? narrow_radius * r : 0.f;
    Colord sum = Colord::Zero(), narrow = Colord::Zero();
    const auto add_all_within = [&](float radius) {
        map.within(p, radius, [&](const Photon& photon, float distance2) {
            if (!eye.accepts(photon)) return;
            sum += scattered(photon, distance2, radius);
            if (distance2 < sqr(narrow_r)) narrow += scattered(photon, distance2, narrow_r);
        });
    };
    if (k == all_photons) {
        add_all_within(r);
    } else {
        std::vector<Neighbour>& neighbours = neighbours_of_thread();
        find_nearest(
            map, p, k, max_radius, [&](const Photon& photon, float) { return eye.accepts(photon); }, neighbours);
        std::size_t inside = neighbours.size();
        if (inside == k) r = std::sqrt(neighbours[--inside].distance2);
        const float unresolved = std::min(place_rounding(rays.scene(), p), max_radius);
        if (inside < neighbours.size() && r <= unresolved) {
            r = unresolved;
            add_all_within(r);
        } else if (r > 0.f) {
            for (std::size_t i = 0; i < inside; ++i)
                sum += scattered(map[neighbours[i].index], neighbours[i].distance2, r);
        }
    }
    Scattered light{sum.cast<float>(), estimates_bias ? Color(narrow.cast<float>()) : Color::Zero()};
    if (is_black(light.radiance)) return light;
    if (area == DiscArea::surface) {
        light.radiance *= reciprocal_share_in_sight(kernel, rays, p, r, u);
        if (!is_black(light.bias)) light.bias *= reciprocal_share_in_sight(kernel, rays, p, narrow_r, u);
    }
    if (estimates_bias) light.bias = bias_of_difference * (light.radiance - light.bias);
    return light;
}

}  // namespace gib
