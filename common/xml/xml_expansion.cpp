#include "common/xml/xml_expansion.h"

#include "common/core/reject.h"
#include "common/xml/xml_upgrade.h"
#include "common/xml/xml_values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

namespace gib {

namespace {

constexpr int deepest_include = 15;
bool is_name_character(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

void add_once(std::vector<std::string>& names, const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

/// The values of $parameters, and which of them the file knows.
class Parameters {
public:
    explicit Parameters(const std::map<std::string, std::string>& given) : given_(given), values_(given) {}

    /// Keeps a value that was given from outside; of several defaults the first is kept.
    void declare(const std::string& name, const std::string& value) {
        values_.emplace(name, value);
        known_.insert(name);
    }

    /// Puts the values of its parameters into an attribute. Returns the names of parameters without a value, each once.
    std::vector<std::string> substitute(XmlAttribute& attribute) {
        std::vector<std::string> without;
        std::string result;
        const std::string& text = attribute.value;
        for (std::size_t i = 0; i < text.size();) {
            if (text.compare(i, 2, "\\$") == 0) {
                result += '$';
                i += 2;
            } else if (text[i] == '$') {
                const std::string name = name_at(attribute.value, i + 1);
                known_.insert(name);
                const auto value = values_.find(name);
                if (value != values_.end()) result += value->second;
                else add_once(without, name);
                i += 1 + name.size();
            } else {
                result += text[i++];
            }
        }
        attribute.value = std::move(result);
        if (!without.empty() && missing_.empty()) first_missing_ = attribute.where;
        for (const auto& name : without)
            add_once(missing_, name);
        return without;
    }

    /// "no value for $r, $g: WHAT--set r=... --set g=... would give them", of all parameters that have no value.
    std::string no_value(const std::string& what) const {
        std::vector<std::string> settings;
        for (const auto& name : missing_)
            settings.push_back(fmt::format("--set {}=...", name));
        return fmt::format("no value for ${}: {}{} would give {}", fmt::join(missing_, ", $"), what,
                           fmt::join(settings, " "), missing_.size() == 1 ? "it" : "them");
    }
    /// Throws InputError with all parameters that have no value, at the place of the first one.
    void reject_missing() const { throw InputError(first_missing_, no_value("")); }

    void check_all_known(const std::string& file) const {
        for (const auto& [name, value] : given_)
            if (!known_.count(name))
                reject({file, 0, 0}, "there is no parameter '{}'; the file has: {}", name,
                       known_.empty() ? "none" : fmt::format("{}", fmt::join(known_, ", ")));
    }

private:
    /// The longest name that has a value and stands at `at`: "$ab" is "$a" followed by "b" where only a is known. If none has
    /// a value, all characters that a name may have.
    std::string name_at(const std::string& text, std::size_t at) const {
        const std::string* longest = nullptr;
        for (const auto& [name, value] : values_)
            if (!name.empty() && text.compare(at, name.size(), name) == 0 &&
                (!longest || name.size() > longest->size()))
                longest = &name;
        if (longest) return *longest;
        std::size_t end = at;
        while (end < text.size() && is_name_character(text[end]))
            ++end;
        return text.substr(at, end - at);
    }

    const std::map<std::string, std::string>& given_;
    std::map<std::string, std::string> values_;
    std::set<std::string> known_;
    std::vector<std::string> missing_;  ///< names without a value
    SourceLocation first_missing_;      ///< where the first of them stands
};

/// A name that stands for the one of an object whose name changes no image; empty for other objects.
std::string_view stand_in_name(const XmlElement& element) {
    for (const auto& [tag, name] : {std::pair("integrator", "path"), std::pair("sampler", "independent"),
                                    std::pair("film", "hdrfilm"), std::pair("rfilter", "gaussian")})
        if (element.tag == tag) return name;
    return {};
}

/// Whether Mitsuba's plugins have a default for the value of this element.
bool may_be_left_out(const XmlElement& element) {
    const XmlAttribute* name = element.find("name");
    for (const std::string_view tag : {"float", "integer", "boolean", "string", "rgb", "spectrum"})
        if (element.tag == tag) return name && name->value != "filename" && !element.find("type");
    return false;
}

/// In Mitsuba <texture type="..."> and <spectrum type="..."> make objects of one class, whose plugins may stand under
/// either tag. Here <spectrum> is for plugins that are the same everywhere and <texture> for varying ones.
void unify_texture_tag(XmlElement& element) {
    if (element.tag != "texture" && element.tag != "spectrum") return;
    const XmlAttribute* type = element.find("type");
    if (!type) return;
    for (const std::string_view plugin : {"uniform", "regular", "irregular", "srgb", "d65", "blackbody"})
        if (type->value == plugin) element.tag = "spectrum";
    for (const std::string_view plugin : {"bitmap", "checkerboard"})
        if (type->value == plugin) element.tag = "texture";
}

/// The file whose path differs from `path` in capitals only; empty if there is none.
std::string file_in_other_capitals(const std::filesystem::path& path) {
    namespace fs = std::filesystem;
    fs::path found;
    for (const fs::path& part : path) {
        std::error_code error;
        if (fs::exists(found / part, error)) {
            found /= part;
            continue;
        }
        const fs::path folder = found.empty() ? fs::path(".") : found;
        fs::directory_iterator entry(folder, error);
        const auto is_alike = [&](const fs::directory_entry& e) {
            return lower_case(e.path().filename().string()) == lower_case(part.string());
        };
        while (!error && entry != fs::directory_iterator() && !is_alike(*entry))
            entry.increment(error);
        if (error || entry == fs::directory_iterator()) return {};
        found /= entry->path().filename();
    }
    return found.string();
}

class Expander {
public:
    Expander(FileFinder& files, Parameters& parameters, ContentHash& hash, LoadWarnings& warnings)
        : files_(files), parameters_(parameters), hash_(hash), warnings_(warnings) {}

    XmlElement expand_main(const std::string& text, const std::string& path) {
        hash_.add(text);
        XmlElement root = parse_xml(text, path);
        if (root.tag != "scene") reject(root.where, "the root element must be <scene>, not <{}>", root.tag);
        version_ = version_of(root);
        root.check_attributes({"version", "id"});
        expand_children(root, 0);
        if (is_incomplete_) parameters_.reject_missing();
        warn_of_left_out(path);
        return root;
    }

private:
    SceneVersion version_of(const XmlElement& root) {
        if (const XmlAttribute* version = root.find("version")) return parse_version(*version);
        const bool is_old = has_old_names(root);
        warnings_.add(root.where,
                      fmt::format("the file states no version: by its names it is read as {}", is_old ? "0.6" : "3.0"));
        return is_old ? SceneVersion{0, 6} : SceneVersion{3, 0};
    }

    /// Puts the values of parameters into the attributes. Returns whether the element is complete. A value element without a
    /// value is left out, and so is the name of an object that may have any name; in other elements a missing value becomes an
    /// error at the end of the file, which names the parameters of their children, too.
    bool substitute(XmlElement& element, bool with_children = false) {
        const bool optional = may_be_left_out(element);
        const std::string_view stand_in = stand_in_name(element);
        bool complete = true;
        for (auto& attribute : element.attributes) {
            const std::vector<std::string> missing = parameters_.substitute(attribute);
            if (missing.empty()) continue;
            if (attribute.name == "type" && !stand_in.empty()) {
                attribute.value = stand_in;
                left_out_.push_back({attribute.where, fmt::format("the type of <{}>", element.tag)});
            } else {
                complete = false;
                if (!optional || attribute.name != "value") is_incomplete_ = true;
                else left_out_.push_back({attribute.where, fmt::format("'{}'", element.find("name")->value)});
            }
        }
        if (!complete || with_children)
            for (auto& child : element.children)
                substitute(child, true);
        return complete;
    }

    /// Warns of all values that were left out at once, at the first of them. `path` is the main file's.
    void warn_of_left_out(const std::string& path) {
        if (left_out_.empty()) return;
        std::vector<std::string> names;
        for (const LeftOut& value : left_out_) {
            std::string place = left_out_.size() == 1 ? "" : fmt::format(" (line {})", value.where.line);
            if (value.where.file != path) place = fmt::format(" ({}:{})", value.where.file, value.where.line);
            names.push_back(value.what + place);
        }
        warnings_.add(left_out_.front().where,
                      parameters_.no_value(fmt::format("{} {}; ", fmt::join(names, ", "),
                                                       names.size() == 1 ? "is left out, and its default counts"
                                                                         : "are left out, and their defaults count")));
    }

    void expand_children(XmlElement& element, int depth) {
        std::vector<XmlElement> expanded;
        for (auto& child : element.children)
            expand_into(expanded, child, depth);
        element.children = std::move(expanded);
    }

    /// Appends the elements that replace `element`.
    void expand_into(std::vector<XmlElement>& target, XmlElement& element, int depth) {
        if (!substitute(element)) return;
        for (auto& attribute : element.attributes)
            if (attribute.name == "type") attribute.value = lower_case(attribute.value);  // as Mitsuba on some systems
        unify_texture_tag(element);
        if (element.tag == "default") {
            declare(element);
        } else if (element.tag == "path") {
            add_path(element);
        } else if (element.tag == "include") {
            include(target, element, depth);
        } else {
            if (element.tag == "spectrum") find_spectrum_file(element);
            expand_children(element, depth);
            upgrade_element(element, version_, warnings_);
            target.push_back(std::move(element));
        }
    }

    /// Replaces the name of a spectrum's file by its path, because the code that reads the value knows neither the
    /// folders nor the hash.
    void find_spectrum_file(XmlElement& element) {
        for (auto& attribute : element.attributes) {
            if (attribute.name != "filename") continue;
            attribute.value = files_.find(attribute.value, attribute.where, folders_);
            hash_.add(read_file(attribute.value));
        }
    }

    void declare(const XmlElement& element) {
        element.check_attributes({"name", "value"});
        element.check_no_children();
        const XmlAttribute& name = element.required("name");
        if (name.value.empty()) throw InputError(name.where, "a parameter needs a name");
        parameters_.declare(name.value, element.required("value").value);
    }

    void add_path(const XmlElement& element) {
        element.check_attributes({"value"});
        element.check_no_children();
        const std::string& value = element.required("value").value;
        if (value.empty()) return;  // the folder of the scene, where files are searched for anyway
        const std::string folder = files_.find(value, element.where, folders_);
        if (std::error_code error; !std::filesystem::is_directory(folder, error))
            reject(element.where, "'{}' is not a folder", folder);
        files_.add_path(folder);
    }

    void include(std::vector<XmlElement>& target, const XmlElement& element, int depth) {
        element.check_attributes({"filename", "name"});
        element.check_no_children();
        if (depth == deepest_include)
            reject(element.where, "includes are nested deeper than {} files: circular?", deepest_include);
        const std::string path = files_.find(element.required("filename").value, element.where, folders_);
        const std::string text = read_file(path);
        hash_.add(text);
        XmlElement root = parse_xml(text, path);
        const SceneVersion outer = version_;
        if (const XmlAttribute* version = root.find("version")) version_ = parse_version(*version);
        folders_.insert(folders_.begin(), std::filesystem::path(path).parent_path().string());
        if (root.tag == "scene") include_children(target, root, element, depth);
        else include_object(target, root, element, depth);
        folders_.erase(folders_.begin());
        version_ = outer;
    }

    void include_children(std::vector<XmlElement>& target, XmlElement& root, const XmlElement& include, int depth) {
        if (const XmlAttribute* name = include.find("name"))
            throw InputError(name->where, "an include of a <scene> cannot have a name: it is not one object");
        for (auto& child : root.children)
            expand_into(target, child, depth + 1);
    }

    /// Adds the root as a child of the element that holds the <include>, under the name that the <include> gives.
    void include_object(std::vector<XmlElement>& target, XmlElement& root, const XmlElement& include, int depth) {
        std::erase_if(root.attributes, [](const XmlAttribute& a) { return a.name == "version"; });
        if (const XmlAttribute* name = include.find("name")) {
            std::erase_if(root.attributes, [](const XmlAttribute& a) { return a.name == "name"; });
            root.attributes.push_back(*name);
        }
        expand_into(target, root, depth + 1);
    }

    FileFinder& files_;
    Parameters& parameters_;
    ContentHash& hash_;
    LoadWarnings& warnings_;
    struct LeftOut {
        SourceLocation where;
        std::string what;
    };
    std::vector<LeftOut> left_out_;     ///< values that were left out
    bool is_incomplete_ = false;        ///< a parameter that cannot be left out has no value
    SceneVersion version_;              ///< version of the file that is read
    std::vector<std::string> folders_;  ///< folders of the included files that are open, the innermost first
};

}  // namespace

std::string FileFinder::find(const std::string& name, const SourceLocation& where,
                             const std::vector<std::string>& first) const {
    namespace fs = std::filesystem;
    std::vector<std::string> searched = first;
    searched.push_back(main_folder_);
    searched.insert(searched.end(), paths_.begin(), paths_.end());
    if (std::find(searched.begin(), searched.end(), "") == searched.end())
        searched.emplace_back();  // the working folder
    std::string with_slashes = name;
    std::replace(with_slashes.begin(), with_slashes.end(), '\\', '/');
    for (const std::string& spelling : {name, with_slashes})
        for (const std::string& folder : searched) {
            const fs::path path = fs::path(folder) / spelling;  // the name alone if it is absolute
            if (std::error_code error; spelling.empty() || !fs::exists(path, error)) continue;
            if (spelling != name) warnings_.add(where, fmt::format("'{}' is read as '{}'", name, spelling));
            return path.string();
        }
    for (const std::string& folder : searched)
        if (const std::string alike = file_in_other_capitals(fs::path(folder) / with_slashes); !alike.empty())
            reject(where, "there is no file '{}', but there is '{}': capitals matter", name, alike);
    if (fs::path(name).is_absolute()) reject(where, "there is no file '{}'", name);
    std::replace(searched.begin(), searched.end(), std::string(), std::string("."));
    reject(where, "there is no file '{}'; searched: {}", name, fmt::join(searched, ", "));
}

void XmlIds::collect(const XmlElement& element) {
    for (const auto& child : element.children) {
        if (child.tag == "alias") {
            child.check_attributes({"id", "as"});
            child.check_no_children();
            insert(child.required("as").value, resolve(child), child.required("as").where);
        } else if (child.tag == "ref") {
            const XmlAttribute* id = child.find("id");
            const auto object = id ? objects_.find(id->value) : objects_.end();
            if (object != objects_.end()) earlier_.emplace(&child, object->second);
        } else {
            collect(child);
            if (const XmlAttribute* id = child.find("id")) insert(id->value, child, id->where);
        }
    }
}

const XmlElement* XmlIds::find(const XmlElement& ref) const {
    if (const auto earlier = earlier_.find(&ref); earlier != earlier_.end()) return earlier->second;
    const XmlAttribute* id = ref.find("id");
    const auto object = id ? objects_.find(id->value) : objects_.end();
    return object == objects_.end() ? nullptr : object->second;
}

void XmlIds::collect_uses(const XmlElement& element) {
    for (const auto& child : element.children) {
        if (child.tag == "ref") used_.insert(find(child));
        collect_uses(child);
    }
}

void XmlIds::insert(const std::string& id, const XmlElement& object, const SourceLocation& where) {
    const auto [it, is_new] = objects_.emplace(id, &object);
    if (is_new) return;
    const SourceLocation first = it->second->where;
    warnings_.add(where, fmt::format("the id '{}' is given twice, before at {}:{}:{}: a reference means the last one "
                                     "before it",
                                     id, first.file, first.line, first.column));
    it->second = &object;
}

const XmlElement& XmlIds::resolve(const XmlElement& ref) const {
    const XmlAttribute& id = ref.required("id");
    const XmlElement* object = find(ref);
    if (!object) reject(id.where, "there is no object with the id '{}'", id.value);
    return *object;
}

ExpandedXml expand_xml(const std::string& text, const std::string& path,
                       const std::map<std::string, std::string>& parameters, const std::vector<std::string>& folders,
                       ContentHash& hash, LoadWarnings& warnings) {
    for (const auto& [name, value] : parameters)
        hash.add(fmt::format("parameter {}={}", name, value));
    FileFinder files(std::filesystem::path(path).parent_path().string(), warnings);
    for (auto folder = folders.rbegin(); folder != folders.rend(); ++folder)
        files.add_path(*folder);  // the first is searched first
    Parameters values(parameters);
    XmlElement root = Expander(files, values, hash, warnings).expand_main(text, path);
    values.check_all_known(path);
    return {std::move(root), std::move(files)};
}

}  // namespace gib
