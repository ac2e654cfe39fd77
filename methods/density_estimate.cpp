#include "methods/density_estimate.h"

namespace gib {

namespace {

/// Width of the Gaussian in units of the radius at which it is cut off; exp(-r^2 / (2 sigma^2)) = exp(-2) there.
constexpr float gaussian_sigma = 0.5f;
constexpr float gaussian_cut = 0.13533528f;  // exp(-1 / (2 gaussian_sigma^2))

/// A photon lies on the surface of the point if their normals agree within 60 degrees and it is seen within 30 degrees
/// off the tangent plane: on a smooth surface both hold for radii up to its radius of curvature.
constexpr float min_normal_cosine = 0.5f;
constexpr float max_elevation_sine = 0.5f;

/// Points per probed disc; stratified by distance, golden-angle spiral.
constexpr int disc_probes = 8;
constexpr float golden_angle = 2.3999632f;

/// A photon that passed the test of its normal arrived on wo's side of its own surface. Where the surface is curved it
/// may come from below the horizon of the look-up's point; dropping it would darken every curved surface.
Vec3 lifted(const Vec3& wo_local, Vec3 wi_local) {
    constexpr float horizon = 1e-4f;
    if (wi_local.z() * wo_local.z() <= 0.f) wi_local.z() = std::copysign(horizon, wo_local.z());
    return wi_local;
}

/// The density of photons is irradiance on the geometric surface, |wi.ng|; what an interpolated normal reflects is |wi.ns|.
/// The ratio grows without bound for photons that graze the geometry; 10 is where it is cut off, which darkens only them.
float shading_normal_factor(const SurfaceHit& hit, const Vec3& wi) {
    if (hit.ns == hit.ng) return 1.f;
    return std::abs(wi.dot(hit.ns)) / std::max(std::abs(wi.dot(hit.ng)), 0.1f * std::abs(wi.dot(hit.ns)));
}

Vec3 normal_towards(const SurfacePoint& s, const Vec3& wo) { return wo.dot(s.ng) >= 0.f ? s.ng : Vec3(-s.ng); }

/// Finds out which points of a disc in the tangent plane lie on the surface around its centre. Rays go down to the disc
/// from a point above its centre, so that walls that stand on it hide what lies behind them. What an object that merely
/// touches the surface hides from there (a sphere on a floor) is tried again from just above the surface.
class DiscProbe {
public:
    DiscProbe(RayQueries& rays, const SurfaceHit& hit, const Vec3& normal, float r)
        : hit_(hit),
          frame_(normal),
          origin_(offset_origin(hit, normal)),
          below_(0.25f * r),
          low_(1e-3f * r),
          high_(0.5f * r) {
        if (const auto ceiling = rays.intersect({origin_, normal, 0.f, high_}))
            high_ = 0.5f * (ceiling->p - origin_).norm();
        low_ = std::min(low_, high_);
    }

    bool reaches(RayQueries& rays, float distance, float phi) const {
        const Vec3 target = hit_.p + distance * (std::cos(phi) * frame_.s + std::sin(phi) * frame_.t);
        switch (look(rays, target, high_)) {
            case Seen::surface:
                return true;
            case Seen::nothing:
                return false;
            case Seen::obstacle:
                return look(rays, target, low_) == Seen::surface;
        }
        return false;
    }

private:
    enum class Seen { surface, obstacle, nothing };

    Seen look(RayQueries& rays, const Vec3& target, float height) const {
        const Vec3 apex = origin_ + height * frame_.n;
        const auto found = rays.intersect({apex, target - apex, 0.f, (height + below_) / height});
        if (!found) return Seen::nothing;
        const bool level = std::abs((found->p - hit_.p).dot(frame_.n)) <= below_;
        const bool alike = normal_towards(*found, frame_.n).dot(frame_.n) > min_normal_cosine;
        const bool stores_photons = found->bsdf->traits_at(found->ns.dot(frame_.n)).diffuse;
        return level && alike && stores_photons ? Seen::surface : Seen::obstacle;
    }

    const SurfaceHit& hit_;
    Frame frame_;
    Vec3 origin_;
    float below_;       ///< a surface that bends away stays on the disc down to here
    float low_, high_;  ///< above the surface: where the rays start
};

}  // namespace

float kernel_weight(Kernel kernel, float d2, float r) {
    const float area = pi * r * r;
    const float s2 = d2 / (r * r);
    switch (kernel) {
        case Kernel::uniform:
            return 1.f / area;
        case Kernel::cone:
            return 3.f * std::max(1.f - std::sqrt(s2), 0.f) / area;
        case Kernel::gaussian:
            return std::exp(-s2 / (2.f * sqr(gaussian_sigma))) /
                   (2.f * sqr(gaussian_sigma) * (1.f - gaussian_cut) * area);
        case Kernel::epanechnikov:
            return 2.f * std::max(1.f - s2, 0.f) / area;
    }
    return 0.f;
}

float kernel_radius(Kernel kernel, float u) {
    switch (kernel) {
        case Kernel::uniform:
            return std::sqrt(u);
        case Kernel::cone:
            return 0.5f - std::sin(std::asin(1.f - 2.f * u) / 3.f);  // 3 s^2 - 2 s^3 = u
        case Kernel::gaussian:
            return gaussian_sigma * std::sqrt(-2.f * std::log1p(-u * (1.f - gaussian_cut)));
        case Kernel::epanechnikov:
            return std::sqrt(1.f - std::sqrt(1.f - u));  // 2 s^2 - s^4 = u
    }
    return 0.f;
}

Color DensityEstimator::reflected_radiance(const PhotonMap& map, RayQueries& rays, const SurfaceHit& hit,
                                           const Vec3& wo, int max_photon_edges, const Sampler& sampler,
                                           std::uint32_t dimension, std::vector<PhotonMap::Neighbour>& found) const {
    const Vec3 normal = normal_towards(hit, wo);
    // Light that arrives from behind is scattered here too where the material lets it through.
    const bool transmits = hit.bsdf->traits().transmission;
    const auto on_surface = [&](const Photon& photon, float d2) {
        const float cosine = photon.surface_normal().dot(normal);
        return photon.edges <= max_photon_edges && (transmits ? std::abs(cosine) : cosine) > min_normal_cosine &&
               sqr((photon.p - hit.p).dot(normal)) <= sqr(max_elevation_sine) * d2;
    };
    map.nearest(hit.p, k, max_radius, on_surface, found);
    const bool all_found = found.size() == k;
    const float r = all_found ? std::sqrt(found.back().distance2) : max_radius;
    const std::size_t inside = all_found ? k - 1 : found.size();
    if (inside == 0 || !(r > 0.f)) return Color::Zero();

    const Vec3 wo_local = hit.shading.to_local(wo);
    Color sum = Color::Zero();
    for (std::size_t i = 0; i < inside; ++i) {
        const Photon& photon = map[found[i].photon];
        const Vec3 wi = photon.direction();
        const Vec3 wi_local = transmits ? hit.shading.to_local(wi) : lifted(wo_local, hit.shading.to_local(wi));
        const float scale = shading_normal_factor(hit, wi) * kernel_weight(kernel, found[i].distance2, r);
        sum += hit.bsdf->f_local(wo_local, wi_local).diffuse * photon.power() * scale;
    }
    if (area == DiscArea::surface && !is_black(sum))
        sum /= share_on_surface(rays, hit, wo, r, sampler.get_2d(dimension));
    return sum;
}

float DensityEstimator::share_on_surface(RayQueries& rays, const SurfaceHit& hit, const Vec3& wo, float r,
                                         const Vec2& u) const {
    const DiscProbe disc(rays, hit, normal_towards(hit, wo), r);
    int on_surface = 0;
    for (int i = 0; i < disc_probes; ++i) {
        const float s = r * kernel_radius(kernel, (static_cast<float>(i) + u.x()) / disc_probes);
        if (disc.reaches(rays, s, golden_angle * static_cast<float>(i) + 2.f * pi * u.y())) ++on_surface;
    }
    // The centre is on the surface, so the share cannot be zero even where no probe finds it.
    return static_cast<float>(std::max(on_surface, 1)) / disc_probes;
}

}  // namespace gib
