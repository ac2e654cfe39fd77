#include "experiments/report/tuning_section.h"

#include "common/core/error.h"
#include "experiments/text/embedded_files.h"
#include "experiments/text/json_file.h"

#include <fmt/format.h>

#include <filesystem>

namespace gib {

namespace {

using kainjow::mustache::data;
using kainjow::mustache::list;
using kainjow::mustache::object;
using nlohmann::json;

list texts_in(const json& texts) {
    list all;
    for (const json& text : texts)
        all.push_back(text.get<std::string>());
    return all;
}

data words_of(const json& tuning) {
    list methods, charts;
    for (std::size_t m = 0; m < tuning.at("methods").size(); ++m) {
        const json& method = tuning["methods"][m];
        methods.push_back(object{{"paste", method.at("paste").get<std::string>()},
                                 {"verdict", method.at("verdict").get<std::string>()},
                                 {"best", tuning.at("best") == m}});
        if (!method.at("parameters").empty())
            charts.push_back(object{{"number", std::to_string(m)}, {"base", method.at("base").get<std::string>()}});
    }
    return object{{"target", tuning.at("target").get<std::string>()},
                  {"methods", methods},
                  {"lines", texts_in(tuning.at("lines"))},
                  {"cuts", texts_in(tuning.at("cuts"))},
                  {"charts", charts}};
}

}  // namespace

void add_tuning(const ResultFolder& folder, data& page, json& numbers) {
    page["tuning"] = data(false);
    page["tuning_section"] = std::string(embedded_file("report_page/tuning.html"));
    const std::string file = folder.file("tune.json");
    if (!std::filesystem::exists(file)) return;
    try {
        json tuning = read_json(file);
        page["tuning"] = words_of(tuning);
        numbers["tuning"] = std::move(tuning);
    } catch (const json::exception& error) {
        throw InputError({file}, fmt::format("not the numbers of a tuning: {}", error.what()));
    }
}

}  // namespace gib
