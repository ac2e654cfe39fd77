#include "methods/radiosity/light.h"

#include "common/core/parallel.h"
#include "common/sampling/warp.h"
#include "methods/parts/transport/direct_light.h"
#include "methods/parts/transport/white_surface.h"
#include "methods/radiosity/contacts.h"

#include <algorithm>
#include <atomic>

namespace gib {

namespace {

constexpr std::size_t leaves_per_block = 64;
/// Random dimension that places a sample on a patch, past the dimensions of the path's first vertex.
constexpr std::uint32_t on_patch = dimension::at_vertex(1, 0);

Colord irradiance_at(RayQueries& rays, SurfaceHit hit, const Sampler& sampler) {
    hit.bsdf = &white_bsdf();
    hit.shading = Frame(hit.ns);
    const VertexNumbers u = sampler.at_vertex(0);
    NumberStream flights(sampler);
    const LobeValues light =
        sample_direct_light(rays, hit, Vec3::UnitZ(), u, {nullptr, flights}, LightTechniques::light_and_bsdf_sampling);
    const LobeValues found = follow_to_light(rays, hit, Vec3::UnitZ(), u);
    return (pi * (light.sum() + found.sum())).cast<double>();
}

Colord reflectance_at(const SurfaceHit& hit) {
    const float there = 1.f - hit.bsdf->pass_through();
    const float side = hit.shading.to_local(hit.ns).z() < 0.f ? -1.f : 1.f;
    if (const auto ideal = hit.bsdf->ideal_diffuse_reflectance(side)) return (there * *ideal).cast<double>();
    // The reflectance for evenly distributed light: the mean over sin^2 of the angle of incidence.
    constexpr int angles = 8;
    Colord sum = Colord::Zero();
    for (int i = 0; i < angles; ++i) {
        const float sine2 = (static_cast<float>(i) + 0.5f) / angles;
        const Vec3 w(std::sqrt(sine2), 0.f, side * std::sqrt(1.f - sine2));
        sum += hit.bsdf->coefficients_local(w).diffuse.cast<double>() / angles;
    }
    return static_cast<double>(there) * sum;
}

/// Calls use(queries, n) for every leaf n; returns the number of rays.
template <typename Use>
std::uint64_t over_leaves(const PatchMesh& mesh, std::string_view stage, const StageTimes& stages, Use&& use) {
    std::atomic<std::uint64_t> traced = 0;
    StageProgress progress(stages, stage, mesh.leaves().size());
    parallel_blocks(mesh.leaves().size(), leaves_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        RayQueries queries(mesh.charts().scene());
        for (std::size_t n = begin; n < end; ++n)
            use(queries, n);
        traced += queries.count();
        progress.add(end - begin);
    });
    return traced;
}

/// Samples the points of all leaves.
class Sampling {
public:
    Sampling(const PatchMesh& mesh, std::uint64_t seed, PatchLight& light)
        : mesh_(mesh),
          contacts_(mesh),
          seed_(seed),
          light_(light),
          irradiance_(light.points.size(), Colord::Zero()),
          in_light_(mesh.nodes().size(), 0) {}

    /// Places the points of a leaf, and samples their direct light and reflectance.
    void light_leaf(RayQueries& queries, std::size_t n) {
        const std::uint32_t i = mesh_.leaves()[n];
        const PatchNode& leaf = mesh_.nodes()[i];
        const bool textured = !queries.scene().material_of_shape(mesh_.chart_of(leaf).shape).constant();
        const std::uint32_t first = static_cast<std::uint32_t>(n) * light_.samples;
        light_.points_of[i] = {first, light_.samples};
        for (std::uint32_t k = 0; k < light_.samples; ++k) {
            const Sampler sampler(PointSet::sobol, seed_, i, k);
            SurfaceHit hit = mesh_.point_on(leaf, sampler.get_2d(on_patch).cast<double>());
            PatchLight::Point& point = light_.points[first + k];
            point.share = static_cast<float>(contacts_.share(leaf.side, hit.p.cast<double>()));
            // Light arrives above all surfaces that touch.
            if (point.share < 1.f) hit.p += 2 * static_cast<float>(contacts_.reach()) * hit.ng;
            static_cast<SurfacePoint&>(point) = hit;
            irradiance_[first + k] = irradiance_at(queries, hit, sampler);
            light_.irradiance[i] += irradiance_[first + k];
            if (textured || k == 0) light_.reflectance[i] += reflectance_at(hit) / (textured ? light_.samples : 1);
        }
    }

    /// Covers the points of a leaf to which no light gets: those under something that lies close above them, and those
    /// under something that stands on the leaf, such as a block without a bottom. They are dark, see no light on other
    /// patches, and no straight line leads to them from points that do.
    void leave_out_covered(RayQueries& queries, std::size_t n) {
        const std::uint32_t i = mesh_.leaves()[n];
        std::vector<std::uint32_t> lit, dark;
        for (std::uint32_t k = light_.points_of[i].first; k < light_.points_of[i].first + light_.samples; ++k)
            (irradiance_[k].sum() > 0 ? lit : dark).push_back(k);
        in_light_[i] =
            !lit.empty() || std::ranges::any_of(dark, [&](std::uint32_t k) { return sees_light(queries, k, 1); });
        if (dark.empty() || !in_light_[i] || mesh_.chart_of(mesh_.nodes()[i]).curved) return;
        if (lit.empty()) {
            // Nothing stands on the patch or lies close above it: it is dark for another reason.
            if (std::ranges::all_of(dark, [&](std::uint32_t k) {
                    return is_free(queries, dark.front(), k) && !lies_under_something(queries, k);
                }))
                return;
            std::ranges::copy_if(dark, std::back_inserter(lit),
                                 [&](std::uint32_t k) { return sees_light(queries, k); });
            if (lit.empty()) return;
        }
        for (const std::uint32_t k : dark) {
            if (!lies_under_something(queries, k) &&
                std::ranges::any_of(lit, [&](std::uint32_t other) { return is_free(queries, other, k); }))
                continue;
            if (!sees_light(queries, k)) light_.points[k].share *= static_cast<float>(Contacts::covered);
        }
    }

    const std::vector<char>& in_light() const { return in_light_; }

    /// Averages irradiance over the points of each leaf by their shares, and puts covered points last.
    void average() {
        for (const std::uint32_t i : mesh_.leaves()) {
            auto& [first, count] = light_.points_of[i];
            Colord sum = Colord::Zero();
            double shares = 0;
            for (std::uint32_t k = first; k < first + count; ++k) {
                const auto share = static_cast<double>(light_.points[k].share);
                sum += share * irradiance_[k];
                shares += share;
            }
            light_.irradiance[i] = sum / shares;
            light_.area[i] = mesh_.nodes()[i].area * shares / count;
            const auto begin = light_.points.begin() + first;
            const auto end = std::stable_partition(begin, begin + count, [](const PatchLight::Point& point) {
                return static_cast<double>(point.share) > 2 * Contacts::covered;
            });
            if (end != begin) count = static_cast<std::uint32_t>(end - begin);
        }
    }

private:
    /// Whether a straight line just above the surface leads from one point to the other.
    bool is_free(RayQueries& queries, std::uint32_t a, std::uint32_t b) const {
        const auto above = [&](std::uint32_t k) -> Vec3 {
            return light_.points[k].p + 2 * static_cast<float>(contacts_.reach()) * light_.points[k].ng;
        };
        const Vec3 way = above(b) - above(a);
        const float distance = way.norm();
        return !(distance > 0.f) || queries.visibility({above(a), above(b), way / distance, distance}).maxCoeff() > 0.f;
    }

    /// Whether something lies above a point, much closer than the patch is large.
    bool lies_under_something(RayQueries& queries, std::uint32_t k) const {
        const PatchLight::Point& point = light_.points[k];
        const Vec3 origin = offset_origin(point, point.ng);
        const float distance = 0.1f * static_cast<float>(mesh_.size());
        return queries.visibility({origin, origin + distance * point.ng, point.ng, distance}).maxCoeff() == 0.f;
    }

    std::uint32_t nearest_point(std::uint32_t leaf, const Vec3& p) const {
        const auto first = light_.points.begin() + light_.points_of[leaf].first;
        const auto distance2 = [&](const SurfacePoint& point) { return (point.p - p).squaredNorm(); };
        return static_cast<std::uint32_t>(std::ranges::min_element(first, first + light_.samples, {}, distance2) -
                                          light_.points.begin());
    }

    /// Whether one of the first rays from a point meets a patch with direct light.
    bool sees_light(RayQueries& queries, std::uint32_t k, std::uint32_t rays = 8) const {
        const PatchLight::Point& point = light_.points[k];
        for (std::uint32_t r = 0; r < rays; ++r) {
            const Vec2 u = Sampler(PointSet::sobol, seed_, k, r).get_2d(on_patch + 1);
            const Vec3 w = Frame(point.ng).to_world(square_to_cosine_hemisphere(u));
            const auto hit = queries.intersect({offset_origin(point, w), w});
            const auto place = hit ? mesh_.locate(*hit, -w) : std::nullopt;
            if (place && irradiance_[nearest_point(place->leaf, hit->p)].sum() > 0) return true;
        }
        return false;
    }

    const PatchMesh& mesh_;
    const Contacts contacts_;
    std::uint64_t seed_;
    PatchLight& light_;
    std::vector<Colord> irradiance_;  ///< direct irradiance by point [W/m^2]
    std::vector<char> in_light_;      ///< by node: a leaf is lit, or sees a leaf that is
};

/// Estimates the radiosity that the exchange of light will lead to: light that is reflected more than once is spread
/// evenly over all patches that see directly lit ones. Source: the ambient term of Cohen, Chen, Wallace and Greenberg 1988.
void estimate_ambient(const PatchMesh& mesh, const std::vector<char>& in_light, PatchLight& light) {
    const auto& nodes = mesh.nodes();
    Colord area = Colord::Zero(), absorbed = Colord::Zero(), received = Colord::Zero(), reflected = Colord::Zero();
    for (const std::uint32_t i : mesh.leaves()) {
        area += light.area[i];
        absorbed += light.area[i] * (1 - light.reflectance[i]);
        received += light.area[i] * light.irradiance[i];
        reflected += light.area[i] * light.irradiance[i] * light.reflectance[i];
    }
    light.expected.assign(nodes.size(), 0.0);
    light.spread.assign(nodes.size(), 0.0);
    if (mesh.leaves().empty()) return;
    const Colord ambient = reflected / absorbed.max(1e-3 * area);
    light.mean_irradiance = (received / area + ambient).mean();
    for (const std::uint32_t i : mesh.leaves())
        light.expected[i] =
            (light.reflectance[i] * (light.irradiance[i] + (in_light[i] ? ambient : Colord::Zero()))).mean();
    for (std::size_t i = nodes.size(); i-- > 0;) {
        if (nodes[i].is_leaf()) continue;
        const std::uint32_t a = nodes[i].child, b = a + 1;
        const double share = light.area[a] / (light.area[a] + light.area[b]);
        light.area[i] = light.area[a] + light.area[b];
        light.expected[i] = std::lerp(light.expected[b], light.expected[a], share);
        light.spread[i] = std::sqrt(std::lerp(sqr(light.spread[b]), sqr(light.spread[a]), share) +
                                    share * (1 - share) * sqr(light.expected[a] - light.expected[b]));
    }
}

/// A leaf of a node, chosen in proportion to its area. The number that chooses a half is used again in that half.
template <typename Area>
std::uint32_t chosen_leaf(const PatchMesh& mesh, std::uint32_t node, double& u, Area&& area) {
    while (!mesh.nodes()[node].is_leaf()) {
        const std::uint32_t child = mesh.nodes()[node].child;
        const double share = area(child) / (area(child) + area(child + 1));
        const bool first = u < share;
        u = first ? u / share : (u - share) / (1 - share);
        node = first ? child : child + 1;
    }
    return node;
}

}  // namespace

const PatchLight::Point& PatchLight::open_point(const PatchMesh& mesh, std::uint32_t node, double u) const {
    const std::uint32_t leaf = chosen_leaf(mesh, node, u, [&](std::uint32_t i) { return area[i]; });
    const auto [first, count] = points_of[leaf];
    return points[first + std::min(static_cast<std::uint32_t>(u * count), count - 1)];
}

const PatchLight::Point& PatchLight::any_point(const PatchMesh& mesh, std::uint32_t node, double u) const {
    const std::uint32_t leaf = chosen_leaf(mesh, node, u, [&](std::uint32_t i) { return mesh.nodes()[i].area; });
    return points[points_of[leaf].first + std::min(static_cast<std::uint32_t>(u * samples), samples - 1)];
}

PatchLight patch_light(const PatchMesh& mesh, std::uint32_t samples, std::uint64_t seed, std::uint64_t& rays,
                       const StageTimes& stages) {
    PatchLight light;
    light.irradiance.assign(mesh.nodes().size(), Colord::Zero());
    light.reflectance.assign(mesh.nodes().size(), Colord::Zero());
    light.area.assign(mesh.nodes().size(), 0.0);
    light.points.resize(samples * mesh.leaves().size());
    light.points_of.assign(mesh.nodes().size(), {0, 0});
    light.samples = samples;
    Sampling sampling(mesh, seed, light);
    rays += over_leaves(mesh, "direct light", stages,
                        [&](RayQueries& queries, std::size_t n) { sampling.light_leaf(queries, n); });
    rays += over_leaves(mesh, "covered points", stages,
                        [&](RayQueries& queries, std::size_t n) { sampling.leave_out_covered(queries, n); });
    sampling.average();
    estimate_ambient(mesh, sampling.in_light(), light);
    return light;
}

}  // namespace gib
