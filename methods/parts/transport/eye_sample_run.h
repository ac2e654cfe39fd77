#pragma once
// The run of a method whose image is the mean of eye samples: one sample of every pixel a pass.

#include "methods/parts/transport/pixel_samples.h"

#include <memory>
#include <utility>

namespace gib {

/// The inputs of such a run, apart from its estimate.
struct EyeSampling {
    const Scene& scene;
    PointSet points;
    std::uint64_t seed;
    StageTimes& stages;
    bool runs = true;                     ///< false if the plan skips the eye paths: the image stays black
    std::uint64_t photons = 0, rays = 0;  ///< emitted and traced in the preparation
};

template <typename Estimate>
class EyeSampleRun final : public Run {
public:
    EyeSampleRun(const EyeSampling& sampling, const ShownComponents& shown, Estimate estimate)
        : sampling_(sampling),
          film_(sampling.scene.sensor().width(), sampling.scene.sensor().height(), shown.accumulated, shown.black),
          estimate_(std::move(estimate)) {}

    Progress advance(std::uint32_t pass) override {
        passes_ = pass + 1;
        if (!sampling_.runs) return Progress::converged;
        sampling_.rays += sample_pixels(sampling_.scene, film_, sampling_.points, sampling_.seed, pass,
                                        sampling_.stages, step_eye_paths, [this] { return estimate_; });
        return Progress::more;
    }

    ComponentImages image() const override { return film_.mean(passes_); }
    RunCounts counts() const override { return {sampling_.photons, sampling_.rays, film_.non_finite()}; }

private:
    EyeSampling sampling_;
    Film film_;
    Estimate estimate_;
    std::uint32_t passes_ = 0;
};

/// The run that averages `estimate`, PixelSample(RayQueries&, const TracedRay& eye, const Sampler&), over the samples
/// of each pixel. Every block of pixels has a copy of the estimate, which may therefore own scratch memory.
template <typename Estimate>
std::unique_ptr<Run> average_eye_samples(const EyeSampling& sampling, const ShownComponents& shown, Estimate estimate) {
    return std::make_unique<EyeSampleRun<Estimate>>(sampling, shown, std::move(estimate));
}

}  // namespace gib
