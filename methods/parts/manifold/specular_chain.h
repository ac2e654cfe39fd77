#pragma once
// Chains of delta vertices between a point x and a point y, or a direction, of a light, found by Newton's method.
// Sources: Jakob and Marschner 2012 (derivatives along specular chains), Hanika et al. 2015 (manifold next event
// estimation), Zeltner et al. 2020 (specular manifold sampling).
//
// A chain x, x_1 ... x_k, y reflects or refracts at each x_i. Its state is the unit direction w at x. A ray along w and
// the delta lobes that it meets give x_1 ... x_k, so that the constraints at x_1 ... x_{k-1} hold exactly. Left is the
// constraint of the last vertex, the difference of directions
//     c(w) = B^T (d - o),    o = (y - x_k) / |y - x_k|, or the direction towards a light at infinity,
// where d is the direction in which the ray leaves x_k, and the columns of B span the plane across d + o. The ray
// carries its derivatives by the two coordinates of w (Igehy 1999, "Tracing Ray Differentials"), which is the forward
// elimination of the block-tridiagonal system of Jakob and Marschner (section 4). A step of Newton's method and the
// light that arrives read
//     M = dc/dw = B^T (dd/dw + (I - o o^T) dp/dw / |y - x_k|),    w <- w - M^-1 c,
//     dw/dA_y = 1 / (|y - x_k|^2 |det M|),            dw/do = 1 / |det M|,
// with dA_y across the ray. A long step moves x_1 in its tangent plane, and a ray from x carries it back to the
// surface. Unlike in Zeltner 2020, the unknown is the direction at x and not the place of x_1, and the constraint is a difference of
// directions at x_k and not of half vectors. dw/dA_y is the generalised geometric term of Jakob and Marschner, without the cosine at x.

#include "common/sampling/sampler.h"
#include "methods/parts/transport/ray_queries.h"
#include "methods/parts/transport/scattered_ray.h"

namespace gib {

/// Length and events of a chain: bit i of `transmits` is set if vertex i of 0 ... length - 1, counted from x,
/// transmits.
struct ChainEvents {
    int length;
    std::uint32_t transmits;

    bool operator==(const ChainEvents&) const = default;
    bool transmits_at(int vertex) const { return ((transmits >> vertex) & 1u) != 0; }
    void append(bool transmits_there) {
        transmits |= transmits_there ? 1u << length : 0u;
        ++length;
    }
};

/// Whether the delta lobe of a hit is a vertex of chains: that of a smooth dielectric, conductor or plastic whose
/// normal no map changes. Other surfaces, thin sheets among them, only let light straight on.
bool makes_chains(const SurfaceHit& hit);
/// Whether all delta lobes of the material are vertices of chains wherever it is seen.
bool makes_chains(const Material& material);

/// The point x, with what light finds there.
struct ChainStart {
    const SurfaceHit& hit;
    const Medium* medium;        ///< medium that the path arrives in; null: vacuum
    std::optional<int> stratum;  ///< stratum of wavelengths; none if the scene does not split light
};

/// The end of chains on a light: its position, or the unit direction towards a light at infinity.
struct ChainEnd {
    Vec3 p;
    bool at_infinity;
};

struct Chain {
    using Differential = Eigen::Matrix<double, 3, 2>;

    Vec3 w;                                        ///< direction at x, unit
    ChainEvents events;                            ///< of its vertices
    Color weight = Color::Ones();                  ///< product of f |cos| of the lobes and of what goes straight on
    float probability = 1.f;                       ///< probability that samples of the bsdfs take these lobes
    std::uint32_t shape = 0, instance = 0;         ///< surface of x_1
    Vec3d first = Vec3d::Zero();                   ///< x_1
    Differential first_dp = Differential::Zero();  ///< its derivative by the coordinates of w
    std::optional<SurfaceHit> last = {};           ///< x_k
    Vec3 d = Vec3::Zero();                         ///< direction behind x_k
    const Medium* medium = nullptr;                ///< medium behind x_k
    bool is_split = false;                         ///< some vertex splits light by wavelength
    Vec3d p = Vec3d::Zero();                       ///< the last vertex so far
    Differential dp = Differential::Zero(),
                 dd = Differential::Zero();  ///< derivatives of p and d by the coordinates of w

    double error = 0;  ///< length of the next step of Newton's method, about the error of w; set by find_chain()
};

/// The chain along w. Empty if a lobe of the events is missing: the ray meets no such surface, or is totally reflected.
/// With `flights` its weight includes estimates of the transmittance of the media up to x_k.
std::optional<Chain> trace_chain(RayQueries& rays, const ChainStart& from, const Vec3& w, const ChainEvents& events,
                                 NumberStream* flights = nullptr);

/// The chain of the same events that Newton's method finds from the seed. Empty if it does not converge.
std::optional<Chain> find_chain(RayQueries& rays, const ChainStart& from, std::optional<Chain> seed,
                                const ChainEnd& end);

/// |det M| of a chain that ends there.
double determinant_of(const Chain& chain, const ChainEnd& end);

}  // namespace gib
