#pragma once
// What of an image is compared with a reference: everything but the components that the reference does not resolve.

#include "common/images/image.h"
#include "experiments/metrics/reference_image.h"
#include "experiments/results/result_folder.h"

#include <map>
#include <string>

namespace gib {

class Judgement {
public:
    /// The reference outlives it.
    explicit Judgement(const Reference& reference);

    bool is_resolved(Component c) const;
    /// The total without unresolved components; its mean is the denominator of every relative error.
    const ReferenceLayer& total() const { return partial_total_ ? *partial_total_ : reference_.total; }
    /// Null if the reference has no such component or does not resolve it.
    const ReferenceLayer* component(Component c) const;
    Image total_of(const ComponentImages& image) const;

    /// The errors of the total and of each component that both have, by name.
    std::map<std::string, ImageError> errors(const ComponentImages& image, double epsilon) const;

private:
    const Reference& reference_;
    std::optional<ReferenceLayer> partial_total_;
};

}  // namespace gib
