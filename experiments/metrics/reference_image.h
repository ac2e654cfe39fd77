#pragma once
// A reference is an image whose own error is known.

#include "common/images/image.h"
#include "common/images/image_file.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gib {

struct LoadedScene;

/// The standard error of a reference comes from this many groups of independently seeded batches.
inline constexpr int reference_groups = 16;

/// One image of a reference, the total or a component [W/(sr m^2)].
struct ReferenceLayer {
    Image mean;
    std::optional<Image> standard_error;  ///< standard error of the mean, per pixel and channel
    std::vector<Image> groups;            ///< means of the groups of batches, independent of each other; may be empty
    /// Empty, or one layer: the estimated bias of the mean (ComponentImages::bias).
    std::vector<ReferenceLayer> bias = {};

    /// The number of values that are not finite: of the groups, else of the mean and its standard error, which are made
    /// of them.
    std::size_t non_finite_values() const;
    /// Estimate of the squared bias of value i; 0 without a bias. It is unbiased, and may be negative, if the bias has
    /// a standard error. If not, as in a single image, it is too large by the noise of the bias.
    double squared_bias(std::size_t i) const;
    /// The mean over all values of weight(i) squared_bias(i), but at least 0: how far the bias shifts the mean square
    /// of a difference to this layer.
    template <typename Weight>
    double mean_squared_bias(const Weight& weight) const {
        double sum = 0;
        for (std::size_t i = 0; !bias.empty() && i < mean.rgb.size(); ++i)
            sum += weight(i) * squared_bias(i);
        return sum > 0 ? sum / static_cast<double>(mean.rgb.size()) : 0;
    }
};

inline bool contains(const std::vector<Component>& list, Component c) {
    return std::find(list.begin(), list.end(), c) != list.end();
}

struct Reference {
    ReferenceLayer total;
    std::array<std::optional<ReferenceLayer>, component_count> components;
    /// Components that the reference's method samples incompletely, or in which it is contradicted.
    std::vector<Component> unresolved;
    std::map<std::string, std::string> metadata;

    const std::optional<ReferenceLayer>& operator[](Component c) const {
        return components[static_cast<std::size_t>(index_of(c))];
    }
};

/// Reads a file with or without standard errors; an image of any renderer is accepted. The layers are R,G,B; NAME;
/// stderr; NAME_stderr; group00, NAME_group00 and so on; bias and NAME_bias, which may have all of these too. Throws
/// InputError, also if the file has a digest and its content does not match it.
Reference read_reference(const std::string& path);
/// Writes an EXR file with the groups, the metadata, and a digest of the pixels and of the metadata that are needed
/// to add samples later. read_reference() checks the digest, so that it refuses a file that was damaged or edited.
/// Throws RunError.
void write_reference(const std::string& path, const Reference& reference);
/// Whether the reference was read from a file with a digest. A file without one is accepted unchecked.
bool is_verified(const Reference& reference);
/// Takes the reference from a file that is already in memory, without a check of its digest. Errors name `path`.
/// Throws InputError if there are no channels R,G,B.
Reference reference_in(const LayeredImage& file, const std::string& path);
/// The layers of the file that write_reference() writes. `with_groups` includes the groups, which the interval of a
/// bias needs.
LayeredImage layers_of(const Reference& reference, bool with_groups);

/// The components' names as one text, separated by `;`, and back. Names of no component are left out.
std::string names_of(const std::vector<Component>& components);
std::vector<Component> components_named(const std::string& names);
/// Whether every value is 0.
bool is_black(const Image& image);
/// The mean of one image or more of one size.
Image mean_image(std::span<const Image> images);
/// An attribute of a file; empty if it has none.
std::string attribute_in(const std::map<std::string, std::string>& metadata, const std::string& key);
/// The attributes by which an image of gibench says which scene it shows.
std::map<std::string, std::string> scene_attributes(const LoadedScene& scene);
/// Whether the attributes of two images say that they show different scenes: neither LoadedScene::content_hash nor
/// LoadedScene::view_hash agrees. Images of older versions have only the first; one that has neither may show any
/// scene.
bool show_different_scenes(const std::map<std::string, std::string>& a, const std::map<std::string, std::string>& b);

/// Makes a layer from the means of groups, which all have the same number of samples: their mean, and as its standard
/// error their standard deviation / sqrt(groups).
ReferenceLayer layer_of_groups(std::vector<Image> groups);

/// The share that the most deviant group of each value (pixel and channel) has in the sum of the groups' squared
/// deviations from their mean: about 0.27 for Gaussian noise of 16 groups, near 1 if rare bright samples dominate the
/// image, 0 if all groups are equal.
double dominance_of_one_group(const std::vector<Image>& groups);

}  // namespace gib
