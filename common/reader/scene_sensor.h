#pragma once
// The parts of a scene file that say how to take its picture: <sensor> with its film and sampler, and <integrator>.

#include "common/scene/sensor.h"
#include "common/xml/xml_properties.h"

namespace gib {

struct ParsedSensor {
    Sensor sensor;
    std::optional<int> sample_count;     ///< samples a pixel, of the sampler
    std::optional<NestedObject> medium;  ///< that the sensor stands in
};

/// perspective, thinlens (fov or focal_length, fov_axis; the first with principal_point_offset_x and _y, the second
/// with aperture_radius and focus_distance) or orthographic, all with to_world, near_clip, far_clip, an hdrfilm and a
/// sampler. Clip distances act only if they are given. A film's crop window becomes the image; `resolution` replaces
/// the image's width and height, and a crop window stays where it is on the film. Throws InputError, also for an image
/// of more than 1e9 samples.
ParsedSensor parse_sensor(const NestedObject& sensor, const XmlIds& ids,
                          const std::optional<std::pair<int, int>>& resolution);

/// The edges of the longest path, INT_MAX without a limit, of any of Mitsuba's integrators; its other parameters mean
/// nothing here. Throws InputError for hide_emitters.
int parse_max_edges(const NestedObject& integrator, const XmlIds& ids);

}  // namespace gib
