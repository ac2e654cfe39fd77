#pragma once
// The commands behind the command line. They throw InputError for wrong input; one that returns has succeeded.
//
// `gibench photons`: writes the page that shows the light that a method stores.

#include "common/reader/scene_file.h"

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>

namespace gib {

/// Work on one scene with one method.
struct SceneJob {
    std::string scene;
    std::string method;  ///< label
    std::uint64_t seed = 1;
    int threads = 0;
    SceneLoadOptions loading;
    std::string out;
};

struct RenderOptions : SceneJob {
    bool features = false;  ///< adds the layers albedo, normal and depth
};
void render(const RenderOptions& options, std::ostream& out);

struct ReferenceOptions : SceneJob {
    std::optional<std::string> target;
    std::optional<double> seconds;
    std::optional<double> epsilon;  ///< epsilon of the relative error [radiance^2]; none: the default (epsilon.h)
    bool replace = false;           ///< an image at `out` that is not the reference of this scene, method and size
};
void make_reference_file(const ReferenceOptions& options, std::ostream& out);

/// Prints the plans of a method, by its label, or of all methods if `method` is empty.
void print_plan(const std::string& scene, const std::string& method, const SceneLoadOptions& loading,
                std::ostream& out);

void list_methods(bool parameters, std::ostream& out);
void list_scenes(std::ostream& out);
void list_experiments(std::ostream& out);
void list_effects(std::ostream& out);
/// Keys of an experiment file, and columns of the CSV files; as Markdown they make experiments/REFERENCE.md.
void list_keys(bool markdown, std::ostream& out);
void list_columns(bool markdown, std::ostream& out);
/// The lines that list_keys() prints.
std::string key_help();
/// Name, default, unit, range and sentence of every parameter of every method.
std::string parameter_help();

/// Writes the tables and the report of a result folder again. Damage that can be left out gives a warning. Throws
/// InputError, and writes nothing, if no scene is left or if another process works in the folder.
void rebuild_report(const std::string& folder, std::ostream& out);

struct PhotonsOptions : SceneJob {
    std::size_t most_photons = 200000;  ///< number of photons shown
    /// Limit on passes; none: that of the label or the scene, but at most default_passes.
    std::optional<std::uint32_t> passes;
};
/// Passes of a method that stores other light in each, and of an image beside light that stays.
inline constexpr std::uint32_t default_passes = 16, default_image_passes = 4, most_passes_shown = 255;
inline constexpr std::size_t most_photons_shown = 5000000;

/// Writes the page and prints what it shows of how much. Throws InputError if the method stores no light.
void show_photons(const PhotonsOptions& options, std::ostream& out);

}  // namespace gib
