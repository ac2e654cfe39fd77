#include "experiments/text/html.h"

#include <kainjow/mustache.hpp>

namespace gib {

namespace {

std::string replaced(std::string_view text, std::string_view what, std::string_view by) {
    std::string result;
    while (true) {
        const std::size_t at = text.find(what);
        result += text.substr(0, at);
        if (at == std::string_view::npos) return result;
        result += by;
        text.remove_prefix(at + what.size());
    }
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

std::string script_safe_json(std::string json) { return replaced(json, "<", "\\u003c"); }

std::string script_safe_code(std::string_view code) {
    return replaced(replaced(code, "</script", "<\\/script"), "<!--", "<\\!--");
}

}  // namespace gib
