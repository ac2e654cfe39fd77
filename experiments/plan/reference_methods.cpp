#include "experiments/plan/reference_methods.h"

namespace gib {

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
