#include "common/reader/scene_emitter.h"

#include "common/core/reject.h"
#include "common/images/linear_file.h"
#include "common/reader/scene_daylight.h"
#include "common/reader/scene_sensor.h"
#include "common/xml/scene_spectrum.h"

namespace gib {

namespace {

constexpr double rigid_tolerance = 1e-3;  ///< tolerance of squared lengths and dot products, as for cameras

/// Checks Mitsuba's relative share of the light samples. It changes no image, except that 0 switches light sampling
/// off; this is refused.
void check_sampling_weight(Properties& properties) { properties.positive("sampling_weight", 1); }

Vec3 recentred_position(const Properties& properties, const Vec3d& position, const Vec3d& origin) {
    const Vec3d p = position - origin;
    if (!(p.lpNorm<Eigen::Infinity>() <= largest_position))
        throw InputError(properties.element().where, "the emitter is too far away");
    return p.cast<float>();
}

/// The directions of to_world's axes, which must be orthogonal and of equal length: 1, unless `may_scale`.
Frame rigid_axes(const Properties& properties, const Mat4d& to_world, bool may_scale) {
    const Eigen::Matrix3d linear = to_world.topLeftCorner<3, 3>();
    const double scale = may_scale ? std::cbrt(std::abs(linear.determinant())) : 1;
    const Eigen::Matrix3d axes = linear / scale;
    if (!((axes.transpose() * axes - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= rigid_tolerance))
        properties.reject("to_world", "the to_world of '{}' must not {}", properties.element().find("type")->value,
                          may_scale ? "shear or scale its axes differently" : "scale or shear");
    // Errors within the tolerance are removed.
    const Vec3d z = axes.col(2).normalized();
    const Vec3d x = (axes.col(0) - z.dot(axes.col(0)) * z).normalized();
    const Vec3d y = z.cross(x) * (axes.determinant() < 0 ? -1.0 : 1.0);
    Frame frame;
    frame.s = x.cast<float>();
    frame.t = y.cast<float>();
    frame.n = z.cast<float>();
    return frame;
}

PointLight parse_point(Properties& properties, const Vec3d& origin) {
    const auto position = properties.point("position");
    const Mat4d to_world = properties.transform("to_world");
    properties.exclude("to_world", "position");
    const Color intensity = color_property(properties, "intensity", 1, ColorRange::emission);
    return {recentred_position(properties, position.value_or(Vec3d(to_world.topRightCorner<3, 1>())), origin),
            intensity};
}

/// The smallest cut-off angle [degrees]. A narrower cone is less than a thousand float directions wide, so that
/// rounding would change its light by more than a thousandth.
constexpr double least_cutoff = 1e-3;

SpotLight parse_spot(Properties& properties, TextureFiles& files, const Vec3d& origin) {
    const Mat4d to_world = properties.transform("to_world");
    const Color intensity = color_property(properties, "intensity", 1, ColorRange::emission);
    const double cutoff = properties.within("cutoff_angle", 20, least_cutoff, 180);
    const double beam = properties.within("beam_width", 0.75 * cutoff, 0, cutoff);
    std::optional<Texture> slide;
    const Texture texture = parse_textured(properties, "texture", 1, ColorRange::non_negative, files);
    if (properties.has("texture")) {
        if (texture.constant()) properties.reject("texture", "the 'texture' of a spot must vary: a <texture>");
        if (!(cutoff < 90))
            properties.reject("cutoff_angle", "a spot with a texture needs a 'cutoff_angle' below 90, not {}", cutoff);
        slide = texture;
    }
    constexpr double radians = std::numbers::pi / 180;
    return {recentred_position(properties, to_world.topRightCorner<3, 1>(), origin),
            rigid_axes(properties, to_world, true),
            intensity,
            cutoff * radians,
            beam * radians,
            std::move(slide)};
}

/// A beam without width (Mitsuba 0.6's `collimated`), which no path would meet: the narrowest spot of the same power.
SpotLight parse_collimated(Properties& properties, const Vec3d& origin) {
    const Mat4d to_world = properties.transform("to_world");
    const Color power = color_property(properties, "power", 1, ColorRange::emission);
    properties.ids().warn(
        properties.element().where,
        fmt::format("'collimated' is read as a spot of the same power whose 'cutoff_angle' is {} degrees",
                    least_cutoff));
    const double cutoff = least_cutoff * std::numbers::pi / 180;
    const double solid_angle = 4 * std::numbers::pi * sqr(std::sin(cutoff / 2));  // of a cone
    return {recentred_position(properties, to_world.topRightCorner<3, 1>(), origin),
            rigid_axes(properties, to_world, true),
            power / static_cast<float>(solid_angle),
            cutoff,
            cutoff,
            std::nullopt};
}

ProjectorLight parse_projector(Properties& properties, TextureFiles& files, const Vec3d& origin) {
    const Mat4d to_world = properties.transform("to_world");
    const Texture image = parse_textured(properties, "irradiance", 1, ColorRange::emission, files);
    const auto scale = static_cast<float>(properties.not_negative("scale", 1));
    const double half_width = parse_half_width(properties, image.aspect());
    return {recentred_position(properties, to_world.topRightCorner<3, 1>(), origin),
            rigid_axes(properties, to_world, false),
            image,
            scale,
            half_width,
            image.aspect()};
}

DirectionalLight parse_directional(Properties& properties) {
    const auto direction = properties.point("direction");
    const Mat4d to_world = properties.transform("to_world");
    properties.exclude("to_world", "direction");
    const Vec3d z = direction.value_or(Vec3d(to_world.block<3, 1>(0, 2)));
    if (!(z.stableNorm() > 0)) properties.reject("direction", "'direction' must not be zero");
    return {z.stableNormalized().cast<float>(), color_property(properties, "irradiance", 1, ColorRange::emission), {}};
}

MappedEnvironment parse_envmap(Properties& properties, TextureFiles& files) {
    const std::string name = properties.required_string("filename");
    const Frame axes = rigid_axes(properties, properties.transform("to_world"), false);
    const auto scale = static_cast<float>(properties.not_negative("scale", 1));
    properties.boolean("mis_compensation", false);  // changes Mitsuba's sampling, not its image
    const std::string path = files.path(name, properties.element_where("filename"));
    LinearImage image = load_linear_image(path);
    const auto width = static_cast<std::size_t>(image.width);
    for (std::size_t i = 0; i < image.rgb.size(); ++i) {
        if (!(image.rgb[i] >= 0))
            reject({path, 0, 0}, "the pixel in column {}, row {} is negative: {}", i / 3 % width, i / 3 / width,
                   image.rgb[i]);
        image.rgb[i] *= scale;
        if (!std::isfinite(image.rgb[i])) properties.reject("scale", "'scale' is too large for '{}': {}", name, scale);
    }
    return {std::make_shared<const EnvironmentMap>(std::move(image), axes), {}};
}

}  // namespace

Texture parse_area_emitter(const NestedObject& emitter, TextureFiles& files) {
    Properties properties(*emitter.element, files.ids());
    properties.plugin({"area"});
    check_sampling_weight(properties);
    Texture radiance = parse_textured(properties, "radiance", 1, ColorRange::emission, files);
    properties.finish();
    return radiance;
}

std::vector<Light> parse_emitter(const NestedObject& emitter, TextureFiles& files, const Vec3d& origin) {
    Properties properties(*emitter.element, files.ids());
    const std::string& type = properties.plugin({"point", "spot", "projector", "directional", "constant", "envmap",
                                                 "sunsky", "sky", "sun", "area", "collimated"});
    if (type == "area") throw InputError(emitter.where, "an area emitter must stand in a shape");
    check_sampling_weight(properties);
    const auto parse = [&]() -> std::vector<Light> {
        if (type == "point") return {parse_point(properties, origin)};
        if (type == "spot") return {parse_spot(properties, files, origin)};
        if (type == "collimated") return {parse_collimated(properties, origin)};
        if (type == "projector") return {parse_projector(properties, files, origin)};
        if (type == "directional") return {parse_directional(properties)};
        if (type == "envmap") return {parse_envmap(properties, files)};
        if (type == "sunsky" || type == "sky" || type == "sun")
            return parse_daylight(properties, type, rigid_axes(properties, properties.transform("to_world"), false));
        return {ConstantEnvironment{color_property(properties, "radiance", 1, ColorRange::emission), {}}};
    };
    std::vector<Light> lights = parse();
    properties.finish();
    return lights;
}

}  // namespace gib
