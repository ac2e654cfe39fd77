#include "experiments/text/html.h"

#include <boost/algorithm/string/replace.hpp>
#include <kainjow/mustache.hpp>
#include <nlohmann/json.hpp>

#include <stdexcept>

namespace gib {

namespace {

using kainjow::mustache::data;

data data_of(const nlohmann::json& value) {
    if (value.is_array()) {
        data list{data::type::list};
        for (const auto& item : value)
            list.push_back(data_of(item));
        return list;
    }
    if (value.is_object()) {
        data object{data::type::object};
        for (const auto& [name, member] : value.items())
            object[name] = data_of(member);
        return object;
    }
    if (value.is_number()) return value.dump();
    if (value.is_string() && value != "") return value.get<std::string>();
    return value == true;
}

}  // namespace

std::string html_escape(std::string_view text) { return kainjow::mustache::html_escape(std::string(text)); }

std::string sentence_html(std::string_view text) {
    std::string html;
    bool code = false;
    while (true) {
        const std::size_t at = text.find('`');
        html += html_escape(text.substr(0, at));
        if (at == std::string_view::npos) return code ? html + "</code>" : html;
        code = !code;
        html += code ? "<code>" : "</code>";
        text.remove_prefix(at + 1);
    }
}

std::string script_safe_json(const std::string& text) { return boost::replace_all_copy(text, "<", "\\u003c"); }

std::string script_safe_code(std::string_view code) {
    const std::string safe = boost::replace_all_copy(std::string(code), "</script", "<\\/script");
    return boost::replace_all_copy(safe, "<!--", "<\\!--");
}

std::string markdown_text(std::string_view text) {
    std::string line;
    for (const char c : text) {
        if (c == '|') line += '\\';
        line += c == '\n' || c == '\r' ? ' ' : c;
    }
    return line;
}

std::string filled(std::string_view page, const nlohmann::json& values, std::string (*escape)(std::string_view)) {
    kainjow::mustache::mustache text{std::string(page)};
    text.set_custom_escape([escape](const std::string& part) { return escape(part); });
    std::string result;
    text.render(data_of(values), [&](const std::string& part) { result += part; });
    if (!text.is_valid()) throw std::logic_error("not a template: " + text.error_message());
    return result;
}

std::string embedded_scripts(std::initializer_list<std::string_view> names) {
    std::string script;
    for (const std::string_view name : names)
        script += script_safe_code(embedded_file(name));
    return script;
}

}  // namespace gib
