#include "common/scene_file.h"

#include "common/scene_bsdf.h"
#include "common/scene_sensor.h"
#include "common/scene_shape.h"

#include <fmt/format.h>
#include <climits>
#include <filesystem>

namespace gib {

namespace {

/// Collects the objects of a <scene>.
class SceneBuilder {
public:
    SceneBuilder(const ExpandedXml& xml, ContentHash& hash) : ids_(xml.root), files_(xml.files), hash_(hash) {}

    void add_bsdf(const NestedObject& bsdf) { material_index(*bsdf.element); }

    void add_shape(const NestedObject& object) {
        Properties properties(*object.element, ids_);
        Pending pending{object.where, std::nullopt, {}, 0, std::nullopt};
        const auto bsdf = properties.object("bsdf"), emitter = properties.object("emitter");
        properties.number("silhouette_sampling_weight");  // Mitsuba's, for derivatives
        pending.shape = parse_shape(properties, files_, hash_);
        properties.finish();
        if (emitter) {
            pending.radiance = parse_area_light(*emitter);
            pending.emitter_where = emitter->where;
        }
        pending.material = bsdf ? material_index(*bsdf->element) : default_material(emitter.has_value());
        bounds_.extend(bounds_of(*pending.shape));
        pending_.push_back(std::move(pending));
    }

    void add_emitter(const NestedObject& emitter) {
        Properties properties(*emitter.element, ids_);
        if (properties.plugin({"point", "area"}) == "area")
            throw InputError(emitter.where, "an area emitter must stand in a shape");
        const auto position = properties.point("position");
        const Mat4d to_world = properties.transform("to_world");
        if (position && properties.has("to_world"))
            throw InputError(properties.where("to_world"), "give either 'position' or 'to_world'");
        const Color intensity = properties.color("intensity", 1, ColorRange::non_negative);
        properties.finish();
        points_.push_back({position.value_or(Vec3d(to_world.topRightCorner<3, 1>())), intensity, emitter.where});
    }

    /// Moves the scene's centre to the origin: float holds positions near it best.
    SceneParts finish(const XmlElement& root, Sensor sensor) {
        if (pending_.empty()) throw InputError(root.where, "the scene is empty: it has no shape");
        SceneParts parts;
        parts.origin = bounds_.center();
        if (!parts.origin.allFinite()) throw InputError(root.where, "the scene is too large");
        for (auto& p : pending_) {
            SceneParts::Object object{recentred(std::move(*p.shape), parts.origin, p.where), p.material, p.radiance};
            if (p.radiance && !(area_of(object.shape) > 0))
                throw InputError(p.emitter_where, "an area emitter on a shape without area");
            parts.objects.push_back(std::move(object));
        }
        for (const auto& point : points_) {
            const Vec3 position = (point.position - parts.origin).cast<float>();
            if (!(position.lpNorm<Eigen::Infinity>() <= 1e18f))
                throw InputError(point.where, "the emitter is too far away");
            parts.point_lights.push_back({position, point.intensity});
        }
        parts.materials = std::move(materials_);
        parts.sensor = std::move(sensor);
        return parts;
    }

    const XmlIds& ids() const { return ids_; }

private:
    struct Pending {
        SourceLocation where;
        std::optional<ParsedShape> shape;
        SourceLocation emitter_where;
        std::uint32_t material;
        std::optional<Color> radiance;
    };
    struct PendingPoint {
        Vec3d position;
        Color intensity;
        SourceLocation where;
    };

    Color parse_area_light(const NestedObject& emitter) {
        Properties properties(*emitter.element, ids_);
        properties.plugin({"area"});
        const Color radiance = properties.color("radiance", 1, ColorRange::non_negative);
        properties.finish();
        return radiance;
    }

    /// A bsdf that several shapes refer to is one material.
    std::uint32_t material_index(const XmlElement& element) {
        const auto [it, is_new] = material_of_element_.emplace(&element, static_cast<std::uint32_t>(materials_.size()));
        if (is_new) materials_.push_back(parse_bsdf(element, ids_));
        return it->second;
    }

    /// Mitsuba's: a grey diffuse surface, and a black one on a light.
    std::uint32_t default_material(bool emitter) {
        auto& index = default_materials_[emitter];
        if (!index) {
            index = static_cast<std::uint32_t>(materials_.size());
            materials_.emplace_back(Scattering(Diffuse{Color::Constant(emitter ? 0.f : 0.5f)}));
        }
        return *index;
    }

    XmlIds ids_;
    const FileFinder& files_;
    ContentHash& hash_;
    std::vector<Pending> pending_;
    std::vector<PendingPoint> points_;
    std::vector<Material> materials_;
    std::map<const XmlElement*, std::uint32_t> material_of_element_;
    std::optional<std::uint32_t> default_materials_[2];
    BoundsD bounds_;
};

}  // namespace

LoadedScene parse_scene(const std::string& xml, const std::string& path, const SceneLoadOptions& options) {
    ContentHash hash;
    if (options.resolution)
        hash.add(fmt::format("resolution {} x {}", options.resolution->first, options.resolution->second));
    const ExpandedXml expanded = expand_xml(xml, path, options.parameters, hash);
    SceneBuilder builder(expanded, hash);
    Properties scene(expanded.root, builder.ids());
    const auto integrator = scene.object("integrator"), sensor = scene.object("sensor");
    const auto bsdfs = scene.objects("bsdf"), shapes = scene.objects("shape"), emitters = scene.objects("emitter");
    scene.finish();
    if (!sensor) throw InputError(expanded.root.where, "the scene has no sensor");
    const int max_edges = integrator ? parse_max_edges(*integrator, builder.ids()) : INT_MAX;
    ParsedSensor parsed = parse_sensor(*sensor, builder.ids(), options.resolution);
    for (const auto& bsdf : bsdfs)
        builder.add_bsdf(bsdf);
    for (const auto& shape : shapes)
        builder.add_shape(shape);
    for (const auto& emitter : emitters)
        builder.add_emitter(emitter);
    SceneParts parts = builder.finish(expanded.root, std::move(parsed.sensor));
    return {std::filesystem::path(path).stem().string(), std::make_shared<const Scene>(std::move(parts)),
            parsed.sample_count, max_edges, hash.hex()};
}

LoadedScene load_scene(const std::string& path, const SceneLoadOptions& options) {
    return parse_scene(read_file(path), path, options);
}

}  // namespace gib
