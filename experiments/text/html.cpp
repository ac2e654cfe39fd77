#include "experiments/text/html.h"

#include <fmt/format.h>

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

std::string html_escape(std::string_view text) {
    std::string escaped;
    for (const char c : text)
        switch (c) {
            case '&':
                escaped += "&amp;";
                break;
            case '<':
                escaped += "&lt;";
                break;
            case '>':
                escaped += "&gt;";
                break;
            case '"':
                escaped += "&quot;";
                break;
            case '\'':
                escaped += "&#39;";
                break;
            default:
                escaped += c;
        }
    return escaped;
}

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

std::string with_interval_html(const Estimate& estimate, std::string (*text)(double)) {
    std::string html = text(estimate.value);
    if (estimate.interval)
        html += fmt::format("<span class=\"interval\">{} to {}</span>", text(estimate.interval->lo),
                            text(estimate.interval->hi));
    return html;
}

std::string method_color(std::size_t index) { return fmt::format("var(--method-{})", index % 10); }

std::string method_html(std::size_t index, const std::string& label) {
    return fmt::format("<span class=\"swatch\" style=\"background:{}\"></span>{}", method_color(index),
                       html_escape(label));
}

}  // namespace gib
