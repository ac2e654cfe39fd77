// References are made to a target, kept, topped up, and made again if their file is damaged. Of batches that other processes make,
// the reference is the same whoever made them, and its standard error falls with their number as theory says.

#include "experiments/references/reference.h"

#include "common/images/image_digest.h"
#include "common/sampling/sampler.h"
#include "experiments/metrics/denominators.h"
#include "experiments/metrics/epsilon.h"
#include "experiments/plan/label_checks.h"
#include "experiments/references/reference_methods.h"
#include "experiments/references/store.h"
#include "tests/support/constant_image.h"
#include "tests/support/driver_fixtures.h"
#include "tests/support/source_path.h"

#include <fstream>
#include <functional>
#include <limits>
#include <random>
#include <set>

namespace gib::test::reference_cache_test {
namespace {

/// Noise of 0.5.
template <int pass_milliseconds = 0, int halvings = 0>
MethodDescription fake_method() {
    return {"fake",
            "noise",
            {},
            Effects::all(),
            {Component::direct},
            true,
            [](const ParameterValues&, const MethodDefaults&) -> std::unique_ptr<Method> {
                return std::make_unique<FakeMethod>(FakeBehaviour{
                    .noise = 0.5, .pass_seconds = 0.001 * pass_milliseconds, .unit = std::ldexp(1.f, -halvings)});
            }};
}

std::uint32_t passes_of(const FinishedReference& r) {
    return static_cast<std::uint32_t>(std::stoul(r.reference.metadata.at("passes")));
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
    MethodDescription method_ = fake_method();
};

TEST_F(ReferenceCacheTest, MeetsItsTarget) {
    const FinishedReference r = make(0.02);
    EXPECT_LE(r.relative_error, 0.02);
    // Noise of 0.5 in n samples has an error of 0.5 / sqrt(n): the target needs about 613.
    const auto samples = 16 * passes_of(r);
    EXPECT_GT(samples, 400u);
    EXPECT_LT(samples, 1300u) << "no more work than the target needs";
    EXPECT_NEAR(mean_of(r.reference.total.mean)[0], 1.0, 0.01);
    EXPECT_EQ(r.reference.total.groups.size(), static_cast<std::size_t>(reference_groups));
}

// With an absolute epsilon, noise in a dark picture is below every target.
TEST_F(ReferenceCacheTest, StopsAfterTheSamePassesInAnyUnitOfLight) {
    const MethodDescription dim = fake_method<0, 13>();
    const auto made = [&](const MethodDescription& method, std::optional<double> epsilon, const std::string& file) {
        ProgressLine progress(false);
        return make_reference(
            {scene_, {&method}, MethodLabel{"fake", {}}, {0.02, std::nullopt}, epsilon, folder_ / file}, progress);
    };
    const FinishedReference bright = made(method_, std::nullopt, "bright.exr");
    const FinishedReference dark = made(dim, std::nullopt, "dark.exr");
    EXPECT_EQ(passes_of(dark), passes_of(bright));
    EXPECT_NEAR(dark.relative_error, bright.relative_error, 1e-6);
    EXPECT_NEAR(bright.epsilon, 0.01, 0.001) << "the mean is 1";
    EXPECT_NEAR(dark.epsilon / bright.epsilon, 0x1p-26, 1e-12);
    EXPECT_EQ(std::stod(dark.reference.metadata.at("epsilon")), dark.epsilon);
    EXPECT_LT(2 * passes_of(made(dim, 0.01, "absolute.exr")), passes_of(bright));
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

TEST_F(ReferenceCacheTest, AnotherSceneIsNoticed) {
    make(0.05);
    scene_.content_hash[0] = scene_.content_hash[0] == '0' ? '1' : '0';
    EXPECT_THAT(make(0.05).warnings, Contains(HasSubstr("not the reference of this scene")));
}

// Two reference methods. One lacks a fiftieth of the light, too little for the pilot to find.
TEST_F(ReferenceCacheTest, AMethodThatLacksLightIsLeftOut) {
    const auto named_method = []<int percent>(std::integral_constant<int, percent>, const char* name) {
        MethodDescription method = fake_method();
        method.name = name;
        method.create = [](const ParameterValues&, const MethodDefaults&) -> std::unique_ptr<Method> {
            return std::make_unique<FakeMethod>(FakeBehaviour{.noise = 0.1, .unit = 0.01f * percent});
        };
        return method;
    };
    const MethodDescription whole = named_method(std::integral_constant<int, 100>(), "whole"),
                            lacking = named_method(std::integral_constant<int, 98>(), "lacking");
    const ReferenceWork work{.scene = scene_,
                             .methods = {&lacking, &whole},
                             .label = {"auto", {}},
                             .goal = {0.002, std::nullopt},
                             .epsilon = 0.01,
                             .path = path_};
    ProgressLine progress(false);
    const FinishedReference r = make_reference(work, progress);
    EXPECT_NEAR(mean_of(r.reference.total.mean)[0], 1, 0.001);
    EXPECT_LE(r.relative_error, 0.002);
    EXPECT_TRUE(r.reference.unresolved.empty());
    const MethodShare& share = shares_in(r.reference.metadata.at("makers")).at(0);
    EXPECT_EQ(share.weights[static_cast<std::size_t>(index_of(Component::direct))], 0) << share.method;
}

TEST_F(ReferenceCacheTest, OfAnotherSeedIsIndependent) {
    const auto made = [&](std::uint64_t seed, const std::string& file) {
        ProgressLine progress(false);
        return make_reference({.scene = scene_,
                               .methods = {&method_},
                               .label = {"fake", {}},
                               .goal = {0.05, std::nullopt},
                               .epsilon = 0.01,
                               .path = folder_ / file,
                               .seed = seed},
                              progress)
            .reference.total;
    };
    const ReferenceLayer one = made(1, "one.exr"), two = made(2, "two.exr");
    EXPECT_EQ(made(1, "again.exr").mean.rgb, one.mean.rgb);
    double product = 0, square = 0;
    for (std::size_t i = 0; i < one.mean.rgb.size(); i += 3) {
        product += (double{one.mean.rgb[i]} - 1) * (double{two.mean.rgb[i]} - 1);
        square += sqr(double{one.mean.rgb[i]} - 1);
    }
    EXPECT_LT(std::abs(product / square), 0.5) << "4 standard errors of the correlation of 64 pixels";
}

/// The digest of all that a top-up starts from.
std::string start_of(const Reference& reference) {
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
    const std::string good = start_of(make(0.05).reference);
    const std::string file = read_file(path_);
    std::mt19937 random(1);
    int found = 0;
    for (int i = 0; i < 100; ++i) {
        std::string damaged = file;
        const std::size_t at = random() % file.size();
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << random() % 8));
        std::ofstream(path_, std::ios::binary) << damaged;
        const FinishedReference r = make(0.05);
        EXPECT_EQ(start_of(r.reference), good) << "byte " << at;
        if (r.rounds_added == 0) continue;  // the bit does not matter, such as in the program's name
        ++found;
        ASSERT_FALSE(r.warnings.empty()) << "byte " << at;
        EXPECT_THAT(r.warnings.front(), HasSubstr("made again"));
    }
    EXPECT_GT(found, 80);
}

TEST_F(ReferenceCacheTest, ValuesThatStillDecodeAreCompared) {
    const std::string good = start_of(make(0.05).reference);
    const LayeredImage written = writable_image(path_);
    const auto edit = [&](const std::function<void(LayeredImage&)>& change) {
        LayeredImage edited = written;
        change(edited);
        write_exr(path_, edited);
        EXPECT_THROW(read_reference(path_), InputError);
        EXPECT_THAT(make(0.05).warnings, Contains(HasSubstr("digest")));
        EXPECT_EQ(start_of(read_reference(path_)), good);
    };
    edit([](LayeredImage& image) { image.layers.back().second.rgb[7] *= 1.0000002f; });
    edit([](LayeredImage& image) { image.metadata["passes"] = "1000000"; });
    edit([](LayeredImage& image) { image.metadata["not_finite"] = "5"; });
}

TEST_F(ReferenceCacheTest, FilesThatAreNoReferenceAreMadeAgain) {
    const std::string good = start_of(make(0.05).reference);
    const std::string content = read_file(path_);
    LayeredImage without_digest = writable_image(path_);
    without_digest.metadata.erase("digest");
    const std::vector<std::pair<std::function<void()>, std::string>> damages = {
        {[&] { std::ofstream(path_, std::ios::trunc); }, "made again"},
        {[&] { std::ofstream(path_) << "no image\n"; }, "made again"},
        {[&] { std::ofstream(path_, std::ios::binary) << content.substr(0, content.size() / 2); }, "made again"},
        {[&] { write_exr(path_, one_layer(Image(8, 8))); }, "made again"},
        {[&] { write_exr(path_, without_digest); }, "it has no digest"}};
    for (std::size_t i = 0; i < damages.size(); ++i) {
        damages[i].first();
        const FinishedReference r = make(0.05);
        EXPECT_GT(r.rounds_added, 0u) << i;
        EXPECT_LE(r.relative_error, 0.05) << i;
        EXPECT_THAT(r.warnings, Contains(HasSubstr(damages[i].second))) << i;
        EXPECT_EQ(start_of(read_reference(path_)), good) << i;
        EXPECT_EQ(make(0.05).rounds_added, 0u) << i;
    }
}

TEST_F(ReferenceCacheTest, TimeThatIsUpIsSaidOnceAndForAll) {
    const FinishedReference r = make(1e-6, 0.05);
    EXPECT_THAT(r.warnings, Contains(HasSubstr("target")));
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
    EXPECT_EQ(groups.units, 4u);
    EXPECT_EQ(groups.rounds, 2u);
    EXPECT_FLOAT_EQ(groups.reference().total.mean.rgb[0], 4.f);
    EXPECT_FLOAT_EQ(groups.reference()[Component::direct]->mean.rgb[0], 4.f);
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

class ReferenceBatchesTest : public ::testing::Test {
protected:
    FinishedReference make(const std::string& file, std::optional<double> most_own_work = std::nullopt,
                           std::optional<double> seconds = std::nullopt) {
        ProgressLine progress(false);
        return make_reference(work(file, most_own_work, seconds), progress);
    }
    ReferenceWork work(const std::string& file, std::optional<double> most_own_work = std::nullopt,
                       std::optional<double> seconds = std::nullopt) {
        return {.scene = scene_,
                .methods = {&method_},
                .label = {"fake", {}},
                .goal = {0.02, seconds},
                .epsilon = 0.01,
                .path = folder_ / file,
                .most_own_work = most_own_work};
    }
    /// A reference all of whose batches are made by others. Counts the submissions.
    FinishedReference make_by_others(const std::string& file, int& submissions) {
        for (submissions = 0;; ++submissions) {
            FinishedReference r = make(file, 0);
            if (r.missing.empty()) return r;
            make_batches(file, r);
        }
    }
    /// Makes the batches that the reference still lacks.
    void make_batches(const std::string& file, const FinishedReference& reference) {
        for (const ReferenceBatch& batch : reference.missing)
            make_batch(work(file), batch);
    }
    static std::string content_of(const FinishedReference& r) {
        return image_digest(layers_of(r.reference, true)) + r.reference.metadata.at("passes") +
               r.reference.metadata.at("work");
    }
    std::string batch_file(const std::string& file) {
        return fs::directory_iterator(folder_ / (file + ".batches"))->path().string();
    }

    TemporaryFolder folder_;
    LoadedScene scene_ = scene_of(tiny_scene_xml());
    MethodDescription method_ = fake_method();
};

TEST_F(ReferenceBatchesTest, MakeTheSameReferenceWhoeverMadeThem) {
    const FinishedReference alone = make("alone.exr");
    int submissions = 0;
    const FinishedReference shared = make_by_others("shared.exr", submissions);
    EXPECT_EQ(content_of(shared), content_of(alone));
    EXPECT_EQ(shared.identity, alone.identity);
    EXPECT_GE(submissions, 2);
    EXPECT_LE(submissions, 6) << "rounds are foreseen";
    EXPECT_FALSE(fs::exists(folder_ / "shared.exr.batches")) << "they are in the reference";
}

TEST_F(ReferenceBatchesTest, DependOnNoTime) {
    const std::string quick = content_of(make("quick.exr"));
    EXPECT_EQ(content_of(make("limit.exr", std::nullopt, 1000)), quick) << "a limit out of sight";
    method_ = fake_method<2>();
    EXPECT_EQ(content_of(make("slow.exr")), quick);
}

TEST_F(ReferenceBatchesTest, ADamagedOneIsMadeAgain) {
    const std::string good = content_of(make("good.exr"));
    const FinishedReference first = make("damaged.exr", 0);
    ASSERT_FALSE(first.missing.empty());
    make_batches("damaged.exr", first);
    const std::string file = batch_file("damaged.exr");
    const std::string content = read_file(file);
    std::ofstream(file, std::ios::binary) << content.substr(0, content.size() - 20);
    EXPECT_EQ(content_of(make("damaged.exr")), good);
}

TEST_F(ReferenceBatchesTest, AnEditedOneIsMadeAgain) {
    const std::string good = content_of(make("good.exr"));
    const ReferenceBatch batch = make("edited.exr", 0).missing.at(0);
    make_batch(work("edited.exr"), batch);
    const std::string file = batch_file("edited.exr");
    LayeredImage edited = read_image(file);
    edited.metadata.erase("compression");  // which OpenImageIO adds and OpenEXR does not take as text
    for (auto& [name, layer] : edited.layers)
        for (float& value : layer.rgb)
            value *= 1.01f;
    write_exr(file, edited);
    EXPECT_EQ(content_of(make("edited.exr")), good);
}

TEST_F(ReferenceBatchesTest, WhatIsShortIsDoneByTheProcessItself) {
    const FinishedReference all = make("all.exr", std::numeric_limits<double>::max());
    EXPECT_FALSE(all.missing.empty()) << "nothing is known before the first round";
    make_batches("all.exr", all);
    EXPECT_TRUE(make("all.exr", std::numeric_limits<double>::max()).missing.empty());
}

// The standard errors of n and of 4 n rounds of equal batches, each estimated from 16 groups on 64 pixels: the ratio of
// the variances is 4 times an F variable of 960 and 960 degrees of freedom, and lies within 4 exp(+-0.212) with a
// probability of 99.9 %.
TEST_F(ReferenceBatchesTest, FourTimesAsManyHalveTheStandardError) {
    constexpr std::uint32_t rounds = 4, passes = 4;
    const BatchFolder batches(folder_ / "n.exr");
    const auto error_of = [&](std::uint32_t first, std::uint32_t count) {
        ReferenceGroups groups;
        for (std::uint32_t round = first; round < first + count; ++round) {
            std::vector<ComponentImages> images;
            for (std::uint32_t g = 0; g < reference_groups; ++g) {
                const ReferenceBatch batch{0, round * reference_groups + g, passes, round * passes};
                make_batch(work("n.exr"), batch);
                images.push_back(batches.read(batch).value().images);
            }
            groups.add_round(images, passes);
        }
        const ReferenceLayer total = groups.reference().total;
        return relative_standard_error(total, {total, 0.01});
    };
    const double few = error_of(0, rounds), many = error_of(rounds, 4 * rounds);
    EXPECT_NEAR(2 * std::log(few / many), std::log(4), 0.212);
}

// Several reference methods share the work of a unit, so that few units are enough.
TEST(StoredReference, OfSeveralMethodsIsNotToppedUpWithoutNeed) {
    const TemporaryFolder folder;
    const LoadedScene scene = load_scene(source_path("scenes/cornell-box.xml"), {{}, {{24, 24}}, {}});
    const MethodLabel label{"auto", {}};
    const ReferenceWork work{scene, reference_methods(label), label, {0.3, std::nullopt},
                             0.01,  folder / "reference.exr"};
    ProgressLine progress(false);
    const FinishedReference first = make_reference(work, progress);
    ASSERT_LT(passes_of(first), 8u);
    EXPECT_EQ(make_reference(work, progress).rounds_added, 0u);
}

// A lamp of 4 mm in view and the caustic of a glass ball under it: rays from the camera hardly ever meet it, so that path tracing
// alone finds no light of either and shows no noise. The other methods connect the lamp to the camera.
TEST(StoredReference, HoldsTheLightOfASmallLampOrSaysThatItDoesNot) {
    const TemporaryFolder folder;
    const auto wall = [](const std::string& place) { return shape("rectangle", to_world(place), diffuse(0.7)); };
    const LoadedScene scene =
        Scene(element("sensor", "perspective", number("fov", 50), to_world(look_at("0.2, 1.2, 2.6", "0, 0.9, 0")),
                      box_film(16)))
            .add(wall(rotate('x', -90)))
            .add(wall(translate(0, 1, -1)))
            .add(shape("rectangle", to_world(scale(0.002) + rotate('x', 90) + translate(0, 1.9, 0)), bsdf("diffuse"),
                       area_light(156250)))
            .add(shape("sphere", center(-0.35, 0.35, 0.1), radius(0.35), bsdf("dielectric")))
            .load();
    const ReferenceWork work{.scene = scene,
                             .methods = reference_methods({"auto", {}}),
                             .label = {"auto", {}},
                             .goal = {0.1, std::nullopt},
                             .epsilon = std::nullopt,
                             .path = folder / "reference.exr"};
    ProgressLine progress(false);
    const Reference r = make_reference(work, progress).reference;
    for (const Component c : {Component::emission, Component::caustic}) {
        EXPECT_TRUE(std::count(r.unresolved.begin(), r.unresolved.end(), c) > 0 || mean_of(r[c]->mean).sum() > 0)
            << name_of(c);
    }
}

}  // namespace
}  // namespace gib::test::reference_cache_test
