#include "experiments/text/template_text.h"

#include "experiments/text/html.h"

#include <stdexcept>

namespace gib {

std::string filled(std::string_view page, const kainjow::mustache::data& values,
                   std::string (*escape)(std::string_view)) {
    kainjow::mustache::mustache text{std::string(page)};
    text.set_custom_escape([escape](const std::string& part) { return escape(part); });
    std::string result;
    text.render(values, [&](const std::string& part) { result += part; });
    if (!text.is_valid()) throw std::logic_error("not a template: " + text.error_message());
    return result;
}

kainjow::mustache::list embedded_scripts(std::initializer_list<std::string_view> names) {
    kainjow::mustache::list scripts;
    for (const std::string_view name : names)
        scripts.push_back(script_safe_code(embedded_file(name)));
    return scripts;
}

}  // namespace gib
