#include "experiments/results/manifest.h"

#include "common/core/files.h"
#include "experiments/measuring/measurement_json.h"
#include "experiments/plan/run_limits.h"
#include "experiments/system/build_info.h"
#include "experiments/text/json_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <ctime>
#include <filesystem>
#include <fstream>
#include <thread>

namespace gib {

static auto json_fields(RecordOf<ManifestCell> auto& c) {
    return std::tuple(JsonField{"scene", c.scene}, JsonField{"method", c.method}, JsonField{"seed", c.seed},
                      JsonField{"passes", c.passes}, JsonField{"image", c.image});
}

static auto json_fields(RecordOf<Manifest::Scene> auto& s) {
    return std::tuple(JsonField{"name", s.name}, JsonField{"file", s.file}, JsonField{"content_hash", s.content_hash},
                      JsonField{"reference", s.reference}, JsonField{"reference_method", s.reference_method});
}

namespace {

std::string utc_date() {
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    gmtime_r(&now, &utc);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    return text;
}

std::string commit_text(const std::string& commit, bool modified) {
    return commit + (modified ? " and uncommitted changes" : "");
}

}  // namespace

std::string cpu_model() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);) {
        const std::size_t colon = line.find(": ");
        if (line.rfind("model name", 0) == 0 && colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown";
}

std::string manifest_text(const ResultIndex& index, const ManifestRun& run) {
    const BuildInfo& build = build_info();
    nlohmann::ordered_json j;
    j["title"] = index.title;
    j["program"] = program_version();
    j["commit"] = build.commit;
    j["modified"] = build.modified;
    j["executable_sha1"] = executable_hash();
    j["compiler"] = build.compiler;
    j["flags"] = build.flags;
    j["build_type"] = build.build_type;
    j["cpu"] = cpu_model();
    j["processors"] = std::thread::hardware_concurrency();
    j["threads"] = index.threads;
    for (const auto& [name, version] : build.libraries)
        j["libraries"][name] = version;
    for (const auto& scene : index.scenes)
        j["scenes"].push_back(
            Manifest::Scene{scene.name, scene.path, scene.content_hash, scene.reference, scene.reference_method});
    j["methods"] = index.methods;
    j["seeds"] = index.seeds;
    j["epsilon"] = index.epsilon;
    j["date"] = utc_date();
    j["command_line"] = run.command_line;
    j["working_folder"] = std::filesystem::current_path().string();
    j["experiment_file"] = run.experiment_file;
    j["experiment"] = index.experiment_text;
    j["resolution"] = run.resolution;  // null: the scenes' own
    j["cells"] = run.cells;
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
        m.threads = static_cast<int>(count_from_json(j, "threads", path, 0, most_threads));
        m.seeds = static_cast<int>(count_from_json(j, "seeds", path, 1, most_seeds));
        for (const auto& cell : j.at("cells")) {
            count_from_json(cell, "seed", path, 1, most_seeds);
            count_from_json(cell, "passes", path, 1, most_passes);
        }
        j.at("scenes").get_to(m.scenes);
        j.at("cells").get_to(m.cells);
        const auto text = [&](const char* key) { return j.at(key).get<std::string>(); };
        m.machine = {{"program", text("program")},       {"commit", commit_text(text("commit"), j.at("modified"))},
                     {"compiler", text("compiler")},     {"flags", text("flags")},
                     {"build type", text("build_type")}, {"processor", text("cpu")}};
        for (const auto& [name, version] : j.at("libraries").items())
            m.machine[name] = version.get<std::string>();
        return m;
    } catch (const json::parse_error&) {
        throw InputError({path}, "not a manifest of results");
    } catch (const json::exception& error) {
        throw InputError({path}, fmt::format("not a manifest that can be repeated: {}", error.what()));
    }
}

std::map<std::string, std::string> this_machine() {
    const BuildInfo& build = build_info();
    std::map<std::string, std::string> machine = {
        {"program", program_version()},   {"commit", commit_text(build.commit, build.modified)},
        {"compiler", build.compiler},     {"flags", build.flags},
        {"build type", build.build_type}, {"processor", cpu_model()}};
    for (const auto& [name, version] : build.libraries)
        machine[name] = version;
    return machine;
}

}  // namespace gib
