#pragma once
// Expands what Mitsuba's scene language adds to XML: $parameters with <default>, <include>, <path>, id with
// <ref> and <alias>.

#include "common/core/files.h"
#include "common/core/load_errors.h"
#include "common/core/load_warnings.h"
#include "common/xml/xml_document.h"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace gib {

/// Finds files in the main scene's folder, then in the <path> entries, the latest entry first (Mitsuba's order), and last in the
/// working folder.
class FileFinder {
public:
    /// `warnings` must outlive this object.
    FileFinder(std::string main_folder, LoadWarnings& warnings)
        : main_folder_(std::move(main_folder)), warnings_(warnings) {}
    void add_path(std::string folder) { paths_.insert(paths_.begin(), std::move(folder)); }
    /// Looks into the folders `first` before all others. A name with backslashes that is found nowhere is searched with slashes,
    /// with a warning. Throws InputError at `where`, with the folders that were searched, or with the file whose name differs in
    /// capitals only.
    std::string find(const std::string& name, const SourceLocation& where,
                     const std::vector<std::string>& first = {}) const;

private:
    std::string main_folder_;
    std::vector<std::string> paths_;
    LoadWarnings& warnings_;
};

/// The objects of a scene by their id, and the warnings of whoever reads them.
class XmlIds {
public:
    /// Both arguments must outlive this object. Of several objects with one id, which are warned of, a reference means the
    /// last one before it. Throws InputError for an alias of an unknown one.
    XmlIds(const XmlElement& root, LoadWarnings& warnings) : warnings_(warnings) {
        collect(root);
        collect_uses(root);
    }
    void warn(const SourceLocation& where, const std::string& message) const { warnings_.add(where, message); }
    /// From now on unknown parameters are added to `errors`, which must outlive this object. Without it, as at first, the first
    /// one throws.
    void collect_unknown(LoadErrors* errors) { unknown_ = errors; }
    /// Throws InputError or collects the error.
    void reject_unknown(const SourceLocation& where, const std::string& message) const {
        if (!unknown_) throw InputError(where, message);
        unknown_->add(where, message);
    }
    /// The object that a <ref> means. Throws InputError at the reference if there is none.
    const XmlElement& resolve(const XmlElement& ref) const;
    /// Whether a <ref> means the object.
    bool is_used(const XmlElement& object) const { return used_.contains(&object); }

private:
    void collect(const XmlElement& element);
    void insert(const std::string& id, const XmlElement& object, const SourceLocation& where);

    void collect_uses(const XmlElement& element);
    /// The object that a <ref> means; null if there is none.
    const XmlElement* find(const XmlElement& ref) const;

    LoadWarnings& warnings_;
    LoadErrors* unknown_ = nullptr;
    std::map<std::string, const XmlElement*> objects_;        ///< the last one of each id
    std::map<const XmlElement*, const XmlElement*> earlier_;  ///< the object of each <ref> that stands after it
    std::set<const XmlElement*> used_;
};

struct ExpandedXml {
    XmlElement root;  ///< a <scene> without <default>, <include> and <path>, all parameters substituted, a spectrum's
                      ///< `filename` replaced by the path where it was found
    FileFinder files;
};

/// Expands the scene in `text`, and upgrades it if its version is old (xml_upgrade.h). `parameters` replace the defaults;
/// files are searched for in `folders` after that of `path`; all files that are read are added to `hash`. Values whose
/// parameters have no value are left out with one warning, so that the plugins' defaults count. Throws InputError for other
/// parameters without a value (all in one message), for one of `parameters` that the file does not know, and for a missing
/// or circular include.
ExpandedXml expand_xml(const std::string& text, const std::string& path,
                       const std::map<std::string, std::string>& parameters, const std::vector<std::string>& folders,
                       ContentHash& hash, LoadWarnings& warnings);

}  // namespace gib
