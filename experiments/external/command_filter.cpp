#include "experiments/external/command_filter.h"

#include "common/images/image_file.h"
#include "experiments/external/command_image.h"

#include <algorithm>
#include <filesystem>
#include <map>

namespace gib {

namespace {

/// The files that a command reads, which are layers of a checkpoint's image, and the one that it writes.
std::map<std::string, std::string> files_of(const FilteredCell& cell, const LayeredImage& image) {
    const std::string work = std::filesystem::absolute(cell.work_folder).lexically_normal().string() + "/";
    std::map<std::string, std::string> files = {{"out", work + "filtered.exr"}};
    for (const auto& [layer, pixels] : image.layers) {
        const std::string name = layer.empty() ? "image" : layer;
        if (!cell.filter.takes(name)) continue;
        files[name] = work + name + ".exr";
        write_scratch_exr(files[name], {{{"", pixels}}, {}});
    }
    return files;
}

}  // namespace

void filter_checkpoints(const std::string& program, const FilteredCell& cell, Measurement& measured) {
    double last = 0;  // [s]
    for (Checkpoint& checkpoint : measured.checkpoints) {
        const std::string path = checkpoint_image(cell.work_folder, checkpoint.passes);
        const LayeredImage image = read_image(path);
        auto values = files_of(cell, image);
        const std::string out = values["out"];
        values["threads"] = std::to_string(cell.threads);
        std::filesystem::remove(out);
        const auto [filtered, cost] = run_image_command(program, {.name = "its filter",
                                                                  .command = filled_command(cell.filter, values),
                                                                  .out = out,
                                                                  .folder = cell.folder,
                                                                  .timeout = cell.filter.timeout,
                                                                  .width = image.layers.front().second.width,
                                                                  .height = image.layers.front().second.height,
                                                                  .cell_folder = cell.cell_folder,
                                                                  .work_folder = cell.work_folder});
        write_scratch_exr(path, {{{"", filtered}}, {}});
        last = cost.seconds;
        checkpoint.seconds += last;
        checkpoint.peak_rss_mib = std::max(checkpoint.peak_rss_mib, cost.peak_rss_mib);
    }
    measured.stages.push_back({"command", last});
}

}  // namespace gib
