#pragma once
// The loop over the pixels of an image; all methods that take samples of pixels share it.

#include "common/core/parallel.h"
#include "common/images/film.h"
#include "common/sampling/sampler.h"
#include "methods/method.h"
#include "methods/parts/transport/ray_queries.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <type_traits>

namespace gib {

/// Calls body(pixel, TracedRay, Sampler) for the pixels [begin, end) in one pass, each with a ray from the camera.
/// Rays of neighbouring pixels are traced together as a packet.
template <typename Body>
void for_each_pixel(RayQueries& rays, PointSet points, std::uint64_t seed, std::uint32_t pass, std::size_t begin,
                    std::size_t end, Body&& body) {
    const Sensor& sensor = rays.scene().sensor();
    const auto width = static_cast<std::size_t>(sensor.width());
    int x = static_cast<int>(begin % width), y = static_cast<int>(begin / width);
    std::array<std::optional<Sampler>, Accelerator::packet_size> samplers;
    std::array<Ray, Accelerator::packet_size> packet;
    std::array<std::optional<Intersection>, Accelerator::packet_size> found;
    for (std::size_t first = begin; first < end; first += packet.size()) {
        const std::size_t count = std::min(packet.size(), end - first);
        for (std::size_t i = 0; i < count; ++i) {
            packet[i] = sensor.sample_ray(x, y, samplers[i].emplace(points, seed, first + i, pass));
            if (++x == sensor.width()) {
                x = 0;
                ++y;
            }
        }
        rays.trace_from_camera(std::span(packet).first(count), found);
        for (std::size_t i = 0; i < count; ++i)
            body(first + i, TracedRay{packet[i], found[i], sensor.hides_emitters()}, *samplers[i]);
    }
}

/// Adds one sample of every pixel to the film and returns the number of rays traced. The time and the progress are
/// recorded in `stages` under the name `stage`. `start_block()` returns the sampling function for one block of
/// pixels, PixelSample(RayQueries&, const TracedRay&, const Sampler&), which may own scratch memory and may take the
/// pixel's index as a fourth argument. AnyFilm is Film or a class with the same function add().
template <typename AnyFilm, typename StartBlock>
std::uint64_t sample_pixels(const Scene& scene, AnyFilm& film, PointSet points, std::uint64_t seed, std::uint32_t pass,
                            StageTimes& stages, std::string_view stage, StartBlock&& start_block) {
    const auto timer = stages.time(stage);
    const Sensor& sensor = scene.sensor();
    const std::size_t pixels = static_cast<std::size_t>(sensor.width()) * static_cast<std::size_t>(sensor.height());
    std::atomic<std::uint64_t> traced = 0;
    StageProgress progress(stages, stage, pixels);
    parallel_blocks(pixels, 256, [&](std::size_t begin, std::size_t end, std::size_t) {
        RayQueries rays(scene);
        auto sample = start_block();
        for_each_pixel(rays, points, seed, pass, begin, end,
                       [&](std::size_t pixel, const TracedRay& eye, const Sampler& sampler) {
                           if constexpr (std::is_invocable_v<decltype(sample)&, RayQueries&, const TracedRay&,
                                                             const Sampler&, std::size_t>)
                               film.add(pixel, pass, sample(rays, eye, sampler, pixel));
                           else film.add(pixel, pass, sample(rays, eye, sampler));
                       });
        traced += rays.count();
        progress.add(end - begin);
    });
    return traced;
}

}  // namespace gib
