#pragma once
// The part of radiosity that is the same for all cameras: patches, links, the system, its solution, and the
// interpolation of the solution.

#include "methods/radiosity/display.h"

namespace gib {

struct RadiositySettings {
    double patch;  ///< longest edge of a patch [scene diagonals]
    RadiositySolver solver;
    double links;     ///< allowed error of a link, as a share of the mean irradiance
    bool adapt;       ///< halve patches at contacts, and further for display
    int gather;       ///< final gather rays; 0: none
    std::string ply;  ///< file for the mesh; empty: none
    int max_edges;    ///< number of edges of the longest path
};

class RadiosityModel {
public:
    /// Makes patches and links. Throws InputError, which names the bytes needed, if they are not available.
    RadiosityModel(const Scene& scene, const RadiositySettings& settings, std::uint64_t seed, StageTimes& stages);

    /// One sweep of the solver, unless the solution has converged; true if the displayed solution has changed.
    bool advance();
    bool has_converged() const { return converged_; }

    const RadiosityDisplay& display() const { return *display_; }
    const RadiositySystem& system() const { return *system_; }
    const PatchMesh& mesh() const { return mesh_; }
    const PatchLight& light() const { return light_; }
    const RadiositySolution& solution() const { return *solution_; }
    std::uint64_t rays() const { return rays_ + (display_ ? display_->rays() : 0); }
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
    bool closed_ = false;
    std::unique_ptr<RadiositySystem> system_;
    std::unique_ptr<RadiositySolution> solution_;
    std::unique_ptr<RadiosityDisplay> display_;
    bool converged_ = false;
};

/// The mesh as a PLY file (ascii, faces of three or four corners). Each corner has its position, normal, radiosity B
/// [W/m^2] and, as red, green and blue, B over the largest value of all corners.
std::string radiosity_ply(const RadiosityModel& model);

}  // namespace gib
