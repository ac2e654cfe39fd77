#include "common/xml/xml_document.h"

#include "common/core/reject.h"

#include <fmt/ranges.h>
#include <algorithm>
#include <optional>
#include <pugixml.hpp>

namespace gib {

namespace {

constexpr int deepest_element = 64;  ///< deeper files are mistakes, and recursion over them must stay on the stack

class Converter {
public:
    Converter(const std::string& text, std::string file) : text_(text), file_(std::move(file)) {
        for (std::size_t i = 0; i < text.size(); ++i)
            if (text[i] == '\n') line_starts_.push_back(i + 1);
    }

    SourceLocation location(std::size_t offset) const {
        offset = std::min(offset, text_.size());
        const auto next = std::upper_bound(line_starts_.begin(), line_starts_.end(), offset);
        return {file_, static_cast<int>(next - line_starts_.begin()), static_cast<int>(offset - *(next - 1)) + 1};
    }

    XmlElement convert(const pugi::xml_node& node, int depth) const {
        // pugixml's offset is that of the name, one after the `<`.
        const auto name_offset = static_cast<std::size_t>(node.offset_debug());
        XmlElement element{.tag = node.name(), .where = location(name_offset - 1), .attributes = {}, .children = {}};
        if (depth > deepest_element)
            reject(element.where, "elements are nested deeper than {} levels", deepest_element);
        convert_attributes(node, name_offset + element.tag.size(), element);
        for (const auto& child : node.children()) {
            if (child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata)
                reject(location(static_cast<std::size_t>(child.offset_debug())), "unexpected text in <{}>",
                       element.tag);
            element.children.push_back(convert(child, depth + 1));
        }
        return element;
    }

private:
    /// pugixml has no offsets of attributes: their places are found again in the text, which is known
    /// to be well-formed.
    void convert_attributes(const pugi::xml_node& node, std::size_t at, XmlElement& element) const {
        for (const auto& attribute : node.attributes()) {
            at = text_.find_first_not_of(" \t\r\n", at);
            XmlAttribute converted{attribute.name(), attribute.value(), location(at)};
            if (element.find(converted.name)) reject(converted.where, "attribute '{}' is given twice", converted.name);
            element.attributes.push_back(std::move(converted));
            const std::size_t quote = text_.find_first_of("\"'", at);
            at = text_.find(text_[quote], quote + 1) + 1;
        }
    }

    const std::string& text_;
    std::string file_;
    std::vector<std::size_t> line_starts_{0};
};

struct WrongEndTag {
    std::string tag;       ///< the name in the end tag
    std::string open_tag;  ///< the name of the innermost element that is open there
    std::size_t opened;    ///< offset of that element's `<`
};

/// The offset after the tag whose `<` stands at `at`; a `>` within quotes does not end it.
std::size_t end_of_tag(const std::string& text, std::size_t at) {
    char quote = 0;
    for (; at < text.size(); ++at) {
        const char c = text[at];
        if (quote) quote = c == quote ? char{0} : quote;
        else if (c == '"' || c == '\'') quote = c;
        else if (c == '>') return at + 1;
    }
    return text.size();
}

/// The first end tag that does not close the innermost open element; the XML library names neither.
std::optional<WrongEndTag> wrong_end_tag(const std::string& text) {
    std::vector<std::pair<std::string, std::size_t>> open;
    for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at)) {
        const auto skip_to = [&](std::string_view end) { at = std::min(text.find(end, at), text.size()); };
        if (text.compare(at, 4, "<!--") == 0) {
            skip_to("-->");
            continue;
        }
        if (text.compare(at, 9, "<![CDATA[") == 0) {
            skip_to("]]>");
            continue;
        }
        const std::size_t end = end_of_tag(text, at), from = at + (text.compare(at, 2, "</") == 0 ? 2 : 1);
        const std::string name = text.substr(from, text.find_first_of(" \t\r\n/>", from) - from);
        if (from == at + 2) {
            if (open.empty()) return std::nullopt;
            if (open.back().first != name) return WrongEndTag{name, open.back().first, open.back().second};
            open.pop_back();
        } else if (text[from] != '!' && text[from] != '?' && text.compare(end - 2, 2, "/>") != 0) {
            open.emplace_back(name, at);
        }
        at = end;
    }
    return std::nullopt;
}

}  // namespace

const XmlAttribute* XmlElement::find(std::string_view name) const {
    const auto it = std::find_if(attributes.begin(), attributes.end(), [&](const auto& a) { return a.name == name; });
    return it == attributes.end() ? nullptr : &*it;
}

const XmlAttribute& XmlElement::required(std::string_view name) const {
    const XmlAttribute* attribute = find(name);
    if (!attribute) reject(where, "<{}> needs the attribute '{}'", tag, name);
    return *attribute;
}

void XmlElement::check_attributes(std::initializer_list<std::string_view> allowed) const {
    for (const auto& attribute : attributes)
        if (std::find(allowed.begin(), allowed.end(), attribute.name) == allowed.end())
            reject(attribute.where, "unknown attribute '{}' of <{}>; it takes: {}", attribute.name, tag,
                   fmt::join(allowed, ", "));
}

void XmlElement::check_no_children() const {
    if (!children.empty()) reject(children[0].where, "<{}> cannot hold <{}>", tag, children[0].tag);
}

XmlElement parse_xml(const std::string& text, const std::string& file) {
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
        reject({file, 1, 1}, "the file is UTF-16: it has to be saved as UTF-8");
    const Converter converter(text, file);
    pugi::xml_document document;
    const auto result = document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!result) {
        const auto where = converter.location(static_cast<std::size_t>(result.offset));
        const auto wrong = result.status == pugi::status_end_element_mismatch ? wrong_end_tag(text) : std::nullopt;
        if (wrong)
            reject(where, "malformed XML: </{}> stands where <{}> of line {} has to be closed first", wrong->tag,
                   wrong->open_tag, converter.location(wrong->opened).line);
        reject(where, "malformed XML: {}", result.description());
    }
    const pugi::xml_node root = document.document_element();
    if (const pugi::xml_node second = root.next_sibling())
        throw InputError(converter.location(static_cast<std::size_t>(second.offset_debug()) - 1),
                         "malformed XML: something follows the root element");
    return converter.convert(root, 0);
}

}  // namespace gib
