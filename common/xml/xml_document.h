#pragma once
// An XML file as a tree that holds the place of every element and every attribute in the file.

#include "common/core/error.h"

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace gib {

struct XmlAttribute {
    std::string name, value;
    SourceLocation where;  ///< place of the first letter of its name
};

struct XmlElement {
    std::string tag;
    SourceLocation where;  ///< place of its `<`
    std::vector<XmlAttribute> attributes;
    std::vector<XmlElement> children;
    bool old = false;  ///< from a file of a version below 2, whose needless parameters are warned of
    /// From a file of a version below 3: of a value that is given twice the last one counts.
    bool last_counts = false;

    /// Null if there is none.
    const XmlAttribute* find(std::string_view name) const;
    /// Throws InputError if there is none.
    const XmlAttribute& required(std::string_view name) const;
    /// Throws InputError at the first attribute that is not among `allowed`.
    void check_attributes(std::initializer_list<std::string_view> allowed) const;
    void check_no_children() const;
};

/// Parses a document in UTF-8 and returns its root element; `file` names the document in messages. Throws InputError
/// for malformed XML, for text between elements and for an attribute that is given twice.
XmlElement parse_xml(const std::string& text, const std::string& file);

}  // namespace gib
