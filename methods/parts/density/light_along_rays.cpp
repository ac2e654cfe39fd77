#include "methods/parts/density/light_along_rays.h"

namespace gib {

namespace {

/// The points of a tree: positions of photons, or the ends of beams.
std::vector<Vec3> points_of(const PhotonWalkResult& walk, bool beams) {
    std::vector<Vec3> points;
    points.reserve(beams ? 2 * walk.beams.size() : walk.photons.size());
    for (const Photon& photon : walk.photons)
        points.push_back(photon.p);
    for (const PhotonBeam& beam : walk.beams) {
        points.push_back(beam.p);
        points.push_back(beam.end());
    }
    return points;
}

/// sigma_s T p at the distance t along the stretch, for light that comes from wi.
Colord scattered_at(const MediumStretch& stretch, double t, const Vec3& wi) {
    const auto at = static_cast<float>(t);
    const Color share = stretch.medium.scattering_at(stretch.from + at * stretch.w) * stretch.transmittance.at(at);
    return stretch.medium.phase().value(-stretch.w, wi) * share.cast<double>();
}

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
            static const double norm =
                1 / (sigma * std::sqrt(2 * std::numbers::pi) * std::erf(1 / (sigma * std::numbers::sqrt2)));
            return norm * std::exp(-s2 / (2 * sqr(sigma))) / r;
        }
        case Kernel::epanechnikov:
            return 0.75 * std::max(1 - s2, 0.0) / r;
    }
    return 0;
}

LightAlongRays::LightAlongRays(PhotonWalkResult walk, VolumeLookUp look_up, Kernel kernel, float radius,
                               bool estimates_bias)
    : walk_(std::move(walk)),
      beams_(look_up == VolumeLookUp::beams),
      kernel_(kernel),
      radius_(radius),
      estimates_bias_(estimates_bias),
      tree_(points_of(walk_, beams_), beams_ ? 2 : 1, radius) {}

double LightAlongRays::kernel(double d2, double r) const {
    return beams_ ? line_kernel_weight(kernel_, d2, r)
                  : kernel_weight(kernel_, static_cast<float>(d2), static_cast<float>(r));
}

template <typename Visit>
void LightAlongRays::show_photon(const Photon& photon, const MediumStretch& stretch, const EyePath& eye,
                                 Visit&& visit) const {
    const Eigen::Vector3d from_start = (photon.p - stretch.from).cast<double>(), w = stretch.w.cast<double>();
    const double t = from_start.dot(w);
    if (!(t >= 0 && t < double{stretch.length}) || !eye.accepts(photon)) return;
    const double d2 = (from_start - t * w).squaredNorm();
    if (!(d2 < sqr(double{radius_}))) return;
    const Colord value = walk_.unit * (photon.power() * eye.weight(photon)).cast<double>();
    visit(Colord(value * scattered_at(stretch, t, photon.direction())), d2);
}

template <typename Visit>
void LightAlongRays::show_beam(const PhotonBeam& beam, const MediumStretch& stretch, const EyePath& eye,
                               Visit&& visit) const {
    if (beam.medium != &stretch.medium || !eye.accepts(beam)) return;
    const Eigen::Vector3d w = stretch.w.cast<double>(), v = beam.w.cast<double>(),
                          between = (beam.p - stretch.from).cast<double>(), across = w.cross(v);
    const double sine2 = across.squaredNorm();
    if (!(sine2 > 0)) return;
    const double d2 = sqr(between.dot(across)) / sine2;
    if (!(d2 < sqr(double{radius_}))) return;
    const double t = between.cross(v).dot(across) / sine2, s = between.cross(w).dot(across) / sine2;
    if (!(t >= 0 && t < double{stretch.length} && s >= 0 && s < double{beam.length})) return;
    const Color power = beam.medium->power_along(beam.power(), static_cast<float>(s)) * eye.weight(beam);
    const Colord value = walk_.unit / std::sqrt(sine2) * power.cast<double>();
    visit(Colord(value * scattered_at(stretch, t, -beam.w)), d2);
}

template <typename Visit>
void LightAlongRays::for_each_near(const MediumStretch& stretch, const EyePath& eye, std::vector<std::uint32_t>& found,
                                   Visit&& visit) const {
    tree_.find({.o = stretch.from, .d = stretch.w, .t_max = stretch.length}, found);
    for (const std::uint32_t i : found) {
        if (beams_) show_beam(walk_.beams[i], stretch, eye, visit);
        else show_photon(walk_.photons[i], stretch, eye, visit);
    }
}

Scattered LightAlongRays::radiance(const MediumStretch& stretch, const EyePath& eye,
                                   std::vector<std::uint32_t>& found) const {
    const double r{radius_}, narrow_r = double{narrow_radius} * r;
    Colord sum = Colord::Zero(), narrow = Colord::Zero();
    for_each_near(stretch, eye, found, [&](const Colord& light, double d2) {
        sum += light * kernel(d2, r);
        if (estimates_bias_ && d2 < sqr(narrow_r)) narrow += light * kernel(d2, narrow_r);
    });
    Scattered scattered{sum.cast<float>()};
    if (estimates_bias_) scattered.bias = (double{bias_of_difference} * (sum - narrow)).cast<float>();
    return scattered;
}

void LightAlongRays::collect(const MediumStretch& stretch, const EyePath& eye, const Color& weight,
                             std::vector<NearLight>& near) const {
    std::vector<std::uint32_t> found;
    for_each_near(stretch, eye, found, [&](const Colord& light, double d2) {
        near.push_back({(light * weight.cast<double>()).mean(), d2});
    });
}

}  // namespace gib
