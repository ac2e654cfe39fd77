#pragma once
// Converts measurements to JSON and back: a cell's process hands them over as JSON, and they are stored as JSON.

#include "experiments/measuring/measure.h"
#include "experiments/text/json_record.h"

namespace gib {

auto json_fields(RecordOf<NonFinite> auto& bad) {
    return std::tuple(JsonField{"count", bad.count}, JsonField{"first_pass", bad.first_pass},
                      JsonField{"first_pixel", bad.first_pixel});
}

auto json_fields(RecordOf<Checkpoint> auto& c) {
    return std::tuple(JsonField{"passes", c.passes}, JsonField{"seconds", c.seconds},
                      JsonField{"photons", c.counts.photons}, JsonField{"rays", c.counts.rays},
                      JsonField{"nonfinite", c.counts.non_finite}, JsonField{"peak_rss_mib", c.peak_rss_mib});
}

auto json_fields(RecordOf<StageTimes::Stage> auto& stage) {
    return std::tuple(JsonField{"stage", stage.name}, JsonField{"seconds", stage.seconds});
}

}  // namespace gib
