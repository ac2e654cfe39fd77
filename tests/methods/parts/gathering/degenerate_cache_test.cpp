// Irradiance records and their cache at the limits of their formulas: distances of 0, dark edges, values near the
// ends of the range of floats, corners and needles.

#include "common/core/float_traps.h"
#include "methods/parts/gathering/irradiance_cache.h"
#include "tests/support/hard_cases.h"
#include "tests/support/moments.h"
#include "tests/support/scene_fixtures.h"
#include "tests/support/scene_text.h"

#include <vector>

namespace gib::test::degenerate_cache_test {
namespace {

const Vec3 up(0, 0, 1);
constexpr float accuracy = 0.1f;

/// A record with radiance L in even strata and 3 L in odd ones. All strata are
/// seen at `distance`, except those in `near`.
IrradianceRecord striped_record(float L, float distance, const std::vector<int>& near, float near_distance) {
    const auto strata = HemisphereStrata::of(64);
    std::vector<HemisphereSample> samples;
    for (int i = 0; i < strata.count(); ++i)
        samples.push_back({Color::Constant(i % 2 == 0 ? L : 3 * L), distance});
    for (const int i : near)
        samples[static_cast<std::size_t>(i)].distance = near_distance;
    return irradiance_record(Vec3::Zero(), Frame(up), strata, samples);
}

float mean_striped(float L) {
    const int n = HemisphereStrata::of(64).count();
    return pi * L * static_cast<float>(1 * ((n + 1) / 2) + 3 * (n / 2)) / static_cast<float>(n);
}

// The harmonic mean with a distance of 0 is 0. Irradiance does not depend on distances. A surface that touches the
// point leaves its stratum at once when the point moves, so it says nothing about the motion of edges.
TEST(DegenerateRecord, ThatTouchesASurfaceIsFiniteAndServesNothingElse) {
    const int n = HemisphereStrata::of(64).count();
    std::vector<int> all;
    for (int i = 0; i < n; ++i)
        all.push_back(i);
    for (const auto& near : {std::vector<int>{0}, std::vector<int>{n - 1}, std::vector<int>{3, 4, 5}, all}) {
        const IrradianceRecord record = striped_record(1.f, 2.f, near, 0.f);
        ASSERT_TRUE(record.is_finite()) << near.size();
        EXPECT_EQ(record.distance, 0.f);
        EXPECT_NEAR(record.irradiance[0], mean_striped(1.f), 1e-5f);
        if (near.size() == all.size()) {
            EXPECT_EQ(record.translation[0], Vec3::Zero()) << "no edge is left";
        }
    }
    EXPECT_EQ(striped_record(1.f, infinity, {}, 0.f).distance, infinity) << "the sky";
    EXPECT_EQ(striped_record(1.f, infinity, {}, 0.f).translation[0], Vec3::Zero());
}

Bounds box_of(float size) {
    Bounds bounds;
    bounds.lower = Vec3::Constant(-size);
    bounds.upper = Vec3::Constant(size);
    return bounds;
}

/// How far the cache serves points along x [scene units], at most `most`, by bisection.
float reach_of(const IrradianceCache& cache, float most) {
    float inside = 0.f, outside = most;
    if (!cache.covers(Vec3::Zero(), up)) return 0.f;
    for (int i = 0; i < 40; ++i) {
        const float middle = 0.5f * (inside + outside);
        (cache.covers(Vec3(middle, 0, 0), up) ? inside : outside) = middle;
    }
    return outside;
}

IrradianceRecord plain_record(float E, const Vec3& slope, float distance) {
    IrradianceRecord record;
    record.p = Vec3::Zero();
    record.n = up;
    record.irradiance = Color::Constant(E);
    record.rotation.fill(Vec3::Zero());
    record.translation.fill(slope);
    record.distance = distance;
    return record;
}

struct ClampCase {
    std::string name;
    IrradianceRecord record;
    RecordSpacing spacing;
    float reach;  ///< reach by theory; 0: the record is not kept
    std::string reason;
};

std::vector<ClampCase> clamp_cases() {
    const Vec3 none = Vec3::Zero();
    const RecordSpacing any = {0.f, 10.f}, some = {0.01f, 0.2f};
    std::vector<ClampCase> cases = {
        {"Distance0", plain_record(1, none, 0), some, 0.01f, "the least spacing"},
        {"Distance0WithoutSpacing", plain_record(1, none, 0), any, 0, "serves not even its own place"},
        {"DistanceInfinite", plain_record(1, none, infinity), some, 0.2f, "the greatest spacing"},
        {"DarkEdge", plain_record(0, Vec3(1, 0, 0), 1), some, 0.01f, "E changes by more than itself over any way"},
        {"DarkEdgeWithoutSpacing", plain_record(0, Vec3(1, 0, 0), 1), any, 0, "the same"},
        {"Black", plain_record(0, none, 1), some, 0.1f, "its distance, times the accuracy"},
        {"EqualSpacings", plain_record(1, none, 1), {0.05f, 0.05f}, 0.05f, "both"},
    };
    for (const auto& [name, scale] : {std::pair("1", 1.f), std::pair("1e36", 1e36f), std::pair("1eMinus30", 1e-30f)})
        cases.push_back({"Slope" + std::string(name), plain_record(scale, Vec3(0, 2 * scale, 0), 1), any, 0.05f,
                         "|E| / |slope| = 1/2, in any unit of radiance"});
    return cases;
}

class GradientClamp : public testing::TestWithParam<ClampCase> {};
INSTANTIATE_TEST_SUITE_P(Table, GradientClamp, testing::ValuesIn(clamp_cases()),
                         [](const auto& test) { return test.param.name; });

TEST_P(GradientClamp, HasTheReachOfTheory) {
    const ClampCase& c = GetParam();
    SCOPED_TRACE(c.reason);
    IrradianceCache cache(box_of(20.f), accuracy);
    cache.insert(c.record, c.spacing);
    EXPECT_EQ(cache.size(), c.reach > 0.f ? 1u : 0u);
    EXPECT_NEAR(reach_of(cache, 20.f), c.reach, 1e-5f * c.reach);
    EXPECT_EQ(cache.interpolate(Vec3::Zero(), up).has_value(), c.reach > 0.f);
    if (c.reach == 0.f) return;
    // Within its reach, E changes by at most the share `accuracy` of itself and is never below 0.
    for (const float x : {-0.9f, 0.f, 0.9f})
        for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0)}) {
            const auto E = cache.interpolate(x * c.reach * axis, up);
            ASSERT_TRUE(E && E->isFinite().all());
            const float here = c.record.irradiance[0];
            EXPECT_GE((*E)[0], 0.f);
            EXPECT_LE(std::abs((*E)[0] - here), 1.00001f * accuracy * here);
        }
}

// A hundred records in one place differ in irradiance; their mean is served, at the place and around it.
TEST(DegenerateCache, RecordsInOnePlaceAreAveraged) {
    IrradianceCache cache(box_of(1.f), accuracy);
    for (int i = 0; i <= 100; ++i)
        cache.insert(plain_record(static_cast<float>(i), Vec3::Zero(), 1), {0.f, 1.f});
    for (const float x : {0.f, 0.03f, 0.09f})
        EXPECT_NEAR((*cache.interpolate(Vec3(x, 0, 0), up))[0], 50.f, 1e-3f) << x;
    EXPECT_FALSE(cache.covers(Vec3(0.11f, 0, 0), up));
}

/// A furnace in the form of a cube of side 2. Its walls reflect a half and emit a
/// half, so that the radiance is 1 everywhere.
std::string furnace_cube(const std::string& view, const std::string& things) {
    const std::string half = diffuse_bsdf(0.5) + area_light(0.5);
    return scene_xml(camera(8, view, box_film(8)) + shape("cube", flag("flip_normals"), half) + things);
}

/// White triangles a millionth as wide as long, in a strip along the diagonal of the floor.
std::string needles(const TemporaryFolder& folder) {
    std::string obj;
    constexpr int count = 8;
    for (int i = 0; i <= count; ++i)
        for (const double end : {-0.99, 0.99})
            obj += fmt::format("v {} {} 0\n", end + (i - count / 2) * 1e-6, end);
    for (int i = 0; i < count; ++i) {
        const int a = 2 * i + 1;
        obj += fmt::format("f {0} {2} {1}\nf {2} {3} {1}\n", a, a + 1, a + 2, a + 3);
    }
    folder.write("needles.obj", obj);
    return shape("obj", text("filename", folder / "needles.obj"), diffuse(1));
}

// In the furnace's corner, walls are seen at distances down to 0. Half of the radiance 1 is emitted and a quarter is
// light that comes straight from the walls; the remaining quarter is indirect. White needles reflect all light, and
// half of it comes straight from the walls. Records are made of paths, so that only their noise is left: the mean of
// eight seeds deviates by 5.4 of its standard errors once in a thousand times (Student's t of 7).
TEST(DegenerateCache, CornersAndNeedlesHaveTheRadianceOfTheFurnace) {
    const TemporaryFolder folder;
    struct Seen {
        std::string name, scene;
        double indirect;
    };
    for (const Seen& seen :
         {Seen{"corner", furnace_cube(Place{}.view({0, 0, 0}, {-1, -1, -1}), ""), 0.25},
          Seen{"needles", furnace_cube(Place{}.view({0, 0, 1e-5}, {0, 0, 0}), needles(folder)), 0.5}}) {
        const LoadedScene scene = scene_of(seen.scene);
        Moments mean;
        for (std::uint64_t seed = 1; seed <= 8; ++seed) {
            const ComponentImages image = render(scene, "photon_mapper gather=256 source=paths cache=on", 1, seed);
            for (const float x : image.total().rgb)
                ASSERT_TRUE(std::isfinite(x) && x >= 0.f);
            mean.add(mean_of(*image[Component::indirect]).mean());
        }
        EXPECT_NEAR(mean.mean(), seen.indirect, 5.4 * mean.standard_error()) << seen.name;
        EXPECT_LT(mean.standard_error(), 0.05 * seen.indirect) << "the test would not see an error";
    }
}

}  // namespace
}  // namespace gib::test::degenerate_cache_test
