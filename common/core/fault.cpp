#include "common/core/fault.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace gib {

const std::vector<FaultDescription>& fault_descriptions() {
    static const std::vector<FaultDescription> descriptions = {
        {Fault::diffuse_energy, "diffuse_energy", "diffuse reflection loses 1 %"},
        {Fault::conductor_energy, "conductor_energy", "a smooth conductor loses 1 %"},
        {Fault::dielectric_reflection_energy, "dielectric_reflection_energy", "a dielectric's reflection loses 1 %"},
        {Fault::dielectric_refraction_energy, "dielectric_refraction_energy", "a dielectric's refraction loses 1 %"},
        {Fault::thin_dielectric_energy, "thin_dielectric_energy", "a thin sheet's transmission loses 1 %"},
        {Fault::rough_conductor_energy, "rough_conductor_energy", "a rough conductor loses 1 %"},
        {Fault::rough_reflection_energy, "rough_reflection_energy", "a rough dielectric's reflection loses 1 %"},
        {Fault::rough_refraction_energy, "rough_refraction_energy", "a rough dielectric's refraction loses 1 %"},
        {Fault::plastic_coat_energy, "plastic_coat_energy", "the smooth coat of plastic loses 1 %"},
        {Fault::plastic_base_energy, "plastic_base_energy", "the base under a smooth coat loses 1 %"},
        {Fault::rough_plastic_energy, "rough_plastic_energy", "the coat of rough plastic loses 1 %"},
        {Fault::phong_energy, "phong_energy", "Phong's glossy lobe loses 1 %"},
        {Fault::diffuse_cosine, "diffuse_cosine", "diffuse reflection has one cosine too many"},
        {Fault::delta_cosine, "delta_cosine", "refraction divides by the cosine of the incident side"},
        {Fault::radiance_scaling, "radiance_scaling", "refracted radiance is scaled the wrong way round"},
        {Fault::cosine_hemisphere_density, "cosine_hemisphere_density", "the hemisphere is sampled uniformly"},
        {Fault::triangle_warp, "triangle_warp", "a triangle is sampled without its Jacobian"},
        {Fault::disk_warp, "disk_warp", "a disk is sampled without its Jacobian"},
        {Fault::sphere_warp, "sphere_warp", "a sphere is sampled uniformly in its angle"},
        {Fault::visible_normal_warp, "visible_normal_warp", "all normals are sampled, not the visible ones"},
        {Fault::reflection_jacobian, "reflection_jacobian", "the half vector's Jacobian lacks 1 / (wo.m)"},
        {Fault::refraction_jacobian, "refraction_jacobian", "the refracted half vector's Jacobian lacks eta^2"},
        {Fault::phong_density, "phong_density", "Phong's density has the factor n instead of n + 1"},
        {Fault::blend_weight, "blend_weight", "a blend's parts are exchanged"},
        {Fault::tilted_cosine, "tilted_cosine", "under a tilted normal the cosine is that of the surface"},
        {Fault::mis_weight, "mis_weight", "light sampling has weight 1 although bsdfs are sampled, too"},
        {Fault::roulette_rescaling, "roulette_rescaling", "survivors of Russian roulette are not rescaled"},
        {Fault::light_cosine, "light_cosine", "a light's density lacks the light's cosine"},
        {Fault::cone_density, "cone_density", "a cone's density is that of a flat disc"},
        {Fault::environment_jacobian, "environment_jacobian",
         "the environment's density has the sine of its latitude twice"},
        {Fault::spot_falloff, "spot_falloff", "a spot's fall-off is squared"},
        {Fault::directional_area, "directional_area",
         "a directional light's photons have the power of too small a disc"},
        {Fault::light_choice, "light_choice", "the choice of a light is left out of its density"},
        {Fault::mask_opacity, "mask_opacity", "shadow rays pass masks undimmed"},
        {Fault::thin_lens_area, "thin_lens_area", "points on the lens are too dense in its middle"},
        {Fault::phase_energy, "phase_energy", "a phase function loses 1 %"},
        {Fault::phase_warp, "phase_warp", "a phase function is sampled uniformly"},
        {Fault::medium_energy, "medium_energy", "scattering in a medium loses 1 %"},
        {Fault::flight_channel, "flight_channel", "a flight's density is that of the chosen channel alone"},
        {Fault::null_collision, "null_collision", "delta tracking leaves out the weights of null collisions"},
        {Fault::transmittance_roulette, "transmittance_roulette", "survivors in a dense medium are not rescaled"},
        {Fault::stratum_weight, "stratum_weight", "the weight of a stratum of wavelengths is 1 % too small"},
        {Fault::dispersion_sign, "dispersion_sign", "the index grows with the wavelength"},
    };
    return descriptions;
}

bool is_chosen(Fault fault) {
    static const int chosen = [] {
        const char* name = std::getenv("GIB_FAULT");
        if (!name || !*name) return -1;
        const auto& all = fault_descriptions();
        const auto it = std::find_if(all.begin(), all.end(), [&](const auto& d) { return d.name == name; });
        if (it == all.end()) throw std::runtime_error("GIB_FAULT: there is no fault '" + std::string(name) + "'");
        return static_cast<int>(it->fault);
    }();
    return static_cast<int>(fault) == chosen;
}

}  // namespace gib
