#pragma once
// The pyramid of techniques: what each way of making a path of some length has contributed, with its weight and as if it
// were the only one (Veach 1997, figure 10.3).

#include "common/images/splat_film.h"
#include "methods/parts/vertices/connections.h"

#include <map>

namespace gib {

/// Technique (s, t) takes s vertices from a light's walk and t from the camera's; its paths have s + t - 1 edges.
class TechniquePyramid {
public:
    static constexpr int longest = 5;  ///< edges of a path that is shown

    TechniquePyramid(int width, int height, double unit);

    /// Adds a path that technique (s, t) has made; `factor` makes its light that of a sample of the pixel.
    void add(int s, int t, std::size_t pixel, const Connection& path, double factor);
    /// The means over `count` samples of each pixel [W/(sr m^2)]: technique_k2_s1_t2 with its weight, and
    /// technique_k2_s1_t2_alone, where k is the number of edges.
    std::vector<std::pair<std::string, Image>> images(double count) const;

private:
    struct Layers {
        FixedPointImage weighted, alone;
    };
    std::map<std::pair<int, int>, Layers> layers_;
};

}  // namespace gib
