#pragma once
// The loop over an image that every method with samples per pixel shares.

#include "common/film.h"
#include "common/parallel.h"
#include "common/sampler.h"
#include "methods/ray_queries.h"

#include <atomic>

namespace gib {

/// Adds one sample of every pixel to the film and returns the number of rays traced. `start_block()` gives the sampling
/// function of one block of pixels, which may own scratch memory: PixelSample(RayQueries&, const Ray&, const Sampler&).
template <typename StartBlock>
std::uint64_t sample_pixels(const Scene& scene, Film& film, PointSet points, std::uint64_t seed, std::uint32_t pass,
                            StartBlock&& start_block) {
    const Sensor& sensor = scene.sensor();
    const auto width = static_cast<std::size_t>(sensor.width());
    std::atomic<std::uint64_t> traced = 0;
    parallel_blocks(
        width * static_cast<std::size_t>(sensor.height()), 256, [&](std::size_t begin, std::size_t end, std::size_t) {
            RayQueries rays(scene);
            auto sample = start_block();
            for (std::size_t pixel = begin; pixel < end; ++pixel) {
                const Sampler sampler(points, seed, pixel, pass);
                const Ray ray = sensor.generate_ray(static_cast<int>(pixel % width), static_cast<int>(pixel / width),
                                                    sampler.get_2d(dimension::film));
                film.add(pixel, pass, sample(rays, ray, sampler));
            }
            traced += rays.count();
        });
    return traced;
}

}  // namespace gib
