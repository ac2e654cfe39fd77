#include "common/reader/view_hash.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace gib {

namespace {

/// Adds what is seen of an element (LoadedScene::view_hash).
void add_view(const XmlElement& element, ContentHash& view) {
    const bool is_film = element.tag == "film";
    view.add("<" + element.tag);
    for (const XmlAttribute& attribute : element.attributes) {
        if (is_film) continue;
        const bool is_path = element.tag == "spectrum" && attribute.name == "filename";
        view.add(attribute.name);
        view.add(is_path ? read_file(attribute.value) : attribute.value);
    }
    for (const XmlElement& child : element.children) {
        const bool is_seen = is_film ? child.tag == "rfilter" || child.tag == "ref"
                                     : child.tag != "sampler" && child.tag != "integrator";
        if (is_seen) add_view(child, view);
    }
    view.add(">");
}

}  // namespace

std::string view_hash_of(const XmlElement& root, const ContentHash& files, const ParsedSensor& sensor,
                         const ParsedIntegrator& integrator) {
    ContentHash view;
    view.add(fmt::format("view 1, max_depth {}, hide_emitters {}", integrator.max_edges, integrator.hides_emitters));
    // Rounded, because the window's pixels are scaled with the resolution.
    if (sensor.window) view.add(fmt::format("crop {:.6g}", fmt::join(*sensor.window, " ")));
    add_view(root, view);
    view.add(files);
    return view.hex();
}

}  // namespace gib
