#pragma once
// Filters the image of a cell at each checkpoint, or adds to it what an external filter reads.
//
// The halves of (non_local_means.h) are passes 1 to m and m + 1 to n of one run: a mean over passes i + 1 to j is (j
// image(j) - i image(i)) / (j - i). m is the checkpoint that is nearest to n / 2, and each half has a checkpoint near
// its own middle, so that no sample is taken for the filter's sake. Any method will do whose image is the mean of its
// passes. Sobol' points of two halves are not quite independent: those of `path` in the Cornell box differ by a tenth
// more than independent ones would for the variance of their mean, which is overestimated by so much.

#include "common/images/non_local_means.h"
#include "methods/method.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gib {

/// The things that are made of the images of a cell.
struct FilterRequest {
    bool non_local_means = false;             ///< filters them
    bool features = false, variance = false;  ///< adds layers for a filter that is a command
};

class CheckpointFilter {
public:
    /// The scene must outlive it.
    CheckpointFilter(const Scene& scene, std::uint64_t seed, const FilterRequest& request)
        : scene_(scene), seed_(seed), request_(request) {}

    bool does_anything() const { return request_.non_local_means || request_.features || request_.variance; }
    /// The least number of passes that can be filtered.
    std::uint32_t least_passes() const { return request_.non_local_means ? 4 : request_.variance ? 2 : 1; }
    /// Makes the features; the time is charged.
    void prepare(StageTimes& stages);
    /// Keeps the image of a checkpoint for later halves.
    void keep(std::uint32_t passes, const ComponentImages& image);
    /// The image that is measured; the time is charged.
    ComponentImages filtered(std::uint32_t passes, const ComponentImages& image) const;
    /// The layers `albedo`, `normal`, `depth` and `variance`, as far as they are wanted; each is there from prepare()
    /// or filtered() on.
    std::vector<std::pair<std::string, Image>> layers(std::uint32_t passes) const;

private:
    /// The mean over the passes after the first `begin` ones, up to `end`; both are kept, or 0.
    ComponentImages mean(std::uint32_t begin, std::uint32_t end) const;
    /// The kept number of passes that is nearest to the middle of `begin` and `end`, and between them.
    std::uint32_t middle(std::uint32_t begin, std::uint32_t end) const;
    HalfImage half(std::uint32_t begin, std::uint32_t end) const;

    const Scene& scene_;
    std::uint64_t seed_;
    FilterRequest request_;
    std::optional<std::array<FeatureImages, 2>> features_ = {};
    std::map<std::uint32_t, ComponentImages> kept_ = {};  ///< by passes
};

}  // namespace gib
