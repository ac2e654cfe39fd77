#include "methods/radiosity/model.h"

#include "common/core/files.h"
#include "common/core/memory_limit.h"
#include "common/core/parallel.h"
#include "common/sampling/warp.h"
#include "methods/radiosity/contacts.h"
#include "methods/radiosity/light.h"

#include <fmt/format.h>

#include <atomic>

namespace gib {

namespace {

/// The residual of a solution that has converged (RadiositySolution::residual()).
constexpr double converged_residual = 1e-4;
/// Number of points on a patch at which direct light is sampled.
constexpr std::uint32_t direct_samples = 16;
/// Number of rays that test whether the scene is closed.
constexpr std::size_t closure_rays = 1 << 14;
constexpr std::size_t rays_per_block = 1024;
/// The radius down to which patches are halved on which something stands, as a share of the parameter `patch`: their
/// edges become a quarter as long.
constexpr double least_at_contacts = 0.25;
/// Approximate memory of a patch: two nodes with their share of vertices, links and rows [bytes].
constexpr double bytes_per_patch = 5000;

// Keys that give the parts different random numbers.
constexpr std::uint64_t light_key = 0x4c49, link_key = 0x4c4b, display_key = 0x4449, closure_key = 0x434c;

bool has_limit(const RadiositySettings& settings) { return settings.max_edges < std::numeric_limits<int>::max(); }

/// The number of reflections that the system computes of the longest paths. Such a path has one edge from the camera
/// to the surface seen, one edge for each reflection, and one to the light; a final gather ray is one edge more.
int most_reflections(const RadiositySettings& settings) { return settings.max_edges - (settings.gather > 0 ? 3 : 2); }

/// Throws InputError if patches with edges of `size` [scene units] take more memory than there is.
void require_memory_for(const Charts& charts, double size, const RadiositySettings& settings) {
    const double patches = PatchMesh::estimated_patches(charts, size);
    const double links = settings.solver == RadiositySolver::hierarchical ? 0 : 0.5 * sqr(patches);
    const double matrix = settings.solver == RadiositySolver::direct ? sqr(patches) * sizeof(double) : 0;
    require_memory(patches * bytes_per_patch + links * (sizeof(PatchLink) + 2 * sizeof(LinkTable::Entry)) + matrix,
                   fmt::format("radiosity of {:.0f} patches", patches));
}

}  // namespace

RadiosityModel::RadiosityModel(const Scene& scene, const RadiositySettings& settings, std::uint64_t seed,
                               StageTimes& stages)
    : settings_(settings),
      seed_(seed),
      stages_(stages),
      charts_(scene, settings.patch * static_cast<double>(scene.diagonal())),
      mesh_([&] {
          const auto timer = stages.time("patches");
          const double size = settings.patch * static_cast<double>(scene.diagonal());
          require_memory_for(charts_, size, settings);
          return PatchMesh(charts_, size);
      }()) {
    if (settings.adapt) {
        const auto timer = stages.time("patches");
        halve_at_contacts(mesh_, least_at_contacts * mesh_.size(), rays_);
    }
    {
        const auto timer = stages.time("direct light");
        light_ = patch_light(mesh_, direct_samples, combine_keys(seed, light_key), rays_, &stages);
        closed_ = is_closed();
    }
    std::vector<PatchLink> seen;
    {
        const auto timer = stages.time("links");
        PatchLinks links = link_patches(mesh_, light_,
                                        {.error = settings.links,
                                         .refine_all = settings.solver != RadiositySolver::hierarchical,
                                         .seed = combine_keys(seed, link_key)},
                                        &stages);
        rays_ += links.rays;
        link_count_ = links.links.size();
        seen = std::move(links.seen);
        system_ = std::make_unique<RadiositySystem>(mesh_, light_, links.links, closed_);
    }
    solution_ = has_limit(settings) ? start_series(*system_, most_reflections(settings))
                                    : start_solution(*system_, settings.solver);
    const auto timer = stages.time("vertices");
    display_ = std::make_unique<RadiosityDisplay>(
        mesh_, *system_, light_, seen,
        DisplaySettings{.adapt = settings.adapt, .links = settings.links, .seed = combine_keys(seed, display_key)});
}

/// Whether the scene is closed: all rays from the patches end on the fronts of patches, so all light that a patch
/// sends is received.
bool RadiosityModel::is_closed() {
    const Scene& scene = charts_.scene();
    std::vector<std::uint32_t> leaves;
    for (std::uint32_t i = 0; i < mesh_.nodes().size(); ++i)
        if (mesh_.nodes()[i].is_leaf()) leaves.push_back(i);
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
    rays_ += closure_rays;
    return closed;
}

bool RadiosityModel::advance() {
    if (converged_) return false;
    if (solution_->residual() > converged_residual) {
        const auto timer = stages_.time("solution");
        solution_->sweep();
    }
    converged_ = !(solution_->residual() > converged_residual);
    {
        const auto timer = stages_.time("vertices");
        const PatchColors X = solution_->shown();
        if (converged_) display_->refine(X);
        else display_->show(X);
    }
    if (!settings_.ply.empty()) {
        const auto timer = stages_.time("ply");
        write_file(settings_.ply, radiosity_ply(*this));
    }
    return true;
}

std::vector<std::pair<std::string, std::string>> RadiosityModel::facts() const {
    return {
        {"patches", std::to_string(system_->size())},
        {"vertices", std::to_string(display_->vertices().vertices().size())},
        {"links", std::to_string(link_count_)},
        {"sweeps", std::to_string(solution_->sweeps())},
        {"reflections",
         has_limit(settings_) ? fmt::format("{}, summed", most_reflections(settings_)) : "all, solved for"},
        {"residual", fmt::format("{:.2e}", solution_->residual())},
        {"converged", converged_ ? "yes" : "no"},
        {"closed", closed_ ? "yes" : "no"},
        {"closure_mean", fmt::format("{:.2e}", system_->closure().mean)},
        {"closure_largest", fmt::format("{:.2e}", system_->closure().largest)},
    };
}

}  // namespace gib
