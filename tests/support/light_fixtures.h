#pragma once
// Environment maps and moments of light samples, shared by the tests of emitters.

#include "common/images/image_file.h"
#include "common/sampling/sampler.h"
#include "tests/support/moments.h"
#include "tests/support/scene_text.h"

#include <functional>

namespace gib::test {

/// An image whose texel in column x and row y is `value(x, y)`.
inline Image image_of(int width, int height, const std::function<Color(int, int)>& value) {
    Image image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            image.set(static_cast<std::size_t>(y * width + x), value(x, y));
    return image;
}

/// Random radiance in [0, 1), a pure function of the texel.
inline Color noise(int x, int y) {
    const Sampler sampler(PointSet::independent, 17, static_cast<std::uint64_t>(x), static_cast<std::uint32_t>(y));
    return {sampler.get_1d(0), sampler.get_1d(1), sampler.get_1d(2)};
}

/// An envmap <emitter> that shows `image`, which is written to map.exr in `folder`.
inline std::string envmap_xml(const TemporaryFolder& folder, const Image& image, const std::string& more = "") {
    write_exr(folder / "map.exr", {{{"", image}}, {}});
    return "<emitter type='envmap'><string name='filename' value='" + (folder / "map.exr") + "'/>" + more +
           "</emitter>";
}

/// The frame whose axes are those of the world.
inline Frame identity_frame() {
    Frame frame;
    frame.s = Vec3::UnitX();
    frame.t = Vec3::UnitY();
    frame.n = Vec3::UnitZ();
    return frame;
}

/// The direction with these angles, as Mitsuba's documentation of envmap defines them: theta
/// from +y, phi from -z towards +x.
inline Vec3 envmap_direction(double theta, double phi) {
    return Vec3d(std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)).cast<float>();
}

/// The integral of f over the sphere in envmap_direction's angles by the midpoint rule: `cells_theta` x `cells_phi`
/// cells with n x n points in each.
inline double sphere_integral(int cells_theta, int cells_phi, int n, const std::function<double(const Vec3&)>& f) {
    double sum = 0;
    const int rows = cells_theta * n, columns = cells_phi * n;
    for (int i = 0; i < rows; ++i) {
        const double theta = std::numbers::pi * (i + 0.5) / rows;
        for (int j = 0; j < columns; ++j)
            sum += f(envmap_direction(theta, 2 * std::numbers::pi * (j + 0.5) / columns)) * std::sin(theta);
    }
    return sum * 2 * sqr(std::numbers::pi) / (static_cast<double>(rows) * columns);
}

inline Moments moments_over_samples(int n, const std::function<double(const Sampler&)>& f) {
    Moments moments;
    for (int i = 0; i < n; ++i)
        moments.add(f(Sampler(PointSet::independent, 5, static_cast<std::uint64_t>(i), 0)));
    return moments;
}

}  // namespace gib::test
