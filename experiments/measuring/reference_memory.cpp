// Memory of a reference, counted in images, for each component and the total: the groups, the reference with its own copy of
// the groups, the same as layers, and the file's bytes twice, because noise hardly compresses. A round takes less, a batch of
// each group and two references.
#include "experiments/measuring/reference_memory.h"

#include "common/core/memory_limit.h"
#include "experiments/metrics/reference_image.h"

#include <fmt/format.h>

namespace gib {

void require_memory_for_reference(int width, int height) {
    const double whole = reference_groups + 2;
    const double layers = (reference_groups + 4 * whole) * (component_count + 1);
    require_memory(3.0 * sizeof(float) * width * height * layers,
                   fmt::format("a reference of {} x {} pixels", width, height));
}

}  // namespace gib
