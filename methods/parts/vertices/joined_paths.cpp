#include "methods/parts/vertices/joined_paths.h"

#include "common/scene/scene.h"
#include "methods/parts/vertices/camera_walk.h"
#include "methods/parts/vertices/light_walk.h"

#include <cmath>

namespace gib {

namespace {

constexpr std::uint64_t light_path = 1, light_in_view = 2;  // tags of the light path's numbers, and of this point's

void add_weighted(const Connection& path, PixelSample& sample) {
    for (std::size_t c = 0; c < sample.parts.size(); ++c)
        if (!is_black(path.light.parts[c])) sample.parts[c] += path.weight * path.light.parts[c];
}

/// The weights take shared connections for this many samples, which lies between the three that are made and the number of paths.
/// In door-ajar 4 is within a quarter of the best, 16; in cornell-box, where few vertices are hidden, 8 and 4 are best.
constexpr double first_samples = 4;

class JoinedPathsRun final : public Run {
public:
    JoinedPathsRun(const Scene& scene, const JoinedPathsSettings& settings, const Plan& plan,
                   const ShownComponents& shown, std::uint64_t seed, StageTimes& stages)
        : scene_(scene),
          stages_(stages),
          runs_(plan.runs(step_eye_paths)),
          paths_(scene, plan, stages),
          film_(width(), height(), shown.accumulated, shown.black,
                settings.merging ? shown.accumulated : std::vector<Component>()),
          splats_(width(), height(), shown.accumulated, paths_.sum_unit),
          pass_{.paths = paths_,
                .rules = {settings.max_edges, settings.used},
                .splats = splats_,
                .points = settings.points,
                .seed = seed} {
        if (connects_paths(settings.used) && settings.max_edges >= 3 && settings.shared_paths > 1) {
            pass_.shared_paths = settings.shared_paths;
            pass_.rules.first_samples = first_samples;
        }
        if (settings.shows_techniques) {
            pyramid_ = std::make_unique<TechniquePyramid>(width(), height(), paths_.sum_unit / paths_.count);
            pass_.pyramid = pyramid_.get();
        }
        if (settings.merging) {
            const bool is_specular =
                plan.called_for.has(Effect::specular_reflection) || plan.called_for.has(Effect::refraction);
            merged_.emplace(scene, paths_, *settings.merging, is_specular, seed);
            pass_.merged = &*merged_;
        }
    }

    Progress advance(std::uint32_t pass) override {
        passes_ = pass + 1;
        if (!runs_) return Progress::converged;
        pass_.pass = pass;
        if (merged_) {
            const auto timer = stages_.time(step_merging);
            merged_->start_pass(pass, pass_.rules, rays_);
        }
        rays_ += sample_blocks(
            scene_, film_, pass, stages_, step_eye_paths, Tile::count(scene_.sensor()),
            [&](RayQueries& rays, std::size_t index, const auto& add) {
                const Tile tile(scene_.sensor(), index);
                // A group has every `apart`-th pixel of the tile in x and y, because its pixels' noise is alike.
                const bool shares = pass_.shared_paths > 1;
                const int apart = shares ? Tile::edge / static_cast<int>(std::sqrt(pass_.shared_paths)) : 1;
                JoinedPathsEstimate estimate(pass_);
                for (int group = 0; group < apart * apart; ++group) {
                    const auto places = tile.every(apart, group % apart, group / apart, scene_.sensor());
                    if (shares) estimate.start_group(rays, places);
                    for_each_pixel_of(
                        rays, pass_.points, pass_.seed, pass, places.size(), [&](std::size_t i) { return places[i]; },
                        [&](std::size_t pixel, const TracedRay& eye, const Sampler& sampler) {
                            add(pixel, estimate(rays, eye, sampler, pixel));
                        });
                }
                return tile.pixels();
            });
        return Progress::more;
    }

    ComponentImages image() const override {
        ComponentImages images = film_.mean(passes_);
        splats_.add_mean(paths_.count * passes_, images);
        if (pyramid_) images.techniques = pyramid_->images(passes_);
        return images;
    }
    RunCounts counts() const override {
        RunCounts counts{
            .photons = merged_ ? merged_->light_paths() : 0, .rays = rays_, .non_finite = film_.non_finite()};
        counts.non_finite = counts.non_finite + splats_.non_finite();
        return counts;
    }

    std::vector<std::pair<std::string, std::string>> facts() const override {
        return merged_ ? merged_->facts() : std::vector<std::pair<std::string, std::string>>{};
    }

private:
    int width() const { return scene_.sensor().width(); }
    int height() const { return scene_.sensor().height(); }

    const Scene& scene_;
    StageTimes& stages_;
    bool runs_;
    std::uint64_t rays_ = 0;
    LightPaths paths_;
    BiasedFilm film_;
    SplatFilm splats_;
    PassOfPaths pass_;
    std::unique_ptr<TechniquePyramid> pyramid_;
    std::optional<MergedVertices> merged_;
    std::uint32_t passes_ = 0;
};

}  // namespace

BiasedSample JoinedPathsEstimate::operator()(RayQueries& rays, const TracedRay& eye, const Sampler& sampler,
                                             std::size_t pixel,
                                             std::vector<std::pair<std::size_t, PixelSample>>* kept) {
    kept_ = kept;
    const PathRules& rules = pass_.rules;
    const std::size_t own = pass_.shared_paths > 1 ? next_++ : 0;
    if (pass_.shared_paths == 1) {
        light_vertices_.clear();
        follow_light(rays, sampler);
    }
    BiasedSample sample;
    const auto add = [&](int s, int t, const std::optional<Connection>& path) {
        if (!path) return;
        add_weighted(*path, sample.light);
        if (pass_.pyramid) pass_.pyramid->add(s, t, pixel, *path, 1);
    };
    CameraWalk(
        rays, eye, sampler, pass_.paths, rules, sample.light,
        [&](const FoundLight& light) {
            if (light.edges < rules.min_edges) return;
            Connection path{.light = {}, .weight = light.weight};
            path.light[light.path_class.component()] = light.radiance;
            add(0, light.edges + 1, path);
        },
        [&](PathVertex& vertex, const VertexNumbers& u, NumberStream& flights) {
            if (pass_.merged) pass_.merged->merge(vertex, rules, rays, flights, sample);
            if (used_.only_merging()) return;
            if (used_.light_sampling && vertex.edges + 1 >= rules.min_edges)
                add(1, vertex.edges + 1, connect_to_light(rays, vertex, pass_.paths, used_, u, flights));
            const auto join = [&](const PathVertex& from_light, double factor) -> double {
                const int edges = vertex.edges + 1 + from_light.edges;
                if (edges < rules.min_edges || edges > rules.max_edges) return 0;
                if (from_light.sums.merging().focuses()) tell_n(rules.merging, rays, vertex);
                auto path = connect(rays, vertex, from_light, pass_.paths, rules, flights);
                if (!path) return 0;
                const double size = path->size();
                for (Color& part : path->light.parts)
                    part *= static_cast<float>(factor);
                add(from_light.edges + 1, vertex.edges + 1, path);
                return size;
            };
            if (vertex.is_first && pass_.shared_paths > 1) return light_vertices_.join_first(flights, join);
            for (const PathVertex& from_light : light_vertices_.path(own))
                join(from_light, 1);
        })
        .follow();
    return sample;
}

void JoinedPathsEstimate::start_group(RayQueries& rays, std::span<const PixelPlace> places) {
    light_vertices_.clear();
    next_ = 0;
    for (const PixelPlace& at : places)
        follow_light(rays, Sampler(pass_.points, pass_.seed, at.index, pass_.pass));
}

/// Connects a point of a light and the vertices of the pixel's light path to the camera, and keeps the vertices.
void JoinedPathsEstimate::follow_light(RayQueries& rays, const Sampler& sampler) {
    light_vertices_.begin_path();
    if (!(used_.camera || used_.connections) || used_.only_merging()) return;
    if (used_.camera && used_.light_sampling && pass_.rules.min_edges <= 1) {
        const Sampler numbers = sampler.split(0, 1, light_in_view);
        NumberStream flights(numbers);
        splat(sample_light_from_camera(rays, pass_.paths, pass_.splats, true, numbers.at_vertex(0), flights), 1);
    }
    const Sampler light_sampler = sampler.split(0, 1, light_path);
    const auto start = pass_.paths.emission.sample(light_sampler);
    if (!start) return;
    LightWalk(rays, light_sampler, pass_.paths, pass_.rules, *start,
              [&](const PathVertex& vertex, const VertexNumbers& u, NumberStream& flights) {
                  if (used_.camera && vertex.edges + 1 >= pass_.rules.min_edges)
                      splat(connect_to_camera(rays, vertex, pass_.paths, pass_.rules, pass_.splats,
                                              {u.light_position(), u.light_choice()}, flights),
                            vertex.edges + 1);
                  if (used_.connections) light_vertices_.add(vertex);
              })
        .follow();
}

void JoinedPathsEstimate::splat(const std::optional<Splat>& splat, int s) {
    if (!splat) return;
    if (pass_.pyramid) pass_.pyramid->add(s, 1, splat->pixel, splat->connection, 1 / pass_.paths.count);
    PixelSample weighted;
    add_weighted(splat->connection, weighted);
    if (kept_) kept_->emplace_back(splat->pixel, weighted);
    else pass_.splats.add(splat->pixel, pass_.pass, weighted);
}

Parameter shared_paths_parameter() {
    return choice_parameter(
        std::string(shared_paths_name), {"16", "1", "4", "64", "256"},
        "light paths of pixels nearby that a path from the camera is connected with where it first can be");
}
std::size_t shared_paths_of(const ParameterValues& values) { return std::stoul(values.choice(shared_paths_name)); }

void add_joined_paths(Plan& plan, const Scene& scene, const JoinedPathsSettings& settings) {
    const Techniques& used = settings.used;
    add_light_paths(plan, scene, settings.max_edges);
    add_eye_paths(plan, scene, settings.max_edges);
    add_light_sampling(plan, settings.max_edges);
    plan.add(std::string(step_connections), used.connections && settings.max_edges >= 3,
             used.connections ? "a path with two inner vertices has three edges, more than max_depth allows"
                              : "connections are turned off");
}

std::unique_ptr<Run> start_joined_paths(const Scene& scene, const JoinedPathsSettings& settings, const Plan& plan,
                                        const ShownComponents& shown, std::uint64_t seed, StageTimes& stages) {
    JoinedPathsSettings needed = settings;
    needed.used.light_sampling &= plan.runs(step_light_sampling);
    if (!plan.runs(step_merging)) needed.merging.reset();
    return std::make_unique<JoinedPathsRun>(scene, needed, plan, shown, seed, stages);
}

}  // namespace gib
