// Requests for more memory than there is are refused, with both numbers, before the memory is taken.

#include "common/core/memory_limit.h"

#include "common/mesh_files/mesh_data.h"
#include "methods/parts/gathering/irradiance_cache.h"
#include "tests/support/input_error.h"
#include "tests/support/run_fixtures.h"
#include "tests/support/source_path.h"

#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

namespace gib::test::memory_limit_test {
namespace {

#ifdef GIB_SANITIZED
constexpr bool no_limit = true;
#else
constexpr bool no_limit = false;
#endif

class MemoryLimitTest : public ::testing::Test, protected ExperimentFolder {
protected:
    double available() const { return available_memory(path("proc"), path("groups")); }
    /// Matches a message with the numbers of bytes that `what` needs and that are available.
    static ::testing::Matcher<std::string> refusal(const std::string& what) {
        return ContainsRegex(what + ".* needs [0-9]+ bytes, and [0-9]+ are available");
    }
};

TEST_F(MemoryLimitTest, IsTheLeastOfWhatTheSystemAndTheGroupsLeave) {
    EXPECT_TRUE(std::isinf(available())) << "nothing says so";
    write("proc/meminfo", "MemTotal:       2000 kB\nMemFree:   10 kB\nMemAvailable:    1000 kB\n");
    EXPECT_EQ(available(), 1000 * 1024);
    write("proc/self/cgroup", "0::/outer/inner\n");
    EXPECT_EQ(available(), 1000 * 1024) << "the group's files are not there";
    write("groups/outer/inner/memory.max", "max\n");
    EXPECT_EQ(available(), 1000 * 1024);
    write("groups/outer/memory.max", "500000\n");
    EXPECT_EQ(available(), 500000) << "the limit of a group above";
    write("groups/outer/memory.current", "300000\n");
    EXPECT_EQ(available(), 200000);
    write("groups/outer/memory.stat", "anon 200000\ninactive_file 100000\n");
    EXPECT_EQ(available(), 300000) << "pages of files are given up";
    write("groups/outer/inner/memory.max", "1000\n");
    write("groups/outer/inner/memory.current", "4000\n");
    EXPECT_EQ(available(), 0);
}

/// During its life, programs that the test starts have this much address space [bytes].
class AddressSpace {
public:
    explicit AddressSpace(rlim_t bytes) {
        getrlimit(RLIMIT_AS, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        setrlimit(RLIMIT_AS, &limit);
    }
    ~AddressSpace() { setrlimit(RLIMIT_AS, &before_); }
    AddressSpace(const AddressSpace&) = delete;
    AddressSpace& operator=(const AddressSpace&) = delete;

private:
    rlimit before_;
};

TEST_F(MemoryLimitTest, RendersThatAskForTooMuchAreRefused) {
    if (no_limit) GTEST_SKIP() << "the sanitizer's address space has no limit";
    const AddressSpace limit(rlim_t{4} << 30);
    const std::string many = "=4000000000";  // the largest value of these parameters
    const std::vector<std::pair<std::string, std::string>> requests = {
        {"photon_mapper photons" + many, "photons" + many},
        {"photon_mapper gather=4 photons" + many, "photons" + many},
        {"photon_mapper photons=1000 shadow_photons" + many, "shadow_photons" + many},
        {"photon_view photons" + many, "photons" + many},
        {"radiosity patch=1e-5", "radiosity"},
        {"radiosity patch=0.002 solver=direct", "radiosity"},
        {"radiosity patch=5e-4", "radiosity of [0-9]+ patches needs"}};
    for (const auto& [method, what] : requests) {
        EXPECT_THAT(
            gibench("render '" + source_path("scenes/cornell-box.xml") + "' --method '" + method + "' -o out.exr"),
            exits(2, ContainsRegex(what + ".* [0-9]+ bytes")))
            << method;
        EXPECT_FALSE(std::filesystem::exists(path("out.exr"))) << method;
    }
}

TEST_F(MemoryLimitTest, AnImageIsNotBelievedToBeAsLargeAsItsHeaderSays) {
    if (no_limit) GTEST_SKIP() << "the sanitizer's address space has no limit";
    const AddressSpace limit(rlim_t{4} << 30);
    write("large.pfm", "PF\n50000 50000\n-1.0\n" + std::string(1 << 20, '\0'));
    EXPECT_THAT(gibench("compare large.pfm large.pfm"),
                exits(2, refusal("large.pfm:1:1: an image of 50000 x 50000 pixels")));
    std::string sky = tiny_scene_xml(4);
    sky.insert(sky.find("</scene>"), emitter("envmap", text("filename", "large.pfm")));
    write("sky.xml", sky);
    EXPECT_THAT(gibench("render sky.xml --method 'path spp=1' -o out.exr"),
                exits(2, refusal("large.pfm:1:1: an image of 50000 x 50000 pixels")));
}

/// The address space of this process [bytes].
rlim_t address_space_in_use() {
    std::ifstream statistics("/proc/self/statm");
    rlim_t pages = 0;
    statistics >> pages;
    return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

// The number of records is not known beforehand, so the cache asks for memory each time it doubles its room.
TEST_F(MemoryLimitTest, AGrowingIrradianceCacheAsksBeforeItDoubles) {
    if (no_limit) GTEST_SKIP() << "the sanitizer's address space has no limit";
    IrradianceCache cache({Vec3::Zero(), Vec3::Ones()}, 0.1f);
    const AddressSpace limit(address_space_in_use() + (rlim_t{64} << 20));
    IrradianceRecord record{};
    record.irradiance = Color::Ones();
    record.rotation.fill(Vec3::Zero());
    record.translation.fill(Vec3::Zero());
    record.n = Vec3::UnitZ();
    record.distance = 1e-3f;
    const std::string error = input_error_of([&] {
        for (int i = 0; i < 1'000'000; ++i) {
            record.p =
                Vec3(static_cast<float>(i % 100), static_cast<float>(i / 100 % 100), static_cast<float>(i / 10'000)) /
                100;
            cache.insert(record, {1e-4f, 1e-4f});
        }
    });
    EXPECT_THAT(error, refusal("an irradiance cache of more than [0-9]+ records"));
    EXPECT_GT(cache.size(), 1'000u);
}

}  // namespace
}  // namespace gib::test::memory_limit_test
