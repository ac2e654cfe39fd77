#include "experiments/results/manifest.h"

#include "experiments/system/build_info.h"
#include "experiments/text/json_record.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <ctime>
#include <filesystem>
#include <thread>

namespace gib {

static auto json_fields(RecordOf<Manifest::Scene> auto& s) {
    return std::tuple(JsonField{"name", s.name}, JsonField{"file", s.file}, JsonField{"content_hash", s.content_hash},
                      JsonField{"reference", s.reference}, JsonField{"reference_method", s.reference_method});
}

namespace {

/// The part of a manifest about this program and its machine.
nlohmann::ordered_json machine_json() {
    const BuildInfo& build = build_info();
    nlohmann::ordered_json j = {{"program", program_version()},
                                {"commit", build.commit},
                                {"modified", build.modified},
                                {"compiler", build.compiler},
                                {"flags", build.flags},
                                {"build_type", build.build_type},
                                {"cpu", cpu_model()}};
    for (const auto& [name, version] : build.libraries)
        j["libraries"][name] = version;
    return j;
}

/// Manifest::machine.
std::map<std::string, std::string> machine_in(const nlohmann::json& j) {
    std::map<std::string, std::string> machine = j.at("libraries");
    for (const auto& [what, key] : {std::pair("program", "program"),
                                    {"compiler", "compiler"},
                                    {"flags", "flags"},
                                    {"build type", "build_type"},
                                    {"processor", "cpu"}})
        machine[what] = j.at(key).get<std::string>();
    machine["commit"] = j.at("commit").get<std::string>() + (j.at("modified") ? " and uncommitted changes" : "");
    return machine;
}

}  // namespace

std::string manifest_text(const ResultIndex& index, const ManifestRun& run) {
    nlohmann::ordered_json j;
    j["format"] = results_format;
    j["title"] = index.title;
    j.update(machine_json());
    j["executable_sha1"] = executable_hash();
    j["processors"] = std::thread::hardware_concurrency();
    j["threads"] = index.threads;
    for (const auto& scene : index.scenes) {
        j["scenes"].push_back(
            Manifest::Scene{scene.name, scene.path, scene.content_hash, scene.reference, scene.reference_method});
        const auto unjudged = run.unjudged.find(scene.name);
        j["scenes"].back()["quantities"] =
            quantities_of(index, scene, unjudged == run.unjudged.end() ? Components() : unjudged->second);
    }
    j["methods"] = index.methods;
    j["seeds"] = index.seeds;
    j["epsilon"] = index.epsilon;
    j["date"] = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
    j["command_line"] = run.command_line;
    j["working_folder"] = std::filesystem::current_path().string();
    j["experiment_file"] = run.experiment_file;
    j["experiment"] = index.experiment_text;
    j["resolution"] = run.resolution;  // null: the scenes' own
    j["cells"] = nlohmann::ordered_json::array();
    for (const Cell& cell : run.cells)
        j["cells"].push_back({{"scene", cell.scene},
                              {"method", cell.method},
                              {"seed", cell.seed},
                              {"passes", cell.last().passes},
                              {"image", cell.image}});
    // Command lines and folders may hold bytes that are not UTF-8.
    return j.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

Manifest read_manifest(const std::string& path) {
    using nlohmann::json;
    try {
        const json j = read_json(path);
        if (!j.is_object() || !j.contains("experiment")) throw InputError({path}, "not a manifest of results");
        Manifest m;
        j.at("experiment_file").get_to(m.experiment_file);
        j.at("working_folder").get_to(m.working_folder);
        j.at("experiment").get_to(m.experiment_text);
        j.at("threads").get_to(m.threads);
        j.at("seeds").get_to(m.seeds);
        j.at("epsilon").get_to(m.epsilon);
        j.at("scenes").get_to(m.scenes);
        for (std::size_t i = 0; i < m.scenes.size(); ++i)
            m.scenes[i].quantities = j["scenes"][i].value("quantities", Quantities());
        for (const json& entry : j.at("cells")) {
            Cell& cell = m.cells.emplace_back();
            entry.at("scene").get_to(cell.scene);
            entry.at("method").get_to(cell.method);
            entry.at("seed").get_to(cell.seed);
            entry.at("image").get_to(cell.image);
            entry.at("passes").get_to(cell.checkpoints.emplace_back().checkpoint.passes);
        }
        m.machine = machine_in(j);
        return m;
    } catch (const json::parse_error&) {
        throw InputError({path}, "not a manifest of results");
    } catch (const json::exception& error) {
        throw InputError({path}, fmt::format("not a manifest that can be repeated: {}", error.what()));
    }
}

std::map<std::string, std::string> this_machine() { return machine_in(machine_json()); }

}  // namespace gib
