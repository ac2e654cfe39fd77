#pragma once
// Photons of known density on small scenes, and the mean of many independent look-ups among them.

#include "common/core/parallel.h"
#include "methods/parts/density/density_estimate.h"
#include "tests/support/moments.h"
#include "tests/support/scene_fixtures.h"

#include <functional>
#include <numbers>
#include <vector>

namespace gib::test {

/// A photon of this power on a surface of this normal.
inline Photon photon_at(const Vec3& p, const Vec3& normal, float power) {
    return {p, Color::Constant(power), normal, normal, 2};
}

/// `n` photons evenly spread over the parallelogram corner + u a + v b, of total power `power`.
inline void spread(std::vector<Photon>& photons, std::size_t n, const Vec3& corner, const Vec3& a, const Vec3& b,
                   const Vec3& normal, float power, std::uint64_t seed) {
    for (std::size_t i = 0; i < n; ++i) {
        const Vec2 u = Sampler(PointSet::independent, seed, i, 0).get_2d(0);
        photons.push_back(photon_at(corner + u.x() * a + u.y() * b, normal, power / static_cast<float>(n)));
    }
}

/// A white diffuse shape; its rectangle is [-1, 1]^2 in z = 0 before the steps of `placing`.
inline std::string white(const std::string& type, const std::string& placing = "") {
    return shape(type, to_world(placing), diffuse(1.0));
}

/// A scene of these shapes. Two specks far away on opposite sides keep the scene's centre at the origin, so that its
/// coordinates are as in the file.
inline LoadedScene scene_of_shapes(const std::string& shapes) {
    const std::string speck = scale(0.001);
    return Scene(element("sensor", "orthographic", box_film(4)), shapes,
                 white("rectangle", speck + translate(-10, -10, -10)),
                 white("rectangle", speck + translate(10, 10, 10)))
        .load();
}

/// Estimates divided by the truth `E` / pi over `maps` independent sets of photons, for each estimator and each group
/// of rays. The hits of the rays are looked up; `make` returns the photons of a seed.
using Groups = std::vector<std::vector<Ray>>;
inline std::vector<std::vector<Moments>> relative_estimates(
    const gib::Scene& scene, const std::vector<DensityEstimator>& estimators, std::size_t maps, double E,
    const std::function<std::vector<Photon>(std::uint64_t)>& make, const Groups& groups) {
    std::vector<std::vector<std::vector<double>>> values(maps);
    parallel_blocks(maps, 1, [&](std::size_t number, std::size_t, std::size_t) {
        RayQueries rays(scene);
        const PhotonMap map(make(1000 + number), 1);
        for (std::size_t e = 0; e < estimators.size(); ++e)
            for (std::size_t g = 0; g < groups.size(); ++g) {
                auto& of_group = values[number].emplace_back();
                for (std::size_t i = 0; i < groups[g].size(); ++i) {
                    const Sampler u(PointSet::independent, number, i, 0);
                    const auto hit = scene.intersect(groups[g][i]);
                    const Color L = estimators[e]
                                        .reflected_radiance(map, rays, *hit, -groups[g][i].d, EyePath{100}, u, 0)
                                        .between_surfaces;
                    of_group.push_back(static_cast<double>(L[0]) * std::numbers::pi / E);
                }
            }
    });
    std::vector<std::vector<Moments>> sums(estimators.size(), std::vector<Moments>(groups.size()));
    for (const auto& of_map : values)
        for (std::size_t j = 0; j < of_map.size(); ++j)
            for (double v : of_map[j])
                sums[j / groups.size()][j % groups.size()].add(v);
    return sums;
}

inline Ray down_at(float x, float y, float z = 1.f) { return {Vec3(x, y, z), Vec3(0, 0, -1)}; }

}  // namespace gib::test
