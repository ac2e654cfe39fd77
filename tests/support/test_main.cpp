// GoogleTest's main, with floating-point exceptions trapped in the builds that have it.

#include "common/core/float_traps.h"

#include <gtest/gtest.h>

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    gib::trap_floating_point_errors();
    return RUN_ALL_TESTS();
}
