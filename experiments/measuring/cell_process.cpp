#include "experiments/measuring/cell_process.h"

#include "common/core/files.h"
#include "common/core/parallel.h"
#include "common/images/image_file.h"
#include "common/reader/scene_file.h"
#include "experiments/filter/checkpoint_filter.h"
#include "experiments/measuring/measurement_json.h"
#include "experiments/plan/label_checks.h"
#include "experiments/system/child_process.h"
#include "experiments/text/json_record.h"

#include <fmt/format.h>

#include <unistd.h>
#include <chrono>
#include <cstdio>
#include <sstream>

namespace gib {

using nlohmann::json;

static auto json_fields(RecordOf<CellRequest> auto& r) {
    return std::tuple(
        JsonField{"scene", r.scene_path}, JsonField{"resolution", r.resolution}, JsonField{"folders", r.folders},
        JsonField{"scene_hash", r.scene_hash}, JsonField{"method", r.method}, JsonField{"seed", r.seed},
        JsonField{"seconds", r.budget.seconds}, JsonField{"passes", r.budget.passes}, JsonField{"threads", r.threads},
        JsonField{"features", r.features}, JsonField{"variance", r.variance}, JsonField{"work_folder", r.work_folder});
}

static auto json_fields(RecordOf<CellTiming> auto& timing) {
    auto& m = timing.measurement;
    return std::tuple(JsonField{"load_seconds", timing.load_seconds}, JsonField{"prepare_seconds", m.prepare_seconds},
                      JsonField{"converged", m.converged}, JsonField{"checkpoints", m.checkpoints},
                      JsonField{"stages", m.stages}, JsonField{"processor_seconds", m.processor_seconds},
                      JsonField{"waiting_seconds", m.waiting_seconds});
}

namespace {

void measure_request(const CellRequest& request) {
    using clock = std::chrono::steady_clock;
    const auto load_start = clock::now();
    const LoadedScene loaded = load_scene(request.scene_path, {{}, request.resolution, request.folders});
    const double load_seconds = std::chrono::duration<double>(clock::now() - load_start).count();
    if (loaded.content_hash != request.scene_hash)
        throw RunError(fmt::format("the scene '{}' was changed while the experiment ran", request.scene_path));

    const ConfiguredMethod configured(MethodLabel::parse(request.method));
    const auto method = configured.create({loaded.max_edges});
    CheckpointFilter filter(*loaded.scene, request.seed,
                            {.non_local_means = filter_of(configured.label) == non_local_means_filter,
                             .features = request.features,
                             .variance = request.variance});
    const CellWork work{.scene = *loaded.scene,
                        .method = *method,
                        .seed = request.seed,
                        .spp = last_pass(configured.values, loaded.sample_count),
                        .budget = request.budget,
                        .filter = filter.does_anything() ? &filter : nullptr};

    auto said = clock::now();
    const auto sink = [&](const Checkpoint& checkpoint, const ComponentImages& image) {
        LayeredImage file = layers_of(image);
        for (auto& layer : filter.layers(checkpoint.passes))
            file.layers.push_back(std::move(layer));
        write_scratch_exr(checkpoint_image(request.work_folder, checkpoint.passes), file);
    };
    const auto observer = [&](std::uint32_t passes, double seconds) {
        if (clock::now() - said < std::chrono::milliseconds(200)) return;
        said = clock::now();
        fmt::print("{} {}\n", passes, seconds);
        std::fflush(stdout);
    };
    const CellTiming timing{load_seconds, measure(work, sink, observer)};
    write_file(request.work_folder + "/timing.json", json(timing).dump(1) + "\n");
}

CellTiming timing_from(const std::string& path) {
    try {
        const auto timing = read_json(path).get<CellTiming>();
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
            return j.get<CellRequest>();
        } catch (const json::exception& error) {
            throw InputError({request_file}, fmt::format("not a request: {}", error.what()));
        }
    }();
    with_threads(request.threads, [&] { measure_request(request); });
}

CellTiming run_cell_process(const std::string& program, const CellRequest& request, const PassObserver& observer) {
    const std::string request_file = request.work_folder + "/request.json";
    json j = request;
    j["parent"] = getpid();
    write_file(request_file, j.dump(1) + "\n");
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
