#pragma once
// The walk from the camera: its vertices, and the lights that it finds by itself.

#include "common/images/film.h"
#include "methods/parts/vertices/light_paths.h"
#include "methods/parts/vertices/no_merging.h"
#include "methods/parts/vertices/path_vertex.h"

#include <cmath>
#include <optional>
#include <utility>

namespace gib {

/// Light that the camera's walk has found by itself (s = 0).
struct FoundLight {
    PathClass path_class;
    Color radiance;  ///< times the walk's throughput [W/(sr m^2)]
    float weight;
    int edges;  ///< number of edges of the path
};

/// Follows the path of a camera's ray. Calls found(FoundLight) for lights on its way, and visit(vertex, along, numbers, flights)
/// at every vertex where another walk could end, before the path is scattered there. `Rule` is NoMerging or what a method adds.
template <typename Rule, typename Found, typename Visit>
class CameraWalk {
public:
    /// `eye` has been traced. `paths` are the light paths for each of the camera's paths of a pixel. A throughput that is
    /// not finite ends the path and is added to the class's component of `lost`, for the film to count it.
    CameraWalk(RayQueries& rays, const TracedRay& eye, const Sampler& sampler, const LightPaths& paths,
               const PathRules& rules, const Rule& added, PixelSample& lost, Found found, Visit visit)
        : scene_(rays.scene()),
          paths_(paths),
          rules_(rules),
          lost_(lost),
          found_(std::move(found)),
          visit_(std::move(visit)),
          along_(added),
          walk_(rays, sampler, eye, scene_.camera_medium()),
          sums_(TechniqueSums::at_camera(scene_.sensor().ray_density(eye.ray.d), paths.count, rules)) {}

    void follow() {
        bool goes_on = true;
        while (goes_on && walk_.at.vertex < rules_.max_edges) {
            const Flight flight = walk_.fly();
            if (flight.is_black) return;
            const VertexNumbers u = walk_.vertex_numbers;
            goes_on = flight.scattering_at ? scatters_in_medium(*flight.scattering_at, u) : leaves_surface(u);
        }
    }

private:
    bool is_last() const { return walk_.at.vertex + 1 >= rules_.max_edges; }

    /// The event at p in the medium. Returns whether the path goes on.
    bool scatters_in_medium(const Vec3& p, const VertexNumbers& u) {
        if (is_last()) return false;
        PathState& path = walk_.at;
        arrive(p, 1);
        along_.arrive(walk_, p, sums_);
        if (along_.ends(sums_)) return false;
        PathVertex vertex(walk_, p, path.path_class, sums_);
        tell_whether_first(vertex);
        visit_(vertex, along_, u, walk_.flights);
        path.path_class.in_medium = true;
        const auto [to, step] = scatter_in_medium(walk_, sums_, u);
        along_.scattered(vertex, step);
        if (!survives(most_survival(path.vertex), u)) return false;
        walk_.go_on(p, to);
        return true;
    }

    /// The surface at the end of the ray, or the environment. Returns whether the path goes on.
    bool leaves_surface(const VertexNumbers& u) {
        auto hit = walk_.surface_hit();
        if (!hit) {
            find_environment();
            return false;
        }
        const TechniqueSums before = sums_;
        const double cosine = std::abs(double{walk_.wo().dot(hit->ng)});
        arrive(hit->p, cosine);
        find_emitter(*hit, cosine);
        if (walk_.passes_through(*hit)) {
            sums_ = before;
            return true;
        }
        if (is_last()) return false;

        PathState& path = walk_.at;
        along_.arrive(walk_, *hit, cosine, sums_);
        walk_.disperse(*hit, dimension::stratum);
        PathVertex vertex(walk_, std::move(*hit), path.path_class, sums_);
        if (vertex.can_be_joined()) {
            tell_whether_first(vertex);
            if (along_.ends(sums_)) return false;
            visit_(vertex, along_, u, walk_.flights);
        }
        const auto next = walk_.scatter(*vertex.hit, vertex.from_local, u, Transport::radiance, true);
        if (!next) return false;
        along_.scatters(walk_.rays, next->delta, sums_);
        along_.scattered(vertex, step(sums_, vertex, *next, Transport::power));
        if (!survives(next->delta ? most_specular_survival(path.vertex) : most_survival(path.vertex), u)) return false;
        walk_.go_on(*vertex.hit, next->wi);
        return true;
    }

    void arrive(const Vec3& p, double cosine) {
        const PathState& path = walk_.at;
        const bool parallel = path.vertex == 0 && scene_.sensor().is_orthographic();
        sums_.arrive(parallel ? 1. : double{(p - path.previous).squaredNorm()}, cosine, samples_of_connection());
    }
    /// Samples of the technique that connects the edge on which the walk has just arrived; 0 if none in use does.
    double samples_of_connection() const {
        if (!rules_.follows_light) return 0;
        if (walk_.at.vertex == 0) return 1;
        if (!rules_.connects) return 0;
        return first_ && walk_.at.vertex == *first_ + 1 ? rules_.first_samples() : 1;
    }
    void tell_whether_first(PathVertex& vertex) {
        vertex.is_first = !first_;
        if (!first_) first_ = walk_.at.vertex;
    }
    bool finds_lights() const { return !along_.is_alone() && !walk_.ray.hides_emitters; }

    void find_environment() {
        if (!finds_lights() || !scene_.environment()) return;
        const Vec3& w = walk_.ray.ray.d;
        find(scene_.environment_radiance(w), double{scene_.environment_pdf_w(walk_.lit_previous(), w)},
             paths_.emission.density(scene_.environment_index(), walk_.at.previous, -w, 1.f), false);
    }
    void find_emitter(const SurfaceHit& hit, double cosine) {
        if (!finds_lights() || !hit.emitter) return;
        const Vec3& from = walk_.at.previous;
        const double per_area = cosine / double{(hit.p - from).squaredNorm()};
        find(hit.Le(walk_.wo()), double{scene_.light_pdf_w(walk_.lit_previous(), hit)} * per_area,
             paths_.emission.density(hit.light, hit.p, walk_.wo(), static_cast<float>(cosine)),
             !scene_.sensor().is_orthographic());
    }
    /// A light of radiance Le is found. The density of this find by light sampling is `sampling`, in the unit of
    /// TechniqueSums::other_than_hit(), and the emission's is `emission`. `is_sampled_in_view`: sample_light_from_camera()
    /// finds it, too, if the camera sees it without scattering.
    void find(const Color& Le, double sampling, double emission, bool is_sampled_in_view) {
        if (is_black(Le)) return;
        const PathState& path = walk_.at;
        const bool is_alone = path.vertex == 0 && !is_sampled_in_view;
        const double others = is_alone ? 0 : sums_.other_than_hit(sampling, emission, rules_);  // (42), (43)
        found_(FoundLight{path.path_class, path.beta * Le, static_cast<float>(1 / (1 + others)), path.vertex + 1});
    }

    bool survives(float most, const VertexNumbers& u) {
        return walk_.at.vertex < first_roulette_vertex ||
               walk_.survives(most, u.roulette(), lost_[walk_.at.path_class.component()]);
    }

    const Scene& scene_;
    const LightPaths& paths_;
    const PathRules& rules_;
    PixelSample& lost_;
    Found found_;
    Visit visit_;
    typename Rule::AlongCamera along_;
    PathWalk walk_;
    TechniqueSums sums_;
    std::optional<int> first_;  ///< number of vertices before the first one that can be joined; empty until then
};

}  // namespace gib
