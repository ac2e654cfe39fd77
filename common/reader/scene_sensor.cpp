#include "common/reader/scene_sensor.h"

#include "common/core/float_traps.h"
#include "common/core/number_text.h"
#include "common/core/reject.h"

#include <algorithm>
#include <climits>

namespace gib {

namespace {

constexpr int deepest_integrator = 8;  ///< an integrator that refers to itself must not recurse for ever

ReconstructionFilter parse_filter(const NestedObject& filter, const XmlIds& ids) {
    Properties properties(*filter.element, ids);
    const std::string& type = properties.plugin({"box", "tent", "gaussian", "mitchell", "catmullrom", "lanczos"});
    const auto parse = [&] {
        const auto length = [&](const char* name, double fallback) {
            return static_cast<float>(properties.positive(name, fallback));
        };
        if (type == "box") return ReconstructionFilter::box(length("radius", 0.5));
        if (type == "tent") return ReconstructionFilter::tent(length("radius", 1));
        if (type != "gaussian") {
            // Pixels are sampled by the filter, which must not be negative therefore.
            ids.warn(filter.where, fmt::format("the filter '{}' has negative lobes: gaussian stands in for it", type));
            for (const char* name : {"A", "B", "a", "b", "lobes"})
                properties.number(name);
        }
        return ReconstructionFilter::gaussian(length("stddev", 0.5));
    };
    const ReconstructionFilter result = parse();
    properties.finish();
    return result;
}

/// The image is the window of the film that crop_offset_x, crop_offset_y, crop_width and crop_height give, by default
/// the whole film. As in Mitsuba, the window must lie on the film.
void parse_crop(Properties& properties, Sensor::Parameters& sensor) {
    const int film_width = sensor.width, film_height = sensor.height;
    const int x = properties.integer("crop_offset_x", 0).value_or(0),
              y = properties.integer("crop_offset_y", 0).value_or(0);
    sensor.width = properties.integer("crop_width", 1).value_or(film_width);
    sensor.height = properties.integer("crop_height", 1).value_or(film_height);
    const auto check = [&](int offset, int size, int film, const char* offset_name, const char* size_name) {
        if (offset <= film - size) return;
        const char* name = properties.has(offset_name) ? offset_name : size_name;
        properties.reject(name, "the crop window from {} to {} is not within the film's {} pixels", offset,
                          static_cast<std::int64_t>(offset) + size, film);
    };
    check(x, sensor.width, film_width, "crop_offset_x", "crop_width");
    check(y, sensor.height, film_height, "crop_offset_y", "crop_height");
    if (sensor.width != film_width || sensor.height != film_height)
        sensor.crop = Sensor::Crop{Vec2d(film_width, film_height), Vec2d(x, y)};
}

/// Changes the number of pixels of the same picture.
void set_resolution(Sensor::Parameters& sensor, const std::pair<int, int>& resolution) {
    const auto [width, height] = resolution;
    if (width < 1 || height < 1) reject({}, "a resolution of {} x {} has no pixels", width, height);
    if (sensor.crop) {
        const Vec2d scale(1.0 * width / sensor.width, 1.0 * height / sensor.height);
        sensor.crop = Sensor::Crop{sensor.crop->film.cwiseProduct(scale), sensor.crop->offset.cwiseProduct(scale)};
    }
    sensor.width = width;
    sensor.height = height;
}

/// Reads the filter of a film or of a sensor. Of several the last counts, as in Mitsuba 0.6.
void read_filter(Properties& properties, const XmlIds& ids, Sensor::Parameters& sensor) {
    const auto filters = properties.objects("rfilter");
    if (filters.size() > 1)
        ids.warn(filters.back().where,
                 fmt::format("<{}> has {} filters: the last one counts", properties.element().tag, filters.size()));
    if (!filters.empty()) sensor.filter = parse_filter(filters.back(), ids);
}

/// Reads the size of the image, its window and its filter from a film of any name. The rest says what Mitsuba does with the
/// image, which is the program's here.
void parse_film(const NestedObject& film, const XmlIds& ids, Sensor::Parameters& sensor) {
    Properties properties(*film.element, ids);
    const std::string& type = film.element->required("type").value;
    constexpr std::string_view known[] = {"hdrfilm",  "ldrfilm", "tiledhdrfilm", "mfilm",
                                          "specfilm", "exrfilm", "pngfilm"};
    if (std::find(std::begin(known), std::end(known), type) == std::end(known))
        ids.warn(film.where, fmt::format("film '{}': only its size, its window and its filter are read", type));
    sensor.width = properties.integer("width", 1).value_or(sensor.width);
    sensor.height = properties.integer("height", 1).value_or(sensor.height);
    parse_crop(properties, sensor);
    read_filter(properties, ids, sensor);
    properties.warn_of_unread({"pixel_format", "component_format", "file_format", "sample_border", "high_quality_edges",
                               "compensate", "banner", "gamma", "exposure", "key", "burn", "tonemap_method",
                               "attach_log", "alpha", "digits", "variable"});
}

/// The number of samples that a sampler of any name asks for. Methods draw their numbers in their own way. A number beyond
/// all budgets means that the user ends the run, and is left out.
std::optional<int> parse_sampler(const NestedObject& sampler, const XmlIds& ids) {
    Properties properties(*sampler.element, ids);
    const auto sample_count = properties.long_integer("sample_count", 1);
    properties.warn_of_unread({"seed", "jitter", "strength", "dimension", "scramble", "depth"});
    if (!sample_count) return std::nullopt;
    if (*sample_count <= INT_MAX) return static_cast<int>(*sample_count);
    properties.warn("sample_count", "a 'sample_count' above {} is left out: the method's 'spp' has its own default",
                    INT_MAX);
    return std::nullopt;
}

/// Parses a focal length [mm] for a film of 36 mm x 24 mm, such as "50mm".
double parse_focal_length(const std::string& text, const SourceLocation& where) {
    const auto value = number_from<double>(text.ends_with("mm") ? text.substr(0, text.size() - 2) : text);
    if (!value || !std::isfinite(*value) || *value <= 0)
        reject(where, "bad number '{}': expected a focal length such as 50mm", text);
    return *value;
}

void parse_field_of_view(Properties& properties, Sensor::Parameters& sensor) {
    const auto fov = properties.number("fov");
    const auto focal_length = properties.string("focal_length");
    properties.exclude("focal_length", "fov");
    if (!fov) {
        // Mitsuba's default: the diagonal of a 35 mm film behind a lens of 50 mm.
        const double f = parse_focal_length(focal_length.value_or("50mm"), properties.where("focal_length"));
        sensor.fov = 2 * std::atan(std::hypot(36.0, 24.0) / (2 * f)) * 180 / std::numbers::pi;
        sensor.fov_axis = Sensor::FovAxis::diagonal;
        return;
    }
    if (!(*fov > 0 && *fov < 180)) properties.reject("fov", "'fov' must be between 0 and 180 degrees, not {}", *fov);
    sensor.fov = *fov;
    using Axis = Sensor::FovAxis;
    sensor.fov_axis = properties.chosen("fov_axis", Axis::x,
                                        {{"x", Axis::x},
                                         {"y", Axis::y},
                                         {"diagonal", Axis::diagonal},
                                         {"smaller", Axis::smaller},
                                         {"larger", Axis::larger}});
}

/// Reads the lens of a thinlens. A perspective may give a focus_distance too, which has no effect without a lens.
void parse_lens(Properties& properties, bool thinlens, Sensor::Parameters& sensor) {
    // As in Mitsuba, the default is the far clip distance, whose own default is 1e4.
    const double far_clip = std::isfinite(sensor.far_clip) ? static_cast<double>(sensor.far_clip) : 1e4;
    const double focus_distance = properties.number("focus_distance", far_clip);
    if (!thinlens) return;
    properties.require("aperture_radius");
    sensor.aperture_radius = properties.not_negative("aperture_radius", 0);
    sensor.focus_distance = properties.positive("focus_distance", focus_distance);
}

/// Refuses a camera-to-world transform that changes lengths, by Mitsuba's test and tolerance.
void refuse_scale(const Properties& properties, const Mat4d& to_world) {
    for (int i = 0; i < 3; ++i)
        if (std::abs(to_world.block<3, 1>(0, i).squaredNorm() - 1) > 1e-3)
            properties.reject("to_world", "the to_world of a perspective sensor must not scale");
}

void parse_clip_distances(Properties& properties, Sensor::Parameters& sensor) {
    // The defaults cut nothing off; they are not Mitsuba's.
    const double near_clip = properties.positive("near_clip", 1), far_clip = properties.positive("far_clip", 1);
    if (properties.has("near_clip")) sensor.near_clip = static_cast<float>(near_clip);
    if (properties.has("far_clip")) sensor.far_clip = static_cast<float>(far_clip);
    if (!(sensor.near_clip < sensor.far_clip)) properties.reject("near_clip", "'near_clip' must be below 'far_clip'");
}

/// Whether the rays through the film's corners, which point furthest to the side, have directions. An angle of view
/// near 180 degrees, an offset or a filter can be so large that float cannot hold the square of a ray's length.
bool has_sound_rays(const Sensor& sensor) {
    const FloatTrapsPaused paused;  // the test below looks for overflows
    for (const int x : {0, sensor.width() - 1})
        for (const int y : {0, sensor.height() - 1})
            for (const float u : {0.f, 1.f})
                for (const float v : {0.f, 1.f}) {
                    const Ray ray = sensor.generate_ray(x, y, {u, v});
                    if (!ray.o.array().isFinite().all() || !(std::abs(ray.d.norm() - 1.f) < 1e-3f)) return false;
                }
    return true;
}

ParsedIntegrator integrator_of(const NestedObject& integrator, const XmlIds& ids, int depth) {
    if (depth == deepest_integrator) throw InputError(integrator.where, "integrators are nested too deeply");
    Properties properties(*integrator.element, ids);
    const std::string& type = integrator.element->required("type").value;
    const bool hides = properties.boolean("hide_emitters", false);
    if (type == "direct" || type == "direct_projective") return {2, hides};
    const auto max_depth = properties.integer("max_depth", -1);
    constexpr std::string_view known[] = {
        "path",       "direct", "volpath", "volpathmis",        "ptracer",        "prb",    "prb_basic",
        "prbvolpath", "aov",    "moment",  "direct_projective", "prb_projective", "stokes", "depth"};
    if (std::find(std::begin(known), std::end(known), type) == std::end(known))
        ids.warn(integrator.where, fmt::format("integrator '{}': the method is chosen by its name here; {}", type,
                                               max_depth ? "only max_depth and hide_emitters are taken from it"
                                                         : "only hide_emitters is taken from it"));
    if (max_depth) return {*max_depth < 0 ? INT_MAX : *max_depth, hides};
    const auto nested = properties.objects("integrator");
    if (nested.empty()) return {INT_MAX, hides};
    const ParsedIntegrator inner = integrator_of(nested[0], ids, depth + 1);
    return {inner.max_edges, inner.hides_emitters || hides};
}

}  // namespace

double parse_half_width(Properties& properties, double aspect) {
    Sensor::Parameters view;
    parse_field_of_view(properties, view);
    return Sensor::tan_half_width(view.fov, view.fov_axis, aspect);
}

ParsedSensor parse_sensor(const NestedObject& sensor, const XmlIds& ids,
                          const std::optional<std::pair<int, int>>& resolution) {
    Properties properties(*sensor.element, ids);
    Sensor::Parameters parameters;
    parameters.to_world = properties.transform("to_world");
    for (const double x : parameters.to_world.reshaped())
        if (!(std::abs(x) <= largest_position)) properties.reject("to_world", "the sensor is too far away");
    const std::string& type = properties.plugin({"perspective", "thinlens", "orthographic"});
    if (type == "orthographic") {
        parameters.projection = Sensor::Projection::orthographic;
    } else {
        parse_field_of_view(properties, parameters);
        refuse_scale(properties, parameters.to_world);
    }
    if (type == "perspective")
        parameters.principal_point_offset = {properties.number("principal_point_offset_x", 0),
                                             properties.number("principal_point_offset_y", 0)};
    parse_clip_distances(properties, parameters);
    parse_lens(properties, type == "thinlens", parameters);
    // Shutter times have no effect, because nothing moves.
    for (const char* name : {"shutter_open", "shutter_close"})
        properties.number(name);
    const auto medium = properties.object("medium");
    const auto film = properties.object("film"), sampler = properties.object("sampler");
    read_filter(properties, ids, parameters);  // some exporters write it here; that of the film goes before
    if (film) parse_film(*film, ids, parameters);
    if (resolution) set_resolution(parameters, *resolution);
    const auto sample_count = sampler ? parse_sampler(*sampler, ids) : std::nullopt;
    properties.finish();
    if (1.0 * parameters.width * parameters.height > most_image_pixels)
        reject(film ? film->where : sensor.where, "an image of {} x {} pixels is above {:g} pixels", parameters.width,
               parameters.height, most_image_pixels);
    const Sensor result(parameters);
    if (!has_sound_rays(result))
        throw InputError(film ? film->where : sensor.where, "the film reaches too far from the view's axis");
    std::optional<std::array<double, 4>> window;
    if (const auto& crop = parameters.crop) {
        const Vec2d offset = crop->offset.cwiseQuotient(crop->film),
                    size = Vec2d(parameters.width, parameters.height).cwiseQuotient(crop->film);
        window = {offset.x(), offset.y(), size.x(), size.y()};
    }
    return {result, sample_count, medium, window};
}

ParsedIntegrator parse_integrator(const NestedObject& integrator, const XmlIds& ids) {
    return integrator_of(integrator, ids, 0);
}

namespace {

/// The first sensor below the element; null if there is none.
const XmlElement* nested_sensor(const XmlElement& element) {
    for (const auto& child : element.children) {
        if (child.tag == "sensor") return &child;
        if (const XmlElement* sensor = nested_sensor(child)) return sensor;
    }
    return nullptr;
}

}  // namespace

void refuse_without_sensor(const XmlElement& scene) {
    if (const XmlElement* sensor = nested_sensor(scene))
        reject(sensor->where,
               "the scene has no sensor: this one would measure the element that it stands in; a camera is "
               "a child of <scene>");
    reject(scene.where,
           "the scene has no sensor: add a <sensor type=\"perspective\"> with a to_world and a <film>, or "
           "include this file in a scene that has them");
}

}  // namespace gib
