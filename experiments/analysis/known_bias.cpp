#include "experiments/analysis/known_bias.h"

#include "experiments/metrics/reference_image.h"
#include "experiments/results/judgement.h"
#include "methods/method.h"

#include <algorithm>

namespace gib {

bool is_unbiased(const TableRow& row, const std::string& components_left_out) {
    const MethodLabel label = MethodLabel::parse(row.method);
    const auto& methods = method_registry();
    const auto method =
        std::find_if(methods.begin(), methods.end(), [&](const auto& m) { return m.name == label.name; });
    if (method == methods.end() || !method->unbiased || !row.effects_missing.empty() || row.nonfinite > 0) return false;
    if (std::any_of(label.values.begin(), label.values.end(), [](const auto& v) { return v.first == "max_depth"; }))
        return false;
    const auto left_out = components_named(components_left_out);
    return std::none_of(left_out.begin(), left_out.end(),
                        [&](Component c) { return row.component == total_name || row.component == name_of(c); });
}

}  // namespace gib
