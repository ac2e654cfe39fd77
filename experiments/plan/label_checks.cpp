#include "experiments/plan/label_checks.h"

#include "common/core/reject.h"

#include <fmt/format.h>

namespace gib {

std::string filter_of(const MethodLabel& label) {
    for (const auto& [key, value] : label.values)
        if (key == "filter" && value != no_filter) return value;
    return "";
}

void require_passes(const MethodLabel& label, int least, const SourceLocation& where) {
    const ParameterValues values(all_parameters(find_method(label.name)), label, where);
    if (values.given("spp") && values.integer("spp") < least)
        reject(where, "the filter estimates noise from halves of the passes: 'spp' has to be {} at least", least);
}

void require_own_filter(const MethodLabel& label, const SourceLocation& where) {
    const std::string filter = filter_of(label);
    if (filter.empty()) return;
    if (filter != non_local_means_filter)
        reject(where, "there is no filter '{}': there are {} and {} and, in an experiment file, commands", filter,
               no_filter, non_local_means_filter);
    require_passes(label, 4, where);
}

std::vector<const MethodDescription*> reference_methods(const MethodLabel& label, const SourceLocation& where) {
    std::vector<const MethodDescription*> methods;
    if (label.name == auto_reference) {
        for (const MethodDescription& method : method_registry())
            if (method.unbiased && method.estimates_radiance && method.makes_references) methods.push_back(&method);
    } else {
        methods.push_back(&find_comparable_method(label.name, where));
    }
    for (const MethodDescription* method : methods) {
        const ParameterValues values(all_parameters(*method), {method->name, label.values}, where);
        if (values.given("spp"))
            throw InputError(where, "a reference takes as many samples as its target needs: no 'spp'");
        if (values.given("filter")) throw InputError(where, "a filter is biased and makes no reference: no 'filter'");
    }
    return methods;
}

}  // namespace gib
