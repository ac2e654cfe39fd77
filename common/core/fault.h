#pragma once
// Faults are deliberate mistakes in the code, which show whether the tests catch them. They exist only in builds with
// the CMake option GIB_FAULTS, in which the environment variable GIB_FAULT chooses one by its name. scripts/faults
// runs the tests once with each fault.

#include <string_view>
#include <vector>

namespace gib {

enum class Fault {
    diffuse_energy,
    conductor_energy,
    dielectric_reflection_energy,
    dielectric_refraction_energy,
    thin_dielectric_energy,
    rough_conductor_energy,
    rough_reflection_energy,
    rough_refraction_energy,
    plastic_coat_energy,
    plastic_base_energy,
    rough_plastic_energy,
    phong_energy,
    diffuse_cosine,
    delta_cosine,
    radiance_scaling,
    cosine_hemisphere_density,
    triangle_warp,
    disk_warp,
    sphere_warp,
    visible_normal_warp,
    reflection_jacobian,
    refraction_jacobian,
    phong_density,
    blend_weight,
    tilted_cosine,
    mis_weight,
    roulette_rescaling,
    light_cosine,
    cone_density,
    environment_jacobian,
    spot_falloff,
    directional_area,
    light_choice,
    mask_opacity,
    thin_lens_area,
    phase_energy,
    phase_warp,
    medium_energy,
    flight_channel,
    null_collision,
    transmittance_roulette,
    stratum_weight,
    dispersion_sign
};

struct FaultDescription {
    Fault fault;
    std::string_view name;
    std::string_view sentence;
};
/// All faults, in the order of the enumeration Fault.
const std::vector<FaultDescription>& fault_descriptions();

inline constexpr bool faults_built = GIB_FAULTS;

/// Whether GIB_FAULT names this fault. Throws std::runtime_error if GIB_FAULT holds a name that no fault has.
bool is_chosen(Fault fault);

/// Whether the calling code must make this mistake; always false in builds without faults.
inline bool injected(Fault fault) {
    if constexpr (faults_built) return is_chosen(fault);
    else return false;
}

/// The factor of a lobe: 0.99 if the fault is chosen, so that the lobe loses 1 % of its energy, otherwise 1.
inline float with_loss(Fault fault) { return injected(fault) ? 0.99f : 1.f; }

}  // namespace gib
