#pragma once
// The methods of one scene, compared in one layer: after a time, in the time to an error, and by their final images.

#include "experiments/analysis/curves.h"
#include "experiments/analysis/ranking.h"

#include <string>
#include <vector>

namespace gib {

class Contest {
public:
    /// `analysis` has to outlive this object.
    Contest(const Analysis& analysis, const std::string& scene, Layer layer = Layer::total);

    std::size_t methods() const { return methods_.size(); }
    const CellsByMethod& cells() const { return methods_; }
    /// Whether the whole layer is judged, so that a method can be the best.
    bool is_judged() const { return is_judged_; }
    double noise_floor() const { return noise_floor_; }

    /// The time [s] after which the methods are compared: the shortest of their mean total times, without methods that
    /// have converged, whose images more time would not change (the longest of all if each has).
    double equal_time() const;
    /// By the squared error after `seconds`. Between two checkpoints, errors follow a power law of time. A method whose
    /// runs ended before is known by its law alone, unless it has converged. Errors below the noise floor are equal.
    std::vector<Contender> after(double seconds) const;
    /// By the time to target_errors[target]. Of a seed that has not reached it, the whole
    /// time is a lower bound.
    std::vector<Contender> to_error(std::size_t target) const;
    /// By the squared error of the final images; for methods whose runs ended earlier than those of the best, by that of
    /// their law at that time.
    std::vector<Contender> by_final_images() const;

private:
    Contender contender(const std::string& method, const Runs& cells) const;
    /// Sets what the law of a method says of its error after `seconds`.
    void extrapolate(Contender& contender, double seconds) const;
    /// Sets the squared errors of the seeds after `seconds`; where their mean is not above the noise floor, each is that floor.
    void set_errors(Contender& contender, const Runs& cells, double seconds) const;

    const Analysis& analysis_;
    std::string scene_;
    Layer layer_;
    CellsByMethod methods_;
    bool is_judged_;
    double noise_floor_;
};

}  // namespace gib
