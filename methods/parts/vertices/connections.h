#pragma once
// Connections: a straight edge between the end of the camera's walk and a light, a vertex of a light's walk, or
// between such a vertex and the camera.
//
// Every connection returns the light of the path that it closes, by component, as if it were the only technique, and
// the weight of this technique (technique_sums.h; numbers of equations are those of Georgiev 2012). The vertices at its ends scatter by lobes of both kinds, so the
// path belongs to up to four classes.

#include "common/images/splat_film.h"
#include "methods/parts/vertices/light_paths.h"
#include "methods/parts/vertices/path_vertex.h"

namespace gib {

/// The light of a path that one technique has made.
struct Connection {
    PixelSample light;  ///< by component, unweighted
    float weight = 1.f;

    /// The sum of the weighted light over components and channels.
    double size() const {
        Color sum = Color::Zero();
        for (const Color& part : light.parts)
            sum += part;
        return double{weight * sum.sum()};
    }
};

/// A point of a light is sampled from `eye`, a vertex of the camera's walk (s = 1). Radiance [W/(sr m^2)].
std::optional<Connection> connect_to_light(RayQueries& rays, const PathVertex& eye, const LightPaths& paths,
                                           const PathRules& rules, const VertexNumbers& u, NumberStream& flights);

/// Russian roulette of the connections of one camera's walk before their rays (Veach 1997, section 10.4.1). A connection
/// smaller than `least` is traced with the probability size / least, so that all survivors are as large as `least`. The
/// probabilities are summed from a random start `u`, and a connection survives where the sum passes a whole number: the number
/// of survivors then has the least variance. By default all connections are traced.
class ConnectionRoulette {
public:
    ConnectionRoulette() = default;
    ConnectionRoulette(double least, float u) : least_(least), sum_(double{u}) {}

    /// The survival probability of a connection with this Connection::size() if nothing hides it; 0 if it is not traced.
    double survival(double size) {
        if (!(size < least_)) return 1;
        const double probability = size / least_;
        sum_ += probability;
        if (sum_ < 1) return 0;
        sum_ -= 1;
        return probability;
    }

private:
    double least_ = 0, sum_ = 0;
};

/// A vertex of the camera's walk and one of a light's. Radiance [W/(sr m^2)] of one of the technique's samples times `factor`.
std::optional<Connection> connect(RayQueries& rays, const PathVertex& eye, const PathVertex& light,
                                  const LightPaths& paths, const PathRules& rules, double factor,
                                  ConnectionRoulette& roulette, NumberStream& flights);

/// The random numbers of a connection to the camera.
struct CameraNumbers {
    Vec2 lens;
    float pixel;
};

/// Light that arrives at the camera in some pixel.
struct Splat {
    std::size_t pixel;
    Connection connection;
};

/// A vertex of a light's walk and the camera. The light is the pixel's mean radiance [W/(sr m^2)] times the image's
/// number of pixels, for one light path: the mean over all light paths is to be taken.
///
/// A pixel's value is I = integral of h(c) L(c) dc over the film, where h is the density of its filter [1/px^2]. With
/// dc = rho dw, where rho is Sensor::ray_density(), and dw = cos dA / d^2, a vertex of power P makes the contribution
/// h rho P f cos / d^2. One of the pixels whose filter covers c is chosen in proportion to h.
/// The pixel's place in `film` is fetched while the ray to it is traced.
std::optional<Splat> connect_to_camera(RayQueries& rays, const PathVertex& light, const LightPaths& paths,
                                       const PathRules& rules, const SplatFilm& film, const CameraNumbers& u,
                                       NumberStream& flights);

/// A point of a light that is sampled from the camera itself, in the unit of the function above. `is_found_too`: the camera's
/// walk finds the light by itself as well, and alone if it is the environment; if not, the weight is 1.
std::optional<Splat> sample_light_from_camera(RayQueries& rays, const LightPaths& paths, const SplatFilm& film,
                                              bool is_found_too, const VertexNumbers& u, NumberStream& flights);

}  // namespace gib
