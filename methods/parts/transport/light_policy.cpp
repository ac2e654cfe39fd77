#include "methods/parts/transport/light_policy.h"

namespace gib {

namespace {

constexpr std::array<std::string_view, 3> guiding_names = {"auto", "on", "off"};

}  // namespace

Parameter guide_parameter() {
    return choice_parameter(
        "guide", strings(guiding_names),
        "light's paths follow the importance that walks from the camera find; auto: where most light "
        "would never be used");
}

Guiding guiding_of(const ParameterValues& values) { return chosen<Guiding>(guiding_names, values.choice("guide")); }

void add_importons(Plan& plan, Guiding guiding, std::string why_not) {
    plan.add(step_importons, guiding == Guiding::off ? "guide=off" : std::move(why_not));
}

}  // namespace gib
