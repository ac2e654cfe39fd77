#include "methods/parts/transport/first_surface.h"

#include "methods/parts/transport/pixel_samples.h"

namespace gib {

namespace {

/// Adds a share of the features of one ray.
void add_features(const RayQueries& rays, const TracedRay& eye, float share, std::size_t pixel, FeatureImages& images) {
    const auto hit = rays.surface_hit(eye);
    if (!hit) return;
    const Vec3 wo = -eye.ray.d;
    const Color albedo = hit->bsdf->coefficients_local(hit->shading.to_local(wo)).of(Lobes::all);
    const Vec3 normal = hit->ns.dot(wo) >= 0.f ? hit->ns : Vec3(-hit->ns);
    images.albedo.set(pixel, images.albedo.at(pixel) + share * albedo);
    images.normal.set(pixel, images.normal.at(pixel) + share * normal.array());
    images.depth.set(pixel, images.depth.at(pixel) + Color::Constant(share * (hit->p - eye.ray.o).norm()));
}

}  // namespace

std::array<FeatureImages, 2> first_surface_features(const Scene& scene, std::uint64_t seed, std::uint32_t passes,
                                                    StageTimes& stages) {
    const auto timer = stages.time(step_features);
    const Image black(scene.sensor().width(), scene.sensor().height());
    std::array<FeatureImages, 2> halves = {FeatureImages{black, black, black}, FeatureImages{black, black, black}};
    const std::uint32_t in_half = passes / 2;
    const float share = 1.f / static_cast<float>(in_half);
    StageProgress progress(stages, step_features, black.pixels());
    parallel_blocks(black.pixels(), pixels_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
        RayQueries rays(scene);
        for (std::uint32_t pass = 0; pass < 2 * in_half; ++pass)
            for_each_pixel(rays, PointSet::sobol, seed, pass, begin, end,
                           [&](std::size_t pixel, const TracedRay& eye, const Sampler&) {
                               add_features(rays, eye, share, pixel, halves[pass / in_half]);
                           });
        progress.add(end - begin);
    });
    return halves;
}

FeatureImages mean_of(const std::array<FeatureImages, 2>& halves) {
    FeatureImages mean = halves[0];
    for (const auto member : {&FeatureImages::albedo, &FeatureImages::normal, &FeatureImages::depth})
        for (std::size_t i = 0; i < (mean.*member).rgb.size(); ++i)
            (mean.*member).rgb[i] = 0.5f * ((mean.*member).rgb[i] + (halves[1].*member).rgb[i]);
    return mean;
}

}  // namespace gib
