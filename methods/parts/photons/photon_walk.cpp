#include "methods/parts/photons/photon_walk.h"

#include "common/sampling/sampler.h"
#include "common/scene/scene.h"
#include "methods/method.h"
#include "methods/parts/photons/blocks_within_memory.h"
#include "methods/parts/photons/projection_map.h"
#include "methods/parts/transport/dispersed_path.h"
#include "methods/parts/transport/ray_queries.h"
#include "methods/parts/transport/roulette.h"
#include "methods/parts/transport/scattered_ray.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <utility>

namespace gib {

namespace {

constexpr std::size_t photons_per_block = 4096;
/// Aimed photons have larger blocks: the more of them are sorted together, the closer together they lie.
constexpr std::size_t aimed_photons_per_block = 16384;
/// Memory of a photon while the map is built: the photon itself and its 29 bytes in the map (see PhotonMap).
constexpr double bytes_per_photon = sizeof(Photon) + 29;

/// Name of the parameter for the number of photons that are emitted for a map of this kind.
const char* name_of(PhotonMapKind kind) {
    switch (kind) {
        case PhotonMapKind::caustic:
            return "caustic_photons";
        case PhotonMapKind::volume:
            return "volume_photons";
        case PhotonMapKind::global:
        case PhotonMapKind::full:
            break;
    }
    return "photons";
}

/// |wi.ng| |wo.ns| / (|wi.ns| |wo.ng|): the factor by which an interpolated normal ns changes transported power; it
/// is 1 where the two normals agree. wo is where the photon came from. Source: Veach 1997, section 5.3.
float shading_normal_correction(const SurfaceHit& hit, const Vec3& wo, const ScatteredRay& scattered) {
    const Vec3 &wi = scattered.wi, &ns = scattered.normal;
    const float numerator = std::abs(wi.dot(hit.ng) * wo.dot(ns));
    const float denominator = std::abs(wi.dot(ns) * wo.dot(hit.ng));
    return denominator > 0.f ? numerator / denominator : 0.f;
}

Photon photon_on(const SurfaceHit& hit, const Vec3& wo, const Color& power, int edges, const PathClass& path,
                 std::optional<int> stratum) {
    const Vec3 side = wo.dot(hit.ng) >= 0.f ? hit.ng : Vec3(-hit.ng);
    return {hit.p, power, wo, side, edges, path.in_medium, stratum};
}

/// The path of one photon from a light until it is absorbed, escapes or can no longer be stored.
class PhotonPath {
public:
    PhotonPath(RayQueries& rays, PhotonMapKind kind, int max_edges, const Sampler& sampler, PhotonWalkResult& result)
        : rays_(rays), kind_(kind), max_edges_(max_edges), sampler_(sampler), flights_(sampler), result_(result) {}

    /// Follows the photon with the power `share` times the start's, in the result's unit.
    void trace(const EmissionSample& start, const TracedRay& first, double share) {
        power_ = (share * start.power).cast<float>();
        // The photon comes from a dark texel or from a very much fainter lamp. It would count as a neighbour in a
        // density estimate without adding power.
        if (power_.maxCoeff() < PhotonPayload::least_power) return;
        result_.balance.emitted += power_.cast<double>();
        residual_ = power_.cast<double>();
        follow(first);
        result_.balance.squared_residuals += residual_ * residual_;
    }

private:
    void follow(TracedRay traced) {
        const Scene& scene = rays_.scene();
        if (scene.has_media()) medium_ = rays_.medium_at(traced.ray.o);
        std::uint32_t holes = 0;
        bool is_first = true;
        // The path has `edges` edges up to the hit and needs at least one more to the eye: a photon of max_edges
        // edges could never be used.
        for (int edges = 1; edges < max_edges_; ++edges) {
            if (!std::exchange(is_first, false)) rays_.trace(traced);
            if (medium_) {
                const Color before = power_;
                const float length = traced.found ? traced.found->t : infinity;
                const auto flight = medium_->sample_flight(traced.ray.o, traced.ray.d, length, flights_, power_);
                account(before - power_, result_.balance.lost_in_media);
                if (is_black(power_)) return;
                if (flight) {
                    if (!scatter_in_medium(traced.ray.o + *flight * traced.ray.d, before, edges, traced.ray)) return;
                    continue;
                }
            }
            auto hit = rays_.surface_hit(traced);
            if (!hit) {
                account(power_, result_.balance.escaped);
                return;
            }
            const Vec3 wo = -traced.ray.d;
            const Vec3 wo_local = hit->shading.to_local(wo);
            // The photon is stored before it may pass a hole, as an eye path decides for itself
            // whether the surface is there.
            if (stores_on_surfaces() && hit->bsdf->traits_at(wo_local.z()).diffuse)
                result_.photons.push_back(photon_on(*hit, wo, power_, edges, path_, stratum_));
            if (hit->bsdf->pass_through() > 0.f &&
                sampler_.get_1d(dimension::first_hole + holes++) < hit->bsdf->pass_through()) {
                medium_ = scene.medium_beyond(*hit, traced.ray.d, medium_);
                traced.ray = hit->spawn_ray(traced.ray.d);
                --edges;
                continue;
            }
            if (scene.has_dispersion())
                disperse(scene, sampler_.get_1d(dimension::photon_stratum), *hit, stratum_, power_);
            if (!scatter(*hit, wo_local, edges - 1, traced.ray)) return;
        }
    }

    /// Whether a photon with this path is stored on diffuse surfaces.
    bool stores_on_surfaces() const {
        const bool scattered = path_.diffuse_vertices > 0 || path_.in_medium;
        switch (kind_) {
            case PhotonMapKind::global:
                return scattered;
            case PhotonMapKind::full:
                return true;
            case PhotonMapKind::caustic:
                return !scattered && path_.specular_since_diffuse;
            case PhotonMapKind::volume:
                return false;
        }
        return false;
    }

    /// Books power that leaves the path in `part` of the balance.
    void account(const Color& power, Colord& part) {
        part += power.cast<double>();
        residual_ -= power.cast<double>();
    }

    /// Russian roulette: ends the path with probability 1 - survival, or 1 - `most` if that is
    /// more (Jensen 2001, section 5.2).
    bool survives(float survival, float most, float u) {
        survival = std::clamp(survival, 0.f, most);
        if (!(u < survival)) return false;
        power_ /= survival;
        return true;
    }

    /// A scattering event at p in a medium, at the end of `edges` edges. `before` is the power at the start of the
    /// free flight; the roulette compensates for the weight of the flight. Returns false if the photon ends here.
    /// Source: Jensen and Christensen 1998; Jensen 2001, chapter 10.
    bool scatter_in_medium(const Vec3& p, const Color& before, int edges, Ray& ray) {
        const Vec3 wo = -ray.d;
        const bool came_straight = path_.diffuse_vertices == 0 && !path_.specular_since_diffuse && !path_.in_medium;
        if (kind_ == PhotonMapKind::caustic) return false;
        if (kind_ == PhotonMapKind::volume && !came_straight) {
            const Color sigma_s = medium_->scattering_at(p);
            const Color fluence = (sigma_s > 0.f).select(power_ / sigma_s, Color::Zero());
            result_.photons.emplace_back(p, fluence, wo, wo, edges, true, stratum_);
        }
        const VertexNumbers u = sampler_.at_vertex(edges - 1);
        if (!survives(power_.maxCoeff() / before.maxCoeff(), most_survival(edges - 1), u.roulette())) return false;
        path_.in_medium = true;
        ray = {p, medium_->phase().sample(wo, u.bsdf_direction())};
        return true;
    }

    /// Scattering at a surface by Russian roulette (Jensen 2001, section 5.2): the photon survives with probability
    /// P_r = max_c (d_c + s_c), with the diffuse and specular coefficients d and s of channel c; its power is then
    /// scaled by (d_c + s_c) / P_r in each channel. Returns false if the photon ends here.
    bool scatter(const SurfaceHit& hit, const Vec3& wo_local, int vertex, Ray& ray) {
        const ScatteringCoefficients c = hit.bsdf->coefficients_local(wo_local);
        const Color albedo = c.diffuse + c.specular;
        account(power_ * (1.f - albedo), result_.balance.absorbed);
        const VertexNumbers u = sampler_.at_vertex(vertex);
        const float most = is_black(c.diffuse) ? most_specular_survival(vertex) : most_survival(vertex);
        if (!survives(albedo.maxCoeff(), most, u.roulette())) return false;

        const auto next = sample_scattering(hit, wo_local, u.bsdf_lobe(), u.bsdf_direction(), Transport::power);
        if (!next) return false;
        if (kind_ == PhotonMapKind::caustic && next->lobe == LobeKind::diffuse) return false;
        power_ *= next->weight * shading_normal_correction(hit, -ray.d, *next);
        path_.scatter(next->lobe);
        if (rays_.scene().has_media()) medium_ = rays_.scene().medium_beyond(hit, next->wi, medium_);
        ray = hit.spawn_ray(next->wi);
        return true;
    }

    RayQueries& rays_;
    PhotonMapKind kind_;
    int max_edges_;
    const Sampler& sampler_;
    NumberStream flights_;
    PhotonWalkResult& result_;
    Color power_ = Color::Zero();  ///< in the result's unit
    PathClass path_;
    const Medium* medium_ = nullptr;    ///< that the photon is in
    std::optional<int> stratum_;        ///< of wavelengths, once the path has met dispersion
    Colord residual_ = Colord::Zero();  ///< power that the balance has not accounted for
};

/// Calls visit(start, first, sampler) for the photons [begin, end), where `first` is the start's
/// ray and its closest hit.
template <typename Visit>
void emit(RayQueries& rays, std::uint64_t key, std::size_t begin, std::size_t end, const Visit& visit) {
    for (std::size_t i = begin; i < end; ++i) {
        const Sampler sampler(PointSet::independent, key, i, 0);
        const EmissionSample start = rays.scene().sample_emission(sampler.get_1d(dimension::emission_light),
                                                                  sampler.get_2d(dimension::emission_position),
                                                                  sampler.get_2d(dimension::emission_direction));
        TracedRay first{start.ray};
        rays.trace(first);
        visit(start, first, sampler);
    }
}

/// Calls visit(start, first, sampler) for the aimed photons [begin, end), in the order of their bins. Neighbours in
/// the map are neighbours in space, so a photon finds in the processor's cache what the previous one read, and the
/// first rays are traced as packets.
template <typename Visit>
void emit_aimed(RayQueries& rays, const ProjectionMap& aim, std::uint64_t key, std::size_t begin, std::size_t end,
                const Visit& visit) {
    std::vector<std::pair<std::uint32_t, std::size_t>> order;
    order.reserve(end - begin);
    for (std::size_t i = begin; i < end; ++i)
        order.emplace_back(aim.choose_bin(Sampler(PointSet::independent, key, i, 0).get_2d(dimension::emission_light)),
                           i);
    std::sort(order.begin(), order.end());
    std::array<EmissionSample, Accelerator::packet_size> starts;
    std::array<Ray, Accelerator::packet_size> packet;
    std::array<std::optional<Intersection>, Accelerator::packet_size> found;
    const auto sampler_of = [&](std::size_t at) { return Sampler(PointSet::independent, key, order[at].second, 0); };
    for (std::size_t group = 0; group < order.size(); group += packet.size()) {
        const std::size_t count = std::min(packet.size(), order.size() - group);
        for (std::size_t j = 0; j < count; ++j) {
            const Sampler sampler = sampler_of(group + j);
            starts[j] =
                aim.sample_emission(rays.scene(), order[group + j].first, sampler.get_2d(dimension::emission_position),
                                    sampler.get_2d(dimension::emission_direction));
            packet[j] = starts[j].ray;
        }
        rays.trace(std::span(packet).first(count), found);
        for (std::size_t j = 0; j < count; ++j)
            visit(starts[j], TracedRay{packet[j], found[j]}, sampler_of(group + j));
    }
}

}  // namespace

PowerBalance& PowerBalance::operator+=(const PowerBalance& other) {
    emitted += other.emitted;
    absorbed += other.absorbed;
    escaped += other.escaped;
    lost_in_media += other.lost_in_media;
    squared_residuals += other.squared_residuals;
    return *this;
}

PowerBalance& PowerBalance::operator*=(double factor) {
    emitted *= factor;
    absorbed *= factor;
    escaped *= factor;
    lost_in_media *= factor;
    squared_residuals *= factor * factor;
    return *this;
}

PhotonWalkResult trace_photons(const Scene& scene, PhotonMapKind kind, std::uint64_t count, int max_edges,
                               std::uint64_t seed, const ProjectionMap* aim, StageProgress* progress) {
    PhotonWalkResult result;
    result.emitted = count;
    if (count == 0 || !scene.has_light() || (aim && aim->empty())) return result;
    // Edges are stored in 16 bits, so a photon's path ends there even if paths are unlimited; no sum of edges exceeds
    // the limit then.
    const int longest = std::min(max_edges, static_cast<int>(std::numeric_limits<std::uint16_t>::max()));
    const std::uint64_t key = combine_keys(seed, static_cast<std::uint64_t>(kind) + 1);
    result.unit = photon_power_unit(scene.emitted_power(), count);
    const double share = 1 / (static_cast<double>(count) * result.unit);

    const std::size_t per_block = aim ? aimed_photons_per_block : photons_per_block;
    const auto trace_block = [&](PhotonWalkResult& block, std::size_t begin, std::size_t end) {
        RayQueries rays(scene);
        const auto trace = [&](const EmissionSample& start, const TracedRay& first, const Sampler& sampler) {
            PhotonPath(rays, kind, longest, sampler, block).trace(start, first, share);
        };
        if (aim) emit_aimed(rays, *aim, key, begin, end, trace);
        else emit(rays, key, begin, end, trace);
        block.rays = rays.count();
        if (progress) progress->add(end - begin);
    };
    auto blocks = blocks_within_memory(count, per_block, &PhotonWalkResult::photons, bytes_per_photon,
                                       std::string(name_of(kind)) + "=" + std::to_string(count), trace_block);

    result.photons = joined(blocks, &PhotonWalkResult::photons);
    for (const PhotonWalkResult& block : blocks) {
        result.rays += block.rays;
        result.balance += block.balance;
    }
    result.balance *= result.unit;
    return result;
}

}  // namespace gib
