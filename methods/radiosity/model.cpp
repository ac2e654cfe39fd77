#include "methods/radiosity/model.h"

#include "common/core/memory_limit.h"
#include "common/core/parallel.h"
#include "common/sampling/warp.h"

#include <fmt/format.h>

#include <atomic>

namespace gib {

namespace {

/// Number of points on a patch at which direct light is sampled.
constexpr std::uint32_t direct_samples = 16;
/// Number of rays that test whether the scene is closed.
constexpr std::size_t closure_rays = 1 << 14;
constexpr std::size_t rays_per_block = 1024;
/// Approximate memory of a patch: two nodes with their share of corners and links [bytes].
constexpr double bytes_per_patch = 5000;

// Keys that give the parts different random numbers.
constexpr std::uint64_t light_key = 0x4c49, link_key = 0x4c4b, closure_key = 0x434c;

/// The number of reflections that the system computes of the longest paths. Such a path has one edge from the camera
/// to the surface seen, one edge for each reflection, and one to the light; a final gather ray is one edge more.
std::optional<int> most_reflections(const RadiositySettings& settings) {
    if (settings.max_edges == std::numeric_limits<int>::max()) return std::nullopt;
    return settings.max_edges - (settings.gather > 0 ? 3 : 2);
}

/// Throws InputError if patches with edges of `size` [scene units] take more memory than there is.
void require_memory_for(const Charts& charts, double size, RadiositySolver solver) {
    const double patches = PatchMesh::estimated_patches(charts, size);
    const double bytes_of_pair =
        solver == RadiositySolver::direct
            ? sizeof(double) + 0.5 * static_cast<double>(sizeof(PatchLink) + 2 * sizeof(RadiositySystem::Link))
            : 0;
    require_memory(patches * bytes_per_patch + sqr(patches) * bytes_of_pair,
                   fmt::format("radiosity of {:.0f} patches", patches));
}

}  // namespace

RadiosityModel::RadiosityModel(const Scene& scene, const RadiositySettings& settings, std::uint64_t seed,
                               StageTimes& stages)
    : settings_(settings), seed_(seed), stages_(stages), charts_(scene, settings.size(scene)), mesh_([&] {
          const auto timer = stages.time("patches");
          const double size = settings.size(scene);
          require_memory_for(charts_, size, settings.solver);
          return PatchMesh(charts_, size);
      }()) {
    {
        const auto timer = stages.time("direct light");
        light_ = patch_light(mesh_, direct_samples, combine_keys(seed, light_key), rays_, stages);
    }
    {
        const auto timer = stages.time("links");
        const double error = settings.solver == RadiositySolver::direct ? 0 : settings.links;
        const auto links = link_patches(mesh_, light_, error, combine_keys(seed, link_key), rays_, stages);
        link_count_ = links.size();
        system_ = std::make_unique<RadiositySystem>(mesh_, light_, links, is_closed());
    }
    solution_ = std::make_unique<RadiositySolution>(*system_, settings.solver, most_reflections(settings));
    const auto timer = stages.time("corners");
    corners_ = std::make_unique<PatchCorners>(mesh_);
}

/// Whether the scene is closed: all rays from the patches end on the fronts of patches, so all light that a patch
/// sends is received.
bool RadiosityModel::is_closed() {
    const Scene& scene = charts_.scene();
    const auto& leaves = mesh_.leaves();
    if (leaves.empty() || scene.has_holes()) return false;
    std::atomic<bool> closed = true;
    parallel_blocks(closure_rays, rays_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        RayQueries rays(scene);
        for (std::size_t i = begin; i < end && closed; ++i) {
            const Sampler u(PointSet::independent, combine_keys(seed_, closure_key), i, 0);
            const PatchNode& node = mesh_.nodes()[leaves[i * leaves.size() / closure_rays]];
            const SurfaceHit from = mesh_.point_on(node, u.get_2d(0).cast<double>());
            const Vec3 w = Frame(from.ng).to_world(square_to_cosine_hemisphere(u.get_2d(1)));
            const auto hit = rays.intersect(from.spawn_ray(w));
            if (!hit || !mesh_.locate(*hit, -w)) closed = false;
        }
    });
    rays_ += closure_rays;  // all, so that the count does not depend on when other threads stop
    return closed;
}

bool RadiosityModel::advance() {
    if (has_converged()) return false;
    const auto timer = stages_.time("solution");
    if (!solution_->has_converged()) solution_->sweep();
    E_ = system_->irradiance_at_centres(solution_->radiosity());
    E_at_corners_.clear();
    for (const Colord& E : corners_->values(E_, light_.area))
        E_at_corners_.push_back(E.cast<float>());
    shown_ = true;
    return true;
}

Color RadiosityModel::irradiance(const SurfaceHit& hit, const Vec3& wo) const {
    const auto place = mesh_.locate(hit, wo);
    if (!place) return Color::Zero();
    const PatchNode& leaf = mesh_.nodes()[place->leaf];
    const auto weights = mesh_.weights(leaf, place->uv);
    Color E = Color::Zero();
    for (std::size_t i = 0; i < leaf.corner_count(); ++i)
        E += static_cast<float>(weights[i]) * E_at_corners_[corners_->of_leaf(place->leaf)[i]];
    return E;
}

Color RadiosityModel::irradiance_of_patch(const SurfaceHit& hit, const Vec3& wo) const {
    const auto place = mesh_.locate(hit, wo);
    if (!place) return Color::Zero();
    return (light_.irradiance[place->leaf] + E_[place->leaf]).cast<float>();
}

StoredPatches RadiosityModel::stored_patches() const {
    if (!shown_) return {};
    PatchColors B(mesh_.nodes().size(), Colord::Zero());
    for (const std::uint32_t leaf : mesh_.leaves())
        B[leaf] = light_.reflectance[leaf] * (light_.irradiance[leaf] + E_[leaf]);
    StoredPatches stored{.corners = corners_->places(), .radiosity = {}, .patches = {}};
    for (const Colord& b : corners_->values(B, light_.area))
        stored.radiosity.push_back(b.cast<float>());
    for (const std::uint32_t leaf : mesh_.leaves())
        stored.patches.push_back(corners_->in_turn(leaf));
    return stored;
}

std::vector<std::pair<std::string, std::string>> RadiosityModel::facts() const {
    const auto reflections = most_reflections(settings_);
    return {
        {"patches", std::to_string(mesh_.leaves().size())},
        {"vertices", std::to_string(corners_->size())},
        {"links", std::to_string(link_count_)},
        {"sweeps", std::to_string(solution_->sweeps())},
        {"reflections", reflections ? fmt::format("{}, summed", *reflections) : "all"},
        {"residual", fmt::format("{:.2e}", solution_->residual())},
        {"converged", has_converged() ? "yes" : "no"},
        {"closed", system_->is_closed() ? "yes" : "no"},
        {"closure_mean", fmt::format("{:.2e}", system_->closure().mean)},
        {"closure_largest", fmt::format("{:.2e}", system_->closure().largest)},
    };
}

}  // namespace gib
