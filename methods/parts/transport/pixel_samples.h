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
#include <new>
#include <type_traits>

namespace gib {

/// Calls body(i, TracedRay) for the rays ray_of(i) of the camera, 0 <= i < count. They are traced as packets, so up to
/// Accelerator::packet_size calls of ray_of() come before those of body().
template <typename RayOf, typename Body>
void for_each_camera_ray(RayQueries& rays, std::size_t count, RayOf&& ray_of, Body&& body) {
    const bool hides_emitters = rays.scene().sensor().hides_emitters();
    std::array<Ray, Accelerator::packet_size> packet;
    std::array<std::optional<Intersection>, Accelerator::packet_size> found;
    for (std::size_t first = 0; first < count; first += packet.size()) {
        const std::size_t in_packet = std::min(packet.size(), count - first);
        for (std::size_t i = 0; i < in_packet; ++i)
            ::new (&packet[i]) Ray(ray_of(first + i));  // in place, since a copy would wait for its parts
        rays.trace_from_camera(std::span(packet).first(in_packet), found);
        for (std::size_t i = 0; i < in_packet; ++i)
            body(first + i, TracedRay{packet[i], found[i], hides_emitters});
    }
}

/// Calls body(pixel, TracedRay, Sampler) for the pixels [begin, end) in one pass, each with a ray from the camera.
template <typename Body>
void for_each_pixel(RayQueries& rays, PointSet points, std::uint64_t seed, std::uint32_t pass, std::size_t begin,
                    std::size_t end, Body&& body) {
    const Sensor& sensor = rays.scene().sensor();
    const auto width = static_cast<std::size_t>(sensor.width());
    int x = static_cast<int>(begin % width), y = static_cast<int>(begin / width);
    std::array<std::optional<Sampler>, Accelerator::packet_size> samplers;  // samplers of the packet's pixels
    const auto ray_of = [&](std::size_t i) {
        const Ray ray = sensor.sample_ray(x, y, samplers[i % samplers.size()].emplace(points, seed, begin + i, pass));
        if (++x == sensor.width()) {
            x = 0;
            ++y;
        }
        return ray;
    };
    for_each_camera_ray(rays, end - begin, ray_of, [&](std::size_t i, const TracedRay& eye) {
        body(begin + i, eye, *samplers[i % samplers.size()]);
    });
}

/// One thread samples a block of pixels.
inline constexpr std::size_t pixels_per_block = 256;
inline std::size_t pixel_blocks(const Sensor& sensor) {
    const std::size_t pixels = static_cast<std::size_t>(sensor.width()) * static_cast<std::size_t>(sensor.height());
    return (pixels + pixels_per_block - 1) / pixels_per_block;
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
    parallel_blocks(pixels, pixels_per_block, [&](std::size_t begin, std::size_t end, std::size_t) {
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
