#include "common/reader/scene_medium.h"

#include "common/core/reject.h"
#include "common/xml/scene_spectrum.h"

#include <algorithm>

namespace gib {

namespace {

/// The highest extinction after scaling [1/scene unit]. Its products with lengths, and their sums, must stay finite.
constexpr float highest_extinction = 1e9f;

PhaseFunction parse_phase(const NestedObject& object, const XmlIds& ids) {
    Properties properties(*object.element, ids);
    PhaseFunction phase;
    const std::string& type = properties.plugin({"isotropic", "hg", "rayleigh"});
    if (type == "rayleigh") phase.model = PhaseFunction::Model::rayleigh;
    if (type == "hg") {
        constexpr auto largest = static_cast<double>(PhaseFunction::largest_g);
        phase.g = static_cast<float>(properties.within("g", 0.8, -largest, largest));
    }
    properties.finish();
    return phase;
}

/// From points of the scene to the unit cube that `from_cube` carries into the file's coordinates.
Eigen::Affine3d to_cube(const Properties& properties, const Eigen::Affine3d& from_cube, const Vec3d& origin) {
    Eigen::Affine3d to_cube = from_cube.inverse() * Eigen::Translation3d(origin);
    if (!(std::abs(from_cube.linear().determinant()) > 0) || !to_cube.matrix().cast<float>().array().isFinite().all())
        properties.reject("to_world", "the to_world of the volume cannot be inverted");
    return to_cube;
}

GridVolume parse_constvolume(Properties& properties, ColorRange range, const Vec3d& origin) {
    const Color value = color_property(properties, "value", 1.f, range);
    const Mat4d to_world = properties.transform("to_world");
    properties.finish();
    return {value, to_cube(properties, Eigen::Affine3d(to_world), origin)};
}

/// Small negative cells, as interpolation leaves them, count as 0. Others are refused with the volume.
void clamp_noise(GridVolume::Data& data, const std::string& name, const Properties& properties) {
    const auto [lowest, highest] = std::minmax_element(data.values.begin(), data.values.end());
    const auto least = static_cast<double>(*lowest);
    if (!is_noise(least, static_cast<double>(*highest), ColorRange::non_negative)) return;
    properties.warn("filename", "'{}' must not be negative: cells below 0, down to {:g}, count as 0", name, least);
    for (float& value : data.values)
        value = std::max(value, 0.f);
}

/// Reads the grid of the parameter `name`.
GridVolume parse_gridvolume(Properties& properties, const std::string& name, TextureFiles& files, const Vec3d& origin) {
    const std::string file = properties.required_string("filename");
    const Mat4d to_world = properties.transform("to_world");
    const VolumeFilter filter =
        properties.chosen("filter_type", VolumeFilter::trilinear,
                          {{"nearest", VolumeFilter::nearest}, {"trilinear", VolumeFilter::trilinear}});
    // wrap_type is the name that scenes of this program had.
    properties.exclude("wrap_type", "wrap_mode");
    const Wrap old_wrap = properties.chosen("wrap_type", Wrap::clamp, wrap_names),
               wrap = properties.chosen("wrap_mode", old_wrap, wrap_names);
    const bool own_box = properties.boolean("use_grid_bbox", false);
    // Three options of Mitsuba have no effect here: values are always linear, there is one way to look them up, and their
    // largest one is known.
    properties.boolean("raw", false);
    properties.boolean("accel", true);
    properties.number("max_value");
    properties.finish();
    GridVolume::Data data = load_volume(files.path(file, properties.element_where("filename")));
    clamp_noise(data, name, properties);
    Eigen::Affine3d from_grid(to_world);
    if (own_box) {
        if (!(data.box.sizes().minCoeff() > 0))
            properties.reject("use_grid_bbox", "the box of the volume's file is empty");
        from_grid = from_grid * Eigen::Translation3d(data.box.min()) * Eigen::Scaling(data.box.sizes());
    }
    return {std::move(data), to_cube(properties, from_grid, origin), filter, wrap};
}

/// The parameter `name`: a <volume> with values within `range`, or a constant. Mitsuba reads a constant as a
/// constvolume without a to_world, whose cube is [0, 1]^3.
GridVolume parse_volume(Properties& properties, const std::string& name, float fallback, ColorRange range,
                        TextureFiles& files, const Vec3d& origin) {
    const auto nested = properties.named_object(name, "volume");
    if (!nested)
        return {color_property(properties, name, fallback, range), Eigen::Affine3d(Eigen::Translation3d(origin))};
    Properties volume(*nested->element, files.ids());
    if (volume.plugin({"constvolume", "gridvolume"}) == "constvolume") return parse_constvolume(volume, range, origin);
    GridVolume grid = parse_gridvolume(volume, name, files, origin);
    const float lowest = grid.lowest().minCoeff(), highest = grid.highest().maxCoeff();
    if (!(lowest >= 0)) reject(nested->where, "'{}' must not be negative, but its volume has {}", name, lowest);
    if (range == ColorRange::unit && !(highest <= 1))
        reject(nested->where, "'{}' must be between 0 and 1, but its volume has {}", name, highest);
    return grid;
}

float parse_scale(Properties& properties, const Color& highest) {
    const double scale = properties.not_negative("scale", 1);
    if (!(scale * static_cast<double>(highest.maxCoeff()) <= static_cast<double>(highest_extinction)))
        for (const char* name : {"scale", "sigma_t", "sigma_a", "sigma_s"})
            if (properties.has(name)) properties.reject(name, "an extinction above {:g}", highest_extinction);
    return static_cast<float>(scale);
}

/// The albedo may be a volume; its cube has no effect.
Medium parse_homogeneous(Properties& properties, const PhaseFunction& phase, TextureFiles& files, const Vec3d& origin) {
    Color extinction;
    std::optional<GridVolume> albedo;
    for (const std::string name : {"sigma_s", "sigma_a"})
        for (const std::string other : {"sigma_t", "albedo"})
            if (properties.has(name) && properties.has(other))
                properties.reject(name, "give either 'sigma_t' and 'albedo' or 'sigma_s' and 'sigma_a'");
    if (properties.has("sigma_s") || properties.has("sigma_a")) {
        const Color scattering = color_property(properties, "sigma_s", 0.f, ColorRange::non_negative),
                    absorption = color_property(properties, "sigma_a", 0.f, ColorRange::non_negative);
        extinction = scattering + absorption;
        albedo = GridVolume((extinction > 0.f).select(scattering / extinction, Color::Zero()));
        for (const char* name : {"sigma_t", "albedo"})
            properties.declare(name);
    } else {
        extinction = color_property(properties, "sigma_t", 1.f, ColorRange::non_negative);
        albedo = parse_volume(properties, "albedo", 0.75f, ColorRange::unit, files, origin);
        for (const char* name : {"sigma_s", "sigma_a"})
            properties.declare(name);
    }
    return {GridVolume(extinction), parse_scale(properties, extinction), *std::move(albedo), phase};
}

Medium parse_heterogeneous(Properties& properties, const PhaseFunction& phase, TextureFiles& files,
                           const Vec3d& origin) {
    GridVolume extinction = parse_volume(properties, "sigma_t", 1.f, ColorRange::non_negative, files, origin);
    GridVolume albedo = parse_volume(properties, "albedo", 0.75f, ColorRange::unit, files, origin);
    const float scale = parse_scale(properties, extinction.highest());
    return {std::move(extinction), scale, std::move(albedo), phase};
}

}  // namespace

Medium parse_medium(const NestedObject& object, TextureFiles& files, const Vec3d& origin) {
    Properties properties(*object.element, files.ids());
    const bool homogeneous = properties.plugin({"homogeneous", "heterogeneous"}) == "homogeneous";
    const auto phase = properties.object("phase");
    const PhaseFunction function = phase ? parse_phase(*phase, files.ids()) : PhaseFunction{};
    // These options control how Mitsuba's integrators sample. No image depends on them.
    properties.boolean("sample_emitters", true);
    properties.boolean("has_spectral_extinction", true);
    Medium medium = homogeneous ? parse_homogeneous(properties, function, files, origin)
                                : parse_heterogeneous(properties, function, files, origin);
    properties.finish();
    return medium;
}

}  // namespace gib
