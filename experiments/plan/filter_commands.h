#pragma once
// Filters that are commands, such as Open Image Denoise: values of the key `filter` of an experiment file.

#include "experiments/plan/external_method.h"
#include "experiments/plan/toml_reader.h"

#include <map>
#include <string>
#include <vector>

namespace gib {

/// The placeholders that a filter's command may have: image, albedo, normal, depth, variance, threads, out.
const std::vector<std::string>& filter_placeholders();

/// The commands of an experiment by the names that stand in labels: the file's name of the command's first word, and a number if
/// several commands have the same.
class FilterCommands {
public:
    /// The name of one value of the key. Throws InputError for what is neither a filter nor a command with {image} and {out}.
    std::string name_of(const TomlReader& reader, const toml::node& value);
    const std::map<std::string, ExternalMethod>& all() const { return commands_; }

private:
    std::map<std::string, ExternalMethod> commands_;
};

}  // namespace gib
