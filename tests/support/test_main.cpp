// GoogleTest's main(). In builds with GIB_FLOAT_TRAPS, floating-point exceptions end the tests.

#include "common/core/float_traps.h"

#include <gtest/gtest.h>

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    gib::trap_floating_point_errors();
    return RUN_ALL_TESTS();
}
