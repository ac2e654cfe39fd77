#pragma once
// Reads the parts of a scene file that say how its picture is taken: <sensor> with its film and
// sampler, and <integrator>.

#include "common/scene/sensor.h"
#include "common/xml/xml_properties.h"

#include <array>

namespace gib {

inline constexpr double most_image_pixels = 1e9;  ///< of any image that is rendered

/// The largest coordinate of a camera's or a light's position, and of their axes.
inline constexpr double largest_position = 1e18;

struct ParsedSensor {
    Sensor sensor;
    std::optional<int> sample_count;     ///< samples per pixel, as the sampler gives them
    std::optional<NestedObject> medium;  ///< medium that the sensor stands in
    /// x, y, width and height of a crop window in fractions of the film; none: the image is the whole film.
    std::optional<std::array<double, 4>> window = {};
};

/// Reads a sensor: perspective (fov or focal_length, fov_axis, principal_point_offset_x and _y), thinlens (fov or
/// focal_length, fov_axis, aperture_radius, focus_distance) or orthographic, all with to_world, near_clip, far_clip,
/// an hdrfilm and a sampler. Clip distances act only if they are given. A film's crop window becomes the image.
/// `resolution` replaces the image's width and height; a crop window then keeps its place on the film. Throws
/// InputError, also for an image of more than 1e9 samples.
ParsedSensor parse_sensor(const NestedObject& sensor, const XmlIds& ids,
                          const std::optional<std::pair<int, int>>& resolution);

/// Reads a perspective's field of view (fov with fov_axis, or focal_length). Returns half the width at distance 1 of an
/// image of width / height = `aspect`.
double parse_half_width(Properties& properties, double aspect);

/// The settings that methods take from an integrator.
struct ParsedIntegrator {
    int max_edges;        ///< edges of the longest path that Mitsuba's integrator follows; INT_MAX: unlimited
    bool hides_emitters;  ///< see Sensor::hides_emitters()
};

/// Reads an integrator; its other parameters have no effect. An integrator without a max_depth takes that of the one
/// inside it; emitters are hidden if either of them says so.
ParsedIntegrator parse_integrator(const NestedObject& integrator, const XmlIds& ids);

/// Throws InputError that says where the sensor of a scene belongs.
[[noreturn]] void refuse_without_sensor(const XmlElement& scene);

}  // namespace gib
