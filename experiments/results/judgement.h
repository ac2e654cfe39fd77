#pragma once
// Selects the compared part of an image: all components that the reference has.

#include "common/images/image.h"
#include "common/images/image_file.h"
#include "experiments/metrics/epsilon.h"
#include "experiments/metrics/statistics.h"
#include "experiments/results/result_folder.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace gib {

class Judgement {
public:
    /// `reference` has to outlive this object.
    explicit Judgement(const Reference& reference);
    Judgement(const Judgement&) = delete;
    Judgement& operator=(const Judgement&) = delete;

    bool is_resolved(Component c) const;
    /// Whether there is nothing to compare: the reference lacks components, and no other one holds light.
    bool is_empty() const { return empty_; }
    /// The total without components that the reference lacks; its mean image is in the denominator of every relative
    /// error.
    const ReferenceLayer& total() const { return partial_total_ ? *partial_total_ : reference_.total; }
    /// Null if the reference lacks the component.
    const ReferenceLayer* component(Component c) const;
    /// The total, unless it is empty, and every component that the reference has, by name.
    std::vector<std::pair<std::string, const ReferenceLayer*>> layers() const;
    /// The sum of the image's components that the reference has.
    Image total_of(const ComponentImages& image) const;
    /// total_of() the components of an image's file; a file without components, as other renderers write it, unchanged.
    Image total_of(const LayeredImage& file) const;
    /// Whether total() is only a part of the image, so that an image without components cannot be compared with it.
    bool leaves_out_components() const { return !reference_.unresolved.empty(); }

    /// The brightest radiance that light paths can find by chance [W/(sr m^2)], as the reference's file has it.
    std::optional<double> brightest_light() const;
    /// The epsilon of the relative errors of all layers, from what is given (epsilon_of()) [radiance^2].
    double epsilon(const std::optional<double>& given) const {
        return epsilon_of(given, (empty_ ? reference_.total : total()).mean);
    }
    /// The denominators of the relative errors of all layers.
    const Denominators& denominators(double epsilon) const;
    /// The errors of the total, unless it is empty, and of each component that both the image and the
    /// reference have.
    std::map<Layer, ImageError> errors(const ComponentImages& image, double epsilon) const {
        return errors(image, total_of(image), epsilon);
    }
    std::map<Layer, ImageError> errors(const LayeredImage& file, double epsilon) const {
        return errors(components_in(file), total_of(file), epsilon);
    }

private:
    std::map<Layer, ImageError> errors(const ComponentImages& image, const Image& sum, double epsilon) const;

    const Reference& reference_;
    std::optional<ReferenceLayer> partial_total_;
    bool empty_ = false;
    mutable std::optional<Denominators> denominators_;  ///< made when they are asked for first
    mutable std::map<std::string, NoisyTruth> truths_;  ///< by layer, with these denominators
};

}  // namespace gib
