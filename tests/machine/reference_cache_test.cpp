// References are made to a target, kept, topped up, and made again if their file is damaged.

#include "experiments/measuring/reference.h"

#include "common/images/image_digest.h"
#include "common/sampling/sampler.h"

#include "experiments/measuring/reference_store.h"
#include "tests/support/driver_fixtures.h"

#include <gmock/gmock.h>

#include <fstream>
#include <functional>
#include <limits>
#include <random>
#include <set>

namespace gib::test::reference_cache_test {
namespace {

MethodDescription fake_description() {
    return {"fake",
            "noise",
            {},
            Effects::all(),
            {Component::direct},
            true,
            [](const ParameterValues&, const MethodDefaults&) -> std::unique_ptr<Method> {
                return std::make_unique<FakeMethod>(FakeBehaviour{.noise = 0.5});
            }};
}

class ReferenceCacheTest : public ::testing::Test {
protected:
    FinishedReference make(std::optional<double> target, std::optional<double> seconds = std::nullopt) {
        ProgressLine progress(false);
        return make_reference({scene_, {&method_}, MethodLabel{"fake", {}}, {target, seconds}, 0.01, path_}, progress);
    }
    TemporaryFolder folder_;
    std::string path_ = folder_ / "reference.exr";
    LoadedScene scene_ = scene_of(tiny_scene_xml());
    MethodDescription method_ = fake_description();
};

TEST_F(ReferenceCacheTest, MeetsItsTarget) {
    const FinishedReference r = make(0.02);
    EXPECT_LE(r.relative_error, 0.02);
    // Noise of 0.5 in n samples has an error of 0.5 / sqrt(n): the target needs about 613.
    const double samples = 16 * std::stod(r.reference.metadata.at("passes"));
    EXPECT_GT(samples, 400);
    EXPECT_LT(samples, 1300) << "no more work than the target needs";
    EXPECT_NEAR(mean_of(r.reference.total.mean)[0], 1.0, 0.01);
    EXPECT_EQ(r.reference.total.groups.size(), static_cast<std::size_t>(reference_groups));
}

// With an absolute epsilon, noise in a dark picture is below every target.
TEST_F(ReferenceCacheTest, StopsAfterTheSamePassesInAnyUnitOfLight) {
    MethodDescription dim = method_;
    dim.create = [](const ParameterValues&, const MethodDefaults&) -> std::unique_ptr<Method> {
        return std::make_unique<FakeMethod>(FakeBehaviour{.noise = 0.5, .unit = 0x1p-13f});
    };
    const auto made = [&](const MethodDescription& method, std::optional<double> epsilon, const std::string& file) {
        ProgressLine progress(false);
        return make_reference(
            {scene_, {&method}, MethodLabel{"fake", {}}, {0.02, std::nullopt}, epsilon, folder_ / file}, progress);
    };
    const auto passes = [](const FinishedReference& r) { return std::stoul(r.reference.metadata.at("passes")); };
    const FinishedReference bright = made(method_, std::nullopt, "bright.exr");
    const FinishedReference dark = made(dim, std::nullopt, "dark.exr");
    EXPECT_EQ(passes(dark), passes(bright));
    EXPECT_NEAR(dark.relative_error, bright.relative_error, 1e-6);
    EXPECT_NEAR(bright.epsilon, 0.01, 0.001) << "the mean is 1";
    EXPECT_NEAR(dark.epsilon / bright.epsilon, 0x1p-26, 1e-12);
    EXPECT_EQ(std::stod(dark.reference.metadata.at("epsilon")), dark.epsilon);
    EXPECT_LT(2 * passes(made(dim, 0.01, "absolute.exr")), passes(bright));
}

TEST_F(ReferenceCacheTest, AGoodOneIsNotTouched) {
    const FinishedReference first = make(0.05);
    const std::string content = read_file(path_);
    const FinishedReference again = make(0.05);
    EXPECT_EQ(again.rounds_added, 0u);
    EXPECT_EQ(again.identity, first.identity);
    EXPECT_EQ(read_file(path_), content);
}

TEST_F(ReferenceCacheTest, IsToppedUpAndNotMadeAgain) {
    const FinishedReference first = make(0.05);
    const FinishedReference better = make(0.02);
    EXPECT_GT(better.rounds_added, 0u);
    EXPECT_EQ(std::stoul(better.reference.metadata.at("rounds")),
              std::stoul(first.reference.metadata.at("rounds")) + better.rounds_added);
    EXPECT_NE(better.identity, first.identity);
    EXPECT_LE(better.relative_error, 0.02);
}

TEST_F(ReferenceCacheTest, ADamagedFileIsMadeAgainWithAWarning) {
    make(0.05);
    const std::string content = read_file(path_);
    std::ofstream(path_, std::ios::binary) << content.substr(0, content.size() / 2);
    const FinishedReference r = make(0.05);
    ASSERT_FALSE(r.warnings.empty());
    EXPECT_THAT(r.warnings.front(), ::testing::HasSubstr("made again"));
    EXPECT_LE(r.relative_error, 0.05);
    EXPECT_EQ(make(0.05).rounds_added, 0u);
}

TEST_F(ReferenceCacheTest, AnotherSceneIsNoticed) {
    make(0.05);
    scene_.content_hash[0] = scene_.content_hash[0] == '0' ? '1' : '0';
    EXPECT_THAT(make(0.05).warnings, ::testing::Contains(::testing::HasSubstr("not the reference of this scene")));
}

/// The digest of all that a top-up starts from.
std::string content_of(const Reference& reference) {
    return image_digest(layers_of(reference, true), {"passes", "rounds", "unresolved"});
}

/// The image as it can be written again, without the attribute that
/// OpenImageIO adds and OpenEXR does not take as text.
LayeredImage writable_image(const std::string& path) {
    LayeredImage image = read_image(path);
    image.metadata.erase("compression");
    return image;
}

TEST_F(ReferenceCacheTest, NoFlippedBitIsBelieved) {
    const std::string good = content_of(make(0.05).reference);
    const std::string file = read_file(path_);
    std::mt19937 random(1);
    int found = 0;
    for (int i = 0; i < 100; ++i) {
        std::string damaged = file;
        const std::size_t at = random() % file.size();
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << random() % 8));
        std::ofstream(path_, std::ios::binary) << damaged;
        const FinishedReference r = make(0.05);
        EXPECT_EQ(content_of(r.reference), good) << "byte " << at;
        if (r.rounds_added == 0) continue;  // the bit does not matter, such as in the program's name
        ++found;
        ASSERT_FALSE(r.warnings.empty()) << "byte " << at;
        EXPECT_THAT(r.warnings.front(), ::testing::HasSubstr("made again"));
    }
    EXPECT_GT(found, 80);
}

TEST_F(ReferenceCacheTest, ValuesThatStillDecodeAreCompared) {
    Reference reference = make(0.05).reference;
    const std::string good = content_of(reference);
    const LayeredImage written = writable_image(path_);
    LayeredImage edited = written;
    edited.layers.back().second.rgb[7] *= 1.0000002f;
    write_exr(path_, edited);
    EXPECT_THROW(read_reference(path_), InputError);
    EXPECT_THAT(make(0.05).warnings, ::testing::Contains(::testing::HasSubstr("digest")));
    EXPECT_EQ(content_of(read_reference(path_)), good);
    edited = written;
    edited.metadata["passes"] = "1000000";
    write_exr(path_, edited);
    EXPECT_THAT(make(0.05).warnings, ::testing::Contains(::testing::HasSubstr("digest")));
    edited = written;
    edited.metadata["not_finite"] = "5";
    write_exr(path_, edited);
    EXPECT_THAT(make(0.05).warnings, ::testing::Contains(::testing::HasSubstr("digest")));
}

TEST_F(ReferenceCacheTest, FilesThatAreNoReferenceAreMadeAgain) {
    const std::string good = content_of(make(0.05).reference);
    const std::vector<std::function<void()>> damages = {[&] { std::ofstream(path_, std::ios::trunc); },
                                                        [&] { std::ofstream(path_) << "no image\n"; },
                                                        [&] {
                                                            write_exr(path_, {{{"", Image(8, 8)}}, {}});
                                                        }};
    for (std::size_t i = 0; i < damages.size(); ++i) {
        damages[i]();
        const FinishedReference r = make(0.05);
        EXPECT_THAT(r.warnings, ::testing::Contains(::testing::HasSubstr("made again"))) << i;
        EXPECT_EQ(content_of(read_reference(path_)), good) << i;
    }
}

TEST_F(ReferenceCacheTest, OneWithoutADigestIsMadeAgain) {
    make(0.05);
    LayeredImage file = writable_image(path_);
    file.metadata.erase("digest");
    write_exr(path_, file);
    const FinishedReference again = make(0.05);
    EXPECT_GT(again.rounds_added, 0u);
    EXPECT_THAT(again.warnings, ::testing::Contains(::testing::HasSubstr("it has no digest")));
}

TEST_F(ReferenceCacheTest, TimeThatIsUpIsSaidOnceAndForAll) {
    const FinishedReference r = make(1e-6, 0.05);
    EXPECT_THAT(r.warnings, ::testing::Contains(::testing::HasSubstr("target")));
    EXPECT_GE(r.rounds_added, 1u);
    EXPECT_EQ(make(1e-6, 0.05).rounds_added, 0u) << "its seconds are spent";
}

TEST_F(ReferenceCacheTest, StandardErrorIsHonest) {
    const FinishedReference r = make(0.03);
    double z2 = 0;
    const Image& mean = r.reference.total.mean;
    for (std::size_t i = 0; i < mean.rgb.size(); i += 3)  // the fake's channels are equal
        z2 += sqr(static_cast<double>(mean.rgb[i] - 1.f) /
                  static_cast<double>(r.reference.total.standard_error->rgb[i])) /
              64;
    // t with 15 degrees of freedom: E z^2 = 15 / 13; over 64 pixels its standard deviation is 0.25.
    EXPECT_NEAR(z2, 15.0 / 13.0, 1.0);
}

TEST(ReferenceGroups, WeighRoundsByTheirSamples) {
    const auto batches = [](float value) {
        ComponentImages image;
        image.width = image.height = 1;
        image[Component::direct] = Image(1, 1);
        image[Component::direct]->set(0, Color::Constant(value));
        return std::vector<ComponentImages>(reference_groups, image);
    };
    ReferenceGroups groups;
    groups.add_round(batches(1.f), 1);
    groups.add_round(batches(5.f), 3);
    EXPECT_EQ(groups.passes, 4u);
    EXPECT_EQ(groups.rounds, 2u);
    EXPECT_FLOAT_EQ(groups.reference().total.mean.rgb[0], 4.f);
    EXPECT_FLOAT_EQ(groups.reference()[Component::direct]->mean.rgb[0], 4.f);
}

TEST(BatchSeeds, AreDistinctAndNoCells) {
    std::set<std::uint64_t> seeds;
    for (std::uint32_t batch = 0; batch < 4096; ++batch) {
        seeds.insert(batch_seed("0123456789abcdef", batch));
        EXPECT_GE(batch_seed("0123456789abcdef", batch), 0x8000000000000000ull);
    }
    EXPECT_EQ(seeds.size(), 4096u);
}

TEST(UnresolvedComponents, ArePathsFromDeltaLightsThroughSpecularSurfaces) {
    const auto unresolved = [](const std::string& light) {
        const LoadedScene scene = scene_of(scene_xml("<sensor type='perspective'>" + box_film(4) + "</sensor>" + light +
                                                     "<shape type='rectangle'>" + diffuse(0.5) +
                                                     "</shape><shape type='sphere'>"
                                                     "<bsdf type='dielectric'/></shape>"));
        const auto& path = find_method("path");
        const auto method =
            path.create(ParameterValues(all_parameters(path), MethodLabel{"path", {}}), {scene.max_edges});
        return method->plan(*scene.scene).unresolved;
    };
    for (const char* type : {"point", "spot", "directional"})
        EXPECT_THAT(unresolved(std::string("<emitter type='") + type + "'/>"),
                    ::testing::ElementsAre(Component::caustic, Component::indirect));
    EXPECT_THAT(unresolved("<emitter type='constant'/>"), ::testing::IsEmpty());
    EXPECT_THAT(
        unresolved("<shape type='rectangle'><emitter type='area'><rgb name='radiance' value='1'/></emitter></shape>"),
        ::testing::IsEmpty());
}

TEST(HeavyTails, OneGroupThatCarriesTheScatterIsSeen) {
    std::vector<Image> even, spiked;
    for (int g = 0; g < reference_groups; ++g) {
        Image image(16, 16), spike(16, 16);
        for (std::size_t i = 0; i < image.rgb.size(); ++i) {
            const Sampler sampler(PointSet::independent, static_cast<std::uint64_t>(g), i, 0);
            image.rgb[i] = sampler.get_1d(0) + sampler.get_1d(1) + sampler.get_1d(2);
            spike.rgb[i] = image.rgb[i] + (i % 16 == static_cast<std::size_t>(g) ? 50.f : 0.f);
        }
        even.push_back(image);
        spiked.push_back(spike);
    }
    EXPECT_LT(dominance_of_one_group(even), 0.4);
    EXPECT_GT(dominance_of_one_group(spiked), 0.8);
}

}  // namespace
}  // namespace gib::test::reference_cache_test
