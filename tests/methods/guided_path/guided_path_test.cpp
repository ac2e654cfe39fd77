// Path guiding: whatever the field has learned, right or wrong, images have the means of path tracing.

#include "methods/guided_path/guided_directions.h"
#include "methods/parts/transport/pixel_samples.h"
#include "tests/support/lit_rooms.h"
#include "tests/support/same_means.h"

#include <gtest/gtest.h>

namespace gib::test::guided_path_test {
namespace {

using namespace lit_rooms;

VertexNumbers random_numbers(std::uint64_t seed, std::uint32_t i) {
    return Sampler(PointSet::independent, seed, i, 0).at_vertex(0);
}

/// Records `count` directions of one radiance, each near `peak`, at places all over the box: on surfaces that face up, and in a
/// medium.
void record_peak(RadianceField& field, const Bounds& box, const Vec3& peak, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
        const VertexNumbers place = random_numbers(1, i), direction = random_numbers(2, i);
        const auto& u = place.all();
        const Vec3 p = box.lower + (box.upper - box.lower).cwiseProduct(Vec3(u[0], u[1], u[2]));
        const Vec3 wi = (peak + 0.2f * square_to_sphere(direction.bsdf_lobe())).normalized();
        for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(0, 1, 0), Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 0, 0)}) {
            field.record(field.place(p, normal), wi, normal.isZero() ? 1 : std::abs(double{normal.dot(wi)}), direction);
            field.visit(field.place(p, normal), 1, 0.5);
        }
    }
}
const Bounds cube{Vec3(-1, -1, -1), Vec3(1, 1, 1)};
/// A field that has learned a peak, in several iterations.
RadianceField peaked_field(const Bounds& box, const Vec3& peak, double memory = 0x1p22) {
    RadianceField field(box, 1, memory);
    for (int iteration = 0; iteration < 3; ++iteration) {
        record_peak(field, box, peak, 20000);
        field.learn(4000);
    }
    return field;
}

TEST(RadianceField, SamplesHaveTheDensityThatItTells) {
    const RadianceField field = peaked_field(cube, Vec3(0.6f, 0, 0.8f));
    EXPECT_GT(field.leaf_count(), 20u);
    const auto known = field.at(field.place(Vec3(0.3f, -0.2f, 0.1f), Vec3::Zero()));
    constexpr int samples = 100000, cells = 8, grid = 128;  // cells of z and azimuth; points of a cell along each
    const auto cell_of = [&](const Vec3& w) {
        const double turns = std::atan2(double{w.y()}, double{w.x()}) / (2 * std::numbers::pi) + 0.5;
        return std::pair(std::min(static_cast<int>((double{w.z()} + 1) / 2 * cells), cells - 1),
                         std::min(static_cast<int>(turns * cells), cells - 1));
    };
    std::map<std::pair<int, int>, double> expected, found;
    double whole = 0;
    for (int i = 0; i < cells * grid; ++i)
        for (int j = 0; j < cells * grid; ++j) {
            const Vec2 u((static_cast<float>(i) + 0.5f) / (cells * grid),
                         (static_cast<float>(j) + 0.5f) / (cells * grid));
            const Vec3 w = square_to_sphere(u);
            const double mass = double{known.pdf_w(w)} * 4 * std::numbers::pi / sqr(double{cells * grid});
            expected[cell_of(w)] += mass;
            whole += mass;
        }
    EXPECT_NEAR(whole, 1, 2e-3);
    for (std::uint32_t i = 0; i < samples; ++i) {
        const auto sample = known.sample(random_numbers(3, i).bsdf_direction());
        ASSERT_NEAR(sample.wi.norm(), 1, 1e-5);
        found[cell_of(sample.wi)] += 1. / samples;
    }
    for (const auto& [cell, mass] : expected)
        EXPECT_NEAR(found[cell], mass, 5 * std::sqrt(mass / samples) + 2e-3 * mass) << cell.first << ' ' << cell.second;
    EXPECT_GT(known.pdf_w(Vec3(0.6f, 0, 0.8f)), 10 * uniform_sphere_pdf_w);
}

TEST(RadianceField, TellsConcentratedLightFromEven) {
    EXPECT_EQ(peaked_field(cube, Vec3(0.6f, 0, 0.8f)).concentrated_share(), 1);
    EXPECT_EQ(peaked_field(cube, Vec3::Zero()).concentrated_share(), 0);  // from all sides alike
    EXPECT_EQ(RadianceField(cube, 1, 0x1p22).concentrated_share(), 0);
}

TEST(RadianceField, KeepsToItsMemory) {
    RadianceField field(cube, 1, 0x1p20);
    for (int i = 0; i < 6; ++i) {
        record_peak(field, cube, Vec3(0.6f, 0, 0.8f), 60000);
        field.learn(1);  // two visits crowd a cell
    }
    EXPECT_GT(field.leaf_count(), 64u);
    EXPECT_LE(field.bytes(), 0x1p20);
}

/// An image of paths by a given field, which learns nothing.
Means means_by_field(const LoadedScene& scene, const RadianceField& field, std::uint64_t seed, std::uint32_t passes) {
    const Sensor& sensor = scene.scene->sensor();
    Film film(sensor.width(), sensor.height(), {all_components.begin(), all_components.end()}, {});
    StageTimes stages;
    for (std::uint32_t pass = 0; pass < passes; ++pass)
        sample_pixels(*scene.scene, film, PointSet::sobol, seed, pass, stages, "paths", [&] {
            return [&, directions = GuidedDirections(field)](RayQueries& rays, const TracedRay& eye,
                                                             const Sampler& sampler) mutable {
                directions.start();
                return trace_path_in(directions, rays, eye, sampler, scene.max_edges, true);
            };
        });
    return means_of(film.mean(passes));
}

// The lamp hangs above: a field that sends paths down, or to one side, is wrong, and knows nothing of where light is.
TEST(GuidedPath, IsUnbiasedByAWrongField) {
    for (const std::string& more : {std::string(), fog}) {
        const std::string xml = room_xml({.light = lamp, .more = more, .ball = plastic_ball});
        const LoadedScene scene = scene_of(xml);
        for (const Vec3& peak : {Vec3(-0.6f, -0.8f, 0), Vec3(0, 0, 1)}) {
            const RadianceField wrong = peaked_field(scene.scene->bounds(), peak);
            SeedMeans& expected = shared_means(xml, "path");
            SeedMeans found([&](std::uint64_t seed) {
                Means means = means_by_field(scene, wrong, seed, 256);
                std::erase_if(means, [&](const auto& mean) { return !expected[seed].contains(mean.first); });
                return means;
            });
            expect_same_means(expected, found, more.empty() ? "wrong field" : "wrong field in fog");
        }
    }
}

/// The cells of the field after some passes.
int cells_after(const LoadedScene& scene, std::uint32_t passes) {
    StageTimes stages;
    const auto run = ConfiguredMethod(MethodLabel::parse("guided_path")).create({})->start(*scene.scene, 1, stages);
    for (std::uint32_t pass = 0; pass < passes; ++pass)
        run->advance(pass);
    const auto facts = run->facts();
    return std::stoi(
        std::find_if(facts.begin(), facts.end(), [](const auto& f) { return f.first == "cells"; })->second);
}
TEST(GuidedPath, LearnsFromImagesOfAnySize) {
    for (const int side : {32, 128}) {
        const LoadedScene scene = shipped_scene("cornell-box.xml", {{}, std::pair{side, side}});
        EXPECT_GT(cells_after(scene, 8), 2 * cells_after(scene, 1)) << side;
    }
}

const std::vector<std::string> both = {"path", "guided_path"};

TEST(GuidedPath, AgreesWithPath) {
    expect_same_means(room_xml({.light = lamp}), both);
    expect_same_means(room_xml({.light = lamp, .ball = glass_ball}), both);
    expect_same_means(room_xml({.light = sky + lamp, .more = fog}), both);
    expect_same_means(room_xml({.light = shining_ball, .more = grate, .ball = plastic_ball}), both);
}

}  // namespace
}  // namespace gib::test::guided_path_test
