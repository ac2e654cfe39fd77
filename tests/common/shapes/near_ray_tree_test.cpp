#include "common/shapes/near_ray_tree.h"

#include "tests/support/random.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace gib::near_ray_tree_test {
namespace {

/// The least distance between the segment from a to b (or the point a = b) and the ray, where both come closest in the view
/// along the ray; infinite if that place lies outside of the ray.
double distance(const Vec3& a, const Vec3& b, const Ray& ray) {
    const Eigen::Vector3d o = ray.o.cast<double>(), d = ray.d.cast<double>();
    const auto across = [&](const Eigen::Vector3d& v) { return Eigen::Vector3d(v - v.dot(d) * d); };
    const Eigen::Vector3d from = a.cast<double>() - o, way = (b - a).cast<double>(), flat = across(way);
    const double s = flat.squaredNorm() > 0 ? std::clamp(-across(from).dot(flat) / flat.squaredNorm(), 0.0, 1.0) : 0.0;
    const Eigen::Vector3d there = from + s * way;
    const double t = there.dot(d);
    return t >= double{ray.t_min} && t < double{ray.t_max} ? across(there).norm() : 1e30;
}

// Brute force: everything within the radius is found, in order and once, and little else.
TEST(NearRayTree, FindsAllWithinTheRadiusInOrder) {
    for (const std::size_t ends : {1u, 2u})
        for (const auto& [size, place] : {std::pair{1.f, 0.f}, {1e-4f, 0.f}, {1e5f, 3e5f}})
            for (const float radius : {0.01f * size, 0.1f * size}) {
                test::Random random(ends);
                const auto somewhere = [&, size = size, place = place] {
                    const Vec2 xy = random.next_2d();
                    return Vec3(Vec3::Constant(place) + size * Vec3(xy.x(), xy.y(), random.next()));
                };
                std::vector<Vec3> items;
                for (std::size_t i = 0; i < 2000 * ends; ++i)
                    items.push_back(somewhere());
                const NearRayTree tree(items, ends, radius);
                std::vector<std::uint32_t> found;
                std::size_t total = 0, close = 0;
                for (int i = 0; i < 100; ++i) {
                    const Vec3 d = random.direction();
                    // From inside, from far away, and along a short stretch.
                    const Ray ray{.o = somewhere() - (i % 3 == 1 ? 20.f * size : 0.f) * d,
                                  .d = d,
                                  .t_max = i % 3 == 2 ? 0.3f * size : infinity};
                    tree.find(ray, found);
                    EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
                    EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
                    total += found.size();
                    const double rounding = 4e-6 * double{size + place} * (i % 3 == 1 ? 20 : 1);
                    for (std::uint32_t item = 0; item < 2000; ++item) {
                        const Vec3 &a = items[item * ends], &b = items[item * ends + ends - 1];
                        const bool is_found = std::binary_search(found.begin(), found.end(), item);
                        if (distance(a, b, ray) < double{radius} - rounding) {
                            EXPECT_TRUE(is_found) << ends << ' ' << size << ' ' << radius << ' ' << i;
                        }
                        close += distance(a, b, ray) < double{radius};
                    }
                }
                EXPECT_GT(close, 20u);
                EXPECT_LT(total, close + close / 2 + 20);
            }
}

TEST(NearRayTree, OfNothingFindsNothing) {
    std::vector<std::uint32_t> found = {1};
    NearRayTree().find({Vec3::Zero(), Vec3::UnitX()}, found);
    EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace gib::near_ray_tree_test
