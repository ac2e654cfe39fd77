#pragma once
// Every sampler of the program, with the parameters it is tested with. A new one is a line in one of these lists.

#include "common/materials/bsdf.h"
#include "tests/samplers/sampled_density.h"

#include <optional>
#include <string>
#include <vector>

namespace gib::test {

std::vector<SamplerCase> warp_cases();
std::vector<SamplerCase> bsdf_cases();
std::vector<SamplerCase> light_cases();

/// A material as a scene file has it, and what theory says about it.
struct BsdfModel {
    std::string name;
    std::string xml;                 ///< the bsdf element
    double eta = 1;                  ///< index below the surface over index above it
    std::optional<double> albedo{};  ///< of every angle, if known: 1 without losses
    bool from_below = false;         ///< light from there is scattered too
};

std::vector<BsdfModel> bsdf_models();
/// Bump and normal maps, which are not reciprocal: their cosine and their shadowing are the light's, and the normal is
/// the eye's.
std::vector<BsdfModel> perturbed_models();

/// A material as the rest of the program calls it. What a change of that interface costs the tests is in here.
class LocalBsdf {
public:
    explicit LocalBsdf(const BsdfModel& model);

    std::optional<BsdfSample> sample(const Vec3& wo, const RandomNumbers& numbers, Transport transport) const;
    double pdf(const Vec3& wo, const Vec3& wi, Transport transport = Transport::radiance) const;
    /// [1/sr]
    Color f(const Vec3& wo, const Vec3& wi, Transport transport = Transport::radiance) const;
    /// Index on the side of w.
    double index(const Vec3& w) const { return w.z() >= 0.f ? 1.0 : eta_; }

private:
    Bsdf bsdf_;
    double eta_;
};

/// A direction, angles in degrees.
Vec3 direction_at(double theta, double phi);

}  // namespace gib::test
