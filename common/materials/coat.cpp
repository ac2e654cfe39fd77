#include "common/materials/coat.h"

#include "common/materials/fresnel.h"

namespace gib {

Vec3 Coat::refracted(const Vec3& w) const {
    const float cosine = std::abs(fresnel_dielectric(std::abs(w.z()), eta).cos_t);
    return {w.x() / eta, w.y() / eta, std::copysign(cosine, w.z())};
}

std::optional<Vec3> Coat::leaving(const Vec3& w) const {
    const float cosine = std::abs(fresnel_dielectric(std::abs(w.z()), 1.f / eta).cos_t);
    if (!(cosine > 0.f)) return std::nullopt;
    return Vec3(w.x() * eta, w.y() * eta, std::copysign(cosine, w.z())).normalized();
}

Color Coat::transmittance(const Vec3& w, const Vec3& inside) const {
    if (inside.z() == 0.f) return Color::Zero();
    const float cosine = std::abs(w.z());
    const float share = rough ? rough->transmittance(cosine) : 1.f - fresnel_dielectric(cosine, eta).reflectance;
    return share * (-absorption / std::abs(inside.z())).exp();
}

}  // namespace gib
