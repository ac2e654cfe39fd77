#pragma once
// The solution of radiosity: patches, links, the system and its solution.

#include "methods/parts/stored_light/stored_light.h"
#include "methods/radiosity/corners.h"
#include "methods/radiosity/solution.h"

#include <memory>

namespace gib {

struct RadiositySettings {
    double patch;  ///< longest edge of a patch [scene diagonals]
    RadiositySolver solver;
    double links;   ///< allowed error of a link, as a share of the mean irradiance
    int gather;     ///< final gather rays; 0: none
    int max_edges;  ///< number of edges of the longest path

    /// The longest edge of a patch [scene units].
    double size(const Scene& scene) const { return patch * static_cast<double>(scene.diagonal()); }
};

class RadiosityModel {
public:
    /// Makes patches and links. Throws InputError, which names the bytes needed, if they are not available.
    RadiosityModel(const Scene& scene, const RadiositySettings& settings, std::uint64_t seed, StageTimes& stages);

    /// One sweep of the solver, unless the solution has converged; true if the solution has changed.
    bool advance();
    bool has_converged() const { return shown_ && solution_->has_converged(); }

    /// Indirect irradiance [W/m^2] at a hit seen from wo, interpolated between the corners of its patch; 0 where there
    /// is no patch.
    Color irradiance(const SurfaceHit& hit, const Vec3& wo) const;
    /// Direct and indirect irradiance [W/m^2] of the patch of a hit seen from wo; 0 where there is no patch.
    Color irradiance_of_patch(const SurfaceHit& hit, const Vec3& wo) const;
    /// The radiosity of the patches' corners without emission; none before the first sweep.
    StoredPatches stored_patches() const;

    std::uint64_t rays() const { return rays_; }
    std::vector<std::pair<std::string, std::string>> facts() const;

private:
    bool is_closed();

    const RadiositySettings settings_;
    std::uint64_t seed_;
    StageTimes& stages_;
    Charts charts_;
    PatchMesh mesh_;
    std::uint64_t rays_ = 0;
    PatchLight light_;
    std::size_t link_count_ = 0;
    std::unique_ptr<RadiositySystem> system_;
    std::unique_ptr<RadiositySolution> solution_;
    std::unique_ptr<PatchCorners> corners_;
    PatchColors E_;                    ///< indirect irradiance of leaves [W/m^2]
    std::vector<Color> E_at_corners_;  ///< the same at corners
    bool shown_ = false;               ///< E_ is that of the solution
};

}  // namespace gib
