#include "experiments/external/external_cell.h"

#include "common/core/files.h"
#include "common/images/image_file.h"
#include "experiments/external/command_process.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <sstream>

namespace gib {

namespace {

namespace fs = std::filesystem;

std::string absolute(const std::string& path) { return fs::absolute(path).lexically_normal().string(); }

/// The last line of a file that is not empty.
std::string last_line(const std::string& file) {
    std::istringstream text(read_file(file));
    std::string last;
    for (std::string line; std::getline(text, line);)
        if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
    return last;
}

/// Throws RunError with the last line of the command's standard error.
[[noreturn]] void fail(const ExternalCell& cell, const std::string& what) {
    const std::string messages = cell.cell_folder + "/stderr.txt";
    const std::string said = last_line(messages);
    throw RunError(said.empty() ? what : fmt::format("{}; its last message: {} (all are in {})", what, said, messages));
}

void require_success(const ExternalCell& cell, const CommandResult& result) {
    if (result.timed_out)
        fail(cell, fmt::format("its command was ended after its timeout of {:g} s", cell.method.timeout));
    // A shell that has waited for its command tells a signal as the exit code 128 + signal.
    const bool told_by_shell = result.exit_code > 128 && result.exit_code < 128 + 32;
    if (const int signal = told_by_shell ? result.exit_code - 128 : result.signal; signal != 0)
        fail(cell, fmt::format("its command was killed by signal {} ({})", signal, strsignal(signal)));
    if (result.exit_code != 0) fail(cell, fmt::format("its command ended with exit code {}", result.exit_code));
}

Image image_of(const ExternalCell& cell, const std::string& path) {
    if (!fs::exists(path)) fail(cell, "its command wrote no image");
    const LayeredImage file = [&] {
        try {
            return read_image(path);
        } catch (const InputError& error) {
            fail(cell, fmt::format("its image cannot be read: {}", error.what()));
        }
    }();
    const Image* image = file.find("");
    if (!image) fail(cell, "its image has no channels R,G,B");
    if (image->width != cell.width || image->height != cell.height)
        fail(cell, fmt::format("its image has {} x {} pixels, the scene has {} x {}", image->width, image->height,
                               cell.width, cell.height));
    if (const std::size_t bad = image->non_finite_values(); bad > 0) {
        const auto first =
            std::find_if(image->rgb.begin(), image->rgb.end(), [](float v) { return !std::isfinite(v); });
        const auto pixel = static_cast<int>((first - image->rgb.begin()) / 3);
        fail(cell, fmt::format("{} of the {} values of its image are not finite, the first in column {} of row {}", bad,
                               image->rgb.size(), pixel % image->width, pixel / image->width));
    }
    return *image;
}

}  // namespace

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
    const CommandResult result = run_command(program, {.command = filled_command(cell.method, values),
                                                       .folder = absolute(cell.folder),
                                                       .timeout = cell.method.timeout,
                                                       .output_file = cell.cell_folder + "/stdout.txt",
                                                       .message_file = cell.cell_folder + "/stderr.txt",
                                                       .work_folder = work});
    require_success(cell, result);
    LayeredImage image;
    image.layers.emplace_back("", image_of(cell, out));
    write_scratch_exr(checkpoint_image(cell.work_folder, cell.spp), image);
    CellTiming timing;
    timing.measurement.checkpoints.push_back(
        {.passes = cell.spp, .seconds = result.seconds, .counts = {}, .peak_rss_mib = result.peak_rss_mib});
    timing.measurement.stages.push_back({"command", result.seconds});
    return timing;
}

}  // namespace gib
