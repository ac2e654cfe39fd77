#include "experiments/results/quantities.h"

#include <fmt/format.h>

#include <array>

namespace gib {

namespace {

/// All quantities. A message is `sentence` with the values before and after.
struct Description {
    const char* name;
    std::string Differences::*effect;
    const char* sentence;
};
constexpr std::array descriptions = {
    Description{"scene", &Differences::all, "its content or its resolution has changed"},
    Description{"definitions", &Differences::all, "the definition of errors was version {} and is version {}"},
    Description{"unit", &Differences::all, "the unit was {} and is {}"},
    Description{"epsilon", &Differences::all, "epsilon was {} and is {}"},
    Description{"components", &Differences::all, "the components compared were {} and are {}"},
    Description{"reference image", &Differences::all, "the reference was {} and is {}"},
    Description{"threads", &Differences::seconds, "the number of threads was {} and is {}"},
    Description{"reference", &Differences::noted, "the reference was {} and is {}"},
};

std::string judged_components(const Components& unjudged) {
    std::string names;
    for (const Component c : unjudged.list())
        names += fmt::format("{}{}", names.empty() ? "all but " : ", ", name_of(c));
    return names.empty() ? "all" : names;
}

}  // namespace

Quantities quantities_of(const ResultIndex& index, const IndexScene& scene, const Components& unjudged) {
    const bool is_given = scene.reference_method.starts_with("the image ");
    const std::string target = scene.target ? fmt::format(", target {:g} %", 100 * *scene.target) : "";
    return {
        {"scene", scene.content_hash},
        {"definitions", std::to_string(index.definitions)},
        {"unit", "W/(sr m^2)"},
        {"epsilon", index.epsilon ? fmt::format("{:g}", *index.epsilon) : "that of the reference's mean"},
        {"components", judged_components(unjudged)},
        {"reference image",
         is_given ? fmt::format("{} ({:.8})", scene.reference_method, scene.reference) : "an estimate of gibench"},
        {"threads", std::to_string(index.threads)},
        {"reference", scene.reference_method + target},
    };
}

Differences differences(const Quantities& before, const Quantities& after) {
    Differences found;
    for (const auto& [name, effect, sentence] : descriptions) {
        const auto a = before.find(name), b = after.find(name);
        if (a == before.end() || b == after.end() || a->second == b->second) continue;
        std::string& text = found.*effect;
        text += (text.empty() ? "" : ", and ") + fmt::format(fmt::runtime(sentence), a->second, b->second);
    }
    return found;
}

}  // namespace gib
