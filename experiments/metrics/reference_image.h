#pragma once
// A reference: an image whose own error is known.

#include "common/images/image.h"
#include "common/images/image_file.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace gib {

/// The number of groups of independently seeded batches that a reference's standard error comes from.
inline constexpr int reference_groups = 16;

/// One quantity of a reference, the total or a component. Units of radiance.
struct ReferenceLayer {
    Image mean;
    std::optional<Image> standard_error;  ///< of the mean, per pixel and channel
    std::vector<Image> groups;            ///< means of the groups of batches, independent of each other; may be empty
};

struct Reference {
    ReferenceLayer total;
    std::array<std::optional<ReferenceLayer>, component_count> components;
    std::vector<Component> unresolved;  ///< with paths that the reference's method cannot sample
    std::map<std::string, std::string> metadata;

    const std::optional<ReferenceLayer>& operator[](Component c) const {
        return components[static_cast<std::size_t>(index_of(c))];
    }
};

/// From a file with or without standard errors (any renderer's image will do). Layers: R,G,B; NAME; stderr;
/// NAME_stderr; group00, NAME_group00 and so on. Throws InputError.
Reference read_reference(const std::string& path);
/// With its groups, metadata and a digest of what matters of them, which read_reference() checks: a file that was
/// damaged or edited since is refused there. Throws RunError.
void write_reference(const std::string& path, const Reference& reference);
/// Whether it was read from a file with a digest; those of earlier versions have none.
bool is_verified(const Reference& reference);
/// The same of a file that is read already, unchecked.
Reference reference_in(const LayeredImage& file, const std::string& path);
/// `with_groups` keeps the groups too, which the interval of a bias needs.
LayeredImage layers_of(const Reference& reference, bool with_groups);

/// From the groups' means (all of the same number of samples): their mean, and their scatter / sqrt(groups).
ReferenceLayer layer_of_groups(std::vector<Image> groups);

/// sqrt(mean over pixels and channels of stderr^2 / (r^2 + epsilon)); 0 without a standard error.
double relative_standard_error(const ReferenceLayer& layer, double epsilon);

}  // namespace gib
