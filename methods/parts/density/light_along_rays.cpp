#include "methods/parts/density/light_along_rays.h"

namespace gib {

namespace {

/// The positions of photons, or of the point on each beam.
std::vector<Vec3> points_of(const PhotonWalkResult& walk) {
    std::vector<Vec3> points;
    points.reserve(walk.photons.size() + walk.beams.size());
    for (const Photon& photon : walk.photons)
        points.push_back(photon.p);
    for (const PhotonBeam& beam : walk.beams)
        points.push_back(beam.point());
    return points;
}

/// The ends of beams, two by two.
std::vector<Vec3> ends_of(const std::vector<PhotonBeam>& beams) {
    std::vector<Vec3> ends;
    ends.reserve(2 * beams.size());
    for (const PhotonBeam& beam : beams) {
        ends.push_back(beam.p);
        ends.push_back(beam.end());
    }
    return ends;
}

/// sigma_s T p at the distance t along the stretch, for light that comes from wi.
Colord scattered_at(const MediumStretch& stretch, double t, const Vec3& wi) {
    const auto at = static_cast<float>(t);
    const Color share = stretch.medium.scattering_at(stretch.from + at * stretch.w) * stretch.transmittance.at(at);
    return stretch.medium.phase().value(-stretch.w, wi) * share.cast<double>();
}

/// The place where the ray of a stretch passes a photon or a beam closest, if it does so within the radius r.
struct Passing {
    double t;      ///< along the ray [scene units]
    Vec3d across;  ///< unit, at a right angle to the ray, and to the beam
    double d;      ///< from the ray to the light along `across`, of either sign [scene units]
    Color power;   ///< of the light there
    Vec3 wi;       ///< where it comes from
    double sine = 1;
};

/// Light of the value F = `power` at the point p.
std::optional<Passing> passing_of_point(const Vec3& p, const Color& power, const Vec3& wi, const MediumStretch& stretch,
                                        double r) {
    const Vec3d from_start = (p - stretch.from).cast<double>(), w = stretch.w.cast<double>();
    const double t = from_start.dot(w);
    if (!(t >= 0 && t < double{stretch.length})) return std::nullopt;
    const Vec3d offset = from_start - t * w;
    const double d = offset.norm();
    if (!(d < r)) return std::nullopt;
    return Passing{t, d > 0 ? Vec3d(offset / d) : Vec3d(Frame(stretch.w).s.cast<double>()), d, power, wi};
}

Color power_at(const PhotonBeam& beam, double s) {
    return beam.medium->power_along(beam.power(), static_cast<float>(s));
}

std::optional<Passing> passing_of(const PhotonBeam& beam, const MediumStretch& stretch, double r) {
    const Vec3d w = stretch.w.cast<double>(), v = beam.w.cast<double>(),
                between = (beam.p - stretch.from).cast<double>(), across = w.cross(v);
    const double sine2 = across.squaredNorm(), sine = std::sqrt(sine2), d = between.dot(across) / sine;
    if (!(std::abs(d) < r)) return std::nullopt;
    const double t = between.cross(v).dot(across) / sine2, s = between.cross(w).dot(across) / sine2;
    if (!(t >= 0 && t < double{stretch.length} && s >= 0 && s < double{beam.length})) return std::nullopt;
    return Passing{t, across / sine, d, power_at(beam, s), -beam.w, sine};
}

/// The part of the Gaussian's integral that lies from -s to s.
double gaussian_mass(double s) { return std::erf(s / (double{gaussian_sigma} * std::numbers::sqrt2)); }

}  // namespace

double line_kernel_weight(Kernel kernel, double d2, double r) {
    const double s2 = d2 / sqr(r);
    switch (kernel) {
        case Kernel::uniform:
            return 0.5 / r;
        case Kernel::cone:
            return std::max(1 - std::sqrt(s2), 0.0) / r;
        case Kernel::gaussian: {
            constexpr double sigma{gaussian_sigma};
            static const double norm = 1 / (sigma * std::sqrt(2 * std::numbers::pi) * gaussian_mass(1));
            return norm * std::exp(-s2 / (2 * sqr(sigma))) / r;
        }
        case Kernel::epanechnikov:
            return 0.75 * std::max(1 - s2, 0.0) / r;
    }
    return 0;
}

double line_kernel_mass(Kernel kernel, double s) {
    switch (kernel) {
        case Kernel::uniform:
            return s;
        case Kernel::cone:
            return s * (2 - s);
        case Kernel::gaussian:
            return gaussian_mass(s) / gaussian_mass(1);
        case Kernel::epanechnikov:
            return s * (3 - s * s) / 2;
    }
    return 0;
}

LightAlongRays::LightAlongRays(PhotonWalkResult walk, Kernel kernel, const BlurRadii& radii, const FlatRegions& regions,
                               bool estimates_bias)
    : walk_(std::move(walk)),
      kernel_(kernel),
      radii_(radii),
      regions_(&regions),
      estimates_bias_(estimates_bias),
      points_(points_of(walk_), 1, radii.disc),
      beams_(ends_of(walk_.beams), 2, radii.ribbon) {}

double LightAlongRays::weight(const Nearby& at, double r) const {
    const auto mass = [&](float length) {
        const double s = std::min(double{length} / r, 1.0);
        return at.on_disc ? double{kernel_mass(kernel_, static_cast<float>(s))} : line_kernel_mass(kernel_, s);
    };
    const double k = at.on_disc ? kernel_weight(kernel_, static_cast<float>(at.d2), static_cast<float>(r))
                                : line_kernel_weight(kernel_, at.d2, r);
    if (double{std::min(at.ahead, at.behind)} >= r) return k;
    return 2 * k / (mass(at.ahead) + mass(at.behind));
}

bool LightAlongRays::runs_along(const PhotonBeam& beam, const MediumStretch& stretch) const {
    const double sine = stretch.w.cast<double>().cross(beam.w.cast<double>()).norm();
    return double{std::min(beam.length, stretch.length)} * sine < double{radii_.ribbon};
}

std::optional<LightAlongRays::Nearby> LightAlongRays::nearby(const Vec3& p, const Vec3& across, double d, bool on_disc,
                                                             RayQueries& rays) const {
    const float r = on_disc ? radii_.disc : radii_.ribbon;
    if (regions_->empty_around(p, r)) return Nearby{d * d, r, r, on_disc};
    const auto sight = [&](const Vec3& way) {
        TracedRay probe{{.o = p, .d = way, .t_max = r}};
        rays.trace(probe);
        return probe.found ? probe.found->t : r;
    };
    const Vec3 towards = d < 0 ? Vec3(-across) : across;
    const float ahead = sight(towards);
    if (!(std::abs(d) < double{ahead})) return std::nullopt;
    return Nearby{d * d, ahead, sight(-towards), on_disc};
}

template <typename Visit>
void LightAlongRays::for_each_near(const MediumStretch& stretch, const EyePath& eye, RayQueries& rays,
                                   std::vector<std::uint32_t>& found, Visit&& visit) const {
    const Ray ray{.o = stretch.from, .d = stretch.w, .t_max = stretch.length};
    const double disc{radii_.disc}, ribbon{radii_.ribbon};
    const auto visit_passing = [&](const PhotonPayload& light, const std::optional<Passing>& passing, bool on_disc) {
        if (!passing) return;
        const Vec3 p = stretch.from + static_cast<float>(passing->t) * stretch.w;
        const auto at = nearby(p, passing->across.cast<float>(), passing->d, on_disc, rays);
        if (!at) return;
        const Colord value = walk_.unit / passing->sine * (passing->power * eye.weight(light)).cast<double>();
        visit(Colord(value * scattered_at(stretch, passing->t, passing->wi)), *at);
    };
    points_.find(ray, found);
    for (const std::uint32_t i : found) {
        if (walk_.beams.empty()) {
            const Photon& photon = walk_.photons[i];
            if (!eye.accepts(photon)) continue;
            visit_passing(photon, passing_of_point(photon.p, photon.power(), photon.direction(), stretch, disc), true);
        } else if (const PhotonBeam& beam = walk_.beams[i];
                   eye.accepts(beam) && beam.medium == &stretch.medium && runs_along(beam, stretch)) {
            const Color power = beam.length * power_at(beam, double{beam.place * beam.length});
            visit_passing(beam, passing_of_point(beam.point(), power, -beam.w, stretch, disc), true);
        }
    }
    beams_.find(ray, found);
    for (const std::uint32_t i : found)
        if (const PhotonBeam& beam = walk_.beams[i];
            eye.accepts(beam) && beam.medium == &stretch.medium && !runs_along(beam, stretch))
            visit_passing(beam, passing_of(beam, stretch, ribbon), false);
}

Scattered LightAlongRays::radiance(const MediumStretch& stretch, const EyePath& eye, RayQueries& rays,
                                   std::vector<std::uint32_t>& found) const {
    Colord sum = Colord::Zero(), narrow = Colord::Zero();
    for_each_near(stretch, eye, rays, found, [&](const Colord& light, const Nearby& at) {
        const double r = radius_of(at), narrow_r = double{narrow_radius} * r;
        sum += light * weight(at, r);
        if (estimates_bias_ && at.d2 < sqr(narrow_r)) narrow += light * weight(at, narrow_r);
    });
    Scattered scattered{sum.cast<float>()};
    if (estimates_bias_) scattered.bias = (double{bias_of_difference} * (sum - narrow)).cast<float>();
    return scattered;
}

void LightAlongRays::collect(const MediumStretch& stretch, const EyePath& eye, const Color& throughput,
                             RayQueries& rays, std::vector<NearLight>& near) const {
    std::vector<std::uint32_t> found;
    for_each_near(stretch, eye, rays, found, [&](const Colord& light, const Nearby& at) {
        near.push_back({(light * throughput.cast<double>()).mean(), at});
    });
}

}  // namespace gib
