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
#include <vector>

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

struct PixelPlace {
    int x, y;
    std::size_t index;
};

/// Calls body(pixel, TracedRay, Sampler) for the pixels place_of(i), 0 <= i < count, in one pass, each with a ray from the camera.
template <typename PlaceOf, typename Body>
void for_each_pixel_of(RayQueries& rays, PointSet points, std::uint64_t seed, std::uint32_t pass, std::size_t count,
                       PlaceOf&& place_of, Body&& body) {
    const Sensor& sensor = rays.scene().sensor();
    std::array<std::optional<Sampler>, Accelerator::packet_size> samplers;  // samplers of the packet's pixels
    std::array<std::size_t, Accelerator::packet_size> pixels;
    const auto ray_of = [&](std::size_t i) {
        const PixelPlace at = place_of(i);
        pixels[i % pixels.size()] = at.index;
        return sensor.sample_ray(at.x, at.y, samplers[i % samplers.size()].emplace(points, seed, at.index, pass));
    };
    for_each_camera_ray(rays, count, ray_of, [&](std::size_t i, const TracedRay& eye) {
        body(pixels[i % pixels.size()], eye, *samplers[i % samplers.size()]);
    });
}

/// The same for the pixels [begin, end).
template <typename Body>
void for_each_pixel(RayQueries& rays, PointSet points, std::uint64_t seed, std::uint32_t pass, std::size_t begin,
                    std::size_t end, Body&& body) {
    const int width = rays.scene().sensor().width();
    const auto row = static_cast<std::size_t>(width);
    PixelPlace next{static_cast<int>(begin % row), static_cast<int>(begin / row), begin};
    const auto place_of = [&](std::size_t) {
        const PixelPlace at = next;
        ++next.index;
        if (++next.x == width) {
            next.x = 0;
            ++next.y;
        }
        return at;
    };
    for_each_pixel_of(rays, points, seed, pass, end - begin, place_of, body);
}

/// Calls body(TracedRay, Sampler) for the paths [begin, end) of `count` that are spread evenly over the image, with independent
/// random numbers.
template <typename Body>
void for_paths_over_image(RayQueries& rays, std::uint64_t key, std::size_t begin, std::size_t end, std::size_t count,
                          const Body& body) {
    const Sensor& sensor = rays.scene().sensor();
    const std::size_t pixels = static_cast<std::size_t>(sensor.width()) * static_cast<std::size_t>(sensor.height());
    for (std::size_t i = begin; i < end; ++i) {
        const std::size_t pixel = i * pixels / count;
        for_each_pixel(rays, PointSet::independent, key, static_cast<std::uint32_t>(i), pixel, pixel + 1,
                       [&](std::size_t, const TracedRay& eye, const Sampler& sampler) { body(eye, sampler); });
    }
}

/// One thread samples a block of pixels.
inline constexpr std::size_t pixels_per_block = 256;
inline std::size_t pixel_blocks(const Sensor& sensor) {
    const std::size_t pixels = static_cast<std::size_t>(sensor.width()) * static_cast<std::size_t>(sensor.height());
    return (pixels + pixels_per_block - 1) / pixels_per_block;
}

/// A square of pixels, smaller at the right and lower edge of the image.
struct Tile {
    static constexpr int edge = 16;
    int x, y, width, height;  ///< [pixels]

    /// Tile `index` of the sensor's image.
    Tile(const Sensor& sensor, std::size_t index) {
        const std::size_t across = along(sensor.width());
        x = edge * static_cast<int>(index % across);
        y = edge * static_cast<int>(index / across);
        width = std::min(edge, sensor.width() - x);
        height = std::min(edge, sensor.height() - y);
    }
    static std::size_t count(const Sensor& sensor) { return along(sensor.width()) * along(sensor.height()); }

    std::size_t pixels() const { return static_cast<std::size_t>(width * height); }
    /// The pixels whose x and y have these remainders when divided by `apart`.
    std::vector<PixelPlace> every(int apart, int x_remainder, int y_remainder, const Sensor& sensor) const {
        std::vector<PixelPlace> places;
        for (int py = y + y_remainder; py < y + height; py += apart)
            for (int px = x + x_remainder; px < x + width; px += apart)
                places.push_back({px, py,
                                  static_cast<std::size_t>(py) * static_cast<std::size_t>(sensor.width()) +
                                      static_cast<std::size_t>(px)});
        return places;
    }

private:
    static std::size_t along(int side) { return static_cast<std::size_t>((side + edge - 1) / edge); }
};

/// Adds a sample of every pixel to the film and returns the number of rays traced. The time and the progress are
/// recorded in `stages` under the name `stage`. There are `blocks` of pixels; one thread samples a block:
/// sample_block(RayQueries&, block, add) calls add(pixel, sample) and returns how many pixels it has.
template <typename AnyFilm, typename SampleBlock>
std::uint64_t sample_blocks(const Scene& scene, AnyFilm& film, std::uint32_t pass, StageTimes& stages,
                            std::string_view stage, std::size_t blocks, SampleBlock&& sample_block) {
    const auto timer = stages.time(stage);
    const Sensor& sensor = scene.sensor();
    std::atomic<std::uint64_t> traced = 0;
    StageProgress progress(stages, stage,
                           static_cast<std::size_t>(sensor.width()) * static_cast<std::size_t>(sensor.height()));
    parallel_blocks(blocks, 1, [&](std::size_t block, std::size_t, std::size_t) {
        RayQueries rays(scene);
        const std::size_t pixels =
            sample_block(rays, block, [&](std::size_t pixel, const auto& sample) { film.add(pixel, pass, sample); });
        traced += rays.count();
        progress.add(pixels);
    });
    return traced;
}

/// The same for rows of pixels. `start_block()` returns the sampling function for one block of
/// pixels, PixelSample(RayQueries&, const TracedRay&, const Sampler&), which may own scratch memory and may take the
/// pixel's index as a fourth argument. AnyFilm is Film or a class with the same function add().
template <typename AnyFilm, typename StartBlock>
std::uint64_t sample_pixels(const Scene& scene, AnyFilm& film, PointSet points, std::uint64_t seed, std::uint32_t pass,
                            StageTimes& stages, std::string_view stage, StartBlock&& start_block) {
    const Sensor& sensor = scene.sensor();
    const std::size_t pixels = static_cast<std::size_t>(sensor.width()) * static_cast<std::size_t>(sensor.height());
    return sample_blocks(
        scene, film, pass, stages, stage, pixel_blocks(sensor),
        [&](RayQueries& rays, std::size_t block, const auto& add) {
            const std::size_t begin = block * pixels_per_block, end = std::min(begin + pixels_per_block, pixels);
            auto sample = start_block();
            for_each_pixel(rays, points, seed, pass, begin, end,
                           [&](std::size_t pixel, const TracedRay& eye, const Sampler& sampler) {
                               if constexpr (std::is_invocable_v<decltype(sample)&, RayQueries&, const TracedRay&,
                                                                 const Sampler&, std::size_t>)
                                   add(pixel, sample(rays, eye, sampler, pixel));
                               else add(pixel, sample(rays, eye, sampler));
                           });
            return end - begin;
        });
}

}  // namespace gib
