#pragma once
// A radiosity solution seen by a camera: samples of pixels. Any camera can look at one solution.

#include "common/images/film.h"
#include "methods/radiosity/model.h"

namespace gib {

struct RadiosityViewSettings {
    int max_edges;
    bool samples_lights;
    int gather;  ///< final gather rays a sample; 0: interpolation
};

class RadiosityView {
public:
    /// `scene` holds the camera, and the same surfaces as the model's own scene; both outlive this. `model` is null
    /// where there is no indirect light to show.
    RadiosityView(const Scene& scene, const Effects& effects, const RadiosityModel* model,
                  const RadiosityViewSettings& settings, std::uint64_t seed, StageTimes& stages);

    /// One sample of every pixel. `restart`: the solution has changed, so that earlier samples of indirect light do
    /// not count.
    void sample(std::uint32_t pass, bool restart);

    ComponentImages image() const;
    NonFinite non_finite() const { return direct_.non_finite(); }
    std::uint64_t rays() const { return rays_; }

private:
    const Scene& scene_;
    const RadiosityModel* model_;
    RadiosityViewSettings settings_;
    std::uint64_t seed_;
    StageTimes& stages_;
    Film direct_;                   ///< emission and direct light, which no solution changes; all non-finite samples
    std::optional<Film> indirect_;  ///< since the solution changed last
    bool shows_indirect_;
    std::uint32_t passes_ = 0, first_pass_ = 0;
    std::uint64_t rays_ = 0;
};

}  // namespace gib
