#include "methods/bidirectional/joined_paths.h"

#include "common/images/splat_film.h"
#include "common/scene/scene.h"
#include "methods/parts/density/biased_film.h"
#include "methods/parts/density/first_radius.h"
#include "methods/parts/density/shrinking_radius.h"
#include "methods/parts/transport/pixel_samples.h"
#include "methods/parts/vertices/camera_walk.h"
#include "methods/parts/vertices/connections.h"
#include "methods/parts/vertices/light_vertex_map.h"
#include "methods/parts/vertices/light_walk.h"
#include "methods/parts/vertices/technique_pyramid.h"

namespace gib {

namespace {

/// The data of one pass, which the estimates of all pixels share.
struct PassOfPaths {
    const LightPaths& paths;
    JoinedPathsSettings settings;
    std::uint32_t pass = 0;
    SplatFilm& splats;
    TechniquePyramid* pyramid = nullptr;  ///< null: no images of techniques are kept
    LightVertexMap map = {};
    Merging merging = {};
};

/// The estimate of one pixel's sample, which also adds the light paths that reach the camera to the film of splats.
class JoinedPathsEstimate {
public:
    explicit JoinedPathsEstimate(const PassOfPaths& pass) : pass_(pass), used_(pass.settings.used) {}

    BiasedSample operator()(RayQueries& rays, const TracedRay& eye, const Sampler& sampler, std::size_t pixel) {
        light_vertices_.clear();
        if ((used_.camera || used_.connections) && !used_.only_merging) follow_light(rays, sampler);

        BiasedSample sample;
        const auto add = [&](int s, int t, const std::optional<Connection>& path) {
            if (!path) return;
            add_weighted(*path, sample.light);
            if (pass_.pyramid) pass_.pyramid->add(s, t, pixel, *path, 1);
        };
        const int max_edges = pass_.settings.max_edges;
        CameraWalk(
            rays, eye, sampler, max_edges, pass_.paths, used_, sample.light,
            [&](const FoundLight& light) {
                Connection path{.light = {}, .weight = light.weight};
                path.light[light.path_class.component()] = light.radiance;
                add(0, light.edges + 1, path);
            },
            [&](const PathVertex& vertex, const VertexNumbers& u, NumberStream& flights) {
                if (used_.merging()) pass_.map.merge(vertex, pass_.merging, max_edges, sample);
                if (used_.only_merging) return;
                if (used_.light_sampling)
                    add(1, vertex.edges + 1, connect_to_light(rays, vertex, pass_.paths, u, flights, used_));
                for (const PathVertex& from_light : light_vertices_)
                    if (vertex.edges + 1 + from_light.edges <= max_edges)
                        add(from_light.edges + 1, vertex.edges + 1,
                            connect(rays, vertex, from_light, pass_.paths, flights));
            })
            .follow();
        return sample;
    }

private:
    static constexpr std::uint64_t light_path = 1,
                                   light_in_view = 2;  ///< tags of the light path's numbers, and of this point's

    /// Connects a point of a light and the vertices of the pixel's light path to the camera, and keeps the vertices.
    void follow_light(RayQueries& rays, const Sampler& sampler) {
        if (used_.camera && used_.light_sampling) {
            const Sampler numbers = sampler.split(0, 1, light_in_view);
            NumberStream flights(numbers);
            splat(sample_light_from_camera(rays, pass_.paths, pass_.splats, true, numbers.at_vertex(0), flights), 1);
        }
        const Sampler light_sampler = sampler.split(0, 1, light_path);
        const auto start = pass_.paths.emission.sample(light_sampler);
        if (!start) return;
        LightWalk(rays, light_sampler, pass_.settings.max_edges, pass_.paths, used_, *start,
                  [&](const PathVertex& vertex, const VertexNumbers& u, NumberStream& flights) {
                      if (used_.camera)
                          splat(connect_to_camera(rays, vertex, pass_.paths, pass_.splats,
                                                  {u.light_position(), u.light_choice()}, flights),
                                vertex.edges + 1);
                      if (used_.connections) light_vertices_.push_back(vertex);
                  })
            .follow();
    }

    static void add_weighted(const Connection& path, PixelSample& sample) {
        for (std::size_t c = 0; c < sample.parts.size(); ++c)
            if (!is_black(path.light.parts[c])) sample.parts[c] += path.weight * path.light.parts[c];
    }
    void splat(const std::optional<Splat>& splat, int s) {
        if (!splat) return;
        if (pass_.pyramid) pass_.pyramid->add(s, 1, splat->pixel, splat->connection, 1 / pass_.paths.count);
        PixelSample weighted;
        add_weighted(splat->connection, weighted);
        pass_.splats.add(splat->pixel, pass_.pass, weighted);
    }

    const PassOfPaths& pass_;
    const Techniques& used_;
    std::vector<PathVertex> light_vertices_;
};

class JoinedPathsRun final : public Run {
public:
    JoinedPathsRun(const Scene& scene, const JoinedPathsSettings& settings, const Plan& plan,
                   const ShownComponents& shown, std::uint64_t seed, StageTimes& stages)
        : scene_(scene),
          seed_(seed),
          stages_(stages),
          runs_(plan.runs(pass_eye_paths)),
          follows_specular_(plan.called_for.has(Effect::specular_reflection) ||
                            plan.called_for.has(Effect::refraction)),
          paths_(scene, plan, stages),
          film_(width(), height(), shown.accumulated, shown.black,
                settings.merging ? shown.accumulated : std::vector<Component>()),
          splats_(width(), height(), shown.accumulated, paths_.sum_unit),
          pass_{.paths = paths_, .settings = settings, .splats = splats_},
          shrinking_(settings.merging ? settings.merging->alpha : 1) {
        if (settings.shows_techniques) {
            pyramid_ = std::make_unique<TechniquePyramid>(width(), height(), paths_.sum_unit / paths_.count);
            pass_.pyramid = pyramid_.get();
        }
    }

    Progress advance(std::uint32_t pass) override {
        passes_ = pass + 1;
        if (!runs_) return Progress::converged;
        pass_.pass = pass;
        if (pass_.settings.merging) prepare_merging(combine_keys(seed_, pass));
        rays_ += sample_pixels(scene_, film_, pass_.settings.points, seed_, pass, stages_, pass_eye_paths,
                               [this] { return JoinedPathsEstimate(pass_); });
        return Progress::more;
    }

    ComponentImages image() const override {
        ComponentImages images = film_.mean(passes_);
        splats_.add_mean(paths_.count * passes_, images);
        if (pyramid_) images.techniques = pyramid_->images(passes_);
        return images;
    }
    RunCounts counts() const override {
        RunCounts counts{.photons = photons_, .rays = rays_, .non_finite = film_.non_finite()};
        counts.non_finite = counts.non_finite + splats_.non_finite();
        return counts;
    }

    /// The radii of the first pass [scene diagonals].
    std::vector<std::pair<std::string, std::string>> facts() const override {
        if (!pass_.settings.merging) return {};
        return {radius_fact("radius", first_radius_, scene_),
                radius_fact("volume_radius", first_radius_in_media_, scene_)};
    }

private:
    int width() const { return scene_.sensor().width(); }
    int height() const { return scene_.sensor().height(); }

    /// Follows the light paths of a pass. Its radius is part of their weights, so those of a pilot, from which the
    /// first radius is found, are followed beforehand.
    void prepare_merging(std::uint64_t seed) {
        const auto timer = stages_.time(pass_merging);
        const MergingSettings& merging = *pass_.settings.merging;
        if (passes_ == 1) {
            first_radius_ = merging.radius * double{scene_.diagonal()};
            first_radius_in_media_ = merging.radius_in_media * double{scene_.diagonal()};
            if (!(merging.radius > 0 && merging.radius_in_media > 0)) find_first_radii(seed);
        }
        set_radii();
        pass_.map = LightVertexMap();  // gives its memory back
        pass_.map = LightVertexMap(scene_, paths_, pass_.settings.max_edges, pass_.settings.used, seed, rays_);
        photons_ += static_cast<std::uint64_t>(paths_.count);
    }

    void set_radii() {
        const std::uint64_t passes_before = pass_.settings.merging->first_pass + pass_.pass;
        const double r = first_radius_ * shrinking_.on_surfaces(passes_before);
        const double in_media = first_radius_in_media_ * shrinking_.in_media(passes_before);
        pass_.merging = {pass_.settings.merging->kernel, static_cast<float>(r), static_cast<float>(in_media)};
        Techniques& used = pass_.settings.used;
        used.merging_on_surfaces = paths_.count * std::numbers::pi * sqr(r);
        used.merging_in_media = paths_.count * 4 / 3 * std::numbers::pi * sqr(in_media) * in_media;
    }

    void find_first_radii(std::uint64_t seed) {
        pass_.settings.used.merging_on_surfaces = pass_.settings.used.merging_in_media = 1;
        const std::uint64_t passes = pilot_passes(paths_.count);
        std::vector<LightVertex> vertices;
        for (std::uint64_t pass = 0; pass < passes; ++pass) {
            const LightVertexMap map(scene_, paths_, pass_.settings.max_edges, pass_.settings.used,
                                     combine_keys(seed, pass), rays_);
            for (std::size_t i = 0; i < map.vertices().size(); ++i)
                vertices.push_back(map.vertices()[i]);
        }
        const KdTree<LightVertex> tree(vertices);
        const WalkSettings walk{pass_.settings.max_edges, false, follows_specular_};
        const SeenPlaces seen = seen_places(scene_, walk, seed_, rays_);
        const auto radius = [&](const std::vector<Vec3>& places, bool on_surfaces) {
            return first_radius(tree, static_cast<double>(passes), places, most_merged, on_surfaces ? 2 : 3,
                                scene_.diagonal(), [&](const LightVertex& vertex) {
                                    return vertex.on_surface == on_surfaces ? double{vertex.power().mean()} : 0;
                                });
        };
        if (!(first_radius_ > 0)) first_radius_ = radius(seen.on_surfaces, true);
        if (!(first_radius_in_media_ > 0)) first_radius_in_media_ = radius(seen.in_media, false);
    }

    const Scene& scene_;
    std::uint64_t seed_;
    StageTimes& stages_;
    bool runs_, follows_specular_;
    LightPaths paths_;
    BiasedFilm film_;
    SplatFilm splats_;
    PassOfPaths pass_;
    ShrinkingRadius shrinking_;
    std::unique_ptr<TechniquePyramid> pyramid_;
    double first_radius_ = 0, first_radius_in_media_ = 0;  ///< [scene units]
    std::uint64_t photons_ = 0, rays_ = 0;
    std::uint32_t passes_ = 0;
};

}  // namespace

void add_joined_paths(Plan& plan, const Scene& scene, const JoinedPathsSettings& settings) {
    const Techniques& used = settings.used;
    add_light_paths(plan, scene, settings.max_edges);
    add_eye_paths(plan, scene, settings.max_edges);
    add_light_sampling(plan, settings.max_edges);
    plan.add(std::string(pass_connections), used.connections && settings.max_edges >= 3,
             used.connections ? "a path with two inner vertices has three edges, more than max_depth allows"
                              : "connections are turned off");
}

std::unique_ptr<Run> start_joined_paths(const Scene& scene, const JoinedPathsSettings& settings, const Plan& plan,
                                        const ShownComponents& shown, std::uint64_t seed, StageTimes& stages) {
    JoinedPathsSettings needed = settings;
    needed.used.light_sampling &= plan.runs(pass_light_sampling);
    return std::make_unique<JoinedPathsRun>(scene, needed, plan, shown, seed, stages);
}

}  // namespace gib
