// Prints the names of the mistakes that a build with GIB_FAULTS can make; scripts/faults reads them.
#include "common/core/fault.h"

#include <cstdio>

int main() {
    for (const auto& fault : gib::fault_descriptions())
        std::printf("%.*s\n", static_cast<int>(fault.name.size()), fault.name.data());
}
