#pragma once
// The parts of a scene file that say how to take its picture: <sensor> with its film and sampler, and <integrator>.

#include "common/sensor.h"
#include "common/xml_properties.h"

namespace gib {

struct ParsedSensor {
    Sensor sensor;
    std::optional<int> sample_count;  ///< samples a pixel, of the sampler
};

/// perspective (fov or focal_length, fov_axis, principal_point_offset_x and _y) or orthographic, both with to_world,
/// near_clip, far_clip, an hdrfilm and a sampler. Clip distances act only if they are given. `resolution` replaces the
/// film's width and height. Throws InputError, also for a film of more than 1e9 samples.
ParsedSensor parse_sensor(const NestedObject& sensor, const XmlIds& ids,
                          const std::optional<std::pair<int, int>>& resolution);

/// The edges of the longest path, INT_MAX without a limit, of any of Mitsuba's integrators; its other parameters mean
/// nothing here. Throws InputError for hide_emitters.
int parse_max_edges(const NestedObject& integrator, const XmlIds& ids);

}  // namespace gib
