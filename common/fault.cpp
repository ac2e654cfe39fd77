#include "common/fault.h"

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
        {Fault::diffuse_cosine, "diffuse_cosine", "diffuse reflection has one cosine too many"},
        {Fault::delta_cosine, "delta_cosine", "refraction divides by the cosine of the incident side"},
        {Fault::radiance_scaling, "radiance_scaling", "refracted radiance is scaled the wrong way round"},
        {Fault::cosine_hemisphere_density, "cosine_hemisphere_density", "the hemisphere is sampled uniformly"},
        {Fault::triangle_warp, "triangle_warp", "a triangle is sampled without its Jacobian"},
        {Fault::disk_warp, "disk_warp", "a disk is sampled without its Jacobian"},
        {Fault::sphere_warp, "sphere_warp", "a sphere is sampled uniformly in its angle"},
        {Fault::blend_weight, "blend_weight", "a blend's parts are exchanged"},
        {Fault::tilted_cosine, "tilted_cosine", "a tilted normal keeps the cosine of the surface"},
        {Fault::mis_weight, "mis_weight", "light sampling keeps its full weight beside bsdf sampling"},
        {Fault::roulette_rescaling, "roulette_rescaling", "survivors of Russian roulette are not rescaled"},
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
