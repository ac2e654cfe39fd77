#include "methods/parts/photons/photon_walk.h"

#include "common/sampling/sampler.h"
#include "common/scene/scene.h"
#include "methods/method.h"
#include "methods/parts/emission/light_emission.h"
#include "methods/parts/photons/blocks_within_memory.h"
#include "methods/parts/transport/light_policy.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <utility>

namespace gib {

namespace {

/// Photons in a block of work: a share of all, so that few photons occupy all processors too, within these bounds.
constexpr std::uint64_t walk_blocks = 64, fewest_per_block = 256, most_per_block = 4096;
/// Aimed photons have larger blocks: the more of them are sorted together, the closer together they lie.
constexpr std::uint64_t most_aimed_per_block = 16384;
/// Memory of a photon while the map is built: the photon itself and its 29 bytes in the map (see PhotonMap).
constexpr double bytes_per_photon = sizeof(Photon) + 29;
constexpr double bytes_per_beam = 2 * sizeof(PhotonBeam);

/// Name of the parameter for the number of photons that are emitted for a map of this kind.
const char* name_of(PhotonMapKind kind) {
    return kind == PhotonMapKind::caustic                                 ? "caustic_photons"
           : kind == PhotonMapKind::global || kind == PhotonMapKind::full ? "photons"
                                                                          : "volume_photons";
}

/// How photons scatter, null: plainly, and the mean power with which they start, in the result's unit.
struct PhotonPolicy {
    const LightPolicy* scattering;
    float first_power;
};

/// The path of one photon from a light until it is absorbed, escapes or can no longer be stored.
class PhotonPath {
public:
    /// Starts along `first`, which has been traced.
    PhotonPath(RayQueries& rays, PhotonMapKind kind, int max_edges, const PhotonPolicy& policy, const Sampler& sampler,
               const TracedRay& first, PhotonWalkResult& result)
        : walk_(rays, sampler, first, rays.scene().has_media() ? rays.medium_at(first.ray.o) : nullptr),
          at_(walk_.at),
          kind_(kind),
          max_edges_(max_edges),
          policy_(policy),
          result_(result) {}

    /// Follows the photon, which the light has emitted with this power, in the result's unit.
    void trace(const Light& light, const Color& power) {
        at_.beta = power;
        walk_.come_from(light);
        if (!is_black(at_.beta)) follow();
    }

private:
    /// Whether the photon could be stored at the end of this edge of its path (1: the first), with one more edge to
    /// the eye.
    bool allows_edge(int edge) const { return edge < max_edges_; }

    void follow() {
        while (allows_edge(at_.vertex + 1)) {
            if (kind_ == PhotonMapKind::beams) store_beam();
            const float before = at_.beta.maxCoeff();
            const Flight flight = walk_.fly();
            if (flight.is_black) return;
            if (flight.scattering_at) {
                if (!scatter_in_medium(*flight.scattering_at, before)) return;
                continue;
            }
            auto hit = walk_.surface_hit();
            if (!hit) return;
            const Vec3 wo = walk_.wo(), wo_local = hit->shading.to_local(wo);
            // The photon is stored before it may pass a hole, as an eye path decides for itself
            // whether the surface is there.
            if (stores_on_surfaces() && hit->bsdf->traits_at(wo_local.z()).diffuse)
                result_.photons.emplace_back(hit->p, at_.beta, wo, normal_towards(*hit, wo), at_.vertex + 1,
                                             at_.path_class.in_medium, at_.stratum);
            if (walk_.passes_through(*hit)) continue;
            walk_.disperse(*hit, dimension::photon_stratum);
            if (!scatter(*hit, wo, wo_local)) return;
        }
    }

    /// Whether a photon with this path is stored on diffuse surfaces.
    bool stores_on_surfaces() const {
        const PathClass& path = at_.path_class;
        const bool scattered = path.diffuse_vertices > 0 || path.in_medium;
        return kind_ == PhotonMapKind::full || (kind_ == PhotonMapKind::global && scattered) ||
               (kind_ == PhotonMapKind::caustic && !scattered && path.specular_since_diffuse);
    }

    /// Stores the flight that begins here as a beam, whose end does not depend on that of the flight.
    void store_beam() {
        const Medium* medium = at_.medium;
        if (!medium || !medium->scatters()) return;
        const Ray& way = walk_.ray.ray;
        Color power = at_.beta;
        const auto reach =
            medium->sample_reach(way.o, way.d, walk_.ray.found ? walk_.ray.found->t : infinity, walk_.flights, power);
        if (!reach) return;
        const PhotonPayload light(power, -way.d, way.d, at_.vertex + 1, true, at_.stratum);
        result_.beams.emplace_back(light, way.o + reach->begin * way.d, way.d, reach->end - reach->begin,
                                   walk_.flights.next(), *medium);
    }

    /// A scattering event at p in a medium. `before` is the largest channel of the power at the start of the free
    /// flight. Returns false if the photon ends here.
    /// Source: Jensen and Christensen 1998; Jensen 2001, chapter 10.
    bool scatter_in_medium(const Vec3& p, float before) {
        const Vec3 wo = walk_.wo();
        const bool came_straight = at_.vertex == 0;
        if (kind_ == PhotonMapKind::caustic) return false;
        if (kind_ == PhotonMapKind::media || (kind_ == PhotonMapKind::volume && !came_straight)) {
            const Color sigma_s = at_.medium->scattering_at(p);
            const Color fluence = (sigma_s > 0.f).select(at_.beta / sigma_s, Color::Zero());
            result_.photons.emplace_back(p, fluence, wo, wo, at_.vertex + 1, true, at_.stratum);
        }
        if (!allows_edge(at_.vertex + 2)) return false;
        const auto wi = scatter_light(policy_.scattering, walk_, p, before, walk_.vertex_numbers, policy_.first_power);
        if (!wi) return false;
        at_.path_class.in_medium = true;
        walk_.go_on(p, *wi);
        return true;
    }

    /// Scattering at a surface. Returns false if the photon ends here.
    bool scatter(const SurfaceHit& hit, const Vec3& wo, const Vec3& wo_local) {
        const auto next = scatter_light(policy_.scattering, walk_, hit, wo, wo_local, walk_.vertex_numbers,
                                        policy_.first_power, false);
        if (!next) return false;
        if (kind_ == PhotonMapKind::caustic && next->lobe == LobeKind::diffuse) return false;
        if (!allows_edge(at_.vertex + 2)) return false;
        walk_.go_on(hit, next->wi);
        return true;
    }

    PathWalk walk_;
    PathState& at_;  ///< state of walk_; beta is the power in the result's unit
    PhotonMapKind kind_;
    int max_edges_;
    const PhotonPolicy& policy_;
    PhotonWalkResult& result_;
};

/// Calls visit(start, first, sampler) for the photons [begin, end), where `first` is the start's
/// ray and its closest hit.
template <typename Visit>
void emit(RayQueries& rays, std::uint64_t key, std::size_t begin, std::size_t end, const Visit& visit) {
    for (std::size_t i = begin; i < end; ++i) {
        const Sampler sampler(PointSet::independent, key, i, 0);
        const auto u = sampler.at_start();
        const EmissionSample start = rays.scene().sample_emission(
            u[dimension::emission_light].x(), u[dimension::emission_position], u[dimension::emission_direction]);
        TracedRay first{start.ray};
        rays.trace(first);
        visit(start, first, sampler);
    }
}

/// The same for starts that a policy aims.
template <typename Visit>
void emit_by_policy(RayQueries& rays, const LightEmission& emission, std::uint64_t key, std::size_t begin,
                    std::size_t end, const Visit& visit) {
    for (std::size_t i = begin; i < end; ++i) {
        const Sampler sampler(PointSet::independent, key, i, 0);
        const auto start = emission.sample(sampler);
        if (!start) continue;
        TracedRay first{start->sample.ray};
        rays.trace(first);
        visit(start->sample, first, sampler);
    }
}

/// Calls visit(start, first, sampler) for the aimed photons [begin, end), in the order of their bins. Neighbours in
/// the map are neighbours in space, so a photon finds in the processor's cache what the previous one read, and the
/// first rays are traced as packets.
template <typename Visit>
void emit_aimed(RayQueries& rays, const AimedEmission& aim, std::uint64_t key, std::size_t begin, std::size_t end,
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
    for (std::size_t packet_begin = 0; packet_begin < order.size(); packet_begin += packet.size()) {
        const std::size_t count = std::min(packet.size(), order.size() - packet_begin);
        for (std::size_t j = 0; j < count; ++j) {
            const auto u = sampler_of(packet_begin + j).at_start();
            starts[j] = aim.sample_emission(rays.scene(), order[packet_begin + j].first,
                                            u[dimension::emission_position], u[dimension::emission_direction]);
            packet[j] = starts[j].ray;
        }
        rays.trace(std::span(packet).first(count), found);
        for (std::size_t j = 0; j < count; ++j)
            visit(starts[j], TracedRay{packet[j], found[j]}, sampler_of(packet_begin + j));
    }
}

}  // namespace

PhotonWalkResult trace_photons(const Scene& scene, PhotonMapKind kind, std::uint64_t count, int max_edges,
                               std::uint64_t seed, const AimedEmission* aim, StageProgress* progress, RayLog* log,
                               const LightPolicy* policy) {
    PhotonWalkResult result;
    result.emitted = count;
    if (count == 0 || !scene.has_light() || (aim && aim->empty())) return result;
    // Edges are stored in 16 bits, so a photon's path ends there even if paths are unlimited; no sum of edges exceeds
    // the limit then.
    const int longest = std::min(max_edges, static_cast<int>(std::numeric_limits<std::uint16_t>::max()));
    const std::uint64_t key = combine_keys(seed, static_cast<std::uint64_t>(kind) + 1);
    result.unit = photon_power_unit(scene.emitted_power(), count);
    const double share = 1 / (static_cast<double>(count) * result.unit);

    // Caustic photons follow the policy at their start alone.
    const bool caustic = kind == PhotonMapKind::caustic;
    const PhotonPolicy by{caustic ? nullptr : policy, static_cast<float>(share * scene.emitted_power().maxCoeff())};
    const LightEmission* emission = policy ? policy->start(caustic) : nullptr;
    const std::uint64_t per_block =
        std::clamp(count / walk_blocks, fewest_per_block, aim ? most_aimed_per_block : most_per_block);
    const auto trace_block = [&](PhotonWalkResult& block, std::size_t begin, std::size_t end) {
        RayQueries rays(scene, log);
        const auto trace = [&](const EmissionSample& start, const TracedRay& first, const Sampler& sampler) {
            const Color power = (share * start.power).cast<float>();
            // Such a photon comes from a dark texel or from a very much fainter lamp. It would count as a neighbour in
            // a density estimate without adding power.
            if (power.maxCoeff() < PhotonPayload::least_power) return;
            PhotonPath(rays, kind, longest, by, sampler, first, block).trace(scene.lights()[start.light], power);
        };
        if (emission) emit_by_policy(rays, *emission, key, begin, end, trace);
        else if (aim) emit_aimed(rays, *aim, key, begin, end, trace);
        else emit(rays, key, begin, end, trace);
        block.rays = rays.count();
        if (progress) progress->add(end - begin);
    };
    const auto trace_all = [&](auto items, double bytes_per_item) {
        auto parts = blocks_within_memory(count, per_block, items, bytes_per_item,
                                          std::string(name_of(kind)) + "=" + std::to_string(count), trace_block);
        result.*items = joined(parts, items);
        for (const PhotonWalkResult& block : parts)
            result.rays += block.rays;
    };
    if (kind == PhotonMapKind::beams) trace_all(&PhotonWalkResult::beams, bytes_per_beam);
    else trace_all(&PhotonWalkResult::photons, bytes_per_photon);
    return result;
}

}  // namespace gib
