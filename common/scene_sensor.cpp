#include "common/scene_sensor.h"

#include <fmt/format.h>
#include <charconv>
#include <climits>

namespace gib {

namespace {

constexpr double most_samples = 1e9;
constexpr double largest_coordinate = 1e18;  ///< of the camera, as for shapes (scene_shape.cpp)
constexpr int deepest_integrator = 8;        ///< an integrator that refers to itself must not recurse for ever

ReconstructionFilter parse_filter(const NestedObject& filter, const XmlIds& ids) {
    Properties properties(*filter.element, ids);
    const bool is_box = properties.plugin({"box", "gaussian"}) == "box";
    const ReconstructionFilter result =
        is_box ? ReconstructionFilter::box(static_cast<float>(properties.positive("radius", 0.5)))
               : ReconstructionFilter::gaussian(static_cast<float>(properties.positive("stddev", 0.5)));
    properties.finish();
    return result;
}

void parse_film(const NestedObject& film, const XmlIds& ids, Sensor::Parameters& sensor) {
    Properties properties(*film.element, ids);
    properties.plugin({"hdrfilm"});
    sensor.width = properties.integer("width", 1).value_or(sensor.width);
    sensor.height = properties.integer("height", 1).value_or(sensor.height);
    // What Mitsuba writes is not what gibench writes: these are checked, and mean nothing here.
    properties.choice("pixel_format", "rgb", {"luminance", "luminance_alpha", "rgb", "rgba", "xyz", "xyza"});
    properties.choice("component_format", "float16", {"float16", "float32", "uint32"});
    properties.choice("file_format", "openexr", {"openexr", "exr", "rgbe", "pfm"});
    properties.boolean("sample_border", false);
    properties.boolean("compensate", false);
    properties.boolean("banner", false);
    for (const char* name : {"crop_offset_x", "crop_offset_y", "crop_width", "crop_height"})
        if (properties.has(name)) throw InputError(properties.where(name), "crop windows are not supported yet");
    if (const auto filter = properties.object("rfilter")) sensor.filter = parse_filter(*filter, ids);
    properties.finish();
}

std::optional<int> parse_sampler(const NestedObject& sampler, const XmlIds& ids) {
    Properties properties(*sampler.element, ids);
    const std::string& type =
        properties.plugin({"independent", "stratified", "multijitter", "orthogonal", "ldsampler"});
    const auto sample_count = properties.integer("sample_count", 1);
    properties.integer("seed", INT_MIN);
    if (type == "stratified" || type == "multijitter" || type == "orthogonal") properties.boolean("jitter", true);
    if (type == "orthogonal") properties.integer("strength", 1);
    properties.finish();
    return sample_count;
}

/// Millimetres on a film of 36 x 24, as in "50mm".
double parse_focal_length(const std::string& text, const SourceLocation& where) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::string unit(end, text.data() + text.size());
    if (error != std::errc() || (!unit.empty() && unit != "mm") || !(value > 0) || !std::isfinite(value))
        throw InputError(where, fmt::format("bad number '{}': expected a focal length such as 50mm", text));
    return value;
}

void parse_field_of_view(Properties& properties, Sensor::Parameters& sensor) {
    const auto fov = properties.number("fov");
    const auto focal_length = properties.string("focal_length");
    if (fov && focal_length) throw InputError(properties.where("focal_length"), "give either 'fov' or 'focal_length'");
    if (!fov) {
        // Mitsuba's default: the diagonal of a 35 mm film behind a lens of 50 mm.
        const double f = parse_focal_length(focal_length.value_or("50mm"), properties.where("focal_length"));
        sensor.fov = 2 * std::atan(std::hypot(36.0, 24.0) / (2 * f)) * 180 / std::numbers::pi;
        sensor.fov_axis = Sensor::FovAxis::diagonal;
        return;
    }
    if (!(*fov > 0 && *fov < 180))
        throw InputError(properties.where("fov"), fmt::format("'fov' must be between 0 and 180 degrees, not {}", *fov));
    sensor.fov = *fov;
    using Axis = Sensor::FovAxis;
    const std::map<std::string, Axis> axes{{"x", Axis::x},
                                           {"y", Axis::y},
                                           {"diagonal", Axis::diagonal},
                                           {"smaller", Axis::smaller},
                                           {"larger", Axis::larger}};
    sensor.fov_axis = axes.at(properties.choice("fov_axis", "x", {"x", "y", "diagonal", "smaller", "larger"}));
}

/// Mitsuba's test and tolerance: the camera-to-world transform keeps lengths.
void refuse_scale(const Properties& properties, const Mat4d& to_world) {
    for (int i = 0; i < 3; ++i)
        if (std::abs(to_world.block<3, 1>(0, i).squaredNorm() - 1) > 1e-3)
            throw InputError(properties.where("to_world"), "the to_world of a perspective sensor must not scale");
}

void parse_clip_distances(Properties& properties, Sensor::Parameters& sensor) {
    // The values for files without them are those that cut nothing off, not Mitsuba's.
    const double near_clip = properties.positive("near_clip", 1), far_clip = properties.positive("far_clip", 1);
    if (properties.has("near_clip")) sensor.near_clip = static_cast<float>(near_clip);
    if (properties.has("far_clip")) sensor.far_clip = static_cast<float>(far_clip);
    if (!(sensor.near_clip < sensor.far_clip))
        throw InputError(properties.where("near_clip"), "'near_clip' must be below 'far_clip'");
}

int max_edges_of(const NestedObject& integrator, const XmlIds& ids, int depth) {
    if (depth == deepest_integrator) throw InputError(integrator.where, "integrators are nested too deeply");
    Properties properties(*integrator.element, ids);
    const std::string& type =
        properties.plugin({"path", "direct", "volpath", "volpathmis", "ptracer", "prb", "prb_basic", "prbvolpath",
                           "direct_projective", "prb_projective", "aov", "moment", "stokes", "depth"});
    if (properties.boolean("hide_emitters", false))
        throw InputError(properties.where("hide_emitters"), "'hide_emitters' is not supported yet");
    if (type == "direct" || type == "direct_projective") return 2;
    const auto max_depth = properties.integer("max_depth", -1);
    if (max_depth) return *max_depth < 0 ? INT_MAX : *max_depth;
    const auto nested = properties.objects("integrator");
    return nested.empty() ? INT_MAX : max_edges_of(nested[0], ids, depth + 1);
}

}  // namespace

ParsedSensor parse_sensor(const NestedObject& sensor, const XmlIds& ids,
                          const std::optional<std::pair<int, int>>& resolution) {
    Properties properties(*sensor.element, ids);
    Sensor::Parameters parameters;
    parameters.to_world = properties.transform("to_world");
    for (const double x : parameters.to_world.reshaped())
        if (!(std::abs(x) <= largest_coordinate))
            throw InputError(properties.where("to_world"), "the sensor is too far away");
    if (properties.plugin({"perspective", "orthographic"}) == "perspective") {
        parse_field_of_view(properties, parameters);
        refuse_scale(properties, parameters.to_world);
        parameters.principal_point_offset = {properties.number("principal_point_offset_x", 0),
                                             properties.number("principal_point_offset_y", 0)};
    } else {
        parameters.projection = Sensor::Projection::orthographic;
    }
    parse_clip_distances(properties, parameters);
    // Mitsuba's sensors take these too; without a lens and without motion they change nothing.
    for (const char* name : {"focus_distance", "shutter_open", "shutter_close"})
        properties.number(name);
    const auto film = properties.object("film"), sampler = properties.object("sampler");
    if (film) parse_film(*film, ids, parameters);
    if (resolution) {
        std::tie(parameters.width, parameters.height) = *resolution;
        if (parameters.width < 1 || parameters.height < 1)
            throw InputError(fmt::format("a resolution of {} x {} has no pixels", parameters.width, parameters.height));
    }
    const auto sample_count = sampler ? parse_sampler(*sampler, ids) : std::nullopt;
    properties.finish();
    const double samples = 1.0 * parameters.width * parameters.height * sample_count.value_or(1);
    if (samples > most_samples)
        throw InputError(film ? film->where : sensor.where,
                         fmt::format("a film of {} x {} pixels with {} samples each is above {:g} samples",
                                     parameters.width, parameters.height, sample_count.value_or(1), most_samples));
    return {Sensor(parameters), sample_count};
}

int parse_max_edges(const NestedObject& integrator, const XmlIds& ids) { return max_edges_of(integrator, ids, 0); }

}  // namespace gib
