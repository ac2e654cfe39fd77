#pragma once
// NoMerging adds nothing to the techniques of bidirectional path tracing. The class of vcm with the same members adds merging
// (methods/vcm).

#include "common/images/film.h"
#include "methods/method.h"
#include "methods/parts/vertices/path_vertex.h"

#include <string>
#include <utility>
#include <vector>

namespace gib {

struct NoMerging {
    using Sample = PixelSample;
    using Film = gib::Film;

    /// The techniques that are added along one walk: calls at its vertices.
    struct Along {
        explicit Along(const NoMerging&, bool = false) {}
        template <typename... Arrival>
        void arrive(const Arrival&...) {}
        /// Whether the walk ends here, since no technique wanted can make its paths.
        static constexpr bool ends(const TechniqueSums&) { return false; }
        /// Whether the techniques of bidirectional path tracing are weighed, but not in use.
        static constexpr bool is_alone() { return false; }
        template <typename... Scattering>
        void scatters(const Scattering&...) {}
        void scattered(const PathVertex&, double) {}
        /// The vertex of the camera's walk is about to be connected with one of a light's.
        void join(RayQueries&, PathVertex&, const PathVertex&) {}
    };
    using AlongCamera = Along;
    using AlongLight = Along;

    const NoMerging& rule() const { return *this; }
    static constexpr bool is_alone() { return false; }
    static Film film(const Sensor& sensor, const ShownComponents& shown) {
        return {sensor.width(), sensor.height(), shown.accumulated, shown.black};
    }
    static PixelSample& light_of(Sample& sample) { return sample; }
    /// Called before each pass.
    void start_pass(std::uint32_t, StageTimes&, std::uint64_t&) {}
    /// Adds the light that the added techniques make at a vertex of the camera's walk.
    void merge(PathVertex&, Along&, RayQueries&, NumberStream&, Sample&) const {}
    static std::uint64_t light_paths() { return 0; }
    static std::vector<std::pair<std::string, std::string>> facts() { return {}; }
};

}  // namespace gib
