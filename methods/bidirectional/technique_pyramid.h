#pragma once
// The pyramid of techniques: what each way of making a path of some length has contributed, with its weight and as if
// it were the only one (Veach 1997, figure 10.3).

#include "common/images/splat_film.h"
#include "methods/parts/vertices/joined_paths_estimate.h"

#include <map>

namespace gib {

/// The paths of technique (s, t) have s + t - 1 edges.
class TechniquePyramid final : public TechniqueImages {
public:
    static constexpr int longest = 5;  ///< edges of a path that is shown

    TechniquePyramid(int width, int height, double unit);

    void add(int s, int t, std::size_t pixel, const Connection& path, double factor) override;
    /// The images are technique_k2_s1_t2, with its weight, and technique_k2_s1_t2_alone, where k is the number of
    /// edges.
    std::vector<std::pair<std::string, Image>> images(double count) const override;

private:
    struct Layers {
        FixedPointImage weighted, alone;
    };
    std::map<std::pair<int, int>, Layers> layers_;
};

}  // namespace gib
