#include "experiments/measuring/cell_process.h"

#include "common/core/files.h"
#include "common/core/parallel.h"
#include "common/images/image_file.h"
#include "common/reader/scene_file.h"
#include "experiments/measuring/measurement_json.h"
#include "experiments/system/child_process.h"
#include "experiments/text/json_file.h"

#include <fmt/format.h>

#include <unistd.h>
#include <chrono>
#include <cstdio>
#include <sstream>

namespace gib {

using nlohmann::json;

namespace {

json to_json(const CellRequest& r) {
    json j = {{"scene", r.scene_path}, {"scene_hash", r.scene_hash}, {"method", r.method},
              {"seed", r.seed},        {"threads", r.threads},       {"work_folder", r.work_folder},
              {"resolution", nullptr}, {"seconds", nullptr},         {"passes", nullptr},
              {"parent", getpid()}};
    if (r.resolution) j["resolution"] = {r.resolution->first, r.resolution->second};
    if (r.budget.seconds) j["seconds"] = *r.budget.seconds;
    if (r.budget.passes) j["passes"] = *r.budget.passes;
    return j;
}

CellRequest request_from(const json& j) {
    CellRequest r;
    r.scene_path = j.at("scene");
    r.scene_hash = j.at("scene_hash");
    r.method = j.at("method");
    r.seed = j.at("seed");
    r.threads = j.at("threads");
    r.work_folder = j.at("work_folder");
    if (!j.at("resolution").is_null()) r.resolution = j.at("resolution").get<std::pair<int, int>>();
    if (!j.at("seconds").is_null()) r.budget.seconds = j.at("seconds").get<double>();
    if (!j.at("passes").is_null()) r.budget.passes = j.at("passes").get<std::uint32_t>();
    return r;
}

void measure_request(const CellRequest& request) {
    using clock = std::chrono::steady_clock;
    const auto load_start = clock::now();
    const LoadedScene loaded = load_scene(request.scene_path, {{}, request.resolution});
    const double load_seconds = std::chrono::duration<double>(clock::now() - load_start).count();
    if (loaded.content_hash != request.scene_hash)
        throw RunError(fmt::format("the scene '{}' was changed while the experiment ran", request.scene_path));

    const MethodLabel label = MethodLabel::parse(request.method);
    const MethodDescription& description = find_method(label.name);
    const ParameterValues values(all_parameters(description), label);
    const auto method = description.create(values, {loaded.max_edges});
    const CellWork work{.scene = *loaded.scene,
                        .method = *method,
                        .seed = request.seed,
                        .spp = last_pass(values, loaded.sample_count),
                        .budget = request.budget};

    auto said = clock::now();
    const auto sink = [&](const Checkpoint& checkpoint, const ComponentImages& image) {
        write_scratch_exr(checkpoint_image(request.work_folder, checkpoint.passes), layers_of(image));
    };
    const auto observer = [&](std::uint32_t passes, double seconds) {
        if (clock::now() - said < std::chrono::milliseconds(200)) return;
        said = clock::now();
        fmt::print("{} {}\n", passes, seconds);
        std::fflush(stdout);
    };
    const Measurement measurement = measure(work, sink, observer);

    json checkpoints = json::array();
    for (const auto& c : measurement.checkpoints)
        checkpoints.push_back(checkpoint_to_json(c));
    const json timing = {{"load_seconds", load_seconds},
                         {"prepare_seconds", measurement.prepare_seconds},
                         {"converged", measurement.converged},
                         {"checkpoints", checkpoints},
                         {"stages", stages_to_json(measurement.stages)}};
    write_file(request.work_folder + "/timing.json", timing.dump(1) + "\n");
}

CellTiming timing_from(const std::string& path) {
    try {
        const json j = read_json(path);
        CellTiming timing;
        timing.load_seconds = j.at("load_seconds");
        timing.measurement.prepare_seconds = j.at("prepare_seconds");
        timing.measurement.converged = j.at("converged");
        for (const auto& c : j.at("checkpoints"))
            timing.measurement.checkpoints.push_back(checkpoint_from_json(c));
        timing.measurement.stages = stages_from_json(j.at("stages"));
        if (timing.measurement.checkpoints.empty()) throw RunError("the cell's process measured nothing");
        return timing;
    } catch (const json::exception& error) {
        throw RunError(fmt::format("the cell's process left a record that cannot be read: {}", error.what()));
    } catch (const InputError& error) {
        throw RunError(fmt::format("the cell's process left no record: {}", error.what()));
    }
}

}  // namespace

void measure_cell(const std::string& request_file) {
    const CellRequest request = [&] {
        try {
            const json j = read_json(request_file);
            die_with_parent(j.at("parent"));
            return request_from(j);
        } catch (const json::exception& error) {
            throw InputError({request_file}, fmt::format("not a request: {}", error.what()));
        }
    }();
    with_threads(request.threads, [&] { measure_request(request); });
}

CellTiming run_cell_process(const std::string& program, const CellRequest& request, const PassObserver& observer) {
    const std::string request_file = request.work_folder + "/request.json";
    write_file(request_file, to_json(request).dump(1) + "\n");
    run_child({program, "measure-cell", request_file}, [&](const std::string& line) {
        std::istringstream words(line);
        std::uint32_t passes = 0;
        double seconds = 0;
        if (observer && words >> passes >> seconds) observer(passes, seconds);
    });
    return timing_from(request.work_folder + "/timing.json");
}

std::string checkpoint_image(const std::string& work_folder, std::uint32_t passes) {
    return fmt::format("{}/checkpoint-{}.exr", work_folder, passes);
}

}  // namespace gib
