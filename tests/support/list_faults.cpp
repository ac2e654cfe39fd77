// The names of the mistakes that a build with GIB_FAULTS can make, for scripts/faults.
#include "common/core/fault.h"

#include <cstdio>

int main() {
    for (const auto& fault : gib::fault_descriptions())
        std::printf("%.*s\n", static_cast<int>(fault.name.size()), fault.name.data());
}
