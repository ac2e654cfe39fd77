#include "methods/parts/manifold/specular_chain.h"

#include <Eigen/LU>

namespace gib {

namespace {

/// A chain has converged if its last direction misses the light by less [rad]; one further step then squares the error.
constexpr double converged = 1e-4;
/// Chains of a larger error have a nearly singular M, next to the edge of a caustic, and count as not found.
constexpr double largest_error = 1e-3;
constexpr int most_steps = 12;
constexpr double smallest_damping = 1. / 16;
/// No step moves x_1 farther than this, in units of its distance from x.
constexpr double longest_step = 0.5;

struct Constraint {
    Eigen::Matrix2d m;
    Vec2d step;       ///< M^-1 c
    double mismatch;  ///< |d - o|
};

/// d - o lies in the plane across d + o, whose basis is B; so a small step along -M^-1 c makes it shorter.
Constraint constraint_of(const Chain& chain, const ChainEnd& end) {
    const Vec3d d = chain.d.cast<double>(), way = end.p.cast<double>() - chain.p;
    const double r = end.at_infinity ? std::numeric_limits<double>::infinity() : way.norm();
    const Vec3d o = end.at_infinity ? Vec3d(end.p.cast<double>()) : Vec3d(way / r);
    const Frame frame(Vec3((d + o).normalized().cast<float>()));
    Chain::Differential basis;
    basis << frame.s.cast<double>(), frame.t.cast<double>();
    Constraint c;
    c.m = basis.transpose() * (chain.dd + (chain.dp - o * (o.transpose() * chain.dp)) / r);
    c.step = c.m.inverse() * (basis.transpose() * (d - o));
    c.mismatch = (d - o).norm();
    return c;
}

/// The lobe of this event at full weight.
std::optional<ScatteredRay> delta_ray(const SurfaceHit& hit, const Vec3& wo, bool transmits) {
    // The largest random number chooses transmission, the smallest reflection.
    const Vec2 u(transmits ? 1.f - unit_roundoff : 0.f, 0.f);
    auto ray = sample_scattering(hit, hit.shading.to_local(wo), u, Vec2::Zero(), Transport::radiance, Lobes::all);
    if (!ray || !ray->delta || (ray->wi.dot(hit.ng) * wo.dot(hit.ng) < 0.f) != transmits) return std::nullopt;
    ray->weight *= ray->pdf_w;
    return ray;
}

/// Derivatives at the next vertex of a chain that leaves it along `next` (Igehy 1999: transfer, reflection,
/// refraction).
void bend(Chain& chain, const Scene& scene, const SurfaceHit& hit, const ScatteredRay& next, bool transmits) {
    const Vec3d d = chain.d.cast<double>(), ng = hit.ng.cast<double>(), p = hit.p.cast<double>();
    // Transfer: dp <- (I - d ng^T / d.ng) (dp + t dd).
    const Chain::Differential moved = chain.dp + (p - chain.p).norm() * chain.dd;
    chain.dp = moved - d * (ng.transpose() * moved) / d.dot(ng);
    chain.p = p;
    const bool geometric =
        !hit.is_flat() && (hit.delta_only || !is_about_interpolated(hit, -chain.d));  // as sample_scattering() does
    Vec3d n = (geometric ? hit.ng : hit.shading.n).cast<double>();
    Chain::Differential dn = Chain::Differential::Zero();
    if (!geometric) dn = scene.normal_derivative_at(hit) * chain.dp;
    if (d.dot(n) > 0) {
        n = -n;
        dn = -dn;
    }
    const double cosine = d.dot(n);  // < 0
    const Eigen::RowVector2d dcos = n.transpose() * chain.dd + d.transpose() * dn;
    if (transmits) {
        // d' = eta d - mu n with mu = eta cos + cos_t, cos_t^2 = 1 - eta^2 (1 - cos^2).
        const double eta = 1 / double{next.eta};
        const double cos_t = std::sqrt(std::max(1 - eta * eta * (1 - cosine * cosine), 0.));
        chain.dd = eta * chain.dd - (eta + eta * eta * cosine / cos_t) * (n * dcos) - (eta * cosine + cos_t) * dn;
    } else {
        // d' = d - 2 cos n.
        chain.dd -= 2 * (n * dcos + cosine * dn);
    }
    chain.d = next.wi;
}

bool makes_chains(const Bsdf& bsdf) {
    const auto& layers = bsdf.layers();
    if (!bsdf.traits().delta || bsdf.is_tilted() || bsdf.pass_through() > 0.f || layers.empty()) return false;
    const bool back_to_back =
        layers.size() == 2 && !layers[0].flipped && layers[1].flipped && !bsdf.traits().transmission;
    const auto is_smooth = [](const Bsdf::Layer& layer) {
        return !layer.coat && !std::holds_alternative<ThinDielectric>(layer.model) &&
               (std::holds_alternative<Dielectric>(layer.model) || std::holds_alternative<Conductor>(layer.model) ||
                std::holds_alternative<Plastic>(layer.model) || std::holds_alternative<Diffuse>(layer.model));
    };
    return (layers.size() == 1 || back_to_back) && std::all_of(layers.begin(), layers.end(), is_smooth);
}

}  // namespace

bool makes_chains(const SurfaceHit& hit) { return makes_chains(*hit.bsdf); }

bool makes_chains(const Material& material) {
    if (const Bsdf* bsdf = material.constant()) return makes_chains(*bsdf);
    const auto* textured = std::get_if<TexturedScattering>(&material.node());
    return textured && makes_chains(Bsdf(textured->model));
}

std::optional<Chain> trace_chain(RayQueries& rays, const ChainStart& from, const Vec3& w, const ChainEvents& events,
                                 NumberStream* flights) {
    const Scene& scene = rays.scene();
    Chain chain{.w = w, .events = events, .d = w, .p = from.hit.p.cast<double>()};
    const Frame frame(w);
    chain.dd << frame.s.cast<double>(), frame.t.cast<double>();
    const Medium* medium = scene.medium_beyond(from.hit, w, from.medium);
    Ray ray = from.hit.spawn_ray(w);
    for (int vertex = 0; vertex < events.length;) {
        auto hit = rays.intersect(ray);
        if (!hit) return std::nullopt;
        if (flights && medium) chain.weight *= medium->transmittance(ray.o, ray.d, (hit->p - ray.o).norm(), *flights);
        if (makes_chains(*hit)) {
            if (scene.has_dispersion() && scene.material_of_shape(hit->shape).is_dispersive()) {
                scene.disperse(*hit, *from.stratum);
                chain.is_split = true;
            }
            const bool transmits = events.transmits_at(vertex);
            const auto next = delta_ray(*hit, -ray.d, transmits);
            if (!next) return std::nullopt;
            bend(chain, scene, *hit, *next, transmits);
            chain.weight *= next->weight;
            chain.probability *= next->pdf_w;
            if (vertex == 0) {
                chain.first = chain.p;
                chain.first_dp = chain.dp;
                chain.shape = hit->shape;
                chain.instance = hit->instance;
            }
            if (++vertex == events.length) chain.last = hit;
        } else {
            chain.weight *= hit->straight_on(ray.d);
        }
        if (is_black(chain.weight)) return std::nullopt;
        medium = scene.medium_beyond(*hit, chain.d, medium);
        ray = hit->spawn_ray(chain.d);
    }
    chain.medium = medium;
    return chain;
}

std::optional<Chain> find_chain(RayQueries& rays, const ChainStart& from, std::optional<Chain> chain,
                                const ChainEnd& end) {
    if (!chain) return std::nullopt;
    Constraint at = constraint_of(*chain, end);
    double damping = 1;
    bool is_near = false;
    for (int i = 0; i < most_steps && damping >= smallest_damping; ++i) {
        // The step moves x_1 in its tangent plane, from where the ray from x carries it back to the surface.
        const Vec3d move = chain->first_dp * at.step, way = chain->first - from.hit.p.cast<double>();
        if (!move.allFinite()) return std::nullopt;  // M is singular, or the ray grazes the surface
        const double limit = std::min(1., longest_step * way.norm() / move.norm());
        const Vec3 turned = (way - damping * limit * move).cast<float>();
        auto next = trace_chain(rays, from, turned.normalized(), chain->events);
        Constraint there = at;
        if (next) there = constraint_of(*next, end);
        const bool is_nearer = next && there.mismatch < at.mismatch;
        if (is_nearer) {
            chain = std::move(next);
            at = there;
            damping = std::min(1., 2 * damping);
        } else {
            damping *= 0.5;
        }
        if (is_near || (!is_nearer && at.mismatch < converged)) break;
        is_near = at.mismatch < converged;
    }
    chain->error = at.step.norm();
    return at.mismatch < converged && chain->error < largest_error ? chain : std::nullopt;
}

double determinant_of(const Chain& chain, const ChainEnd& end) {
    return std::abs(constraint_of(chain, end).m.determinant());
}

}  // namespace gib
