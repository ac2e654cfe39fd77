#include "experiments/manifest.h"

#include "experiments/build_info.h"

#include <nlohmann/json.hpp>

#include <ctime>
#include <fstream>
#include <thread>

namespace gib {

namespace {

std::string utc_date() {
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    gmtime_r(&now, &utc);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    return text;
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

std::string manifest_text(const ResultIndex& index, const std::string& command_line) {
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
        j["scenes"].push_back({{"name", scene.name},
                               {"file", scene.path},
                               {"content_hash", scene.content_hash},
                               {"reference", scene.reference},
                               {"reference_method", scene.reference_method}});
    j["methods"] = index.methods;
    j["seeds"] = index.seeds;
    j["epsilon"] = index.epsilon;
    j["date"] = utc_date();
    j["command_line"] = command_line;
    j["experiment"] = index.experiment_text;
    return j.dump(2) + "\n";
}

}  // namespace gib
