#include "experiments/external/command_cell.h"

#include "common/core/error.h"
#include "common/core/files.h"
#include "common/images/image_file.h"
#include "experiments/external/command_process.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <sstream>

namespace gib {

namespace {

/// The last line of a file that is not empty.
std::string last_line(const std::string& file) {
    std::istringstream text(read_file(file));
    std::string last;
    for (std::string line; std::getline(text, line);)
        if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
    return last;
}

std::string absolute(const std::string& path) { return std::filesystem::absolute(path).lexically_normal().string(); }

/// Throws RunError with the last line of the command's standard error.
[[noreturn]] void fail(const CommandCell& cell, const std::string& what) {
    const std::string messages = cell.cell_folder + "/stderr.txt";
    const std::string said = last_line(messages);
    throw RunError(said.empty() ? what : fmt::format("{}; its last message: {} (all are in {})", what, said, messages));
}

/// `name`: in messages, such as "its command".
void require_success(const CommandCell& cell, const char* name, const CommandResult& result) {
    if (result.timed_out)
        fail(cell, fmt::format("{} was ended after its timeout of {:g} s", name, cell.method.timeout));
    // A shell that has waited for its command tells a signal as the exit code 128 + signal.
    const bool told_by_shell = result.exit_code > 128 && result.exit_code < 128 + 32;
    if (const int signal = told_by_shell ? result.exit_code - 128 : result.signal; signal != 0)
        fail(cell, fmt::format("{} was killed by signal {} ({})", name, signal, strsignal(signal)));
    if (result.exit_code != 0) fail(cell, fmt::format("{} ended with exit code {}", name, result.exit_code));
}

Image image_of(const CommandCell& cell, const char* name, const std::string& file) {
    if (!std::filesystem::exists(file)) fail(cell, fmt::format("{} wrote no image", name));
    LayeredImage layers;
    try {
        layers = read_image(file);
    } catch (const InputError& error) {
        fail(cell, fmt::format("its image cannot be read: {}", error.what()));
    }
    const Image* image = layers.find("");
    if (!image) fail(cell, "its image has no channels R,G,B");
    if (image->width != cell.width || image->height != cell.height)
        fail(cell, fmt::format("its image has {} x {} pixels, the scene has {} x {}", image->width, image->height,
                               cell.width, cell.height));
    if (const std::size_t bad = image->non_finite_values(); bad > 0) {
        const auto first = std::ranges::find_if(image->rgb, [](float v) { return !std::isfinite(v); });
        const auto pixel = static_cast<int>((first - image->rgb.begin()) / 3);
        fail(cell, fmt::format("{} of the {} values of its image are not finite, the first in column {} of row {}", bad,
                               image->rgb.size(), pixel % image->width, pixel / image->width));
    }
    return *image;
}

struct CommandImage {
    Image image;
    CommandResult cost;
};

/// Runs the command with these values of its placeholders, of which `out` is the image that it writes.
CommandImage image_by_command(const std::string& program, const CommandCell& cell, const char* name,
                              std::map<std::string, std::string> values) {
    values["threads"] = std::to_string(cell.threads);
    const CommandResult cost = run_command(program, {.command = filled_command(cell.method, values),
                                                     .folder = cell.folder,
                                                     .timeout = cell.method.timeout,
                                                     .cell_folder = cell.cell_folder,
                                                     .work_folder = cell.work_folder});
    require_success(cell, name, cost);
    return {image_of(cell, name, values["out"]), cost};
}

/// The files that a filter reads, which are layers of a checkpoint's image, and the one that it writes.
std::map<std::string, std::string> files_of(const CommandCell& cell, const LayeredImage& image) {
    const std::string work = absolute(cell.work_folder) + "/";
    std::map<std::string, std::string> files = {{"out", work + "filtered.exr"}};
    for (const auto& [layer, pixels] : image.layers) {
        const std::string name = layer.empty() ? "image" : layer;
        if (!cell.method.takes(name)) continue;
        files[name] = work + name + ".exr";
        write_scratch_exr(files[name], {{{"", pixels}}, {}});
    }
    return files;
}

}  // namespace

CellTiming run_external_cell(const std::string& program, const CommandCell& cell, const RendererInput& input) {
    const std::string work = absolute(cell.work_folder);
    std::string scene = absolute(input.scene_file);
    if (!input.scene_text.empty()) {
        scene = work + "/scene.pov";
        write_file(scene, input.scene_text);
    }
    std::map<std::string, std::string> values = {{"scene", scene},
                                                 {"out", work + "/image." + cell.method.image_format},
                                                 {"spp", std::to_string(input.spp)},
                                                 {"seed", std::to_string(input.seed)},
                                                 {"width", std::to_string(cell.width)},
                                                 {"height", std::to_string(cell.height)}};
    if (input.seconds) values["seconds"] = fmt::format("{}", *input.seconds);
    const auto [image, cost] = image_by_command(program, cell, "its command", std::move(values));
    write_scratch_exr(checkpoint_image(cell.work_folder, input.spp), {{{"", image}}, {}});
    CellTiming timing;
    timing.measurement.checkpoints.push_back(
        {.passes = input.spp, .seconds = cost.seconds, .counts = {}, .peak_rss_mib = cost.peak_rss_mib});
    timing.measurement.stages.push_back({"command", cost.seconds});
    return timing;
}

void filter_checkpoints(const std::string& program, const CommandCell& cell, Measurement& measured) {
    double last = 0;  // [s]
    for (Checkpoint& checkpoint : measured.checkpoints) {
        const std::string path = checkpoint_image(cell.work_folder, checkpoint.passes);
        auto values = files_of(cell, read_image(path));
        std::filesystem::remove(values["out"]);
        const auto [filtered, cost] = image_by_command(program, cell, "its filter", std::move(values));
        write_scratch_exr(path, {{{"", filtered}}, {}});
        last = cost.seconds;
        checkpoint.seconds += last;
        checkpoint.peak_rss_mib = std::max(checkpoint.peak_rss_mib, cost.peak_rss_mib);
    }
    measured.stages.push_back({"command", last});
}

}  // namespace gib
