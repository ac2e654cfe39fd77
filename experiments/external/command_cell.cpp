#include "experiments/external/command_cell.h"

#include "common/core/error.h"
#include "common/core/files.h"
#include "common/images/image_file.h"

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

/// Throws RunError with the last line of the command's standard error.
[[noreturn]] void fail(const ImageCommand& command, const std::string& what) {
    const std::string messages = command.cell_folder + "/stderr.txt";
    const std::string said = last_line(messages);
    throw RunError(said.empty() ? what : fmt::format("{}; its last message: {} (all are in {})", what, said, messages));
}

void require_success(const ImageCommand& command, const CommandResult& result) {
    if (result.timed_out)
        fail(command, fmt::format("{} was ended after its timeout of {:g} s", command.name, command.timeout));
    // A shell that has waited for its command tells a signal as the exit code 128 + signal.
    const bool told_by_shell = result.exit_code > 128 && result.exit_code < 128 + 32;
    if (const int signal = told_by_shell ? result.exit_code - 128 : result.signal; signal != 0)
        fail(command, fmt::format("{} was killed by signal {} ({})", command.name, signal, strsignal(signal)));
    if (result.exit_code != 0) fail(command, fmt::format("{} ended with exit code {}", command.name, result.exit_code));
}

Image image_of(const ImageCommand& command) {
    if (!std::filesystem::exists(command.out)) fail(command, command.name + " wrote no image");
    const LayeredImage file = [&] {
        try {
            return read_image(command.out);
        } catch (const InputError& error) {
            fail(command, fmt::format("its image cannot be read: {}", error.what()));
        }
    }();
    const Image* image = file.find("");
    if (!image) fail(command, "its image has no channels R,G,B");
    if (image->width != command.width || image->height != command.height)
        fail(command, fmt::format("its image has {} x {} pixels, the scene has {} x {}", image->width, image->height,
                                  command.width, command.height));
    if (const std::size_t bad = image->non_finite_values(); bad > 0) {
        const auto first = std::ranges::find_if(image->rgb, [](float v) { return !std::isfinite(v); });
        const auto pixel = static_cast<int>((first - image->rgb.begin()) / 3);
        fail(command, fmt::format("{} of the {} values of its image are not finite, the first in column {} of row {}",
                                  bad, image->rgb.size(), pixel % image->width, pixel / image->width));
    }
    return *image;
}

namespace fs = std::filesystem;

std::string absolute(const std::string& path) { return fs::absolute(path).lexically_normal().string(); }

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

CommandImage run_image_command(const std::string& program, const ImageCommand& command) {
    CommandResult cost = run_command(program, {.command = command.command,
                                               .folder = command.folder,
                                               .timeout = command.timeout,
                                               .output_file = command.cell_folder + "/stdout.txt",
                                               .message_file = command.cell_folder + "/stderr.txt",
                                               .work_folder = command.work_folder});
    require_success(command, cost);
    return {image_of(command), cost};
}

CellTiming run_external_cell(const std::string& program, const ExternalCell& cell) {
    const std::string work = absolute(cell.work_folder), out = work + "/image." + cell.method.image_format;
    std::string scene = absolute(cell.scene_file);
    if (!cell.scene_text.empty()) {
        scene = work + "/scene.pov";
        write_file(scene, cell.scene_text);
    }
    std::map<std::string, std::string> values = {{"scene", scene},
                                                 {"out", out},
                                                 {"spp", std::to_string(cell.spp)},
                                                 {"seed", std::to_string(cell.seed)},
                                                 {"threads", std::to_string(cell.threads)},
                                                 {"width", std::to_string(cell.width)},
                                                 {"height", std::to_string(cell.height)}};
    if (cell.seconds) values["seconds"] = fmt::format("{}", *cell.seconds);
    const auto [image, cost] = run_image_command(program, {.name = "its command",
                                                           .command = filled_command(cell.method, values),
                                                           .out = out,
                                                           .folder = absolute(cell.folder),
                                                           .timeout = cell.method.timeout,
                                                           .width = cell.width,
                                                           .height = cell.height,
                                                           .cell_folder = cell.cell_folder,
                                                           .work_folder = work});
    write_scratch_exr(checkpoint_image(cell.work_folder, cell.spp), {{{"", image}}, {}});
    CellTiming timing;
    timing.measurement.checkpoints.push_back(
        {.passes = cell.spp, .seconds = cost.seconds, .counts = {}, .peak_rss_mib = cost.peak_rss_mib});
    timing.measurement.stages.push_back({"command", cost.seconds});
    return timing;
}

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
