#include "experiments/results/result_folder.h"

#include "common/core/files.h"
#include "experiments/measuring/measurement_json.h"
#include "experiments/plan/run_limits.h"
#include "experiments/text/json_file.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace gib {

using nlohmann::json;

namespace {

json to_json(const ImageError& e) {
    return {{"mse", number_to_json(e.mse)},
            {"rmse", number_to_json(e.rmse)},
            {"rel_mse", number_to_json(e.rel_mse)},
            {"mse_corrected", number_to_json(e.mse_corrected)},
            {"rel_mse_corrected", number_to_json(e.rel_mse_corrected)}};
}

ImageError error_from(const json& j) {
    return {.mse = number_from_json(j.at("mse")),
            .rmse = number_from_json(j.at("rmse")),
            .rel_mse = number_from_json(j.at("rel_mse")),
            .mse_corrected = number_from_json(j.at("mse_corrected")),
            .rel_mse_corrected = number_from_json(j.at("rel_mse_corrected"))};
}

json to_json(const Cell& cell) {
    json checkpoints = json::array();
    for (const auto& c : cell.checkpoints) {
        json entry = checkpoint_to_json(c.checkpoint);
        for (const auto& [name, error] : c.errors)
            entry["errors"][name] = to_json(error);
        checkpoints.push_back(entry);
    }
    return {{"complete", true},
            {"scene", cell.scene},
            {"method", cell.method},
            {"seed", cell.seed},
            {"key", cell.key},
            {"build", cell.build},
            {"image", cell.image},
            {"image_file", cell.image_file},
            {"load_seconds", cell.load_seconds},
            {"prepare_seconds", cell.prepare_seconds},
            {"converged", cell.converged},
            {"checkpoints", checkpoints},
            {"stages", stages_to_json(cell.stages)}};
}

Cell cell_from(const json& j) {
    Cell cell;
    cell.scene = j.at("scene");
    cell.method = j.at("method");
    cell.seed = j.at("seed");
    cell.key = j.at("key");
    cell.build = j.at("build");
    cell.image = j.value("image", "");
    cell.image_file = j.value("image_file", "");
    cell.load_seconds = j.at("load_seconds");
    cell.prepare_seconds = j.at("prepare_seconds");
    cell.converged = j.at("converged");
    for (const auto& entry : j.at("checkpoints")) {
        cell.checkpoints.push_back({checkpoint_from_json(entry), {}});
        for (const auto& [name, error] : entry.at("errors").items())
            cell.checkpoints.back().errors[name] = error_from(error);
    }
    cell.stages = stages_from_json(j.at("stages"));
    return cell;
}

json to_json(const IndexScene& s) {
    return {{"name", s.name},
            {"path", s.path},
            {"content_hash", s.content_hash},
            {"reference", s.reference},
            {"reference_method", s.reference_method},
            {"target", s.target ? json(*s.target) : json(nullptr)},
            {"notes", s.notes}};
}

IndexScene scene_from(const json& j) {
    IndexScene s{.name = j.at("name"),
                 .path = j.at("path"),
                 .content_hash = j.at("content_hash"),
                 .reference = j.at("reference"),
                 .reference_method = j.at("reference_method"),
                 .target = {},
                 .notes = j.at("notes")};
    if (!j.at("target").is_null()) s.target = j.at("target").get<double>();
    return s;
}

}  // namespace

std::string CellIdentity::key() const {
    ContentHash hash;
    for (const auto& piece : {std::string("cell 1"), scene, method, std::to_string(seed), scene_hash,
                              std::to_string(spp), budget.seconds ? fmt::format("{}", *budget.seconds) : "",
                              budget.passes ? fmt::format("{}", *budget.passes) : "", fmt::format("{}", epsilon),
                              std::to_string(threads), reference})
        hash.add(piece);
    return hash.hex();
}

std::string CellIdentity::folder_name() const {
    ContentHash hash;
    hash.add(scene);
    hash.add(method);
    // The digits distinguish labels that differ only in unsafe characters or beyond the cut, so that
    // their names are equal.
    return fmt::format("{}-{}-{}-s{}", file_name_of(scene), file_name_of(method), hash.hex().substr(0, 6), seed);
}

void ResultFolder::make(const std::string& path) {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (error == std::errc::no_space_on_device)
        throw RunError(fmt::format("cannot make the folder '{}': {}", path, error.message()));
    if (error || !std::filesystem::is_directory(path))
        throw InputError(
            fmt::format("cannot make the folder '{}': {}", path, error ? error.message() : "a file is in the way"));
}

std::string result_folder_of(const std::string& experiment) {
    for (const char* taken : {"references", ".", ".."})
        if (experiment == taken)
            throw InputError(
                fmt::format("an experiment cannot be named '{}': its results would go to results/{}; give "
                            "the file another name, or --out",
                            experiment, experiment));
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
    if (!fs::is_directory(path_ + "/cells")) return;
    for (const auto& cell : fs::directory_iterator(path_ + "/cells")) {
        const std::string name = cell.path().filename().string();
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

void ResultFolder::write_index(const ResultIndex& index) const {
    json j = {{"format", "gibench results 1"}, {"title", index.title},    {"experiment", index.experiment_text},
              {"epsilon", index.epsilon},      {"seeds", index.seeds},    {"threads", index.threads},
              {"methods", index.methods},      {"cells", index.cell_keys}};
    j["scenes"] = json::array();
    for (const auto& scene : index.scenes)
        j["scenes"].push_back(to_json(scene));
    j["effects_missing"] = json::array();
    for (const auto& [cell, effects] : index.effects_missing)
        j["effects_missing"].push_back({{"scene", cell.first}, {"method", cell.second}, {"effects", effects}});
    write_file(file("index.json"), j.dump(2) + "\n");
}

ResultIndex ResultFolder::read_index() const {
    const std::string path = file("index.json");
    if (!std::filesystem::exists(path))
        throw InputError(fmt::format("'{}' holds no results: there is no {}", path_, path));
    try {
        const json j = read_json(path);
        ResultIndex index;
        index.title = j.at("title");
        index.experiment_text = j.at("experiment");
        index.epsilon = j.at("epsilon");
        require_epsilon(index.epsilon, {path});
        index.seeds = count_from_json(j, "seeds", path, 1, most_seeds);
        index.threads = count_from_json(j, "threads", path, 0, most_threads);
        index.methods = j.at("methods").get<std::vector<std::string>>();
        index.cell_keys = j.at("cells").get<std::map<std::string, std::string>>();
        for (const auto& scene : j.at("scenes"))
            index.scenes.push_back(scene_from(scene));
        for (const auto& m : j.at("effects_missing"))
            index.effects_missing[{m.at("scene"), m.at("method")}] = m.at("effects");
        return index;
    } catch (const json::exception& error) {
        throw InputError({path}, fmt::format("not an index of results: {}", error.what()));
    }
}

void ResultFolder::write_cell(const std::string& folder_name, const Cell& cell) const {
    json record = to_json(cell);
    record["digest"] = json_digest(record);
    write_file(cell_folder(folder_name) + "/cell.json", record.dump(1) + "\n");
}

std::optional<Cell> ResultFolder::read_cell(const std::string& folder_name, const std::string& key,
                                            std::string* damage) const {
    const std::string path = cell_folder(folder_name) + "/cell.json";
    if (!std::filesystem::exists(path)) return std::nullopt;
    const auto damaged = [&](const std::string& file, const char* how) {
        if (damage) *damage = fmt::format("{}: {}", file, how);
        return std::nullopt;
    };
    try {
        json j = read_json(path);
        const std::string digest = j.value("digest", "");
        j.erase("digest");
        // A record may lack a digest, which older files do not have; it is then accepted unchecked.
        if (!digest.empty() && digest != json_digest(j))
            return damaged(path, "its content is not what its digest says");
        if (j.at("key") != key || j.at("complete") != true) return std::nullopt;
        Cell cell = cell_from(j);
        if (cell.checkpoints.empty()) return damaged(path, "it holds no checkpoint");
        const std::string image = cell_image(folder_name);
        if (!std::filesystem::exists(image)) return damaged(image, "the file is missing");
        if (!cell.image_file.empty() && cell.image_file != file_hash(image))
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
    CellIdentity identity;
    identity.scene = scene;
    identity.method = method;
    identity.seed = seed;
    return identity.folder_name();
}

}  // namespace gib
