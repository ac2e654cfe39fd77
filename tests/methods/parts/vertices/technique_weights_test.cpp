// The weights of all techniques of a path, against the densities of these techniques, listed one by one. Half of the
// starts of light walks are aimed at specular surfaces.

#include "methods/parts/emission/light_emission.h"
#include "methods/parts/vertices/camera_walk.h"
#include "methods/parts/vertices/connections.h"
#include "methods/parts/vertices/light_paths.h"
#include "methods/vcm/merge_rule.h"
#include "tests/support/lit_rooms.h"
#include "tests/support/moments.h"

#include <numeric>

namespace gib::test::technique_weights_test {
namespace {

using namespace lit_rooms;

/// A path from a light's start to the camera, with its inner vertices x_1 ... x_{k-1} in this order.
struct WholePath {
    EmissionSample start;
    std::vector<PathVertex> inner;
    Vec3 camera;
};

/// n of merging at x_i, entry i - 1 of the result; 0 where it is not merged.
std::vector<double> merges_of(RayQueries&, const NoMerging&, const WholePath& path) {
    return std::vector<double>(path.inner.size(), 0);
}
std::vector<double> merges_of(RayQueries& rays, const MergeRule& rule, const WholePath& path) {
    std::vector<double> n;
    for (std::size_t i = 0; i < path.inner.size(); ++i) {
        const PathVertex& at = path.inner[i];
        const bool follows_focus =
            i > 0 && path.inner[i - 1].hit && focuses(*path.inner[i - 1].hit, path.inner[i - 1].from);
        const bool is_merged = rule.merges == Merges::everywhere || follows_focus;
        n.push_back(!is_merged ? 0
                    : at.hit   ? rule.radii.n_at(rays, *at.hit, at.from)
                               : rule.radii.n_at(*at.medium, at.p));
    }
    return n;
}

/// p_s^2 over the sum of p_j^2, merging included, by the definitions of technique_sums.h; entry s of the result.
template <typename Rule>
std::vector<double> weights_of(RayQueries& rays, const LightPaths& paths, const PathRules& rules, const Rule& added,
                               const WholePath& path) {
    const gib::Scene& scene = rays.scene();
    const auto& x = path.inner;
    const std::size_t n = x.size();
    const Light& light = scene.lights()[path.start.light];
    const bool has_surface = std::holds_alternative<AreaLight>(light);
    const bool finite = has_surface || std::holds_alternative<PointLight>(light);
    const auto position = [&](std::size_t i) { return i == 0 ? path.start.ray.o : i <= n ? x[i - 1].p : path.camera; };
    const auto direction = [&](std::size_t i, std::size_t j) -> Vec3 {  // from x_i to x_j, which are neighbours
        if (!finite && (i == 0 || j == 0)) return i == 0 ? path.start.ray.d : Vec3(-path.start.ray.d);
        return (position(j) - position(i)).normalized();
    };
    // Density per area at x_j of a direction from x_i, per density per solid angle.
    const auto per_area = [&](std::size_t i, std::size_t j) {
        if (i == 0 && !finite) return double{x[0].cosine(direction(0, 1))};
        if (i == n + 1 && scene.sensor().is_orthographic()) return double{x[n - 1].cosine(direction(i, j))};
        const double cosine = j == 0 ? (has_surface ? double{std::abs(path.start.normal.dot(direction(1, 0)))} : 1.)
                                     : double{x[j - 1].cosine(direction(i, j))};
        return cosine / double{(position(j) - position(i)).squaredNorm()};
    };
    // Density [1/sr] of the direction from x_i to x_j for a walk that came from x_from and carries this quantity.
    const auto pdf_w = [&](std::size_t from, std::size_t i, std::size_t j, Transport carried) -> double {
        const PathVertex& at = x[i - 1];
        const Vec3 wo = direction(i, from), wi = direction(i, j);
        if (!at.hit) return double{at.medium->phase().value(wo, wi)};
        return double{
            at.hit->bsdf->pdf_w_local(at.hit->shading.to_local(wo), at.hit->shading.to_local(wi), Lobes::all, carried)};
    };
    std::vector<double> forward(n + 1, 0), backward(n + 1, 0);  // f_i and b_i
    const double cos_light = has_surface ? double{path.start.normal.dot(direction(0, 1))} : 1.;
    const double emission =
        paths.emission.density(path.start.light, position(0), direction(0, 1), static_cast<float>(cos_light));
    forward[1] = emission * per_area(0, 1);  // times f_0
    for (std::size_t i = 2; i <= n; ++i)
        forward[i] = pdf_w(i - 2, i - 1, i, Transport::power) * per_area(i - 1, i);
    backward[n] = scene.sensor().ray_density(-direction(n, n + 1)) * per_area(n + 1, n);
    for (std::size_t i = n; i-- > 1;)
        backward[i] = pdf_w(i + 2, i + 1, i, Transport::radiance) * per_area(i + 1, i);
    const SurfacePoint origin{path.start.ray.o, path.start.normal, 0.f};
    const double sampling = double{scene.light_pdf_w(x[0].p, path.start.light, origin, direction(0, 1))} *
                            (has_surface ? per_area(1, 0) : 1.);
    backward[0] = is_delta(light) ? 0 : pdf_w(2, 1, 0, Transport::radiance) * (has_surface ? per_area(1, 0) : 1.);

    std::vector<double> p;
    for (std::size_t s = 0; s <= n + 1; ++s) {
        double density = s == 1 ? sampling : 1;
        for (std::size_t i = 1; s >= 2 && i < s; ++i)
            density *= forward[i];
        for (std::size_t i = s; i <= n; ++i)
            density *= backward[i];
        if (s == n + 1) density *= paths.count;
        if (s == n && (s >= 2 || is_delta(light)))
            density *= rules.first_samples();  // at the first vertex of the camera's walk
        p.push_back(squared(density));
    }
    double sum = std::accumulate(p.begin(), p.end(), 0.0);
    const std::vector<double> merges = merges_of(rays, added, path);
    for (std::size_t i = 1; i <= n; ++i) {
        double density = merges[i - 1];
        for (std::size_t j = 1; j <= i; ++j)
            density *= forward[j];
        for (std::size_t j = i; j <= n; ++j)
            density *= backward[j];
        sum += squared(density);
    }
    for (double& value : p)
        value /= sum;
    return p;
}

template <typename Rule = NoMerging>
void expect_weights(const LoadedScene& loaded, const Rule& added = {}, std::size_t shared_paths = 1) {
    const gib::Scene& scene = *loaded.scene;
    constexpr int longest = 6;
    const PathRules rules{.max_edges = longest, .shared_paths = shared_paths};
    Plan plan = described_plan(scene, find_method("bidirectional"));
    add_light_paths(plan, scene, longest);
    StageTimes stages;
    const LightPaths paths(scene, plan, stages);
    RayQueries rays(scene);
    std::size_t checked = 0;
    // A weight is the quotient of products of up to a dozen densities in float, whose directions are rounded most
    // where vertices are close to each other.
    const auto check = [&](const WholePath& path, std::size_t s, float weight) {
        const double expected = weights_of(rays, paths, rules, added, path)[s];
        EXPECT_NEAR(double{weight}, expected, 3e-3 * expected + 1e-6) << "s = " << s << " of " << path.inner.size() + 1;
        ++checked;
    };
    for (std::uint32_t i = 0; i < 2000 && !testing::Test::HasFailure(); ++i) {
        const Sampler sampler(PointSet::independent, 3, i, 0), light_sampler = sampler.split(0, 1, 1);
        const auto start = paths.emission.sample(light_sampler);
        if (!start) continue;
        std::vector<PathVertex> from_light, from_camera;
        LightWalk(
            rays, light_sampler, paths, rules, added, *start,
            [&](const PathVertex& vertex, const VertexNumbers&, NumberStream& flights) {
                from_light.push_back(vertex);
                const auto view = scene.sensor().view_of(vertex.p, Vec2(0.5f, 0.5f));
                const auto splat = connect_to_camera(rays, vertex, paths, rules, SplatFilm(8, 8, {}, 1),
                                                     {Vec2(0.5f, 0.5f), 0.5f}, flights);
                if (splat)
                    check({start->sample, from_light, view->ray.o}, from_light.size() + 1, splat->connection.weight);
            })
            .follow();
        const int x = static_cast<int>(i % 8), y = static_cast<int>(i / 8 % 8);
        TracedRay eye{scene.sensor().sample_ray(x, y, sampler)};
        rays.trace(eye);
        PixelSample lost;
        ConnectionRoulette roulette;  // traces all connections
        CameraWalk(
            rays, eye, sampler, paths, rules, added, lost, [](const FoundLight&) {},
            [&](PathVertex& vertex, auto& along, const VertexNumbers&, NumberStream& flights) {
                from_camera.push_back(vertex);
                for (std::size_t s = 1; s <= from_light.size(); ++s) {
                    along.join(rays, vertex, from_light[s - 1]);
                    const auto joined = connect(rays, vertex, from_light[s - 1], paths, rules, 1, roulette, flights);
                    if (!joined) continue;
                    WholePath path{start->sample,
                                   {from_light.begin(), from_light.begin() + static_cast<std::ptrdiff_t>(s)},
                                   eye.ray.o};
                    path.inner.insert(path.inner.end(), from_camera.rbegin(), from_camera.rend());
                    check(path, s + 1, joined->weight);
                }
            })
            .follow();
    }
    EXPECT_GT(checked, 200u);
}

const MergeRadii merging = {.light_paths = 4, .on_surfaces = 0.5, .in_media = 0.5, .largest_by_place = 0.5f};

// Breaking any factor of the recursion or of a connection's weight makes one of these fail.
TEST(TechniqueWeights, OfLightsWithASurfaceAreThoseOfTheDensities) {
    expect_weights(room({.light = lamp}));
    expect_weights(room({.light = shining_ball}));
}
TEST(TechniqueWeights, OfDeltaLightsAreThoseOfTheDensities) {
    expect_weights(room({.light = lit_rooms::point}));
    expect_weights(room({.light = sun}));
}
TEST(TechniqueWeights, OfAnEnvironmentAreThoseOfTheDensities) { expect_weights(room({.light = sky})); }
TEST(TechniqueWeights, InAMediumAreThoseOfTheDensities) { expect_weights(room({.light = lamp, .more = fog})); }
// The mirror and the ball have no diffuse lobe, so photons are merged at the vertices that follow on them. The radius on the
// ball is half of that on the floor, and the weights of a path know both.
TEST(TechniqueWeights, BesideMergingAreThoseOfTheDensities) {
    for (const Merges merges : {Merges::behind_focus, Merges::everywhere})
        for (const LoadedScene& scene :
             {room({.light = lamp, .more = fog}), room({.light = lit_rooms::point}), room({.light = sky})})
            expect_weights(scene, MergeRule{merges, merging});
}
TEST(TechniqueWeights, OfSharedConnectionsAreThoseOfTheDensities) {
    for (const LoadedScene& scene : {room({.light = lamp, .more = fog}), room({.light = lit_rooms::point})}) {
        expect_weights(scene, NoMerging(), 16);
        for (const Merges merges : {Merges::behind_focus, Merges::everywhere})
            expect_weights(scene, MergeRule{merges, merging}, 16);
    }
}
TEST(TechniqueWeights, OfParallelRaysOfTheCameraAreThoseOfTheDensities) {
    expect_weights(room({.light = lamp, .sensor = "orthographic"}));
}

}  // namespace
}  // namespace gib::test::technique_weights_test
