#pragma once
// The estimate of a pixel by paths from both ends: every path from the camera is joined with paths from lights in all ways.

#include "common/images/splat_film.h"
#include "methods/parts/transport/pixel_samples.h"
#include "methods/parts/vertices/camera_walk.h"
#include "methods/parts/vertices/connections.h"
#include "methods/parts/vertices/shared_vertices.h"

#include <functional>
#include <optional>

namespace gib {

/// Keeps the paths of each technique apart. Technique (s, t) takes s vertices from a light's walk and t from the
/// camera's.
class TechniqueImages {
public:
    virtual ~TechniqueImages() = default;

    /// Adds a path that technique (s, t) has made; `factor` makes its light that of a sample of the pixel.
    virtual void add(int s, int t, std::size_t pixel, const Connection& path, double factor) = 0;
    /// The named means over `count` samples of each pixel [W/(sr m^2)].
    virtual std::vector<std::pair<std::string, Image>> images(double count) const = 0;
};

/// The parts of a run that the estimates of all samples share. `Merging` is NoMerging or what a method adds.
template <typename Merging>
struct JoinedPaths {
    const LightPaths& paths;
    PathRules rules;
    const SplatFilm& film;  ///< of the light paths that reach the camera
    const Merging& merging;
    TechniqueImages* techniques = nullptr;  ///< null: none are kept
};

/// The estimate of the samples of some pixels in one pass, in groups if they share their light paths.
template <typename Merging>
class JoinedPathsEstimate {
public:
    /// Takes the light of a light path that reaches the camera in some pixel, in the unit of connect_to_camera().
    using Splats = std::function<void(std::size_t pixel, const PixelSample& light)>;

    JoinedPathsEstimate(const JoinedPaths<Merging>& joined, const Pass& pass, Splats splats)
        : joined_(joined), rules_(joined.rules), pass_(pass), splats_(std::move(splats)) {}

    /// Follows `count` light paths of pixels that share theirs, before their samples. `first` is the first path's number in
    /// the pass. The paths of a pass, not those of a pixel, are a sequence of Sobol' points, so a group's are stratified.
    void start_group(RayQueries& rays, std::size_t first, std::size_t count) {
        light_vertices_.clear();
        next_ = 0;
        for (std::size_t i = first; i < first + count; ++i)
            follow_light(rays, Sampler(rules_.points, combine_keys(pass_.seed, light_path), pass_.number,
                                       static_cast<std::uint32_t>(i)));
    }

    /// The light of the paths from the camera that end in this pixel.
    typename Merging::Sample operator()(RayQueries& rays, const TracedRay& eye, const Sampler& sampler,
                                        std::size_t pixel) {
        pixel_ = pixel;
        const bool shares = rules_.shared_paths > 1;
        const std::size_t own = shares ? next_++ : 0;
        if (!shares) {
            light_vertices_.clear();
            follow_light(rays, sampler);
        }
        typename Merging::Sample sample;
        PixelSample& light = Merging::light_of(sample);
        CameraWalk(
            rays, eye, sampler, joined_.paths, rules_, joined_.merging.rule(), light,
            [&](const FoundLight& found) { add_found(found, light); },
            [&](PathVertex& vertex, auto& along, const VertexNumbers& u, NumberStream& flights) {
                joined_.merging.merge(vertex, along, rays, flights, sample);
                if (joined_.merging.is_alone()) return;
                if (vertex.is_first && shares) roulette_ = ConnectionRoulette(least_connection(), flights.next());
                if (rules_.light_sampling && vertex.edges + 1 >= rules_.min_edges)
                    add(1, vertex.edges + 1, connect_to_light(rays, vertex, joined_.paths, rules_, u, flights), light);
                const auto join = [&](const PathVertex& from_light, double factor) {
                    along.join(rays, vertex, from_light);
                    return connect_with(rays, vertex, from_light, factor, flights, light);
                };
                if (vertex.is_first && shares) return light_vertices_.join_first(flights, join);
                for (const PathVertex& from_light : light_vertices_.path(own))
                    join(from_light, 1);
            })
            .follow();
        ++samples_;
        for (const Color& part : light.parts)
            if (part.isFinite().all()) seen_ += double{part.sum()};
        return sample;
    }

private:
    static constexpr std::uint64_t light_path = 1,
                                   light_in_view = 2;  ///< tags of the light path's numbers, and of this point's

    static void add_weighted(const Connection& path, PixelSample& sample) {
        for (std::size_t c = 0; c < sample.parts.size(); ++c)
            if (!is_black(path.light.parts[c])) sample.parts[c] += path.weight * path.light.parts[c];
    }
    void add(int s, int t, const std::optional<Connection>& path, PixelSample& light) {
        if (!path) return;
        add_weighted(*path, light);
        if (joined_.techniques) joined_.techniques->add(s, t, pixel_, *path, 1);
    }

    void add_found(const FoundLight& found, PixelSample& light) {
        if (found.edges < rules_.min_edges) return;
        Connection path{.light = {}, .weight = found.weight};
        path.light[found.path_class.component()] = found.radiance;
        add(0, found.edges + 1, path, light);
    }

    /// A hundredth of the mean of the samples so far, of which there are few at first. In the box of a point light, the
    /// connections below it had an eighth of the rays, and their roulette no effect on the variance; three hundredths raised it
    /// by 2 %. The threshold does not depend on the present sample.
    double least_connection() const { return 0.01 * seen_ / (samples_ + 4); }

    /// Connects two vertices, and adds what this makes times `factor`. Returns its size without the factor.
    double connect_with(RayQueries& rays, const PathVertex& eye, const PathVertex& from_light, double factor,
                        NumberStream& flights, PixelSample& light) {
        const int edges = eye.edges + 1 + from_light.edges;
        if (edges < rules_.min_edges || edges > rules_.max_edges) return 0;
        const auto path = connect(rays, eye, from_light, joined_.paths, rules_, factor, roulette_, flights);
        add(from_light.edges + 1, eye.edges + 1, path, light);
        return path ? path->size() / factor : 0;
    }

    /// Connects a point of a light and the vertices of a light path to the camera, and keeps the vertices.
    void follow_light(RayQueries& rays, const Sampler& sampler) {
        light_vertices_.begin_path();
        if (!rules_.connects || joined_.merging.is_alone()) return;
        if (rules_.light_sampling && rules_.min_edges <= 1) {
            const Sampler numbers = sampler.split(0, 1, light_in_view);
            NumberStream flights(numbers);
            splat(sample_light_from_camera(rays, joined_.paths, joined_.film, true, numbers.at_vertex(0), flights), 1);
        }
        if (!rules_.follows_light) return;
        const Sampler light_sampler = sampler.split(0, 1, light_path);
        const auto start = joined_.paths.emission.sample(light_sampler);
        if (!start) return;
        LightWalk(rays, light_sampler, joined_.paths, rules_, joined_.merging.rule(), *start,
                  [&](const PathVertex& vertex, const VertexNumbers& u, NumberStream& flights) {
                      if (vertex.edges + 1 >= rules_.min_edges)
                          splat(connect_to_camera(rays, vertex, joined_.paths, rules_, joined_.film,
                                                  {u.light_position(), u.light_choice()}, flights),
                                vertex.edges + 1);
                      light_vertices_.add(vertex);
                  })
            .follow();
    }

    void splat(const std::optional<Splat>& splat, int s) {
        if (!splat) return;
        if (joined_.techniques) joined_.techniques->add(s, 1, splat->pixel, splat->connection, 1 / joined_.paths.count);
        PixelSample weighted;
        add_weighted(splat->connection, weighted);
        splats_(splat->pixel, weighted);
    }

    const JoinedPaths<Merging>& joined_;
    const PathRules& rules_;
    const Pass& pass_;
    Splats splats_;
    std::size_t pixel_ = 0;
    SharedVertices<PathVertex> light_vertices_;
    std::size_t next_ = 0;  ///< the group's pixel whose sample comes next
    ConnectionRoulette roulette_;
    double seen_ = 0, samples_ = 0;  ///< sum of the samples so far over components and channels; their number
};

}  // namespace gib
