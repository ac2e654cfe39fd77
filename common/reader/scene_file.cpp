#include "common/reader/scene_file.h"

#include "common/core/float_traps.h"
#include "common/core/reject.h"
#include "common/reader/medium_check.h"
#include "common/reader/scene_bsdf.h"
#include "common/reader/scene_emitter.h"
#include "common/reader/scene_medium.h"
#include "common/reader/scene_sensor.h"
#include "common/reader/shape_reader.h"
#include "common/reader/view_hash.h"
#include "common/scene/coincident_shapes.h"
#include "common/xml/scene_spectrum.h"

#include <fmt/format.h>
#include <algorithm>
#include <climits>
#include <filesystem>

namespace gib {

namespace {

bool is_shape(const NestedObject& object, std::string_view plugin) {
    const XmlAttribute* type = object.element->find("type");
    return type && type->value == plugin;
}

/// Collects the objects of a <scene>.
class SceneBuilder {
public:
    SceneBuilder(const ExpandedXml& xml, ContentHash& hash, LoadWarnings& warnings)
        : ids_(xml.root, warnings),
          textures_(xml.files, hash, ids_),
          materials_(textures_),
          shapes_(xml.files, hash, textures_, media_, materials_) {}

    /// Unknown parameters are added to `errors`; without it the first one throws.
    void collect_unknown(LoadErrors* errors) { ids_.collect_unknown(errors); }
    void check_texture(const NestedObject& texture) {
        const MeshInView none(textures_);
        parse_texture(texture, ColorRange::emission, textures_);
    }
    void check_bsdf(const NestedObject& bsdf) {
        const MeshInView none(textures_);
        parse_bsdf(bsdf, textures_);
    }
    void check_medium(const NestedObject& medium) { parse_medium(medium, textures_, Vec3d::Zero()); }
    void add_medium(const NestedObject& medium) { media_.index_of(medium); }
    void set_camera_medium(const std::optional<NestedObject>& medium) {
        camera_medium_ = medium ? media_.index_of(*medium) : no_medium;
    }

    void add_shape(const NestedObject& object) {
        if (is_shape(object, "shapegroup")) {
            group_index(*object.element);
        } else if (is_shape(object, "instance")) {
            add_instance(object);
        } else if (is_shape(object, "merge")) {
            add_merged(object);
        } else {
            bounds_.extend(shapes_.add_shapes(object, pending_));
        }
    }

    void add_emitter(const NestedObject& emitter) { emitters_.push_back(emitter); }

    /// Moves the scene's centre to the origin, because float is most exact for positions near it.
    SceneParts finish(const XmlElement& root, Sensor sensor) {
        if (bounds_.isEmpty()) throw InputError(root.where, "the scene is empty: it has no shape");
        SceneParts parts;
        parts.origin = center(root);
        parts.objects = recentred_objects(pending_, parts.origin);
        lift_lamps_off_surfaces(parts.objects, materials_.all());
        refuse_coincident_shapes(parts.objects, materials_.all(), places_of(pending_));
        place_instances(parts);
        parts.lights = parse_emitters(parts.origin);
        parts.materials = materials_.take();
        parts.media = media_.read(textures_, parts.origin);
        parts.camera_medium = camera_medium_;
        parts.sensor = std::move(sensor);
        return parts;
    }

    /// The media as the file names them, for a scene of the parts that finish() has returned.
    NamedMedia named_media() const {
        NamedMedia named{.shapes = {}, .names = media_.names(), .camera = camera_medium_};
        const auto add = [&](const std::vector<PendingShape>& shapes) {
            for (const PendingShape& shape : shapes)
                named.shapes.push_back({shape.where, shape.media});
        };
        add(pending_);
        for (const std::uint32_t group : placed_groups_)
            add(groups_[group].members);
        return named;
    }

    const XmlIds& ids() const { return ids_; }

private:
    /// A shapegroup. Its own origin is the centre of its bounds.
    struct PendingGroup {
        std::vector<PendingShape> members;
        BoundsD bounds;
        std::optional<std::uint32_t> index;  ///< index of the group in the scene, once an instance shows it
    };
    struct PendingInstance {
        SourceLocation where;
        std::uint32_t group;
        Mat4d to_world;
    };

    /// The group of a <shape type="shapegroup">, which is read at its first mention.
    std::uint32_t group_index(const XmlElement& element) {
        if (const auto it = group_of_element_.find(&element); it != group_of_element_.end()) return it->second;
        Properties properties(element, ids_);
        const auto members = properties.objects("shape");
        properties.finish();
        PendingGroup group;
        for (const auto& member : members) {
            for (const std::string_view plugin : {"shapegroup", "instance"})
                if (is_shape(member, plugin)) reject(member.where, "a shapegroup cannot hold a shape '{}'", plugin);
            const std::size_t first = group.members.size();
            group.bounds.extend(shapes_.add_shapes(member, group.members));
            for (std::size_t i = first; i < group.members.size(); ++i)
                if (group.members[i].radiance)
                    throw InputError(group.members[i].emitter_where, "an emitter cannot stand in a shapegroup");
        }
        groups_.push_back(std::move(group));
        return group_of_element_[&element] = static_cast<std::uint32_t>(groups_.size() - 1);
    }

    void add_instance(const NestedObject& object) {
        Properties properties(*object.element, ids_);
        const Mat4d to_world = properties.transform("to_world");
        const auto group = properties.object("shape");
        properties.number("silhouette_sampling_weight");
        properties.finish();
        if (!group) throw InputError(object.where, "an instance needs a shapegroup");
        if (!is_shape(*group, "shapegroup")) throw InputError(group->where, "an instance takes a shapegroup only");
        const std::uint32_t index = group_index(*group->element);
        bounds_.extend(transformed(to_world, groups_[index].bounds));
        instances_.push_back({object.where, index, to_world});
    }

    /// The meshes of a `merge` stay apart here, which changes no image.
    void add_merged(const NestedObject& object) {
        Properties properties(*object.element, ids_);
        const auto members = properties.objects("shape");
        properties.finish();
        for (const auto& member : members) {
            if (is_shape(member, "merge")) throw InputError(member.where, "a merge cannot hold a shape 'merge'");
            add_shape(member);
        }
    }

    Vec3d center(const XmlElement& root) const {
        const FloatTrapsPaused paused;  // the test below looks for overflows in transforms
        const Vec3d center = bounds_.center();
        if (!center.array().isFinite().all()) throw InputError(root.where, "the scene is too large");
        return center;
    }

    static std::vector<SourceLocation> places_of(const std::vector<PendingShape>& pending) {
        std::vector<SourceLocation> places;
        for (const PendingShape& p : pending)
            places.push_back(p.where);
        return places;
    }

    static std::vector<SceneParts::Object> recentred_objects(std::vector<PendingShape>& pending, const Vec3d& origin) {
        std::vector<SceneParts::Object> objects;
        for (auto& p : pending) {
            SceneParts::Object object{.shape = recentred(std::move(p.shape), origin, p.where),
                                      .material = p.material,
                                      .radiance = p.radiance,
                                      .media = p.media};
            // Densities are inverse areas, which must fit into float.
            const double area = p.radiance ? area_of(object.shape) : 1;
            if (!(area >= 1e-37 && area <= 1e37))
                reject(p.emitter_where, "an area emitter on a shape of area {:g}: it must be between 1e-37 and 1e+37",
                       area);
            objects.push_back(std::move(object));
        }
        return objects;
    }

    /// Adds the instances and their groups to the scene. Groups that no instance shows, and instances of an empty
    /// group, are left out.
    void place_instances(SceneParts& parts) {
        for (const auto& instance : instances_) {
            PendingGroup& group = groups_[instance.group];
            if (group.bounds.isEmpty()) continue;
            const Vec3d center = group.bounds.center();
            if (!group.index) {
                group.index = static_cast<std::uint32_t>(parts.groups.size());
                placed_groups_.push_back(instance.group);
                parts.groups.push_back(recentred_objects(group.members, center));
                refuse_coincident_shapes(parts.groups.back(), materials_.all(), places_of(group.members));
            }
            Mat4d to_scene = instance.to_world;
            to_scene.topRightCorner<3, 1>() += to_scene.topLeftCorner<3, 3>() * center - parts.origin;
            check_range(transformed(to_scene, BoundsD(group.bounds.min() - center, group.bounds.max() - center)),
                        instance.where);
            const auto placed = make_instance(*group.index, to_scene);
            if (!placed) throw InputError(instance.where, "the to_world of the instance scales by more than 1e12");
            parts.instances.push_back(*placed);
        }
    }

    std::vector<Light> parse_emitters(const Vec3d& origin) {
        std::vector<Light> lights;
        for (const auto& emitter : emitters_) {
            if (shapes_.has_read(emitter.element)) continue;  // it stands in the shape that refers to it
            std::vector<Light> parsed = parse_emitter(emitter, textures_, origin);
            std::move(parsed.begin(), parsed.end(), std::back_inserter(lights));
            if (std::count_if(lights.begin(), lights.end(), is_environment) > 1)
                throw InputError(emitter.where,
                                 "a scene can have only one environment: a constant, an envmap, a sky or a sun");
        }
        return lights;
    }

    XmlIds ids_;
    TextureFiles textures_;
    SceneMedia media_;
    SceneMaterials materials_;
    ShapeReader shapes_;
    std::vector<PendingShape> pending_;
    std::vector<PendingGroup> groups_;
    std::map<const XmlElement*, std::uint32_t> group_of_element_;
    std::vector<PendingInstance> instances_;
    std::vector<std::uint32_t> placed_groups_;  ///< indices into groups_, in the order of the scene's
    std::vector<NestedObject> emitters_;
    std::uint32_t camera_medium_ = no_medium;
    BoundsD bounds_;
};

/// Reads the objects that nothing refers to, so that their errors are seen: each becomes a warning.
template <typename Read>
void read_unused(const std::vector<NestedObject>& objects, const XmlIds& ids, LoadWarnings& warnings,
                 const Read& read) {
    for (const auto& object : objects) {
        if (ids.is_used(*object.element)) continue;
        try {
            read(object);
        } catch (const InputError& error) {
            warnings.add(object.where, fmt::format("nothing refers to this {}, which is left out: {}",
                                                   object.element->tag, error.what()));
        }
    }
}

/// Reads a scene, and collects its unknown parameters. Throws InputError for these once all elements have been read, and for
/// the first of all other errors.
LoadedScene read_scene(const std::string& xml, const std::string& path, const SceneLoadOptions& options,
                       LoadErrors& unknown) {
    ContentHash hash, files;
    if (options.resolution)
        hash.add(fmt::format("resolution {} x {}", options.resolution->first, options.resolution->second));
    LoadWarnings warnings;
    const ExpandedXml expanded = expand_xml(xml, path, options.parameters, options.folders, hash, warnings);
    SceneBuilder builder(expanded, files, warnings);
    builder.collect_unknown(&unknown);
    Properties scene(expanded.root, builder.ids());
    const auto integrator = scene.object("integrator");
    const auto sensors = scene.objects("sensor");
    const auto bsdfs = scene.objects("bsdf"), shapes = scene.objects("shape"), emitters = scene.objects("emitter"),
               media = scene.objects("medium"), spectra = scene.objects("spectrum"),
               textures = scene.objects("texture");
    for (const char* part : {"film", "sampler", "rfilter", "phase", "volume"})
        scene.objects(part);  // a sensor or a medium may refer to them
    scene.finish();
    if (sensors.empty()) refuse_without_sensor(expanded.root);
    const auto taken = integrator ? parse_integrator(*integrator, builder.ids()) : ParsedIntegrator{INT_MAX, false};
    ParsedSensor parsed = parse_sensor(sensors.front(), builder.ids(), options.resolution);
    parsed.sensor.hide_emitters(taken.hides_emitters);
    // Whatever refers to an object reads it. One that nothing refers to is read here, so that its errors are seen.
    builder.collect_unknown(nullptr);
    read_unused(spectra, builder.ids(), warnings, [&](const NestedObject& spectrum) {
        // The range of an emission includes those of all other colours.
        parse_spectrum(*spectrum.element, builder.ids(), "spectrum", ColorRange::emission);
    });
    read_unused(textures, builder.ids(), warnings,
                [&](const NestedObject& texture) { builder.check_texture(texture); });
    read_unused(bsdfs, builder.ids(), warnings, [&](const NestedObject& bsdf) { builder.check_bsdf(bsdf); });
    read_unused(media, builder.ids(), warnings, [&](const NestedObject& medium) { builder.check_medium(medium); });
    builder.collect_unknown(&unknown);
    for (const auto& medium : media)
        if (builder.ids().is_used(*medium.element)) builder.add_medium(medium);
    builder.set_camera_medium(parsed.medium);
    for (const auto& shape : shapes)
        builder.add_shape(shape);
    for (const auto& emitter : emitters)
        builder.add_emitter(emitter);
    SceneParts parts = builder.finish(expanded.root, std::move(parsed.sensor));
    unknown.reject();
    hash.add(files);
    auto placed = std::make_shared<Scene>(std::move(parts));
    NamedMedia named = builder.named_media();
    if (const auto around = medium_around_camera(*placed, named)) {
        placed->set_camera_medium(*around);
        named.camera = *around;
        warnings.add(sensors.front().where,
                     fmt::format("the sensor names no medium, and stands in {}", named.names[*around]));
    }
    LoadedScene loaded{.name = std::filesystem::path(path).stem().string(),
                       .scene = std::move(placed),
                       .sample_count = parsed.sample_count,
                       .max_edges = taken.max_edges,
                       .content_hash = hash.hex(),
                       .view_hash = view_hash_of(expanded.root, files, parsed, taken),
                       .warnings = {}};
    for (const auto& find : {contradictions, open_boundaries})
        for (const std::string& warning : find(*loaded.scene, named))
            warnings.add({}, warning);  // it names its own place
    loaded.warnings = warnings.messages();
    return loaded;
}

}  // namespace

LoadedScene parse_scene(const std::string& xml, const std::string& path, const SceneLoadOptions& options) {
    LoadErrors unknown;
    try {
        return read_scene(xml, path, options, unknown);
    } catch (const InputError& error) {
        unknown.reject(error.what());
        throw;
    }
}

LoadedScene load_scene(const std::string& path, const SceneLoadOptions& options) {
    return parse_scene(read_file(path), path, options);
}

}  // namespace gib
