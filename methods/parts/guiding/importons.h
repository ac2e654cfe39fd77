#pragma once
// Importons: walks from the camera that find where light is needed. Source: Peter and Pietrek 1998, "Importance Driven
// Construction of Photon Maps".

#include "methods/guided_path/radiance_field.h"

#include <array>
#include <cstdint>
#include <map>
#include <vector>

namespace gib {

class Scene;

struct ImportonVertex {
    Vec3 p;
    double weight;  ///< throughput of the importon, luminance
};

/// The finds of importons.
struct ImportonPlaces {
    std::vector<ImportonVertex> used = {};      ///< places where light is used
    std::vector<ImportonVertex> needed = {};    ///< places from where it is sent there
    std::vector<ImportonVertex> specular = {};  ///< those of them that are specular
    std::uint64_t rays = 0;

    void append(const ImportonPlaces& more);
};

/// Follows `count` importons, spread evenly over the image, by path tracing. Each records in `field`, wherever it comes after
/// it has met a place where light is used, the direction from which it has come, with its weight. Without a field it ends at
/// the first such place.
ImportonPlaces follow_importons(const Scene& scene, int max_edges, std::size_t count, std::uint64_t key,
                                RadianceField* field);

/// Cubes of space, whose size follows the extent of most of the places that they are made for.
class Cells {
public:
    using Index = std::array<int, 3>;

    Cells(const Scene& scene, const std::vector<ImportonVertex>& places);

    Index of(const Vec3& p) const;
    Vec3 center(const Index& cell) const;
    /// Radius of the ball around a cell [scene units].
    float radius() const { return 0.5f * std::sqrt(3.f) * size_; }
    std::map<Index, double> weights(const std::vector<ImportonVertex>& places) const;

private:
    float size_;
};

}  // namespace gib
