#include "experiments/measuring/cell_process.h"

#include "common/core/parallel.h"
#include "common/images/image_file.h"
#include "common/reader/scene_file.h"
#include "experiments/filter/checkpoint_filter.h"
#include "experiments/measuring/child_request.h"
#include "experiments/measuring/measurement_json.h"
#include "experiments/plan/label_checks.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <sstream>

namespace gib {

static auto json_fields(RecordOf<CellRequest> auto& r) {
    return std::tuple(
        JsonField{"scene", r.scene_path}, JsonField{"resolution", r.resolution}, JsonField{"folders", r.folders},
        JsonField{"scene_hash", r.scene_hash}, JsonField{"method", r.method}, JsonField{"seed", r.seed},
        JsonField{"seconds", r.budget.seconds}, JsonField{"passes", r.budget.passes}, JsonField{"threads", r.threads},
        JsonField{"features", r.features}, JsonField{"variance", r.variance}, JsonField{"work_folder", r.work_folder});
}

static auto json_fields(RecordOf<Measurement> auto& m) {
    return std::tuple(JsonField{"load_seconds", m.load_seconds}, JsonField{"prepare_seconds", m.prepare_seconds},
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
    const MeasureWork work{.scene = *loaded.scene,
                           .method = *method,
                           .seed = request.seed,
                           .spp = last_pass(configured.values, loaded.sample_count),
                           .budget = request.budget,
                           .filter = filter.does_anything() ? &filter : nullptr};

    auto said = clock::now();
    const auto sink = [&](const Checkpoint& checkpoint, ComponentImages&& image) {
        LayeredImage file = layers_of(std::move(image));
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
    Measurement measured = measure(work, sink, observer);
    measured.load_seconds = load_seconds;
    leave_result(request, measured);
}

}  // namespace

void measure_cell(const std::string& request_file) {
    const auto request = request_of_parent<CellRequest>(request_file);
    with_threads(request.threads, [&] { measure_request(request); });
}

Measurement run_cell_process(const CellRequest& request, const PassObserver& observer) {
    const auto show = [&](const std::string& line) {
        std::istringstream words(line);
        std::uint32_t passes = 0;
        double seconds = 0;
        if (observer && words >> passes >> seconds) observer(passes, seconds);
    };
    return result_of_child<Measurement>("measure-cell", request, show);
}

std::string checkpoint_image(const std::string& work_folder, std::uint32_t passes) {
    return fmt::format("{}/checkpoint-{}.exr", work_folder, passes);
}

}  // namespace gib
