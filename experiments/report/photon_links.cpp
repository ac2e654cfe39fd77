#include "experiments/report/photon_links.h"

#include "methods/method.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace gib {

std::vector<PhotonLink> photon_links(const ResultIndex& index, const ResultFolder& folder) {
    namespace fs = std::filesystem;
    const auto names = names_of_methods_that_store_light();
    std::vector<PhotonLink> links;
    for (const IndexScene& scene : index.scenes)
        for (const std::string& method : index.methods) {
            const std::string name = MethodLabel::parse(method).name;
            if (std::find(names.begin(), names.end(), name) == names.end()) continue;
            fs::path page = folder.method_image(scene.name, method);
            page.replace_extension();  // without the image's ending
            page += "-photons.html";
            links.push_back({.scene = scene.name,
                             .method = method,
                             .page = fs::exists(page) ? "images/" + page.filename().string() : "",
                             .command = fmt::format("gibench photons '{}' --method '{}' -o '{}'", scene.path, method,
                                                    page.string())});
        }
    return links;
}

}  // namespace gib
