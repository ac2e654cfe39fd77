#pragma once
// A camera's view of a radiosity solution, by samples of the pixels. One solution serves any number of cameras.

#include "common/images/film.h"
#include "methods/radiosity/model.h"

namespace gib {

struct RadiosityViewSettings {
    int max_edges;
    bool samples_lights;
    int gather;  ///< final gather rays per sample; 0: interpolation
};

class RadiosityView {
public:
    /// `scene` holds the camera, and the same surfaces as the model's own scene; both outlive this. `model` is null
    /// if there is no indirect light to show.
    RadiosityView(const Scene& scene, const Effects& effects, const RadiosityModel* model,
                  const RadiosityViewSettings& settings, std::uint64_t seed, StageTimes& stages);

    /// Takes one sample of every pixel. `restart` says that the solution has changed, so earlier samples are dropped.
    void sample(std::uint32_t pass, bool restart);

    ComponentImages image() const { return film_->mean(passes_); }
    NonFinite non_finite() const { return film_->non_finite(); }
    std::uint64_t rays() const { return rays_; }

private:
    void start_film();

    const Scene& scene_;
    const RadiosityModel* model_;
    RadiosityViewSettings settings_;
    std::uint64_t seed_;
    StageTimes& stages_;
    ShownComponents components_;
    std::optional<Film> film_;
    std::uint32_t passes_ = 0;  ///< samples of each pixel on the film
    std::uint64_t rays_ = 0;
};

}  // namespace gib
