// Chains of delta vertices: derivatives against finite differences on every shape, and defined results where chains
// end.

#include "methods/parts/manifold/specular_chain.h"
#include "tests/support/random.h"
#include "tests/support/scene_fixtures.h"
#include "tests/support/scene_text.h"

#include <gtest/gtest.h>

#include <numbers>

namespace gib::test::specular_chain_test {
namespace {

constexpr ChainEvents reflection{1, 0b0}, refraction{1, 0b1}, through{2, 0b11}, rainbow{3, 0b101};

/// A tetrahedron whose normals are those of a ball, so that they change over each face.
std::string smooth_tetrahedron(const TemporaryFolder& folder) {
    const std::string file = folder.write("tetrahedron.obj",
                                          "v 1 1 1\nv 1 -1 -1\nv -1 1 -1\nv -1 -1 1\n"
                                          "vn 1 1 1\nvn 1 -1 -1\nvn -1 1 -1\nvn -1 -1 1\n"
                                          "f 1//1 2//2 3//3\nf 1//1 4//4 2//2\nf 1//1 3//3 4//4\nf 2//2 4//4 3//3\n");
    return filename(file);
}

/// A floor at z = -3, a ceiling at z = 3, which keeps the scene's centre in the origin, and a body of glass around it.
class Body {
public:
    explicit Body(const std::string& body)
        : scene_(scene_of(scene_xml(
              camera(40, box_film(2)) + shape("rectangle", to_world(scale(20), translate(0, 0, -3)), diffuse(0.5)) +
              shape("rectangle", to_world(scale(20), translate(0, 0, 3)), diffuse(0.5)) + body))) {}

    const gib::Scene& scene() const { return *scene_.scene; }
    SurfaceHit place(float x, float y) const { return *scene().intersect({Vec3(x, y, -2), Vec3(0, 0, -1)}); }

private:
    LoadedScene scene_;
};

Vec3 turned(const Vec3& w, double s, double t) {
    const Frame frame(w);
    return (w + static_cast<float>(s) * frame.s + static_cast<float>(t) * frame.t).normalized();
}

/// The largest error of the derivatives of chains from the floor to points around the origin, relative to their norm;
/// and the number of chains. Central differences of a step h err by h^2 and by the rounding of positions over h.
struct DerivativeErrors {
    double worst = 0;
    int chains = 0;
};
DerivativeErrors derivative_errors(const Body& body, const ChainEvents& events) {
    constexpr double h = 2e-3;
    DerivativeErrors errors;
    for (std::uint64_t i = 0; i < 60; ++i) {
        const Sampler u(PointSet::independent, 7, i, 0);
        const Vec2 at = u.get_2d(0), aim = u.get_2d(1);
        const SurfaceHit x = body.place(2 * at.x() - 1, 2 * at.y() - 1);
        RayQueries rays(body.scene());
        const ChainStart start{x, nullptr, std::nullopt};
        const Vec3 w = (Vec3(0.6f * aim.x() - 0.3f, 0.6f * aim.y() - 0.3f, 0) - x.p).normalized();
        const auto chain = trace_chain(rays, start, w, events);
        if (!chain) continue;
        Chain::Differential dp, dd;
        bool on_same_faces = true;
        for (int k = 0; k < 2; ++k) {
            const auto more = trace_chain(rays, start, turned(w, k == 0 ? h : 0, k == 1 ? h : 0), events);
            const auto less = trace_chain(rays, start, turned(w, k == 0 ? -h : 0, k == 1 ? -h : 0), events);
            on_same_faces =
                on_same_faces && more && less && more->last->primitive == chain->last->primitive &&
                less->last->primitive == chain->last->primitive &&
                (more->d + less->d - 2 * chain->d).norm() < 0.01f;  // else an edge, or another of two normals
            if (!on_same_faces) break;
            dp.col(k) = (more->p - less->p) / (2 * h);
            dd.col(k) = (more->d - less->d).cast<double>() / (2 * h);
        }
        if (!on_same_faces || chain->dd.norm() > 30) continue;  // grazing
        ++errors.chains;
        errors.worst = std::max({errors.worst, (dp - chain->dp).norm() / (1 + chain->dp.norm()),
                                 (dd - chain->dd).norm() / (1 + chain->dd.norm())});
    }
    return errors;
}

void expect_right_derivatives(const std::string& body, const ChainEvents& events) {
    const DerivativeErrors errors = derivative_errors(Body(body), events);
    EXPECT_GE(errors.chains, 10);
    EXPECT_LT(errors.worst, 4e-3);
}

TEST(SpecularChain, DerivativesMatchFiniteDifferencesOnEveryShape) {
    const TemporaryFolder folder;
    const std::string tilted = to_world(rotate('x', 20), rotate('y', 10)),
                      stretched = to_world(scale(0.5, 0.7, 1), rotate('x', 30));
    const std::vector<std::string> bodies = {
        shape("sphere", radius(0.8), glass()),
        shape("sphere", radius(0.8), flag("flip_normals"), glass(1 / 1.5)),
        shape("cylinder", point("p0", -2, 0.1, 0), point("p1", 2, 0, 0.2), radius(0.7), glass()),
        shape("disk", tilted, glass()),
        shape("rectangle", tilted, glass()),
        shape("cube", tilted, glass()),
        shape("obj", smooth_tetrahedron(folder), tilted, glass()),
        shape("obj", smooth_tetrahedron(folder), tilted, flag("flip_normals"), glass(1 / 1.5)),
        with_id("shape", "shapegroup", "balls", shape("sphere", glass())) +
            shape("instance", reference("balls"), stretched),
        with_id("shape", "shapegroup", "meshes", shape("obj", smooth_tetrahedron(folder), glass())) +
            shape("instance", reference("meshes"), stretched),
    };
    for (std::size_t i = 0; i < bodies.size(); ++i)
        for (const ChainEvents& events : {reflection, refraction}) {
            SCOPED_TRACE(fmt::format("body {}, events {}", i, events.transmits));
            expect_right_derivatives(bodies[i], events);
        }
}

TEST(SpecularChain, DerivativesMatchFiniteDifferencesAlongLongChains) {
    for (const ChainEvents& events : {through, rainbow}) {
        SCOPED_TRACE(events.length);
        expect_right_derivatives(shape("sphere", radius(0.8), glass()), events);
        expect_right_derivatives(shape("cube", to_world(scale(1, 1, 0.2), rotate('x', 20)), glass()), events);
    }
}

// A slab with parallel faces shifts a ray and does not turn it.
TEST(SpecularChain, IsFoundThroughASlabInClosedForm) {
    const Body body(shape("cube", to_world(scale(8, 8, 0.25)), glass()));
    const SurfaceHit x = body.place(0, 0);
    RayQueries rays(body.scene());
    const double sine = 0.5, tangent = sine / std::sqrt(1 - sine * sine);
    const double inside = sine / 1.5 / std::sqrt(1 - sine * sine / 2.25);
    const ChainEnd end{Vec3(static_cast<float>(4.5 * tangent + 0.5 * inside), 0, 2), false};
    for (const Vec3& seed : {Vec3(0, 0, 1), Vec3(-5, 6, 6), Vec3(4, 0, 3)}) {
        const ChainStart start{x, nullptr, std::nullopt};
        const auto chain = find_chain(rays, start, trace_chain(rays, start, seed.normalized(), through), end);
        ASSERT_TRUE(chain) << seed.transpose();
        EXPECT_NEAR(chain->w.x(), sine, 1e-5);
        EXPECT_NEAR(chain->w.y(), 0, 1e-5);
        EXPECT_EQ(chain->d.isApprox(chain->w, 1e-5f), true);
    }
}

// Balls in balls, a light on the glass and in its centre, a place beside it, rays along its rim: a chain or none, never
// NaN.
TEST(SpecularChain, IsFiniteOrNone) {
    const std::vector<std::string> bodies = {
        shape("sphere", glass()) + shape("sphere", radius(0.5), glass(1 / 1.5)),
        shape("sphere", center(0, 0, -2), glass(2.4)),
        shape("cube", glass(1.0001)) + shape("sphere", radius(1.4), glass(4)),
        shape("sphere", radius(1e-4), glass()),
    };
    int found = 0;
    for (const std::string& xml : bodies) {
        const Body body(xml);
        for (std::uint64_t i = 0; i < 3000; ++i) {
            const Sampler u(PointSet::independent, 3, i, 0);
            const Vec2 at = u.get_2d(0), kind = u.get_2d(1);
            const SurfaceHit x = body.place(i % 3 == 0 ? 0 : 2 * at.x() - 1, 0);
            const int length = 1 + static_cast<int>(4 * kind.x());
            const ChainEvents events{length, static_cast<std::uint32_t>(kind.y() * static_cast<float>(1 << length))};
            const std::vector<ChainEnd> ends = {{Vec3(0, 0, 0), false},
                                                {Vec3(0, 0, 1), false},
                                                {x.p, false},
                                                {Vec3(1, 0, 0.3f), false},
                                                {Vec3(0, 0, 1), true}};
            const ChainEnd& end = ends[i % ends.size()];
            RayQueries rays(body.scene());
            const ChainStart start{x, nullptr, std::nullopt};
            const auto seed = trace_chain(rays, start, square_to_cosine_hemisphere(u.get_2d(2)), events);
            const auto chain = find_chain(rays, start, seed, end);
            if (!chain) continue;
            ++found;
            EXPECT_TRUE(std::isfinite(determinant_of(*chain, end)) && chain->p.allFinite() && chain->d.allFinite() &&
                        std::isfinite(chain->error) && chain->weight.isFinite().all());
        }
    }
    EXPECT_GT(found, 100);
}

}  // namespace
}  // namespace gib::test::specular_chain_test
