#include "common/reader/scene_daylight.h"

#include "common/color/daylight.h"
#include "common/lights/sun_position.h"
#include "common/xml/scene_spectrum.h"

#include <limits>

namespace gib {

namespace {

constexpr double degree = std::numbers::pi / 180;

/// The sky is tabulated every 0.7 degrees in azimuth, and in 180 steps from the zenith to the horizon.
constexpr int columns = 512, rows_above_horizon = 181;

/// The unit vector at the angle theta to y whose azimuth runs from -z to x, as those of EnvironmentMap: north is -z.
Vec3d direction_at(double theta, double azimuth) {
    return {std::sin(theta) * std::sin(azimuth), std::cos(theta), -std::sin(theta) * std::cos(azimuth)};
}

double angle_between(const Vec3d& a, const Vec3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

SunAngles parse_sun_angles(Properties& properties, const Frame& map) {
    constexpr const char* place_names[] = {"latitude", "longitude", "timezone", "year",  "month",
                                           "day",      "hour",      "minute",   "second"};
    const auto direction = properties.point("sun_direction");
    if (direction)
        for (const char* name : place_names)
            properties.exclude(name, "sun_direction");
    TimeAndPlace at;
    at.latitude = properties.within("latitude", at.latitude, -90, 90);
    at.longitude = properties.within("longitude", at.longitude, -360, 360);
    at.timezone = properties.within("timezone", at.timezone, -24, 24);
    at.year = properties.integer("year", 1900, 2100).value_or(at.year);
    at.month = properties.integer("month", 1, 12).value_or(at.month);
    at.day = properties.integer("day", 1, 31).value_or(at.day);
    at.hour = properties.within("hour", at.hour, 0, 24);
    at.minute = properties.within("minute", at.minute, 0, 60);
    at.second = properties.within("second", at.second, 0, 60);
    if (!is_date(at)) properties.reject("day", "month {} of {} has no day {}", at.month, at.year, at.day);
    if (!direction) return sun_position(at);
    if (!(direction->stableNorm() > 0)) properties.reject("sun_direction", "'sun_direction' must not be zero");
    const Vec3d w = map.to_local(direction->stableNormalized().cast<float>()).cast<double>();
    return {angle_between(Vec3d::UnitY(), w), std::atan2(w.x(), -w.z())};
}

/// Colours in float. Throws InputError at the emitter if they do not fit.
Color checked(const Properties& properties, const Colord& radiance) {
    if (!(radiance.maxCoeff() <= std::numeric_limits<float>::max()))
        throw InputError(properties.element().where, "the light is too bright");
    return radiance.cast<float>();
}

/// How Mitsuba 0.6 shows the sky below its horizon.
struct BelowHorizon {
    double stretch;  ///< directions at the angle theta to the zenith show the sky at theta / stretch
    bool extend;     ///< whether the horizon's radiance goes on below it, and fades to black at the nadir
};

/// The part of the radiance that is left at the angle theta to the zenith: 3 x^2 - 2 x^3 for x from 1 at the horizon to
/// 0 at the nadir.
double fading(double theta) {
    const double x = std::min(2 - 2 * theta / std::numbers::pi, 1.0);
    return sqr(x) * (3 - 2 * x);
}

/// The angle to the zenith up to which there is a sky.
double reach_of(const BelowHorizon& below) {
    return below.extend ? std::numbers::pi : below.stretch * 0.5 * std::numbers::pi;
}

/// The sky from the zenith to reach_of(below).
Image sky_image(const Properties& properties, const ClearSky& sky, const SunAngles& sun, double scale,
                const BelowHorizon& below) {
    const Vec3d towards_sun = direction_at(sun.theta, sun.azimuth);
    const int rows = below.extend ? 2 * rows_above_horizon - 1 : rows_above_horizon;
    Image image(columns, rows);
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const double seen_at = reach_of(below) * row / (rows - 1);
            const double theta = std::min(seen_at / below.stretch, 0.5 * std::numbers::pi);
            const Vec3d w = direction_at(theta, 2 * std::numbers::pi * (column + 0.5) / columns);
            Colord radiance = scale * sky.radiance(w.y(), angle_between(w, towards_sun));
            if (below.extend) radiance *= fading(seen_at);
            image.set(static_cast<std::size_t>(row * columns + column), checked(properties, radiance));
        }
    return image;
}

/// The ratio of the disc's diameter to that of the sun; 0 makes parallel light.
double parse_sun_size(Properties& properties) {
    properties.exclude("sun_radius_scale", "sun_aperture");
    constexpr double least = 0.01, most = 180;  // degrees; float resolves the rim of the smallest disc to 1 %
    const double ratio = properties.not_negative("sun_radius_scale", 1);
    if (ratio > 0 && !(ratio * sun_diameter >= least && ratio * sun_diameter < most))
        properties.reject("sun_radius_scale", "a sun of {:g} degrees: it must be 0, or between {:g} and {:g}",
                          ratio * sun_diameter, least, most);
    const double aperture = properties.within("sun_aperture", sun_diameter, least, most);
    return properties.has("sun_aperture") ? aperture / sun_diameter : ratio;
}

double one_minus_cos(double angle) { return 2 * sqr(std::sin(0.5 * angle)); }

/// The sun as a disc, or as parallel light if its size is 0.
struct ParsedSun {
    std::optional<BrightDisc> disc;
    std::optional<DirectionalLight> parallel;
};

/// `radiance` is that of a disc of the true size, and `size` the ratio of the diameters.
ParsedSun sun_of(const Properties& properties, const Vec3& towards, const Colord& radiance, double size) {
    const double true_versine = one_minus_cos(0.5 * sun_diameter * degree);
    const double versine = one_minus_cos(0.5 * size * sun_diameter * degree);
    if (size > 0)
        return {
            BrightDisc{towards, static_cast<float>(versine), checked(properties, radiance * (true_versine / versine))},
            {}};
    return {{}, DirectionalLight{-towards, checked(properties, radiance * (2 * std::numbers::pi * true_versine)), {}}};
}

}  // namespace

std::vector<Light> parse_daylight(Properties& properties, const std::string& type, const Frame& axes) {
    const bool has_sky = type != "sun", has_sun = type != "sky", both = has_sky && has_sun;
    Frame map;  // x is east, y up and z south
    map.s = -axes.t;
    map.t = axes.n;
    map.n = -axes.s;
    const double turbidity = properties.within("turbidity", 3, least_turbidity, largest_turbidity);
    const SunAngles sun = parse_sun_angles(properties, map);
    BelowHorizon below{.stretch = properties.within("stretch", 1, 1, 2), .extend = false};
    const double scale = properties.not_negative("scale", 1);
    const double sky_scale = both ? properties.not_negative("sky_scale", scale) : scale;
    const double sun_scale = both ? properties.not_negative("sun_scale", scale) : scale;
    const double size = has_sun ? parse_sun_size(properties) : 1;
    properties.integer("resolution", 1);  // resolution of Mitsuba's table: without effect
    if (both) properties.boolean("complex_sun", false);
    const bool is_day = sun.theta <= 0.5 * std::numbers::pi;
    if (!is_day)
        properties.ids().warn(properties.element().where, "the sun is below the horizon, so that all is black");
    Image sky(1, 1);
    if (has_sky) {
        below.extend = properties.boolean("extend", false);
        const Color albedo = color_property(properties, "albedo", 0.3f, ColorRange::unit);
        if (is_day && sky_scale > 0)
            sky = sky_image(properties, ClearSky(turbidity, albedo.cast<double>(), sun.theta), sun, sky_scale, below);
    }
    ParsedSun parsed;
    if (has_sun && is_day && sun_scale > 0)
        parsed = sun_of(properties, map.to_world(direction_at(below.stretch * sun.theta, sun.azimuth).cast<float>()),
                        sun_scale * sun_radiance(turbidity, sun.theta), size);
    std::vector<Light> lights;
    if (parsed.parallel) lights.push_back(*parsed.parallel);
    if (has_sky || lights.empty())
        lights.push_back(MappedEnvironment{
            std::make_shared<const EnvironmentMap>(std::move(sky), map, reach_of(below), parsed.disc), {}});
    return lights;
}

}  // namespace gib
