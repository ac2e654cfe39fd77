// The fuzz target of scene files. An input is the scene; each line `%% name` begins another file of its folder: an
// include, a mesh, a spectrum, a volume. A scene that loads is planned by every method and rendered in a few pixels.

#include "common/scene/scene.h"
#include "common/core/parallel.h"
#include "common/reader/scene_file.h"
#include "methods/method.h"
#include "tests/fuzz/harness.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace gib::fuzz {

namespace {

/// Whether no name in an XML text can lead out of its folder: names have no slash, no two dots, and no escapes that
/// become one of these.
bool stays_in_folder(std::string_view text) {
    if (text.find("..") != text.npos || text.find("&#") != text.npos) return false;
    // The only slashes allowed are those of tags: </name> and <name/>.
    for (std::size_t i = text.find('/'); i != text.npos; i = text.find('/', i + 1))
        if (!(i > 0 && text[i - 1] == '<') && !(i + 1 < text.size() && text[i + 1] == '>')) return false;
    return true;
}

/// Writes the files of an input to `folder`; the destructor removes them.
class SceneInput {
public:
    SceneInput(std::string_view input, const ScratchFolder& folder) : folder_(folder) {
        constexpr std::string_view separator = "\n%% ";
        std::size_t end = std::min(input.find(separator), input.size());
        write("scene.xml", input.substr(0, end));
        while (end < input.size()) {
            const std::size_t begin = end + separator.size();
            end = std::min(input.find(separator, begin), input.size());
            add_file(input.substr(begin, end - begin));
        }
    }
    ~SceneInput() {
        for (const auto& name : written_)
            folder_.remove(name);
    }
    SceneInput(const SceneInput&) = delete;
    SceneInput& operator=(const SceneInput&) = delete;

    std::string path() const { return folder_ / "scene.xml"; }

private:
    void add_file(std::string_view part) {
        const std::size_t end = std::min(part.find('\n'), part.size());
        const std::string name(part.substr(0, end));
        const auto is_plain = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '.'; };
        // Inputs cannot replace the images, because the readers of images are OpenImageIO's and not the target.
        if (name.empty() || name.size() > 32 || name[0] == '.' || name.starts_with("image") ||
            !std::all_of(name.begin(), name.end(), is_plain))
            return;
        write(name, part.substr(std::min(end + 1, part.size())));
    }
    void write(const std::string& name, std::string_view content) {
        // Any file can be included by the scene, whatever its name, so each is checked as XML.
        const bool may_be_xml = content.find('<') != content.npos;
        folder_.write(name, may_be_xml && !stays_in_folder(content) ? std::string_view() : content);
        written_.push_back(name);
    }

    const ScratchFolder& folder_;
    std::vector<std::string> written_;
};

void write_images(const ScratchFolder& folder) {
    folder.write("image.ppm", "P3\n3 2\n255\n0 0 0 255 255 255 10 200 30 1 2 3 90 90 90 128 0 255\n");
    const float pixels[] = {1, 0.5f, 0, 4, 2, 1000};
    folder.write("image.pfm", "PF\n2 1\n-1.0\n" + std::string(reinterpret_cast<const char*>(pixels), sizeof pixels));
}

void check_shape(const Shape& shape) {
    const Bounds bounds = bounds_of(shape);
    require(bounds.lower.allFinite() && bounds.upper.allFinite(), "bounds are finite");
    require(std::isfinite(area_of(shape)) && area_of(shape) >= 0, "areas are finite");
    const auto* mesh = std::get_if<Mesh>(&shape);
    if (!mesh) return;
    const std::size_t vertices = mesh->vertices.size() - 1;  // one is padding
    require(mesh->normals.empty() || mesh->normals.size() == vertices, "a normal for each vertex, or none");
    require(mesh->uvs.empty() || mesh->uvs.size() == vertices, "a uv for each vertex, or none");
    for (const auto& triangle : mesh->triangles)
        for (const auto index : triangle)
            require(index < vertices, "indices are in range");
    for (const Vec3& n : mesh->normals)
        require(n.isZero(0) || std::abs(n.norm() - 1.f) < 1e-5f, "normals are unit or zero");
}

void render(const Scene& scene, int max_edges) {
    const auto& path = find_method("path");
    const auto method =
        path.create(ParameterValues(all_parameters(path), MethodLabel::parse("path max_depth=4")), {max_edges});
    StageTimes stages;
    const auto run = method->start(scene, 1, stages);
    run->advance(0);
    for (const float value : run->image().total().rgb)
        require(std::isfinite(value), "pixels are finite");
}

void check_scene(const LoadedScene& loaded) {
    const Scene& scene = *loaded.scene;
    for (const Shape& shape : scene.shapes())
        check_shape(shape);
    require(std::isfinite(scene.diagonal()), "the scene's size is finite");
    for (const auto& description : method_registry())
        ConfiguredMethod(MethodLabel{description.name, {}}).create({loaded.max_edges})->plan(scene);
}

}  // namespace

void run_input(std::string_view input) {
    static const ScratchFolder folder;
    static const bool written = (write_images(folder), true);
    require(written, "there are images");
    const SceneInput files(input, folder);
    with_threads(1, [&] {
        unless_refused([&] {
            check_scene(load_scene(files.path()));
            // A film may have any size that is allowed, so the scene is rendered with four pixels instead.
            const LoadedScene small = load_scene(files.path(), {{}, std::pair(2, 2)});
            render(*small.scene, small.max_edges);
        });
    });
}

}  // namespace gib::fuzz
