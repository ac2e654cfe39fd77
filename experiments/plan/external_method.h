#pragma once
// Other renderers as methods: [[method]] tables of an experiment file with a `command`. The command runs in a shell,
// after its placeholders, such as {scene}, are replaced.

#include "common/core/error.h"
#include "methods/parameters.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gib {

/// One label of a [[method]] with a command.
struct ExternalMethod {
    MethodLabel label;     ///< the name that the file gives, and the values of the placeholders that are its own
    std::string command;   ///< command with placeholders
    SourceLocation where;  ///< place of the command
    std::string image_format = "exr";       ///< ending of the image's file: exr, pfm or hdr
    std::optional<std::uint32_t> spp = {};  ///< value of {spp}; none: the scene's sample count
    double timeout = 3600;                  ///< wall-clock time after which the command is ended [s]

    /// The names in braces in the command.
    std::vector<std::string> placeholders() const;
    /// Whether the command has this placeholder.
    bool takes(std::string_view placeholder) const;
    /// Everything that decides the image, for the key of a cell.
    std::string identity() const;
};

/// The placeholders that every command may have: scene, out, spp, seconds, seed, threads, width, height.
const std::vector<std::string>& command_placeholders();

/// The command with its placeholders replaced by `values`, each quoted for the shell if it needs that, and by the
/// values of the label. Throws InputError at the command for a placeholder without a value.
std::string filled_command(const ExternalMethod& method, const std::map<std::string, std::string>& values);

/// The methods of an experiment.
struct ExperimentMethods {
    std::vector<MethodLabel> methods;                 ///< sweeps expanded, in the order of the file
    std::map<std::string, ExternalMethod> externals;  ///< those of them that run a command, by their labels
    std::map<std::string, ExternalMethod> filters;    ///< commands that filter, by their names in labels
    std::map<std::string, std::string> given_names;   ///< the key `label` of their tables, by their labels
};

}  // namespace gib
