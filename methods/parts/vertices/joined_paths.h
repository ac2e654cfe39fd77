#pragma once
// The run of paths from both ends. It serves bidirectional, metropolis for its short paths, and vcm, which adds merging.

#include "methods/parts/vertices/joined_paths_estimate.h"

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gib {

using MakeTechniqueImages = std::function<std::unique_ptr<TechniqueImages>(const LightPaths&)>;

template <typename Merging>
class JoinedPathsRun final : public Run {
public:
    /// `make_merging(paths)` returns the run's Merging; `make_techniques` may be empty.
    template <typename MakeMerging>
    JoinedPathsRun(const Scene& scene, const PathRules& rules, const MakeTechniqueImages& make_techniques,
                   const Plan& plan, const ShownComponents& shown, std::uint64_t seed, StageTimes& stages,
                   const MakeMerging& make_merging)
        : scene_(scene),
          stages_(stages),
          runs_(plan.runs(step_eye_paths)),
          paths_(scene, plan, stages),
          merging_(make_merging(paths_)),
          film_(Merging::film(scene.sensor(), shown)),
          splats_(width(), height(), shown.accumulated, paths_.sum_unit),
          joined_{paths_, rules, splats_, merging_},
          pass_{seed} {
        joined_.rules.light_sampling &= plan.runs(step_light_sampling);
        if (!rules.connects || rules.max_edges < 3) joined_.rules.shared_paths = 1;
        if (!make_techniques) return;
        techniques_ = make_techniques(paths_);
        joined_.techniques = techniques_.get();
    }

    Progress advance(std::uint32_t pass) override {
        passes_ = pass + 1;
        if (!runs_) return Progress::converged;
        pass_.number = pass;
        merging_.start_pass(pass, stages_, rays_);
        rays_ += sample_blocks(
            scene_, film_, pass, stages_, step_eye_paths, Tile::count(scene_.sensor()),
            [&](RayQueries& rays, std::size_t index, const auto& add) { return sample_tile(rays, index, add); });
        return Progress::more;
    }

    ComponentImages image() const override {
        ComponentImages images = film_.mean(passes_);
        splats_.add_mean(paths_.count * passes_, images);
        if (techniques_) images.techniques = techniques_->images(passes_);
        return images;
    }
    RunCounts counts() const override {
        RunCounts counts{.photons = merging_.light_paths(), .rays = rays_, .non_finite = film_.non_finite()};
        counts.non_finite = counts.non_finite + splats_.non_finite();
        return counts;
    }
    std::vector<std::pair<std::string, std::string>> facts() const override { return merging_.facts(); }

private:
    /// Samples all pixels of a tile, calls add(pixel, sample), and returns their number.
    template <typename Add>
    std::size_t sample_tile(RayQueries& rays, std::size_t index, const Add& add) {
        const Tile tile(scene_.sensor(), index);
        // A group has every `apart`-th pixel of the tile in x and y, because its pixels' noise is alike.
        const PathRules& rules = joined_.rules;
        const bool shares = rules.shared_paths > 1;
        const int apart = shares ? Tile::edge / static_cast<int>(std::sqrt(rules.shared_paths)) : 1;
        JoinedPathsEstimate<Merging> estimate(joined_, pass_, [this](std::size_t pixel, const PixelSample& light) {
            splats_.add(pixel, pass_.number, light);
        });
        for (int group = 0; group < apart * apart; ++group) {
            const auto places = tile.every(apart, group % apart, group / apart, scene_.sensor());
            const std::size_t path =
                index * Tile::edge * Tile::edge + static_cast<std::size_t>(group) * rules.shared_paths;
            if (shares) estimate.start_group(rays, path, places.size());
            for_each_pixel_of(
                rays, rules.points, pass_.seed, pass_.number, places.size(), [&](std::size_t i) { return places[i]; },
                [&](std::size_t pixel, const TracedRay& eye, const Sampler& sampler) {
                    add(pixel, estimate(rays, eye, sampler, pixel));
                });
        }
        return tile.pixels();
    }

    int width() const { return scene_.sensor().width(); }
    int height() const { return scene_.sensor().height(); }

    const Scene& scene_;
    StageTimes& stages_;
    bool runs_;
    std::uint64_t rays_ = 0;
    LightPaths paths_;
    Merging merging_;
    typename Merging::Film film_;
    SplatFilm splats_;
    JoinedPaths<Merging> joined_;
    Pass pass_;
    std::unique_ptr<TechniqueImages> techniques_;
    std::uint32_t passes_ = 0;
};

/// Pixels whose paths from the camera share their light paths.
inline constexpr std::string_view shared_paths_name = "shared_paths";
Parameter shared_paths_parameter();
std::size_t shared_paths_of(const ParameterValues& values);

/// Adds the steps of light paths, eye paths, light sampling and connections.
void add_joined_paths(Plan& plan, const Scene& scene, const PathRules& rules);

/// Starts the run without merging (see JoinedPathsRun), with light sampling, eye paths and aim where `plan` runs them.
std::unique_ptr<Run> start_joined_paths(const Scene& scene, const PathRules& rules,
                                        const MakeTechniqueImages& make_techniques, const Plan& plan,
                                        const ShownComponents& shown, std::uint64_t seed, StageTimes& stages);

}  // namespace gib
