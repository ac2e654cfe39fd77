#include "methods/photon_walk.h"

#include "common/parallel.h"
#include "common/sampler.h"
#include "common/scene.h"
#include "methods/projection_map.h"
#include "methods/ray_queries.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace gib {

namespace {

constexpr std::size_t photons_per_block = 4096;
/// More of them lie closer together.
constexpr std::size_t aimed_photons_per_block = 16384;
/// From this hit on survival is capped, so that walks among mirrors of albedo 1 end; the rescaling keeps them unbiased.
constexpr int first_capped_hit = 64;
constexpr float capped_survival = 0.9f;

/// |wi.ng| |wo.ns| / (|wi.ns| |wo.ng|): what an interpolated normal does to transported power; 1 where both normals
/// agree.
/// wo is where the photon came from. Source: Veach 1997, section 5.3.
float shading_normal_correction(const SurfaceHit& hit, const Vec3& wo, const Vec3& wi) {
    const float numerator = std::abs(wi.dot(hit.ng) * wo.dot(hit.ns));
    const float denominator = std::abs(wi.dot(hit.ns) * wo.dot(hit.ng));
    return denominator > 0.f ? numerator / denominator : 0.f;
}

Photon photon_at(const SurfaceHit& hit, const Vec3& wo, const Color& power, int edges) {
    const Vec3 side = wo.dot(hit.ng) >= 0.f ? hit.ng : Vec3(-hit.ng);
    return {hit.p, power, encode_direction(wo), encode_normal(side), static_cast<std::uint16_t>(edges)};
}

/// One photon from a light until it is absorbed, escapes or can no longer be stored.
class PhotonPath {
public:
    PhotonPath(RayQueries& rays, PhotonMapKind kind, int max_edges, PhotonWalkResult& result)
        : rays_(rays), kind_(kind), max_edges_(max_edges), result_(result) {}

    void trace(const EmissionSample& start, const Sampler& sampler, float share) {
        Color power = share * start.power;
        if (is_black(power)) return;  // from a dark texel; it would count as a neighbour in a density estimate
        Ray ray = start.ray;
        result_.balance.emitted += power.cast<double>();
        residual_ = power.cast<double>();
        PathClass path;
        std::uint32_t holes = 0;
        // An edge to here and at least one more to the eye: a photon of max_edges could never be used.
        for (int edges = 1; edges < max_edges_; ++edges) {
            const auto hit = rays_.intersect(ray);
            if (!hit) {
                result_.balance.escaped += power.cast<double>();
                residual_ -= power.cast<double>();
                break;
            }
            const Vec3 wo = -ray.d;
            const Vec3 wo_local = hit->shading.to_local(wo);
            // Stored before it may pass a hole: an eye path decides for itself whether the surface is there.
            if (stores(path) && hit->bsdf->traits_at(wo_local.z()).diffuse)
                result_.photons.push_back(photon_at(*hit, wo, power, edges));
            if (hit->bsdf->pass_through() > 0.f &&
                sampler.get_1d(dimension::first_hole + holes++) < hit->bsdf->pass_through()) {
                ray = hit->spawn_ray(ray.d);
                --edges;
                continue;
            }
            if (!scatter(*hit, wo_local, sampler, edges - 1, power, path, ray)) break;
        }
        result_.balance.squared_residuals += residual_ * residual_;
    }

private:
    bool stores(const PathClass& path) const {
        const bool scattered_diffusely = path.diffuse_vertices > 0;
        return kind_ == PhotonMapKind::global ? scattered_diffusely
                                              : !scattered_diffusely && path.specular_since_diffuse;
    }

    void absorb(const Color& power) {
        result_.balance.absorbed += power.cast<double>();
        residual_ -= power.cast<double>();
    }

    /// Roulette on the slides' coefficients: P_r = max over channels of d + s; survivors are rescaled per channel by
    /// coefficient / P_r. False: the photon ends here.
    bool scatter(const SurfaceHit& hit, const Vec3& wo_local, const Sampler& sampler, int vertex, Color& power,
                 PathClass& path, Ray& ray) {
        const ScatteringCoefficients c = hit.bsdf->coefficients_local(wo_local);
        const Color albedo = c.diffuse + c.specular;
        absorb(power * (1.f - albedo));
        float survival = std::clamp(albedo.maxCoeff(), 0.f, 1.f);
        if (vertex >= first_capped_hit) survival = std::min(survival, capped_survival);
        const VertexNumbers u = sampler.at_vertex(vertex);
        if (!(u.roulette() < survival)) return false;

        const auto next = hit.bsdf->sample_local(wo_local, u.bsdf_lobe(), u.bsdf_direction(), Transport::power);
        if (!next) return false;
        if (kind_ == PhotonMapKind::caustic && next->lobe == LobeKind::diffuse) return false;
        const Vec3 wi = hit.shading.to_world(next->wi);
        power *=
            next->f * (std::abs(next->wi.z()) / (next->pdf_w * survival)) * shading_normal_correction(hit, -ray.d, wi);
        path.scatter(next->lobe);
        ray = hit.spawn_ray(wi);
        return true;
    }

    RayQueries& rays_;
    PhotonMapKind kind_;
    int max_edges_;
    PhotonWalkResult& result_;
    Colord residual_ = Colord::Zero();  ///< of this photon: what the balance has not accounted for
};

/// Calls visit(start, sampler) for the photons [begin, end).
template <typename Visit>
void emit(const Scene& scene, std::uint64_t key, std::size_t begin, std::size_t end, const Visit& visit) {
    for (std::size_t i = begin; i < end; ++i) {
        const Sampler sampler(PointSet::independent, key, i, 0);
        visit(scene.sample_emission(sampler.get_1d(dimension::emission_light),
                                    sampler.get_2d(dimension::emission_position),
                                    sampler.get_2d(dimension::emission_direction)),
              sampler);
    }
}

/// The same for aimed photons, in the order of their cells: neighbours in the map are neighbours in space, so that
/// one photon finds in
/// the cache what the one before it read. Tracing the glass bunny's caustic takes two thirds of the time.
template <typename Visit>
void emit_aimed(const Scene& scene, const ProjectionMap& aim, std::uint64_t key, std::size_t begin, std::size_t end,
                const Visit& visit) {
    std::vector<std::pair<std::uint32_t, std::size_t>> order;
    order.reserve(end - begin);
    for (std::size_t i = begin; i < end; ++i)
        order.emplace_back(aim.choose_cell(Sampler(PointSet::independent, key, i, 0).get_2d(dimension::emission_light)),
                           i);
    std::sort(order.begin(), order.end());
    for (const auto& [cell, i] : order) {
        const Sampler sampler(PointSet::independent, key, i, 0);
        visit(aim.sample_emission(scene, cell, sampler.get_2d(dimension::emission_position),
                                  sampler.get_2d(dimension::emission_direction)),
              sampler);
    }
}

}  // namespace

PowerBalance& PowerBalance::operator+=(const PowerBalance& other) {
    emitted += other.emitted;
    absorbed += other.absorbed;
    escaped += other.escaped;
    squared_residuals += other.squared_residuals;
    return *this;
}

PhotonWalkResult trace_photons(const Scene& scene, PhotonMapKind kind, std::uint64_t count, int max_edges,
                               std::uint64_t seed, const ProjectionMap* aim) {
    PhotonWalkResult result;
    result.emitted = count;
    if (count == 0 || !scene.has_light() || (aim && aim->empty())) return result;
    // Edges are stored in 16 bits; with an unlimited path length no sum of edges can exceed the limit.
    const int longest = std::min(max_edges, static_cast<int>(std::numeric_limits<std::uint16_t>::max()));
    const std::uint64_t key = combine_keys(seed, static_cast<std::uint64_t>(kind) + 1);
    const float share = static_cast<float>(1.0 / static_cast<double>(count));

    const std::size_t per_block = aim ? aimed_photons_per_block : photons_per_block;
    std::vector<PhotonWalkResult> blocks((count + per_block - 1) / per_block);
    parallel_blocks(count, per_block, [&](std::size_t begin, std::size_t end, std::size_t block) {
        RayQueries rays(scene);
        PhotonPath path(rays, kind, longest, blocks[block]);
        const auto trace = [&](const EmissionSample& start, const Sampler& sampler) {
            path.trace(start, sampler, share);
        };
        if (aim) emit_aimed(scene, *aim, key, begin, end, trace);
        else emit(scene, key, begin, end, trace);
        blocks[block].rays = rays.count();
    });

    std::size_t stored = 0;
    for (const auto& block : blocks)
        stored += block.photons.size();
    result.photons.reserve(stored);
    for (auto& block : blocks) {  // in block order: the result does not depend on the threads
        result.photons.insert(result.photons.end(), block.photons.begin(), block.photons.end());
        result.rays += block.rays;
        result.balance += block.balance;
        block = {};
    }
    return result;
}

}  // namespace gib
