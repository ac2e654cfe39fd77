#include "experiments/run/run_plan.h"

#include "common/core/error.h"
#include "common/core/files.h"
#include "experiments/text/json_file.h"
#include "experiments/text/json_record.h"

#include <fmt/format.h>

namespace gib {

using nlohmann::json;

static auto json_fields(RecordOf<RunPlan::Scene> auto& s) {
    return std::tuple(JsonField{"name", s.name}, JsonField{"content_hash", s.content_hash},
                      JsonField{"sample_count", s.sample_count}, JsonField{"width", s.width},
                      JsonField{"height", s.height});
}

static auto json_fields(RecordOf<RunPlan::LeftOut> auto& l) {
    return std::tuple(JsonField{"scene", l.scene}, JsonField{"method", l.method}, JsonField{"effects", l.effects},
                      JsonField{"components", l.components});
}

static auto json_fields(RecordOf<PlannedBatch> auto& b) {
    return std::tuple(JsonField{"scene", b.scene}, JsonField{"maker", b.batch.maker},
                      JsonField{"number", b.batch.number}, JsonField{"passes", b.batch.passes},
                      JsonField{"passes_before", b.batch.passes_before});
}

static auto json_fields(RecordOf<CellPlace> auto& p) {
    return std::tuple(JsonField{"scene", p.scene}, JsonField{"method", p.method}, JsonField{"seed", p.seed});
}

static auto json_fields(RecordOf<RunPlan> auto& p) {
    return std::tuple(JsonField{"experiment", p.experiment}, JsonField{"experiment_text", p.experiment_text},
                      JsonField{"out", p.out}, JsonField{"only", p.only}, JsonField{"command_line", p.command_line},
                      JsonField{"threads", p.threads}, JsonField{"seeds", p.seeds}, JsonField{"scenes", p.scenes},
                      JsonField{"methods", p.methods}, JsonField{"left_out", p.left_out},
                      JsonField{"batches", p.batches}, JsonField{"cells", p.cells});
}

void write_plan(const std::string& path, const RunPlan& plan) {
    // A command line may hold bytes that are not UTF-8.
    write_file(path, json(plan).dump(-1, ' ', false, json::error_handler_t::replace) + "\n");
}

RunPlan read_plan(const std::string& path) {
    try {
        return read_json(path).get<RunPlan>();
    } catch (const json::exception& error) {
        throw InputError({path}, fmt::format("not a plan of a run: {}", error.what()));
    }
}

}  // namespace gib
