#pragma once
// Every sampler of the program, with the parameters that it is tested with. A new sampler
// is a line in one of these lists. A new scattering model, light or shape without a case does not compile.

#include "common/materials/bsdf.h"
#include "tests/samplers/sampled_density.h"
#include "tests/support/scene_builder.h"

#include <fmt/format.h>

#include <iterator>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace gib::test {

/// Joins what `make` lists for each alternative T of a variant. `make` has one overload for each std::type_identity<T>;
/// if one is missing, this does not compile.
template <typename Variant, typename Make>
auto listed_for_every_alternative(const Make& make) {
    return [&]<std::size_t... i>(std::index_sequence<i...>) {
        decltype(make(std::type_identity<std::variant_alternative_t<0, Variant>>())) all;
        const auto append = [&all](auto part) {
            all.insert(all.end(), std::make_move_iterator(part.begin()), std::make_move_iterator(part.end()));
        };
        (append(make(std::type_identity<std::variant_alternative_t<i, Variant>>())), ...);
        return all;
    }
    (std::make_index_sequence<std::variant_size_v<Variant>>());
}

/// The mean of the channels.
inline double mean(const Color& c) { return c.cast<double>().mean(); }

std::vector<SamplerCase> warp_cases();
std::vector<SamplerCase> bsdf_cases();
std::vector<SamplerCase> light_cases();

/// A material as a scene file describes it, and its properties that are known from theory.
struct BsdfModel {
    std::string name;
    std::string xml;                 ///< the bsdf element
    double eta = 1;                  ///< index below the surface over index above it
    std::optional<double> albedo{};  ///< albedo at every angle, if known; 1 without losses
    bool from_below = false;         ///< light from below the surface is scattered too
};

std::vector<BsdfModel> bsdf_models();
/// Bump and normal maps. They are not reciprocal: the cosine and the shadowing are those of the light's direction,
/// and the side that the normal is turned to is the eye's.
std::vector<BsdfModel> perturbed_models();

/// A material behind the few functions that the tests need. A change of the program's interface to materials changes
/// the tests only here.
class LocalBsdf {
public:
    explicit LocalBsdf(const BsdfModel& model);

    std::optional<BsdfSample> sample(const Vec3& wo, const RandomNumbers& numbers, Transport transport) const;
    double pdf(const Vec3& wo, const Vec3& wi, Transport transport = Transport::radiance) const;
    /// [1/sr]
    Color f(const Vec3& wo, const Vec3& wi, Transport transport = Transport::radiance) const;
    const Bsdf& bsdf() const { return bsdf_; }
    /// Index of refraction on the side of w.
    double index(const Vec3& w) const { return w.z() >= 0.f ? 1.0 : eta_; }

private:
    Bsdf bsdf_;
    double eta_;
};

/// The direction with polar angle theta and azimuth phi [degrees].
Vec3 direction_at(double theta, double phi);

}  // namespace gib::test
