#include "experiments/text/html.h"

#include <boost/algorithm/string/replace.hpp>
#include <kainjow/mustache.hpp>

namespace gib {

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

std::string script_safe_json(const std::string& json) { return boost::replace_all_copy(json, "<", "\\u003c"); }

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

}  // namespace gib
