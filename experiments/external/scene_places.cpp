#include "experiments/external/scene_places.h"

#include "common/core/files.h"
#include "common/xml/xml_properties.h"

namespace gib {

namespace {

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

}  // namespace

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

}  // namespace gib
