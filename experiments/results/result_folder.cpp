#include "experiments/results/result_folder.h"

#include "common/core/files.h"
#include "common/core/reject.h"
#include "experiments/measuring/measurement_json.h"
#include "experiments/metrics/epsilon.h"
#include "experiments/system/file_lock.h"
#include "experiments/text/json_record.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace gib {

using nlohmann::json;

static auto json_fields(RecordOf<ImageError> auto& e) {
    return std::tuple(JsonField{"mse", e.mse}, JsonField{"rel_mse", e.rel_mse},
                      JsonField{"mse_corrected", e.mse_corrected}, JsonField{"rel_mse_corrected", e.rel_mse_corrected});
}

}  // namespace gib

/// An object with the names of the layers.
template <>
struct nlohmann::adl_serializer<std::map<gib::Layer, gib::ImageError>, void> {
    static void to_json(json& j, const std::map<gib::Layer, gib::ImageError>& errors) {
        j = json::object();
        for (const auto& [layer, error] : errors)
            j[std::string(gib::name_of(layer))] = error;
    }
    static void from_json(const json& j, std::map<gib::Layer, gib::ImageError>& errors) {
        for (const auto& [name, error] : j.items())
            if (const auto layer = gib::layer_named(name)) errors[*layer] = error.get<gib::ImageError>();
    }
};

namespace gib {

static auto json_fields(RecordOf<CellCheckpoint> auto& c) {
    return std::tuple_cat(json_fields(c.checkpoint), std::tuple(JsonField{"errors", c.errors}));
}

static auto json_fields(RecordOf<Cell> auto& c) {
    return std::tuple(JsonField{"scene", c.scene}, JsonField{"method", c.method}, JsonField{"seed", c.seed},
                      JsonField{"key", c.key}, JsonField{"build", c.build}, JsonField{"image", c.image},
                      JsonField{"image_file", c.image_file}, JsonField{"load_seconds", c.load_seconds},
                      JsonField{"prepare_seconds", c.prepare_seconds}, JsonField{"converged", c.converged},
                      JsonField{"checkpoints", c.checkpoints}, JsonField{"stages", c.stages}, JsonField{"cpu", c.cpu},
                      JsonField{"processor_seconds", c.processor_seconds},
                      JsonField{"waiting_seconds", c.waiting_seconds});
}

static auto json_fields(RecordOf<IndexScene> auto& s) {
    return std::tuple(JsonField{"name", s.name}, JsonField{"path", s.path}, JsonField{"content_hash", s.content_hash},
                      JsonField{"reference", s.reference}, JsonField{"reference_method", s.reference_method},
                      JsonField{"target", s.target}, JsonField{"notes", s.notes});
}

static auto json_fields(RecordOf<ResultIndex> auto& i) {
    return std::tuple(JsonField{"title", i.title}, JsonField{"experiment", i.experiment_text},
                      JsonField{"epsilon", i.epsilon}, JsonField{"seeds", i.seeds}, JsonField{"threads", i.threads},
                      JsonField{"scenes", i.scenes}, JsonField{"methods", i.methods}, JsonField{"cells", i.cell_keys},
                      JsonField{"externals", i.externals}, JsonField{"names", i.given_names});
}

std::string CellIdentity::key() const {
    ContentHash hash;
    for (const auto& piece : {fmt::format("cell {}", definitions_version), scene, method, std::to_string(seed),
                              scene_hash, std::to_string(spp), budget.seconds ? fmt::format("{}", *budget.seconds) : "",
                              budget.passes ? fmt::format("{}", *budget.passes) : "",
                              epsilon ? fmt::format("{}", *epsilon) : "relative", std::to_string(threads), reference})
        hash.add(piece);
    if (!command.empty()) hash.add("command " + command);
    return hash.hex();
}

static Effects effects_named(const std::string& names) {
    Effects effects;
    for (const EffectDescription& d : effect_descriptions())
        if ((";" + names + ";").find(";" + std::string(d.name) + ";") != std::string::npos) effects.add(d.effect);
    return effects;
}

LeftOut ResultIndex::left_out_by(const std::string& scene, const std::string& label) const {
    const auto found = left_out.find({scene, label});
    return found == left_out.end() ? LeftOut() : found->second;
}

bool ResultIndex::is_external(const std::string& label) const {
    return std::ranges::find(externals, label) != externals.end();
}

void ResultFolder::make(const std::string& path) {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (error == std::errc::no_space_on_device)
        throw RunError(fmt::format("cannot make the folder '{}': {}", path, error.message()));
    if (error || !std::filesystem::is_directory(path))
        reject({}, "cannot make the folder '{}': {}", path, error ? error.message() : "a file is in the way");
}

std::string result_folder_of(const std::optional<std::string>& out, const std::string& experiment) {
    if (out) return *out;
    for (const char* taken : {"references", ".", ".."})
        if (experiment == taken)
            reject({},
                   "an experiment cannot be named '{}': its results would go to results/{}; give "
                   "the file another name, or --out",
                   experiment, experiment);
    return "results/" + experiment;
}

void require_writable(const std::string& folder) {
    std::string file = folder + "/.gibench.tmp-XXXXXX";
    const int fd = ::mkostemp(file.data(), O_CLOEXEC);
    if (fd < 0) {
        const int error = errno;
        const auto message = fmt::format("cannot write in the folder '{}': {}", folder, std::strerror(error));
        if (error == ENOSPC || error == EDQUOT) throw RunError(message);
        throw InputError(message);
    }
    ::unlink(file.c_str());
    ::close(fd);
}

void ResultFolder::prepare() const {
    for (const auto& folder : {path_, path_ + "/cells", path_ + "/images"}) {
        make(folder);
        require_writable(folder);
    }
}

void ResultFolder::remove_leftovers() const {
    namespace fs = std::filesystem;
    remove_leftovers_in(path_);
    remove_leftovers_in(path_ + "/images");
    for (const auto& entry : fs::directory_iterator(path_))  // folders of other renderers' cells (cell_runner.cpp)
        if (entry.path().filename().string().starts_with("command-")) fs::remove_all(entry.path());
    if (!fs::is_directory(path_ + "/cells")) return;
    for (const auto& cell : fs::directory_iterator(path_ + "/cells")) {
        const std::string name = cell.path().filename().string();
        const auto lock = FileLock::if_free(cell_lock(name));
        if (!lock) continue;
        fs::remove_all(work_folder(name));
        remove_leftovers_in(cell.path().string());
        remove_leftovers_in((cell.path() / "frames").string());
    }
}

std::string ResultFolder::method_file(const std::string& scene, const std::string& method,
                                      const std::string& ending) const {
    std::string name = file_name_of(method);
    if (name.size() < method.size()) {  // it was cut, and labels with the same beginning must not share a file
        ContentHash hash;
        hash.add(method);
        name += "-" + hash.hex().substr(0, 6);
    }
    return fmt::format("{}/images/{}-{}{}", path_, scene, name, ending);
}

void ResultFolder::require_known_format() const {
    for (const char* name : {"index.json", "manifest.json"}) {
        const std::string path = file(name);
        if (!std::filesystem::exists(path)) continue;
        const json j = json::parse(read_file(path), nullptr, false);
        if (!j.is_object() || !j.contains("format") || j["format"] == results_format) continue;
        reject({path},
               "the results are of another format, {}, and this program reads only {}: use the version of gibench that "
               "made them",
               j["format"].dump(), json(results_format).dump());
    }
}

void ResultFolder::write_index(const ResultIndex& index) const {
    json j = index;
    j["format"] = results_format;
    j["definitions"] = index.definitions;
    j["effects_missing"] = json::array();
    for (const auto& [cell, left_out] : index.left_out)
        j["effects_missing"].push_back({{"scene", cell.first},
                                        {"method", cell.second},
                                        {"effects", left_out.effects.names()},
                                        {"components", names_of(left_out.components.list())}});
    write_file(file("index.json"), j.dump(2) + "\n");
}

ResultIndex ResultFolder::read_index() const {
    const std::string path = file("index.json");
    if (!std::filesystem::exists(path)) reject({}, "'{}' holds no results: there is no {}", path_, path);
    require_known_format();
    try {
        const json j = read_json(path);
        auto index = j.get<ResultIndex>();
        index.definitions = j.value("definitions", 1);
        if (index.epsilon) require_epsilon(*index.epsilon, {path});
        for (const auto& m : j.at("effects_missing"))
            index.left_out[{m.at("scene"), m.at("method")}] = {effects_named(m.at("effects")),
                                                               Components(components_named(m.at("components")))};
        return index;
    } catch (const json::exception& error) {
        reject({path}, "not an index of results: {}", error.what());
    }
}

void ResultFolder::write_cell(const std::string& folder_name, const Cell& cell) const {
    write_sealed_json(cell_record(folder_name), cell);
}

std::optional<Cell> ResultFolder::read_cell(const std::string& folder_name, const std::string& key,
                                            std::string* damage) const {
    const std::string path = cell_record(folder_name);
    if (!std::filesystem::exists(path)) return std::nullopt;
    const auto damaged = [&](const std::string& file, const char* how) {
        if (damage) *damage = fmt::format("{}: {}", file, how);
        return std::nullopt;
    };
    try {
        const json j = read_sealed_json(path);
        if (j.is_null()) return damaged(path, "its content is not what its digest says");
        if (j.at("key") != key) return std::nullopt;
        auto cell = j.get<Cell>();
        if (cell.checkpoints.empty()) return damaged(path, "it holds no checkpoint");
        const std::string image = cell_image(folder_name);
        if (!std::filesystem::exists(image)) return damaged(image, "the file is missing");
        if (cell.image_file != file_hash(image))
            return damaged(image, "its content is not that of the image that was rendered");
        return cell;
    } catch (const json::exception&) {
        return damaged(path, "it is not a record of a cell");
    } catch (const InputError&) {
        return damaged(path, "it cannot be read");
    }
}

std::string file_hash(const std::string& path) {
    ContentHash hash;
    hash.add(read_file(path));
    return hash.hex();
}

std::string file_name_of(const std::string& text) {
    std::string name;
    for (const char c : text.substr(0, 100)) {
        const bool plain =
            std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '_' || c == '-' || c == '=' || c == '+';
        name += plain ? c : '_';
    }
    if (!name.empty() && name.front() == '.') name.front() = '_';
    return name;
}

std::string cell_folder_name(const std::string& scene, const std::string& method, std::uint64_t seed) {
    ContentHash hash;
    hash.add(scene);
    hash.add(method);
    // The digits distinguish labels that differ only in unsafe characters or beyond the cut, so that
    // their names are equal.
    return fmt::format("{}-{}-{}-s{}", file_name_of(scene), file_name_of(method), hash.hex().substr(0, 6), seed);
}

}  // namespace gib
