#include "tests/hard_cases.h"

namespace gib::test {

namespace {

/// Mean over pixels and channels, and its standard error from the scatter of the pixels.
struct ImageMean {
    double mean = 0, error = 0, smallest = std::numeric_limits<double>::infinity(), largest = 0;
};

ImageMean image_mean(const Image& image) {
    ImageMean result;
    double squares = 0;
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        const double x = static_cast<double>(image.at(i).mean());
        result.mean += x;
        squares += x * x;
        result.smallest = std::min(result.smallest, x);
        result.largest = std::max(result.largest, x);
    }
    const auto n = static_cast<double>(image.pixels());
    result.mean /= n;
    result.error = std::sqrt(std::max(squares / n - result.mean * result.mean, 0.0) / (n - 1));
    return result;
}

}  // namespace

void expect_answer(const CaseAndMethod& pair) {
    const HardCase& hard = *pair.hard;
    const TemporaryFolder folder;
    const LoadedScene scene = scene_of(hard.scene(folder));
    if (!simulates(pair.method->label, *scene.scene)) GTEST_SKIP() << "the method leaves effects of the scene out";
    const Image image = render(scene, pair.method->label, hard.passes, 1, 1).total();
    for (const float x : image.rgb)
        ASSERT_TRUE(std::isfinite(x) && x >= 0.f) << x;
    const ImageMean found = image_mean(image);
    // A thousand pairs: 4.5 standard errors are exceeded by chance in one of 150 runs of the whole table; seeds are
    // fixed.
    const double bound = 4.5 * found.error + (pair.method->bias + 1e-5) * hard.expected;
    SCOPED_TRACE(hard.reason);
    switch (hard.relation) {
        case Relation::equal:
            EXPECT_NEAR(found.mean, hard.expected, bound);
            break;
        case Relation::at_most:
            EXPECT_LE(found.mean, hard.expected + bound);
            break;
        case Relation::black:
            EXPECT_EQ(found.largest, 0.0);
            break;
    }
    if (hard.every_pixel && pair.method->bias == 0) {
        EXPECT_NEAR(found.smallest, hard.expected, 1e-4 * hard.expected);
        EXPECT_NEAR(found.largest, hard.expected, 1e-4 * hard.expected);
    }
    testing::Test::RecordProperty("mean", std::to_string(found.mean));
    testing::Test::RecordProperty("standard_error", std::to_string(found.error));
    if (std::getenv("GIB_HARD_PRINT"))
        std::printf("%-40s %-12s mean %.6g +- %.2g (%.4g to %.4g), expected %.6g\n", hard.name.c_str(),
                    pair.method->name.c_str(), found.mean, found.error, found.smallest, found.largest, hard.expected);
}

}  // namespace gib::test
