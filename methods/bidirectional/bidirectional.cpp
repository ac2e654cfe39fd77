// Bidirectional path tracing: every path from the camera is joined with a path from a light in all ways. Sources:
// Lafortune and Willems 1993, "Bi-directional path tracing"; Veach 1997, chapter 10; Georgiev 2012, "Implementing
// Vertex Connection and Merging", without merging.
//
// Computes: every component. A path of k edges can be made by up to k + 1 techniques, which take s of its vertices from
// a light's walk: s = 0, the camera's walk finds the light; s = 1, a point of a light is sampled; s = k, the light's
// walk is connected to the camera; the others connect two vertices. The power heuristic weighs them (technique_sums.h).
// Parameters: sampler = sobol (default) | independent; hits, light_sampling, connections, camera = on (default) | off,
// which turn techniques off: the others take over what they can make, the rest of the light is missing; techniques = off
// (default) | on, which keeps an image of each technique (technique_pyramid.h); spp and max_depth as for all methods.
// Bias: none, for paths that it can sample. It cannot sample the light of point, spot and directional lights that
// reaches a diffuse surface through specular ones and is seen through specular ones, E S+ D S+ L.
// A pass: one path from the camera for every pixel, and as many light paths.
// Fails: never; non-finite samples are counted and dropped.
#include "common/images/splat_film.h"
#include "methods/bidirectional/technique_pyramid.h"
#include "methods/parts/transport/delta_paths.h"
#include "methods/parts/transport/eye_sample_run.h"
#include "methods/parts/transport/point_set_parameter.h"
#include "methods/parts/vertices/camera_walk.h"
#include "methods/parts/vertices/connections.h"
#include "methods/parts/vertices/light_paths.h"
#include "methods/parts/vertices/light_walk.h"

namespace gib {

namespace {

struct BidirectionalSettings {
    PointSet points;
    int max_edges;
    Techniques used;
    bool shows_techniques;
};

/// The estimate of one pixel's sample, which also adds the light paths that reach the camera to the film of splats.
class BidirectionalEstimate {
public:
    /// `passes` counts the passes that have begun. `pyramid` is null if no images of techniques are kept.
    BidirectionalEstimate(const LightPaths& paths, const BidirectionalSettings& settings, const std::uint32_t& passes,
                          SplatFilm& splats, TechniquePyramid* pyramid)
        : settings_(settings), paths_(&paths), passes_(&passes), splats_(&splats), pyramid_(pyramid) {}

    PixelSample operator()(RayQueries& rays, const TracedRay& eye, const Sampler& sampler, std::size_t pixel) {
        const Techniques& used = settings_.used;
        const Sampler light_sampler = sampler.split(0, 1, light_path);
        light_vertices_.clear();
        if (const auto start = paths_->emission.sample(light_sampler)) {
            LightWalk(rays, light_sampler, settings_.max_edges, *paths_, used, *start,
                      [&](const PathVertex& vertex, const VertexNumbers& u, NumberStream& flights) {
                          if (used.camera)
                              splat(connect_to_camera(rays, vertex, *paths_, *splats_,
                                                      {u.light_position(), u.light_choice()}, flights),
                                    vertex.edges + 1);
                          if (used.connections) light_vertices_.push_back(vertex);
                      })
                .follow();
        }

        PixelSample sample;
        const auto add = [&](int s, int t, const std::optional<Connection>& path) {
            if (!path) return;
            add_weighted(*path, sample);
            if (pyramid_) pyramid_->add(s, t, pixel, *path, 1);
        };
        CameraWalk(
            rays, eye, sampler, settings_.max_edges, *paths_, used, sample,
            [&](const FoundLight& light) {
                Connection path{.light = {}, .weight = light.weight};
                path.light[light.path_class.component()] = light.radiance;
                add(0, light.edges + 1, path);
            },
            [&](const PathVertex& vertex, const VertexNumbers& u, NumberStream& flights) {
                if (used.light_sampling)
                    add(1, vertex.edges + 1, connect_to_light(rays, vertex, *paths_, u, flights, used));
                for (const PathVertex& from_light : light_vertices_)
                    if (vertex.edges + 1 + from_light.edges <= settings_.max_edges)
                        add(from_light.edges + 1, vertex.edges + 1,
                            connect(rays, vertex, from_light, *paths_, flights));
            })
            .follow();
        return sample;
    }

private:
    static constexpr std::uint64_t light_path = 1;  ///< tag of the light path's numbers

    static void add_weighted(const Connection& path, PixelSample& sample) {
        for (std::size_t c = 0; c < sample.parts.size(); ++c)
            if (!is_black(path.light.parts[c])) sample.parts[c] += path.weight * path.light.parts[c];
    }
    void splat(const std::optional<Splat>& splat, int s) {
        if (!splat) return;
        if (pyramid_) pyramid_->add(s, 1, splat->pixel, splat->connection, 1 / paths_->count);
        PixelSample weighted;
        add_weighted(splat->connection, weighted);
        splats_->add(splat->pixel, *passes_ - 1, weighted);
    }

    BidirectionalSettings settings_;
    const LightPaths* paths_;
    const std::uint32_t* passes_;
    SplatFilm* splats_;
    TechniquePyramid* pyramid_;
    std::vector<PathVertex> light_vertices_;
};

class BidirectionalRun final : public Run {
public:
    BidirectionalRun(const EyeSampling& sampling, const Plan& plan, const BidirectionalSettings& settings,
                     const ShownComponents& shown)
        : size_(sampling.scene.sensor().width(), sampling.scene.sensor().height()),
          paths_(sampling.scene, plan, sampling.stages),
          splats_(size_.x(), size_.y(), shown.accumulated, paths_.sum_unit),
          eye_(average_eye_samples(sampling, shown,
                                   BidirectionalEstimate(paths_, settings, passes_, splats_, pyramid(settings)))) {}

    Progress advance(std::uint32_t pass) override {
        passes_ = pass + 1;
        return eye_->advance(pass);
    }
    ComponentImages image() const override {
        ComponentImages images = eye_->image();
        splats_.add_mean(paths_.count * passes_, images);
        if (pyramid_) images.techniques = pyramid_->images(passes_);
        return images;
    }
    RunCounts counts() const override {
        RunCounts counts = eye_->counts();
        counts.non_finite = counts.non_finite + splats_.non_finite();
        return counts;
    }

private:
    TechniquePyramid* pyramid(const BidirectionalSettings& settings) {
        if (settings.shows_techniques)
            pyramid_ = std::make_unique<TechniquePyramid>(size_.x(), size_.y(), paths_.sum_unit / paths_.count);
        return pyramid_.get();
    }

    Eigen::Vector2i size_;
    LightPaths paths_;
    SplatFilm splats_;
    std::unique_ptr<TechniquePyramid> pyramid_;
    std::unique_ptr<Run> eye_;
    std::uint32_t passes_ = 0;
};

class Bidirectional final : public Method {
public:
    explicit Bidirectional(const BidirectionalSettings& settings) : settings_(settings) {}

    Plan plan(const Scene& scene) const override {
        Plan plan = described_plan(scene, find_method("bidirectional"));
        const Techniques& used = settings_.used;
        const bool uses_all = used.hits && used.light_sampling && used.connections && used.camera;
        plan.unresolved =
            uses_all ? components_of_delta_paths(scene, plan.called_for) : find_method("bidirectional").components;
        add_light_paths(plan, scene, settings_.max_edges);
        add_eye_paths(plan, scene, settings_.max_edges);
        add_light_sampling(plan, settings_.max_edges);
        plan.add(std::string(pass_connections), used.connections && settings_.max_edges >= 3,
                 used.connections ? "a path with two inner vertices has three edges, more than max_depth allows"
                                  : "connections=off");
        return plan;
    }

    std::unique_ptr<Run> start(const Scene& scene, std::uint64_t seed, StageTimes& stages) const override {
        const Plan passes = plan(scene);
        BidirectionalSettings settings = settings_;
        settings.used.light_sampling &= passes.runs(pass_light_sampling);
        return std::make_unique<BidirectionalRun>(
            EyeSampling{.scene = scene,
                        .points = settings.points,
                        .seed = seed,
                        .stages = stages,
                        .runs = passes.runs(pass_eye_paths)},
            passes, settings, shown_components(scene, passes.called_for, find_method("bidirectional")));
    }

private:
    BidirectionalSettings settings_;
};

}  // namespace

MethodDescription describe_bidirectional() {
    const auto technique = [](std::string name, std::string meaning) {
        return choice_parameter(std::move(name), {"on", "off"}, std::move(meaning));
    };
    return {
        .name = "bidirectional",
        .sentence = "paths from the camera and from the lights, joined in all ways: unbiased, resolves caustics",
        .parameters = {point_set_parameter(), technique("hits", "paths from the camera find lights by themselves"),
                       technique("light_sampling", "points of lights are sampled from paths from the camera"),
                       technique("connections", "vertices of both paths are connected"),
                       technique("camera", "vertices of light paths are connected to the camera"),
                       choice_parameter(
                           "techniques", {"off", "on"},
                           "keep an image of each technique, weighted and alone, for paths of up to 5 edges")},
        .simulates = Effects::all(),
        .components = {all_components.begin(), all_components.end()},
        .unbiased = true,
        .create = [](const ParameterValues& values, const MethodDefaults& defaults) -> std::unique_ptr<Method> {
            const auto on = [&](const char* name) { return values.choice(name) == "on"; };
            return std::make_unique<Bidirectional>(BidirectionalSettings{
                point_set_of(values),
                max_edges_of(values, defaults),
                {on("hits"), on("light_sampling"), on("connections"), on("camera")},
                on("techniques"),
            });
        },
    };
}

}  // namespace gib
