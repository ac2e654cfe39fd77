#include "experiments/plan/experiment_methods.h"

#include "common/core/reject.h"
#include "experiments/plan/external_method_reader.h"
#include "experiments/plan/filter_commands.h"
#include "experiments/plan/filter_label.h"
#include "experiments/plan/method_sweep.h"

#include <set>

namespace gib {

namespace {

/// The key `label` of a table; empty if it is not given.
std::string read_given_name(const TomlReader& reader, const toml::table& table, std::set<std::string>& names) {
    const auto* node = table.get("label");
    if (!node) return "";
    const std::string name = reader.string(*node, "label");
    if (name.find_first_of("\n\r\t`") != std::string::npos)
        throw InputError(reader.at(*node), "a label has one line, and no backquotes");
    if (!names.insert(name).second) reject(reader.at(*node), "two methods have the label '{}'", name);
    return name;
}

/// The names of the values of the key `filter`.
std::vector<std::string> read_filters(const TomlReader& reader, const toml::table& table, FilterCommands& filters) {
    const auto* node = table.get("filter");
    if (!node) return {};
    const auto* list = node->as_array();
    if (!list) return {filters.name_of(reader, *node)};
    std::vector<std::string> names;
    for (const auto& value : reader.filled_array(*list, "filter", "values"))
        names.push_back(filters.name_of(reader, value));
    return names;
}

/// Throws InputError if the label's filter takes two halves of the passes and there are none.
void require_halves(const MethodLabel& label, const FilterCommands& filters, const SourceLocation& where) {
    const auto command = filters.all().find(filter_of(label));
    if (command == filters.all().end()) require_own_filter(label, where);
    else if (command->second.takes("variance")) require_passes(label, 2, where);
}

}  // namespace

ExperimentMethods read_methods(const TomlReader& reader, const toml::node& node) {
    ExperimentMethods methods;
    std::set<std::string> texts, names;
    FilterCommands filters;
    for (const auto& item : reader.filled_array(node, "method", "[[method]] tables")) {
        const auto& table = reader.table(item, "method");
        const SourceLocation where = reader.at(item);
        const std::string given_name = read_given_name(reader, table, names);
        const auto add = [&](const MethodLabel& label) {
            if (!texts.insert(label.text()).second) reject(where, "the method '{}' is listed twice", label.text());
            methods.labels.push_back(label);
            if (!given_name.empty()) methods.given_names[label.text()] = given_name;
        };
        if (table.get("command")) {
            for (ExternalMethod& external : read_external_method(reader, table, where)) {
                add(external.label);
                methods.externals.emplace(external.label.text(), std::move(external));
            }
            continue;
        }
        const std::vector<std::string> filter_names = read_filters(reader, table, filters);
        const auto* name = table.get("name");
        if (!name) throw InputError(where, "a [[method]] needs a 'name'");
        const auto& description = find_comparable_method(reader.string(*name, "name"), reader.at(*name));
        MethodSweep sweep(reader, description, MethodLabel{description.name, {}});
        for (const auto& entry : reader.entries(table))
            if (entry.key == "filter") sweep.add(entry, filter_names);
            else if (entry.key != "name" && entry.key != "label") sweep.add(entry);
        for (const auto& label : sweep.labels(where)) {
            require_halves(label, filters, where);
            add(label);
        }
    }
    methods.filters = filters.all();
    return methods;
}

}  // namespace gib
