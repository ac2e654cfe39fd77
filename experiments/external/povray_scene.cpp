#include "experiments/external/povray_scene.h"

#include "common/core/files.h"
#include "common/core/reject.h"
#include "common/scene/scene.h"
#include "common/xml/xml_properties.h"

#include <array>
#include <numbers>

namespace gib {

namespace {

std::string vector(const Vec3d& v) { return fmt::format("<{:.9g},{:.9g},{:.9g}>", v.x(), v.y(), v.z()); }
std::string vector(const Vec3& v) { return vector(Vec3d(v.cast<double>())); }
std::string rgb(const Colord& c) { return fmt::format("rgb <{:.9g},{:.9g},{:.9g}>", c[0], c[1], c[2]); }

/// One <shape> of the scene's file.
struct ShapePlace {
    SourceLocation where, bsdf_where, emitter_where;  ///< places; without a bsdf or emitter, that of the shape
    std::string type, bsdf_type;                      ///< plugins; of a `twosided` the first bsdf in it; empty: none
};

struct ScenePlaces {
    SourceLocation root, sensor, film, medium, emitter;  ///< places of the first of each, else of the root
    std::vector<ShapePlace> shapes;                      ///< in the order of the file
};

std::string type_of(const XmlElement& element) {
    const XmlAttribute* type = element.find("type");
    return type ? type->value : "";
}

ShapePlace place_of(const NestedObject& shape, const XmlIds& ids) {
    ShapePlace place{.where = shape.where,
                     .bsdf_where = shape.where,
                     .emitter_where = shape.where,
                     .type = type_of(*shape.element),
                     .bsdf_type = ""};
    Properties properties(*shape.element, ids);
    auto bsdfs = properties.objects("bsdf");
    while (!bsdfs.empty()) {
        place.bsdf_where = bsdfs.front().element->where;
        place.bsdf_type = type_of(*bsdfs.front().element);
        if (place.bsdf_type != "twosided") break;
        Properties nested(*bsdfs.front().element, ids);
        bsdfs = nested.objects("bsdf");
    }
    if (const auto emitters = properties.objects("emitter"); !emitters.empty())
        place.emitter_where = emitters.front().where;
    return place;
}

/// Reads the scene's file again for the places. Throws InputError as load_scene() does.
ScenePlaces scene_places(const std::string& path, const SceneLoadOptions& options) {
    ContentHash hash;
    LoadWarnings warnings;
    const ExpandedXml xml = expand_xml(read_file(path), path, options.parameters, options.folders, hash, warnings);
    const XmlIds ids(xml.root, warnings);
    Properties scene(xml.root, ids);
    const auto first_of = [&](const char* tag) {
        const auto objects = scene.objects(tag);
        return objects.empty() ? xml.root.where : objects.front().where;
    };
    ScenePlaces places{.root = xml.root.where,
                       .sensor = first_of("sensor"),
                       .film = first_of("sensor"),
                       .medium = first_of("medium"),
                       .emitter = first_of("emitter"),
                       .shapes = {}};
    if (const auto sensors = scene.objects("sensor"); !sensors.empty()) {
        Properties sensor(*sensors.front().element, ids);
        if (const auto films = sensor.objects("film"); !films.empty()) places.film = films.front().where;
    }
    for (const NestedObject& shape : scene.objects("shape"))
        places.shapes.push_back(place_of(shape, ids));
    return places;
}

/// A surface in POV-Ray's words.
struct Surface {
    std::string text;      ///< texture and interior
    bool focuses = false;  ///< glass or a mirror, at which photons are aimed
};

/// A parallelogram: center + a u + b v with a and b from -1/2 to 1/2.
struct Parallelogram {
    Vec3d center, u, v, normal;
    double area() const { return u.cross(v).norm(); }
};

/// The parallelogram that a mesh of two triangles forms; empty if it forms none or if the triangles face opposite sides.
std::optional<Parallelogram> parallelogram(const Mesh& mesh) {
    if (mesh.triangles.size() != 2 || mesh.normal_of(0).dot(mesh.normal_of(1)) <= 0) return std::nullopt;
    std::array<std::vector<Vec3d>, 2> corners;
    for (std::size_t t = 0; t < 2; ++t)
        for (const std::uint32_t i : mesh.triangles[t])
            corners[t].emplace_back(mesh.vertex(i).cast<double>());
    const double tolerance = 1e-4 * (corners[0][1] - corners[0][0]).norm();
    for (std::size_t i = 0; i < 3; ++i) {
        // Corner i of the first triangle is opposite to the shared edge a b; the second triangle adds the fourth corner.
        const Vec3d &p = corners[0][i], &a = corners[0][(i + 1) % 3], &b = corners[0][(i + 2) % 3];
        for (const Vec3d& q : corners[1])
            if ((p + q - a - b).norm() < tolerance)
                return Parallelogram{.center = (a + b) / 2, .u = a - p, .v = b - p, .normal = mesh.normal_of(0)};
    }
    return std::nullopt;
}

class PovrayWriter {
public:
    PovrayWriter(const LoadedScene& loaded, const ScenePlaces& places)
        : scene_(*loaded.scene), places_(places), fade_distance_(1e-3 * double{scene_.diagonal()}) {
        require_expressible();
    }

    std::string text() {
        text_ = header();
        text_ += camera();
        for (const Light& light : scene_.lights())
            add_light(light);
        for (std::size_t i = 0; i < scene_.shapes().size(); ++i)
            add_shape(i);
        return text_;
    }

private:
    /// Throws InputError for what the whole scene has and POV-Ray's form has not.
    void require_expressible() const {
        for (const ShapePlace& shape : places_.shapes)
            if (shape.type == "shapegroup" || shape.type == "instance")
                reject(shape.where, "POV-Ray's form of a scene has no '{}'", shape.type);
        if (places_.shapes.size() != scene_.shapes().size())
            throw InputError(places_.root, "POV-Ray's form of a scene needs one material for each shape file");
        if (scene_.has_media()) throw InputError(places_.medium, "POV-Ray's form of a scene has no medium");
        const Sensor& sensor = scene_.sensor();
        if (sensor.has_lens() || sensor.is_orthographic())
            throw InputError(places_.sensor, "POV-Ray's form of a scene has only the sensor 'perspective'");
        if (sensor.filter().radius() != 0.5f)
            throw InputError(places_.film,
                             "POV-Ray's form of a scene has only the rfilter 'box': a pixel is the mean of "
                             "its samples");
    }

    std::string header() const {
        return "// A scene of gibench. Declare: Radiosity, RadiosityError, Photons, LampPoints.\n"
               "#version 3.7;\n"
               "#ifndef (RadiosityError) #declare RadiosityError = 0.5; #end\n"
               "#ifndef (LampPoints) #declare LampPoints = 4; #end\n"
               "global_settings {\n"
               "  assumed_gamma 1 ambient_light 0 max_trace_level 32 adc_bailout 0.001\n"
               "#ifdef (Radiosity)\n"
               "  radiosity { count Radiosity error_bound RadiosityError recursion_limit 6 brightness 1 nearest_count "
               "10\n"
               "              pretrace_start 0.08 pretrace_end 0.005 low_error_factor 0.5 gray_threshold 0\n"
               "              adc_bailout 0.001 always_sample off }\n"
               "#end\n"
               "#ifdef (Photons) photons { count Photons autostop 0 max_trace_level 32 adc_bailout 0.001 } #end\n"
               "}\n";
    }

    /// The pinhole camera: POV-Ray's ray through the point (x, y) of the image, in [0, 1]^2 with y downwards, is direction + (x
    /// - 1/2) right + (1/2 - y) up. The three vectors follow from the rays in the corners, which makes them right for
    /// every crop and shift of the image.
    std::string camera() const {
        const Sensor& sensor = scene_.sensor();
        const int right = sensor.width() - 1, bottom = sensor.height() - 1;
        const auto corner = [&](int x, int y) {
            return sensor.generate_ray(x * right, y * bottom, Vec2(static_cast<float>(x), static_cast<float>(y)));
        };
        const Ray middle = sensor.generate_ray(right / 2, bottom / 2, Vec2(0.5f, 0.5f));
        require_no_clipping(middle);
        std::array<Vec3d, 4> d;  // top left, top right, bottom left, bottom right
        for (int i = 0; i < 4; ++i)
            d[static_cast<std::size_t>(i)] = corner(i % 2, i / 2).d.cast<double>();
        // Unit vectors to the corners of a parallelogram: d0 + s3 d3 = s1 d1 + s2 d2 gives their lengths.
        Eigen::Matrix3d columns;
        columns << d[1], d[2], -d[3];
        const Vec3d s = columns.fullPivLu().solve(d[0]);
        const Vec3d top_right = s[0] * d[1], bottom_left = s[1] * d[2];
        return fmt::format("camera {{ perspective location {} direction {} right {} up {} }}\n", vector(middle.o),
                           vector(Vec3d((top_right + bottom_left) / 2)), vector(Vec3d(top_right - d[0])),
                           vector(Vec3d(d[0] - bottom_left)));
    }

    /// Throws InputError if near_clip or far_clip may cut something off.
    void require_no_clipping(const Ray& middle) const {
        const Eigen::AlignedBox3f box(scene_.bounds().lower, scene_.bounds().upper);
        float farthest = 0;
        for (int i = 0; i < 8; ++i)
            farthest =
                std::max(farthest, (box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(i)) - middle.o).norm());
        if (middle.t_min > box.exteriorDistance(middle.o) || middle.t_max < farthest)
            throw InputError(places_.sensor, "POV-Ray's form of a scene has no near_clip and far_clip that cut it");
    }

    void add_light(const Light& light) {
        if (const auto* area = std::get_if<AreaLight>(&light)) return add_lamp(*area);
        const auto* point = std::get_if<PointLight>(&light);
        if (!point)
            throw InputError(places_.emitter, "POV-Ray's form of a scene has only the emitters 'area' and 'point'");
        text_ += fmt::format("light_source {{ {} color {} {}}}\n", vector(point->position),
                             rgb(light_color(point->intensity.cast<double>())), fading());
    }

    void add_lamp(const AreaLight& lamp) {
        const SourceLocation& where = places_.shapes[lamp.shape].emitter_where;
        if (lamp.texture && !lamp.texture->constant())
            throw InputError(where, "POV-Ray's form of a scene has no area emitter with a texture");
        const auto* mesh = std::get_if<Mesh>(&scene_.shapes()[lamp.shape]);
        const auto flat = mesh ? parallelogram(*mesh) : std::nullopt;
        if (!flat)
            throw InputError(where,
                             "POV-Ray's form of a scene has area emitters on parallelograms of two triangles only");
        const Vec3d target = flat->center + flat->normal.normalized() * double{scene_.diagonal()};
        // The points of an area_light span its axes from end to end. Shortened by one point, the cells of the jitter are
        // the cells of the lamp.
        text_ += fmt::format(
            "light_source {{ {} color {}\n"
            "  spotlight point_at {} tightness 1 radius 89.99 falloff 90 {}\n"
            "  area_light {}*(LampPoints-1)/LampPoints, {}*(LampPoints-1)/LampPoints, LampPoints, LampPoints jitter\n"
            "  area_illumination on\n"
            "#ifdef (Photons) photons {{ reflection on refraction on area_light }} #end\n"
            "}}\n",
            vector(flat->center), rgb(light_color(flat->area() * lamp.radiance.cast<double>())), vector(target),
            fading(), vector(flat->u), vector(flat->v));
    }

    /// C of a light of this intensity [W/sr] along its axis.
    Colord light_color(const Colord& intensity) const {
        return intensity / (2 * std::numbers::pi * sqr(fade_distance_));
    }
    std::string fading() const { return fmt::format("fade_distance {:.9g} fade_power 2 ", fade_distance_); }

    void add_shape(std::size_t i) {
        const Shape& shape = scene_.shapes()[i];
        const AreaLight* lamp = nullptr;
        for (const Light& light : scene_.lights())
            if (const auto* area = std::get_if<AreaLight>(&light); area && area->shape == i) lamp = area;
        if (const auto* sphere = std::get_if<Sphere>(&shape))
            text_ += fmt::format("sphere {{ {}, {:.9g}\n", vector(sphere->center), sphere->radius);
        else if (const auto* mesh = std::get_if<Mesh>(&shape)) add_mesh(*mesh);
        else reject(places_.shapes[i].where, "POV-Ray's form of a scene has no shape '{}'", places_.shapes[i].type);
        const Surface surface = surface_of(i, lamp);
        text_ += surface.text;
        if (surface.focuses)
            text_ += "#ifdef (Photons) photons { target reflection on refraction on collect off } #end\n";
        if (lamp) {
            text_ += "no_shadow no_radiosity\n";
            if (scene_.sensor().hides_emitters()) text_ += "no_image\n";
        }
        text_ += "}\n";
        if (lamp) add_back(*parallelogram(std::get<Mesh>(shape)));
    }

    /// A black parallelogram just behind a lamp, which does not emit on its back.
    void add_back(const Parallelogram& lamp) {
        const Vec3d corner =
            lamp.center - 1e-5 * double{scene_.diagonal()} * lamp.normal.normalized() - (lamp.u + lamp.v) / 2;
        text_ += fmt::format(
            "mesh2 {{ vertex_vectors {{ 4, {}, {}, {}, {} }} face_indices {{ 2, <0,1,2>, <0,2,3> }}\n"
            "texture {{ pigment {{ rgb 0 }} finish {{ ambient 0 diffuse 0 }} }} no_shadow no_radiosity{} }}\n",
            vector(corner), vector(Vec3d(corner + lamp.u)), vector(Vec3d(corner + lamp.u + lamp.v)),
            vector(Vec3d(corner + lamp.v)), scene_.sensor().hides_emitters() ? " no_image" : "");
    }

    void add_mesh(const Mesh& mesh) {
        const std::size_t vertices = mesh.vertices.size() - 1;  // the last one is there for Embree
        text_ += fmt::format("mesh2 {{ vertex_vectors {{ {}", vertices);
        for (std::uint32_t i = 0; i < vertices; ++i)
            text_ += ",\n" + vector(mesh.vertex(i));
        text_ += " }\n";
        if (!mesh.normals.empty()) {
            text_ += fmt::format("normal_vectors {{ {}", mesh.normals.size());
            for (const Vec3& n : mesh.normals)
                text_ += ",\n" + vector(n);
            text_ += " }\n";
        }
        text_ += fmt::format("face_indices {{ {}", mesh.triangles.size());
        for (const auto& t : mesh.triangles)
            text_ += fmt::format(",\n<{},{},{}>", t[0], t[1], t[2]);
        text_ += " }\n";
    }

    Surface surface_of(std::size_t i, const AreaLight* lamp) const {
        const ShapePlace& place = places_.shapes[i];
        const Bsdf* bsdf = scene_.material_of_shape(i).constant();
        if (!bsdf || bsdf->layers().empty() || bsdf->pass_through() > 0 || bsdf->is_tilted()) refuse(place);
        const Scattering& front = bsdf->layers().front().model;
        if (const auto* diffuse = std::get_if<Diffuse>(&front)) {
            for (const Bsdf::Layer& layer : bsdf->layers()) {
                const auto* other = std::get_if<Diffuse>(&layer.model);
                if (!other) refuse(place);
                if ((other->reflectance != diffuse->reflectance).any())
                    throw InputError(place.bsdf_where,
                                     "POV-Ray's form of a scene has no bsdf with two different sides");
            }
            return {diffuse_text(diffuse->reflectance.cast<double>(), lamp, place)};
        }
        if (lamp) throw InputError(place.emitter_where, "POV-Ray's form of a scene has only lamps that are diffuse");
        if (const auto* glass = std::get_if<Dielectric>(&front); glass && is_clear(*glass))
            return {fmt::format("texture {{ pigment {{ rgbt 1 }} finish {{ ambient 0 diffuse 0 reflection {{ rgb 0, "
                                "rgb 1 fresnel on "
                                "}} conserve_energy }} }}\ninterior {{ ior {:.9g} }}\n",
                                glass->eta),
                    true};
        if (const auto* mirror = std::get_if<Conductor>(&front); mirror && !mirror->index)
            return {
                fmt::format("texture {{ pigment {{ rgb 0 }} finish {{ ambient 0 diffuse 0 reflection {{ {} }} }} }}\n",
                            rgb(mirror->specular_reflectance.cast<double>())),
                true};
        refuse(place);
    }

    static bool is_clear(const Dielectric& glass) {
        return glass.cauchy_b == 0.f && (glass.specular_reflectance == 1.f).all() &&
               (glass.specular_transmittance == 1.f).all();
    }

    /// A diffuse surface, which may be a lamp. POV-Ray multiplies what is emitted by the pigment, too.
    static std::string diffuse_text(const Colord& reflectance, const AreaLight* lamp, const ShapePlace& place) {
        if (!lamp)
            return fmt::format("texture {{ pigment {{ {} }} finish {{ ambient 0 diffuse 1 }} }}\n", rgb(reflectance));
        const Colord radiance = lamp->radiance.cast<double>();
        const bool is_black = (reflectance == 0).all();
        if (!is_black && (reflectance == 0 && radiance > 0).any())
            throw InputError(place.bsdf_where,
                             "POV-Ray's form of a scene has no lamp that reflects nothing in one channel");
        const Colord pigment = is_black ? Colord(Colord::Ones()) : reflectance;
        const Colord emitted = (radiance > 0).select(radiance / pigment.max(1e-30), 0.0);
        return fmt::format("texture {{ pigment {{ {} }} finish {{ ambient 0 diffuse {} emission {} }} }}\n",
                           rgb(pigment), is_black ? 0 : 1, rgb(emitted));
    }

    [[noreturn]] static void refuse(const ShapePlace& place) {
        reject(place.bsdf_where,
               "POV-Ray's form of a scene has no such bsdf '{}'; it has, without textures: diffuse, a clear "
               "dielectric, and "
               "a conductor of the material 'none'",
               place.bsdf_type.empty() ? place.type : place.bsdf_type);
    }

    const Scene& scene_;
    const ScenePlaces& places_;
    double fade_distance_;  ///< d0
    std::string text_;
};

}  // namespace

std::string povray_scene(const LoadedScene& loaded, const std::string& file, const SceneLoadOptions& options) {
    const ScenePlaces places = scene_places(file, options);
    return PovrayWriter(loaded, places).text();
}

}  // namespace gib
